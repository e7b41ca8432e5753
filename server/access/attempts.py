"""How often an address has shown a token that is none: a few times is a slip, more is somebody who tries."""

from __future__ import annotations

import ipaddress
import time
from collections import OrderedDict, deque
from collections.abc import Callable

ALLOWED = 10
"""Failures within the window that are answered as such."""

WINDOW = 60.0
"""How long a failure counts [s]."""

ADDRESSES = 4096
"""Addresses that are kept; the one that failed longest ago is forgotten first."""


class Attempts:
    """Failures of the last minute, by address; bounded in memory."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._failures: OrderedDict[str, deque[float]] = OrderedDict()

    def failed(self, address: str) -> float | None:
        """Count a failure; how long that address has to wait [s], or None if it may go on trying."""
        now = self._clock()
        address = network_of(address)
        times = self._failures.setdefault(address, deque(maxlen=ALLOWED))
        self._failures.move_to_end(address)
        if len(self._failures) > ADDRESSES:
            self._failures.popitem(last=False)
        while times and now - times[0] >= WINDOW:
            times.popleft()
        if len(times) == ALLOWED:
            return WINDOW - (now - times[0])
        times.append(now)
        return None


def network_of(address: str) -> str:
    """Whose address that is: of IPv6 somebody has a whole network, and as many addresses as they like."""
    try:
        found = ipaddress.ip_address(address)
    except ValueError:
        return address
    if isinstance(found, ipaddress.IPv4Address):
        return address
    if found.ipv4_mapped is not None:
        return str(found.ipv4_mapped)
    return str(ipaddress.IPv6Network((found.packed[:8] + bytes(8), 64)))
