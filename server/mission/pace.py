"""The mission's clock against the wall's: which ticks are due, and how late they are.

Pure arithmetic on times passed in. The schedule is absolute: a late wake-up is caught up with, tick by
tick, and never stretches the mission's time. A simulation need not wait for the moment of each tick: those that come
due until the next wake-up are flown together, ahead of it, so that few wake-ups do and none of the ticks is late.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import deque

FULL_SPEED = 0.0
"""The speed that means: as fast as it goes."""

FAST_BATCH = 256
"""Ticks at once at full speed: some milliseconds, after which requests are looked at again."""

CATCH_UP = 0.02
"""Wall time that one turn may catch up with [s]."""

GIVE_UP = 0.5
"""Lateness beyond which the schedule is restarted, and the clock counts as slipped [s]."""

LATENESS_BOUNDS = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.5)
"""Upper ends of the classes in which lateness is counted, but for the last, which has none [s]."""

WINDOW = 1.0
"""Lateness and real-time factor are those of the last second."""


class Pace:
    """Running or paused, at a speed."""

    def __init__(self, period: float, now: float) -> None:
        self.period = period
        self.running = True
        self.speed = 1.0
        self.steps_left = 0
        self._anchor_time = now
        self._ticks_since = 0
        self._lead = 0.0
        """How far ahead of the wall's clock it was paused [s]."""
        self._scheduled = True
        self._lateness: deque[tuple[float, float]] = deque()
        self._flown: deque[tuple[float, int]] = deque()
        self.slips = 0
        self.lateness_counts = [0] * (len(LATENESS_BOUNDS) + 1)
        """Turns on a schedule, by how late their oldest tick was; see `LATENESS_BOUNDS`."""
        self.lateness_sum = 0.0
        """Of all these turns [s]."""

    def anchor(self, now: float) -> None:
        """Restart the schedule: the next tick is due one period from now."""
        self._anchor_time = now
        self._ticks_since = 0
        self._lead = 0.0

    def pause(self, now: float) -> None:
        """Hold the clock."""
        if self.running:
            self._lead = self._flown_ahead(now)
        self.running = False
        self.steps_left = 0

    def run(self, speed: float, now: float) -> None:
        """Let the clock go at this multiple of the wall's; 0 as fast as it goes."""
        # What was flown ahead stays flown: else pausing it or letting it run again and again would gain time.
        lead = self._flown_ahead(now) if self.running else self._lead
        self.running = True
        self.steps_left = 0
        self.speed = speed
        self.anchor(now + lead)

    def due(self, now: float, *, resting: bool, ahead: float = 0.0) -> int:
        """Ticks to fly now. Full speed is for a mission that does something: a resting one goes at real time.

        Args:
            now: wall time [s].
            resting: whether nothing is under way.
            ahead: how long before it is due a tick is flown [s].

        """
        if not self.running:
            return min(self.steps_left, FAST_BATCH)
        self._scheduled = self.speed != FULL_SPEED or resting
        if not self._scheduled:
            return FAST_BATCH
        late, period = now - self._due_time(resting), self._wall_period(resting)
        if late > GIVE_UP:
            self._note_lateness(now, late)
            self.slips += 1
            self.anchor(now)
            return 1
        scheduled = int((now + ahead - self._anchor_time) / period) - self._ticks_since
        if scheduled <= 0:
            return 0
        self._note_lateness(now, late)
        return min(scheduled, max(1, int((CATCH_UP + ahead) / period)), FAST_BATCH)

    def flown(self, ticks: int, now: float) -> None:
        """Count ticks that were flown."""
        if not self.running:
            self.steps_left = max(0, self.steps_left - ticks)
        self._ticks_since += ticks
        if not self._scheduled:
            self.anchor(now)
        self._flown.append((now, ticks))

    def wait(self, now: float, *, resting: bool, longest: float) -> float:
        """Wall time until the next tick is due, at most `longest` [s]."""
        if not self.running:
            return 0.0 if self.steps_left else longest
        if self.speed == FULL_SPEED and not resting:
            return 0.0
        return min(max(self._due_time(resting) - now, 0.0), longest)

    def lateness(self, now: float) -> float:
        """Worst lateness of a tick in the last second [s]."""
        _forget(self._lateness, now)
        return max((late for _, late in self._lateness), default=0.0)

    def real_time_factor(self, now: float) -> float:
        """Mission time flown in the last second of the wall clock, over that second."""
        _forget(self._flown, now)
        return sum(ticks for _, ticks in self._flown) * self.period / WINDOW

    def _wall_period(self, resting: bool) -> float:
        """Of a tick [s]; full speed is real time at rest."""
        speed = 1.0 if resting and self.speed == FULL_SPEED else self.speed
        return self.period / speed

    def _flown_ahead(self, now: float) -> float:
        """How far ahead of the wall's clock it has flown [s]."""
        return max(0.0, self._anchor_time + self._ticks_since * self._wall_period(resting=True) - now)

    def _due_time(self, resting: bool) -> float:
        return self._anchor_time + (self._ticks_since + 1) * self._wall_period(resting)

    def _note_lateness(self, now: float, late: float) -> None:
        late = max(late, 0.0)  # what is flown ahead is not late
        self._lateness.append((now, late))
        self.lateness_counts[bisect_left(LATENESS_BOUNDS, late)] += 1
        self.lateness_sum += late


def _forget(window: deque[tuple[float, float]] | deque[tuple[float, int]], now: float) -> None:
    while window and window[0][0] < now - WINDOW:
        window.popleft()
