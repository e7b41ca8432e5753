"""What each request does to the live mission, or why it is refused."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import ClassVar, cast

from server.errors import ConfigOutdated
from server.instants import wall_clock
from server.library.changes import changed_words
from server.mission.arming import ARMED_TIME, TO_BE_ARMED, ArmedOrder, ArmingContext
from server.mission.clock import MissionClock
from server.mission.control import CONTROL_COMMANDS, ControlCommand, ControlDesk
from server.mission.inbox import Request, Revision
from server.mission.live_mission import LiveMission
from server.mission.opening import MissionOpener
from server.mission.publisher import Publisher
from server.published import ArmedCommand
from sim.config import MissionConfig, differences
from sim.configurations import named_configuration
from sim.control.phases import Command, next_phase


class Commands:
    """Carries out requests other than STOP. Used by the mission thread only."""

    def __init__(
        self,
        clock: MissionClock,
        desk: ControlDesk,
        armed: ArmedOrder,
        opener: MissionOpener,
        publisher: Publisher,
        begin: Callable[[LiveMission], None],
        *,
        arming_needed: bool,
    ) -> None:
        """Commands of one loop.

        Args:
            clock: of the mission.
            desk: knows who is in control.
            armed: knows what is armed.
            opener: makes new missions.
            publisher: shows the configuration in force.
            begin: flies a mission from now on, in place of the one before, which is closed.
            arming_needed: whether what moves the robot has to be armed.

        """
        self._clock = clock
        self._desk = desk
        self._armed = armed
        self._opener = opener
        self._publisher = publisher
        self._begin = begin
        self._arming_needed = arming_needed

    def carry_out(self, request: Request, flying: LiveMission) -> str:
        """Do what was asked of the mission that flies; in words what was done.

        A request that begins another mission is logged in the run that it ends; all others are the caller's to log.

        Raises:
            CaptureError: it is refused.

        """
        self._clock.require_simulation(request.command)
        commands = request.command not in CONTROL_COMMANDS
        if commands:
            self._desk.require(request.who)  # an offer is taken by saying so, not by a command
        message = self._DO[request.command](self, request, flying)
        if commands:
            self._desk.take(request.who, wall_clock())  # the first one who commands has control
        if request.command != "arm":
            self._armed.disarm()  # what was armed before it was armed for how things stood then
        return message

    def _arm(self, request: Request, flying: LiveMission) -> str:
        """Let the next request carry out what moves the robot, if that may be done now.

        Raises:
            MissionRefused: the phase does not allow it.

        """
        command = cast("ArmedCommand", request.arms)
        if command not in ("reset", "configure"):
            next_phase(flying.phase, Command(command))
        self._armed.arm(request, command, arming_context(flying), time.monotonic())
        return f"{command} is armed for {ARMED_TIME:g} s"

    def _require_armed(self, request: Request, flying: LiveMission) -> None:
        """With a robot, what moves it or takes it again has to be armed; a simulation takes an arming that is brought.

        Raises:
            MissionRefused: it is not.

        """
        if self._arming_needed or request.arming is not None:
            self._armed.redeem(request, arming_context(flying), time.monotonic())

    def _change_control(self, request: Request, _flying: LiveMission) -> str:
        command = cast("ControlCommand", request.command)
        return self._desk.change(command, request.who, request.to, wall_clock())

    def _grant(self, request: Request, flying: LiveMission) -> str:
        command = Command(request.command)
        next_phase(flying.phase, command)  # what the phase does not allow is refused for that reason
        if request.command in TO_BE_ARMED:
            self._require_armed(request, flying)
        flying.grant(command)
        what = request.command.replace("_", " ")
        return f"{what} begins" if self._clock.pace.running else f"{what} is granted; it begins when the clock runs"

    def _pause(self, _request: Request, flying: LiveMission) -> str:
        return self._clock.pause(flying)

    def _run(self, request: Request, flying: LiveMission) -> str:
        return self._clock.run(request.speed, flying)

    def _step(self, request: Request, _flying: LiveMission) -> str:
        return self._clock.allow_steps(request.ticks)

    def _reset(self, request: Request, flying: LiveMission) -> str:
        configuration = request.configuration or flying.configuration
        config = named_configuration(configuration) if request.configuration else flying.config
        if request.revision is not None:
            config = _checked(request.revision, config)
        self._opener.require_prepared(config)  # before the arming is used up
        self._require_armed(request, flying)
        changes = changed_words(differences(named_configuration(configuration), config))
        return self._replace(request, flying, configuration, config, "reset", changes)

    def _fork(self, request: Request, flying: LiveMission) -> str:
        """Go on from a moment of the past, with the clock paused."""
        fork = request.fork
        assert fork is not None, "whoever asks has flown it there"
        self._opener.require_prepared(fork.mission.config)
        following = self._opener.new(fork.parent.configuration, fork.mission.config, fork)
        self._clock.pace.pause(time.monotonic())
        message = f"forked from {fork.parent.run_id} at {following.time:.3f} s; the clock is paused"
        return self._succeed(request, flying, following, "a fork", message)

    def _configure(self, request: Request, flying: LiveMission) -> str:
        """Take a configuration that was checked by who asks, unless what it was made from has changed since.

        Raises:
            ConfigOutdated: it has.
            MissionRefused: it takes a new mission, and this one is under way.

        """
        assert request.revision is not None, "whoever asks has made it"
        config = _checked(request.revision, flying.config)
        changes = changed_words(differences(flying.config, config))
        if flying.can_take(config):
            flying.configure(config)
            self._publisher.show_view(flying)
            return f"parameters changed: {changes}" if changes else "no parameter differs"
        flying.require_replaceable(config)
        self._opener.require_prepared(config)
        self._require_armed(request, flying)
        return self._replace(request, flying, flying.configuration, config, "parameters changed", changes)

    def _replace(
        self,
        request: Request,
        flying: LiveMission,
        configuration: str,
        config: MissionConfig,
        reason: str,
        changes: str,
    ) -> str:
        """End the present mission and begin another, unless that is impossible; the answer names the changes."""
        following = self._opener.new(configuration, config)
        message = f"{reason}: a new mission with {following.name}" + (f"; {changes}" if changes else "")
        return self._succeed(request, flying, following, reason, message)

    def _succeed(self, request: Request, flying: LiveMission, following: LiveMission, reason: str, message: str) -> str:
        """End the present mission and begin the following one."""
        self._clock.finish_step(reason, flying)
        flying.log_request(request, accepted=True, message=message)
        flying.close(f"ended by {reason}")
        self._begin(following)
        return message

    _DO: ClassVar[dict[str, Callable[[Commands, Request, LiveMission], str]]] = {
        **dict.fromkeys([each.value for each in Command if each is not Command.STOP], _grant),
        "pause": _pause,
        "run": _run,
        "step": _step,
        "reset": _reset,
        "fork": _fork,
        "configure": _configure,
        "arm": _arm,
        **dict.fromkeys(CONTROL_COMMANDS, _change_control),
    }


def arming_context(flying: LiveMission) -> ArmingContext:
    """Where the mission stands; what is armed there is good nowhere else."""
    return ArmingContext(flying.run.id, flying.phase.label)


def _checked(revision: Revision, base: MissionConfig) -> MissionConfig:
    """The revised configuration, unless it was made from another one.

    Raises:
        ConfigOutdated: it was.

    """
    if revision.before is not base:
        raise ConfigOutdated("the parameters have changed meanwhile", tip="look at them, then change them again")
    return revision.after
