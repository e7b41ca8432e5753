"""What everyone sees of the live mission, put together at every publishing."""

from __future__ import annotations

import time
from typing import NamedTuple

from server.instants import wall_clock
from server.library.changes import display_name
from server.link.robot_link import RobotLink
from server.link.status import robot_data
from server.mission.arming import TO_BE_ARMED, ArmedOrder
from server.mission.clock import MissionClock
from server.mission.control import ControlDesk
from server.mission.feed import Feed, Latest
from server.mission.live_mission import LiveMission
from server.mission.service_problems import ServiceProblems
from sim.config import MissionConfig

PUBLISH_PERIOD = 1 / 60
"""Wall time between two snapshots [s]."""


class ConfigView(NamedTuple):
    """The configuration in force, for readers in other threads."""

    configuration: str
    """The named configuration that it began as."""
    name: str
    config: MissionConfig


class Publisher:
    """Publishes snapshots of the mission that flies. Used by the mission thread only, but for `view`."""

    def __init__(
        self,
        initial: tuple[str, MissionConfig],
        feed: Feed,
        clock: MissionClock,
        desk: ControlDesk,
        armed: ArmedOrder,
        problems: ServiceProblems,
        link: RobotLink | None,
    ) -> None:
        """A publisher that has published nothing.

        Args:
            initial: the named configuration that the first mission will have, and its parameters.
            feed: takes the snapshots.
            clock: of the mission.
            desk: knows who is in control.
            armed: knows what is armed.
            problems: of the service.
            link: to the robot that is flown; None in simulation.

        """
        configuration, config = initial
        self.view = ConfigView(configuration, display_name(configuration, config), config)
        """Replaced, never changed: for any thread to read."""
        self._feed = feed
        self._clock = clock
        self._desk = desk
        self._armed = armed
        self._problems = problems
        self._link = link
        self._due_at = 0.0

    def is_due(self, now: float) -> bool:
        """Whether the next snapshot is due at that monotonic time [s]."""
        return now >= self._due_at - 0.25 * PUBLISH_PERIOD  # a turn that comes a little early is its turn

    def show_view(self, flying: LiveMission) -> None:
        """Let other threads read the mission's configuration."""
        self.view = ConfigView(flying.configuration, flying.name, flying.config)

    def publish(self, flying: LiveMission, now: float) -> None:
        """Publish a snapshot of the mission as it stands at that monotonic time [s]."""
        self._due_at = max(self._due_at + PUBLISH_PERIOD, now)
        self.show_view(flying)
        self._problems.show(flying, now)
        view = flying.view()
        of_service = {
            "made_at": wall_clock(),
            "service_time": time.monotonic(),
            "robot": None if self._link is None else robot_data(self._link, now),
            "run_id": flying.run.id,
            "configuration": flying.name,
            "plant": self._clock.status(now),
            "commands": {**flying.refusals(), **self._clock.refusals()},
            "control": self._desk.control,
            "arming_needed": () if self._link is None else TO_BE_ARMED,
            "armed": self._armed.shown(now),
            "problems": flying.problems.shown(),
        }
        self._feed.publish(Latest(view, of_service))
