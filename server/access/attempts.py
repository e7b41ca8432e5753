"""How many invalid tokens an address has shown: a few are slips, more is somebody who tries.

The same one again is no further try: a page whose token was revoked goes on asking with it.
"""

from __future__ import annotations

import time
from collections import OrderedDict, deque
from collections.abc import Callable

from server.edge.authority import network_of

ALLOWED = 10
"""Wrong tokens within the window that are answered as such."""

WINDOW = 60.0
"""How long a failure counts [s]."""

ADDRESSES = 4096
"""Addresses that are kept; the one that failed longest ago is forgotten first."""


class Attempts:
    """Wrong tokens of the last minute, by address; bounded in memory."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._failures: OrderedDict[str, deque[tuple[float, int]]] = OrderedDict()

    def failed(self, address: str, secret: str) -> float | None:
        """Count a wrong token, once; how long that address has to wait [s], or None if it may go on trying."""
        now = self._clock()
        address = network_of(address)
        tried = self._failures.setdefault(address, deque(maxlen=ALLOWED))
        self._failures.move_to_end(address)
        if len(self._failures) > ADDRESSES:
            self._failures.popitem(last=False)
        while tried and now - tried[0][0] >= WINDOW:
            tried.popleft()
        which = hash(secret)
        if any(which == known for _, known in tried):
            return None
        if len(tried) == ALLOWED:
            return WINDOW - (now - tried[0][0])
        tried.append((now, which))
        return None
