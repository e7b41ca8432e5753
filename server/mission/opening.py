"""How missions are begun: on the simulation, on a fork's, or on the robot as soon as it is there."""

from __future__ import annotations

import gc
import threading

from server.library.recorder import Recorder
from server.link.robot_link import RobotLink
from server.link.zenoh_plant import ZenohPlant
from server.mission.compiling import MissionCompiler
from server.mission.feed import Feed
from server.mission.fork import Fork
from server.mission.live_mission import LiveMission
from sim.config import MissionConfig
from sim.errors import LinkLost, MissionRefused

START_SPAN = 2.0
"""How long a robot is held without being lost before the service's first mission begins [s]."""

AWAIT_PERIOD = 0.5
"""Between two looks for a robot that is not there yet [s]."""


class MissionOpener:
    """Makes missions, which the loop then begins. Used by the mission thread only, but for what says otherwise."""

    def __init__(self, recorder: Recorder, feed: Feed, link: RobotLink | None) -> None:
        self._recorder = recorder
        self._feed = feed
        self._link = link
        self._compiler = MissionCompiler(robot=link is not None)
        self.awaited = ""
        """What keeps the service's first mission from beginning; empty: nothing does. For any thread."""

    def prepare(self, config: MissionConfig) -> None:
        """Compile and load what a mission runs."""
        self._compiler.prepare(config)
        _settle_memory()

    def prepared_share(self, config: MissionConfig) -> float:
        """How much of what a mission runs has been compiled, from 0 to 1; for any thread."""
        return self._compiler.share(config)

    def require_prepared(self, config: MissionConfig) -> None:
        """Refuse a mission that would compile while it flies, and begin to prepare it beside the service.

        Raises:
            ServiceBusy: it is being prepared.
            CaptureError: it cannot be.

        """
        self._compiler.require(config)

    def shutdown(self) -> None:
        """End what is being prepared; for any thread."""
        self._compiler.shutdown()

    def first(self, configuration: str, config: MissionConfig, closing: threading.Event) -> LiveMission | None:
        """The mission that the service opens with, as soon as its robot is there; None if the service ends before.

        Raises:
            ConfigError: the configuration is invalid.

        """
        if self._link is None:
            return self.new(configuration, config)
        self.awaited = "it begins when the robot has been heard without a gap for a second"
        while not closing.is_set():
            try:
                robot = _robot(self._link, config)
                first = self._mission(configuration, config, robot=robot)
                # A start is no fault: whatever this process still loads holds up its threads, so it is let go by first.
                robot.require_held(START_SPAN)
                return first
            except (MissionRefused, LinkLost) as error:
                self.awaited = str(error)
                closing.wait(AWAIT_PERIOD)
        return None

    def new(self, configuration: str, config: MissionConfig, fork: Fork | None = None) -> LiveMission:
        """A mission from its start, or one that goes on where a fork stands.

        Raises:
            ConfigError: the configuration is invalid.
            MissionRefused: the robot cannot be flown now.

        """
        robot = None if self._link is None else _robot(self._link, config)
        return self._mission(configuration, config, fork, robot)

    def _mission(
        self, configuration: str, config: MissionConfig, fork: Fork | None = None, robot: ZenohPlant | None = None
    ) -> LiveMission:
        feed = self._feed
        return LiveMission(configuration, config, self._recorder, feed.publish_event, feed.keep, fork, robot)


def _robot(link: RobotLink, config: MissionConfig) -> ZenohPlant:
    """The robot, for a new mission."""
    _settle_memory()
    return ZenohPlant(link, config)


def _settle_memory() -> None:
    """Look for garbage once, and never again among all that was loaded by now.

    That takes a tenth of a second, longer than a link's deadline, and keeps every thread waiting.
    """
    gc.collect()
    gc.freeze()
