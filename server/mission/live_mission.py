"""The mission that flies now, with its run, its events and its problems.

No thread lives here: `server.mission.loop` calls it from the mission thread, and nobody else does.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any, NamedTuple

from server.instants import wall_clock
from server.library.changes import changed_words, display_name
from server.library.record import LoggedEvent, RunStatus, TickArray
from server.library.recorder import Recorder
from server.link.zenoh_plant import ZenohPlant, require_robot_config
from server.mission.fork import Fork
from server.mission.inbox import Request
from server.mission.live_run import LiveRun
from server.mission.problems import ProblemBoard, problem_of
from sim.capture.events import Event
from sim.capture.mission import Mission
from sim.capture.replay import FlightHistory, Intervention
from sim.capture.saved_states import SavedStates
from sim.capture.snapshots import Flown, snapshot_of
from sim.config import MissionConfig, differences, is_live
from sim.control.phases import AT_REST, Command, Phase, allowed_commands, next_phase
from sim.errors import Cause, MissionRefused, PlantError
from sim.rehearsal.situation import Situation
from sim.snapshot import Snapshot

ACTIVE_PHASES = (Phase.DETUMBLING, Phase.CAGING)
RESTING_PHASES = (Phase.IDLE, Phase.STOPPED, Phase.FAULTED)

_FLOWN_UNDER = frozenset(command.value for command in Command)
"""The requests that change what is flown; the others change the clock or the mission."""

_LOG_LEVELS = {"info": logging.INFO, "warning": logging.WARNING, "error": logging.ERROR}
"""Of an event's line in the service's log."""

_BEFORE = "before the fork: "
"""Begins the message of what a fork has from its parent."""

log = logging.getLogger(__name__)


def _before_the_fork(event: LoggedEvent) -> LoggedEvent:
    """An event of the parent as the fork's log has it; one of a parent's parent is marked already."""
    message = event.message if event.message.startswith(_BEFORE) else f"{_BEFORE}{event.message}"
    return event.model_copy(update={"message": message})


class MissionView(NamedTuple):
    """A mission at one tick: enough for its snapshot, which whoever wants it makes, in any thread."""

    flown: Flown
    phase: Phase
    reached: Phase
    """The phase that the mission is in after that tick."""
    failure: str | None

    def snapshot(self) -> Snapshot:
        """The snapshot."""
        snapshot = snapshot_of(self.flown, self.phase, self.reached)
        if self.failure is not None:
            return snapshot.model_copy(update={"description": f"Failed: {self.failure}"})
        return snapshot


class LiveMission:
    """One mission from its reset to the next."""

    def __init__(
        self,
        configuration: str,
        config: MissionConfig,
        recorder: Recorder,
        announce: Callable[[LoggedEvent], None],
        keep: Callable[[TickArray], None],
        fork: Fork | None = None,
        robot: ZenohPlant | None = None,
    ) -> None:
        """A mission with that configuration from its start, or the fork's or the robot's from where it stands.

        Raises:
            ConfigError: the configuration is invalid.

        """
        self.fork = fork
        self._robot = robot
        self._mission = Mission(config, robot) if fork is None else fork.mission
        config = self._mission.config
        self._announce = announce
        self._keep = keep
        self._failure: str | None = None
        self._activity = AT_REST
        self._tick, self._time = max(0, self._mission.next_tick - 1), float(self._mission.flown().row["time"])
        self._name = display_name(configuration, config)
        self._initial = config if fork is None else fork.history.config
        self._interventions = [] if fork is None else list(fork.history.interventions)
        self.configuration = configuration
        self.states = SavedStates() if fork is None else fork.parent.states.until(fork.tick)
        self.problems = ProblemBoard()
        self.run = LiveRun(recorder, self._name, config, fork, robot=robot is not None)

    @property
    def name(self) -> str:
        """The configuration's name as it is shown."""
        return self._name

    @property
    def config(self) -> MissionConfig:
        """In force."""
        return self._mission.config

    @property
    def history(self) -> FlightHistory:
        """All that the mission's ticks until now follow from."""
        return FlightHistory(
            config=self._initial, interventions=tuple(self._interventions), robot=self._robot is not None
        )

    @property
    def phase(self) -> Phase:
        """The mission's, or `FAULTED` after any failure of a tick."""
        return Phase.FAULTED if self._failure else self._mission.phase

    @property
    def time(self) -> float:
        """Mission time of the last tick [s]."""
        return self._time

    @property
    def tick(self) -> int:
        """The last tick."""
        return self._tick

    @property
    def resting(self) -> bool:
        """Whether nothing is under way, so that there is no reason to hurry."""
        done = self._mission.outcome is not None and self.phase not in ACTIVE_PHASES
        return self.phase in RESTING_PHASES or (done and self._activity == AT_REST)

    def begin(self) -> None:
        """Begin the mission's run; the run before it has been closed."""
        self.run.open()
        before = [self._inherited(intervention) for intervention in self._interventions]
        if self.fork is not None:
            before += map(_before_the_fork, self.fork.events)
        for event in sorted(before, key=lambda event: event.tick):
            self.run.log(event)

    def _inherited(self, intervention: Intervention) -> LoggedEvent:
        """What was done to the parent, so that the fork's log has all that its ticks follow from."""
        tick = intervention.tick
        command = intervention.command
        what = f"{command.value} granted" if command is not None else ", ".join(intervention.changes)
        return LoggedEvent(
            time=tick * self.config.control.period,
            tick=tick,
            kind="config" if command is None else "command",
            severity="info",
            message=f"{_BEFORE}{what}",
            at=wall_clock(),
            command=None if command is None else command.value,
            accepted=None if command is None else True,
            takes_effect=tick,
            changes=intervention.changes or None,
        )

    def grant(self, command: Command) -> None:
        """Do what was asked, from the next tick on.

        Raises:
            MissionRefused: the phase does not allow it, or the method says that it cannot end well as things stand.

        """
        next_phase(self.phase, command, self._mission.method.commands)
        if speaks_against := self._refusal(command):
            raise MissionRefused(speaks_against)
        self._mission.request(command)
        self._interventions.append(Intervention(tick=self._mission.next_tick, command=command))
        self.run.begin(self._name, self.config)

    def stop(self) -> None:
        """Stop at once, in any phase."""
        if self._robot is not None:
            self._robot.stop()
        self._mission.stop()
        self._interventions.append(Intervention(tick=self._mission.next_tick, command=Command.STOP))
        self._take_events()

    def can_take(self, config: MissionConfig) -> bool:
        """Whether this mission can go on with that configuration."""
        return all(map(is_live, differences(self.config, config)))

    def require_replaceable(self, config: MissionConfig) -> None:
        """Refuse a change that takes a new mission while this one is under way.

        Raises:
            MissionRefused: it is; the message names the parameter.

        """
        if self.run.has_moved or self.phase is not Phase.IDLE:
            fixed = next(path for path in differences(self.config, config) if not is_live(path))
            raise MissionRefused(
                f"{fixed} cannot change while a mission is under way (phase {self.phase.label})",
                tip="reset the mission, then change it",
            )

    def configure(self, config: MissionConfig) -> None:
        """Fly on with these parameters, from the next tick on.

        Raises:
            ConfigError: no robot can be flown with them.
            MissionRefused: a parameter differs that cannot change while a mission flies.

        """
        changes = differences(self.config, config)
        if self._robot is not None:
            require_robot_config(config)
        self._mission.configure(config)
        if self._robot is not None:
            self._robot.configure(config)
        self._name = display_name(self.configuration, config)
        self._take_events()
        if changes:
            self._note_changes(changed_words(changes), {path: new for path, (_, new) in changes.items()})

    def advance(self, ticks: int) -> int:
        """Fly up to this many ticks; how many were flown. A failure of the plant is noted, not raised."""
        if self.phase is Phase.FAULTED:
            return 0
        try:
            rows = self._mission.advance(ticks)
        except Exception as error:
            self.fail(error)
            return 0
        if len(rows):
            self._tick, self._time = int(rows["tick"][-1]), float(rows["time"][-1])
            self._activity = int(rows["activity"][-1])
            self.run.keep(rows)
            self._keep(rows)
            self.states.keep(self._mission)
        if self._mission.phase is Phase.FAULTED:
            self.fail(self._mission.fault or PlantError("the plant can no longer be trusted"))
            return len(rows)
        self._take_events()
        self._note_stillness()
        return len(rows)

    def fail(self, error: Exception) -> None:
        """The plant can no longer be trusted: the phase is `FAULTED`, and the operator sees why."""
        log.error("the mission failed at %.3f s", self.time, exc_info=error)
        fault = error if isinstance(error, PlantError) else None
        cause, words = (fault.cause, str(fault)) if fault else (Cause.BECALM_FAILED, f"{type(error).__name__}: {error}")
        self._failure = words
        self._take_events()
        if error is not self._mission.fault:  # else the mission has reported it
            event = Event(time=self.time, tick=self.tick, kind="fault", severity="error", message=words, cause=cause)
            self._note(event)
        self.run.fail(self._failure)

    def view(self) -> MissionView:
        """Of the last tick, but for the phase: a paused mission that was stopped is stopped, without a tick."""
        return MissionView(self._mission.flown(), self.phase, self._mission.phase, self._failure)

    def situation(self) -> Situation:
        """What is known of the state that it is in, for futures to begin in; a copy.

        Raises:
            MissionRefused: the mission has failed, and nothing goes on from it.

        """
        if self.phase is Phase.FAULTED:
            raise MissionRefused("the mission is in phase faulted: no future begins in it", tip="reset it first")
        return Situation.of(self._mission)

    def refusals(self) -> dict[str, str | None]:
        """Every command of the mission: None if it is allowed now, else the reason why not."""
        allowed = allowed_commands(self.phase, self._mission.method.commands)
        return {command.value: reason or self._refusal(command) for command, reason in allowed.items()}

    def _refusal(self, command: Command) -> str | None:
        """What the method says against a command as things stand; None if nothing."""
        return self._mission.refusal(command, on_robot=self._robot is not None) or None

    def log_request(self, request: Request, *, accepted: bool, message: str) -> None:
        """Note who asked what, and the answer."""
        self._log(
            LoggedEvent(
                time=self.time,
                tick=self.tick,
                kind="command",
                severity="info" if accepted else "warning",
                message=message,
                at=wall_clock(),
                who=request.who,
                command=request.command,
                accepted=accepted,
                takes_effect=self._mission.next_tick if accepted and request.command in _FLOWN_UNDER else None,
            )
        )

    def close(self, why: str) -> None:
        """End the mission and its run, which keeps why if it had no verdict yet."""
        self.run.close(why)

    def _take_events(self) -> None:
        for event in self._mission.take_events():
            self._note(event)

    def _note(self, event: Event) -> None:
        self._log(LoggedEvent(**event.model_dump(), at=wall_clock()))
        problem = problem_of(event)
        if problem is not None:
            self.problems.show(event.kind, problem)
        if event.kind == "verdict" and self._mission.outcome is not None:
            self.run.conclude(self._mission.outcome)

    def _note_changes(self, message: str, changes: dict[str, Any]) -> None:
        tick = self._mission.next_tick
        self._interventions.append(Intervention(tick=tick, changes=changes))
        event = Event(time=self.time, tick=self.tick, kind="config", severity="info", message=message)
        self._log(LoggedEvent(**event.model_dump(), at=wall_clock(), takes_effect=tick, changes=changes))

    def _log(self, event: LoggedEvent) -> None:
        self.run.log(event)
        self._announce(event)
        marks = event.model_dump(include={"kind", "who", "command", "accepted", "tick"}, exclude_none=True)
        log.log(_LOG_LEVELS[event.severity], event.message, extra={"run": self.run.id, **marks})

    def _note_stillness(self) -> None:
        if self.phase in ACTIVE_PHASES or self._activity != AT_REST:
            self.run.note_motion()
        else:
            status: RunStatus = "cancelled" if self.phase is Phase.STOPPED else "finished"
            self.run.note_quiet(self.time, self.config.judging.hold_time, status)
