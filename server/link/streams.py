"""How well a stream arrives: rate, age, jitter and loss over the last seconds; and the clock of the other end."""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

import numpy as np

from server.link.trouble import Trouble
from sim.compiled import FloatArray
from sim.errors import Cause

WINDOW = 2.0
"""Rate, jitter and loss are those of the last seconds [s]."""
KEPT = 1024
"""Arrivals that are kept at most."""
SILENCE = 0.5
"""A source that was silent for so long, and then stamps earlier than before, has restarted its clock [s]."""
OFFSET_WINDOW = 30.0
"""The clock's offset is that of the quickest round trip of the last seconds [s]."""
TRIPS_KEPT = 4096
"""Round trips that are kept each for itself: of twenty seconds."""
CLOCKS_APART = 0.005
"""Two steady clocks run apart by less in half a minute [s]."""
HISTORY_SPAN, HISTORY_STEP = 60.0, 0.2
"""How far back the worst of a time is kept, and how finely [s]."""


def clock_restarted(at: float, last: float) -> bool:
    """Whether an earlier stamp that comes at this instant is of a restarted clock, or was overtaken on its way.

    Among newer ones it was overtaken, however old it is; after a silence it is the source's present.
    """
    return at - last > SILENCE


class _Arrival(NamedTuple):
    stamp: int
    at: float


class Stream:
    """The arrivals of one stream. Stamps [ns] are the source's; arrivals `time.monotonic` [s]."""

    def __init__(self, rate: float) -> None:
        """A stream of this nominal rate [Hz]."""
        self.rate = rate
        self.received = 0
        self.lost = 0
        self._arrivals: deque[_Arrival] = deque(maxlen=KEPT)
        self._value: FloatArray | None = None
        self._changed_at = 0.0

    def arrive(self, stamp: int, value: FloatArray, at: float) -> bool:
        """Note an arrival; whether it is newer than all before, or the source's clock has restarted."""
        if self._arrivals and stamp <= self._arrivals[-1].stamp:
            if not clock_restarted(at, self._arrivals[-1].at):
                return False
            self._arrivals.clear()
        if self._arrivals:
            missing = round(1e-9 * (stamp - self._arrivals[-1].stamp) * self.rate) - 1
            self.lost += max(0, missing)
        self.received += 1
        self._arrivals.append(_Arrival(stamp, at))
        if self._value is None or not np.array_equal(value, self._value):
            self._value, self._changed_at = value, at
        return True

    @property
    def latest(self) -> int:
        """Stamp of the last arrival [ns]; 0 before the first."""
        return self._arrivals[-1].stamp if self._arrivals else 0

    def age(self, now: float) -> float | None:
        """Since the last arrival [s]; None before the first."""
        return max(0.0, now - self._arrivals[-1].at) if self._arrivals else None

    def steady(self, now: float, span: float, longest: float) -> bool:
        """Whether there were arrivals all the last span [s], with no gap as long as `longest` [s]."""
        recent = [each.at for each in list(self._arrivals) if each.at > now - span]
        edges = np.array([now - span, *recent, now])
        return bool((np.diff(edges) < longest).all())

    @property
    def unchanged_for(self) -> float:
        """How long the values that arrive have been the same [s]."""
        return self._arrivals[-1].at - self._changed_at if self._arrivals else 0.0

    def measured(self, now: float) -> tuple[float, float | None, float | None]:
        """Arrivals a second, standard deviation of their delay [s], and part lost; None where too few came."""
        recent = [each for each in list(self._arrivals) if each.at > now - WINDOW]
        if len(recent) < 2:
            return len(recent) / WINDOW, None, None
        delays = np.array([each.at - 1e-9 * (each.stamp - recent[0].stamp) for each in recent])
        expected = round(1e-9 * (recent[-1].stamp - recent[0].stamp) * self.rate) + 1
        loss = min(1.0, max(0.0, 1.0 - len(recent) / expected))
        return len(recent) / WINDOW, float(delays.std()), loss


class WorstOf:
    """The worst of some time in each step of the last minute; instants are `time.monotonic` [s]."""

    def __init__(self) -> None:
        self._steps: deque[tuple[int, float]] = deque(maxlen=round(HISTORY_SPAN / HISTORY_STEP))

    def note(self, value: float, at: float) -> None:
        """Note a value [s] of that instant."""
        step = int(at / HISTORY_STEP)
        if self._steps and self._steps[-1][0] >= step:
            value = max(value, self._steps.pop()[1])
        self._steps.append((step, value))

    def ago(self, now: float) -> dict[int, float]:
        """The worst of each step by how many steps ago it was, the oldest first; steps without any are left out."""
        present = int(now / HISTORY_STEP)
        return {present - step: value for step, value in list(self._steps) if now - step * HISTORY_STEP < HISTORY_SPAN}


class Trip(NamedTuple):
    """A heartbeat that came back."""

    at: float
    """`time.monotonic` [s]."""
    duration: float
    """There and back [s]."""
    offset: float
    """Robot's clock less console's, if both ways took the same time [s]."""


class OtherClock:
    """The offset of the other end's clock and the time of a round trip, from heartbeats that came back."""

    def __init__(self) -> None:
        self.worst = WorstOf()
        """Round trips."""
        self._jump: tuple[float, float] | None = None
        """By how much the other clock last jumped, and when [s]."""
        self._trips: deque[Trip] = deque(maxlen=TRIPS_KEPT)
        self._quickest: deque[Trip] = deque()
        """Those that are or may yet be the quickest of the window, the oldest and quickest first."""

    def note(self, sent: int, received: int, returned: int, at: float) -> None:
        """A heartbeat sent and returned by the console's clock and received by the robot's [ns], at `at` [s]."""
        middle = (sent + returned) // 2
        trip = Trip(at, 1e-9 * (returned - sent), 1e-9 * (received - middle))
        self._trips.append(trip)
        self.worst.note(trip.duration, at)
        if self._quickest:
            # Each offset is right to half of its round trip: what is beyond that is another clock than before.
            change = trip.offset - self._quickest[0].offset
            if abs(change) > 0.5 * (trip.duration + self._quickest[0].duration) + CLOCKS_APART:
                self._jump = (change, at)
                self._quickest.clear()
        while self._quickest and self._quickest[-1].duration >= trip.duration:
            self._quickest.pop()
        self._quickest.append(trip)
        while self._quickest[0].at < at - OFFSET_WINDOW:
            self._quickest.popleft()

    def reset(self) -> None:
        """Judge the offset by what comes from now on: the other end may have another clock."""
        self._quickest.clear()

    def jump(self, now: float, span: float) -> Trouble | None:
        """By how much the other end's clock jumped within the last span [s]; None if it did not."""
        if self._jump is None or now - self._jump[1] > span:
            return None
        return Trouble(Cause.CLOCK_JUMPED, f"the robot's clock jumped by {1e3 * self._jump[0]:+.0f} ms")

    @property
    def offset(self) -> float | None:
        """Robot's clock less console's, within half of that round trip [s]; None if nothing came back."""
        quickest = self._quickest
        return quickest[0].offset if quickest else None

    def age(self, now: float) -> float | None:
        """Since the last heartbeat came back [s]; None before the first."""
        return max(0.0, now - self._trips[-1].at) if self._trips else None

    def trips(self, since: float) -> list[Trip]:
        """Round trips after that instant of `time.monotonic` [s]."""
        return [trip for trip in list(self._trips) if trip.at > since]
