"""What was refused, counted; and logged once a second at most, however often it comes."""

from __future__ import annotations

import logging
import threading

LOG_PERIOD = 1.0
"""Between two lines of one kind [s]."""
MOST_KINDS = 64
"""Kinds that are distinguished; the oldest is forgotten."""


class ThrottledLog:
    """Log lines of one kind once a second at most; how many were left out stands in the next one. For any thread."""

    def __init__(self, log: logging.Logger) -> None:
        self._log = log
        self._kinds: dict[str, tuple[float, int]] = {}
        self._lock = threading.Lock()

    def warning(self, kind: str, message: str, at: float) -> None:
        """Log it, unless this kind was logged less than a second before that instant of `time.monotonic` [s]."""
        with self._lock:
            logged, left_out = self._kinds.pop(kind, (-LOG_PERIOD, 0))
            due = at - logged >= LOG_PERIOD
            if len(self._kinds) >= MOST_KINDS:
                self._kinds.pop(next(iter(self._kinds)))
            self._kinds[kind] = (at, 0) if due else (logged, left_out + 1)
        if due:
            self._log.warning("%s%s", message, f" ({left_out} more since the last line)" if left_out else "")


class Refusals:
    """What one stream was refused."""

    def __init__(self) -> None:
        self.count = 0
        self.reason = ""
        """The last."""
        self.at: float | None = None
        """`time.monotonic` of the last [s]."""

    def note(self, reason: str, at: float) -> None:
        """Count one."""
        self.count += 1
        self.reason, self.at = reason, at

    def age(self, now: float) -> float | None:
        """Since the last [s]; None if nothing was refused."""
        return None if self.at is None else max(0.0, now - self.at)
