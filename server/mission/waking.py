"""When the mission thread wakes, and how many ticks it flies then: by the mission's clock, or by the robot's."""

from __future__ import annotations

import threading
import time

from server.mission.feed import Feed
from server.mission.live_mission import LiveMission
from server.mission.pace import Pace
from server.mission.publisher import PUBLISH_PERIOD
from sim.control.phases import Phase

WAKE_PERIOD = PUBLISH_PERIOD
"""Between two wake-ups of a simulation [s], unless somebody asks for something: nobody sees what is between."""

IDLE_PERIOD = 0.1
"""The same while nothing is under way and nobody watches [s]."""

AHEAD = 1.2
"""How far before they are due ticks are flown, as a multiple of that period: so far may a wake-up be late."""


class Waking:
    """Used by the mission thread only."""

    def __init__(self, wake: threading.Event, pace: Pace, feed: Feed, *, robot: bool) -> None:
        """Of a thread that flies a simulation, or a robot.

        Args:
            wake: set by whoever asks for something.
            pace: of the mission's clock.
            feed: knows whether anybody watches.
            robot: whether a robot is flown: each tick waits for its next state, which then is the clock.

        """
        self._wake, self._pace, self._feed, self._robot = wake, pace, feed, robot
        self._woken_at = 0.0

    def sleep(self, flying: LiveMission) -> None:
        """Sleep until a tick is due, or somebody asks for something; with a robot not at all."""
        if self._paced_by_robot(flying):
            self._wake.clear()
            return
        now, period = time.monotonic(), self._period(flying)
        # By the clock, not by when the last turn ended: the screen wants its pictures at an even rate.
        wait = self._pace.wait(now, resting=flying.resting, longest=period)
        until = min(now + wait, max(self._woken_at + period, now))
        if self._wake.wait(until - now):
            self._wake.clear()
        else:
            self._woken_at = until

    def due(self, flying: LiveMission, now: float) -> int:
        """Ticks to fly now."""
        if self._paced_by_robot(flying):
            self._pace.anchor(now)
            return 1
        return self._pace.due(now, resting=flying.resting, ahead=AHEAD * self._period(flying))

    def _paced_by_robot(self, flying: LiveMission) -> bool:
        return self._robot and flying.phase is not Phase.FAULTED

    def _period(self, flying: LiveMission) -> float:
        """Between two wake-ups of a simulation [s]."""
        return IDLE_PERIOD if flying.resting and not self._feed.watched else WAKE_PERIOD
