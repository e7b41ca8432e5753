"""The clock of one end of the link: the wall's at the start, then steady."""

from __future__ import annotations

import time


class Clock:
    """Whole nanoseconds; never steps, whatever happens to the machine's own clock."""

    def __init__(self, offset: float = 0.0) -> None:
        """A clock that is this far ahead of the machine's [s]."""
        self._origin = time.time_ns() - time.monotonic_ns() + round(1e9 * offset)

    def now(self) -> int:
        """The time [ns]."""
        return time.monotonic_ns() + self._origin

    def at(self, monotonic: float) -> int:
        """The time at an instant of `time.monotonic` [s, ns]."""
        return round(1e9 * monotonic) + self._origin
