"""The mission thread: the only one that touches the mission.

Each turn looks at STOP first, then at the inbox, flies the ticks that are due, answers, and publishes.
"""

from __future__ import annotations

import gc
import itertools
import logging
import threading
import time
from collections.abc import Callable
from typing import ClassVar, Literal, NamedTuple, cast

from server.errors import ConfigOutdated, ServiceBusy
from server.instants import wall_clock
from server.library.changes import changed_words, display_name
from server.library.recorder import BACKLOG_LIMIT, Recorder
from server.link.robot_link import RobotLink
from server.link.status import robot_data
from server.link.zenoh_plant import ZenohPlant
from server.mission.arming import ARMED_TIME, TO_BE_ARMED, ArmedOrder, Moment
from server.mission.causes import cause_of
from server.mission.control import CONTROL_COMMANDS, ControlCommand, ControlDesk
from server.mission.feed import Feed
from server.mission.fork import Flight, Fork
from server.mission.inbox import Answer, CommandAnswer, Inbox, Request, Revision
from server.mission.live_mission import RESTING_PHASES, LiveMission
from server.mission.pace import FULL_SPEED, Pace
from server.process.disk import FAULT_TIP, DiskGuard
from server.process.realtime import punctual
from server.published import ArmedCommand, MissionSnapshot, PlantStatus, Problem
from sim.capture.mission import prepare
from sim.capture.snapshot import Readiness
from sim.config import MissionConfig, differences
from sim.configurations import named_configuration
from sim.control.phases import Command, Phase, next_phase
from sim.errors import CaptureError, LinkLost, MissionRefused

PUBLISH_PERIOD = 1 / 60
"""Wall time between two snapshots [s]."""

WAKE_PERIOD = 0.002
"""Shortest sleep [s]: at real time two ticks are flown at once, for half of the wake-ups."""

LATE = 0.05
"""Lateness that the operator is told of [s]."""

START_SPAN = 2.0
"""How long a robot is held without being lost before the service's first mission begins [s]."""

AWAIT_PERIOD = 0.5
"""Between two looks for a robot that is not there yet [s]."""

STOP_PATIENCE = 0.1
"""How long an answer to STOP waits for the robot's acknowledgement [s]."""

_SIMULATED = ("pause", "run", "step", "fork")
"""What only a simulation can do."""
_REAL_TIME = "{} is refused: a robot is flown, in real time"

LoopStatus = Literal["preparing", "ok", "faulted"]

log = logging.getLogger(__name__)


class ConfigView(NamedTuple):
    """The configuration in force, for readers in other threads."""

    configuration: str
    """The named configuration that it began as."""
    name: str
    config: MissionConfig


class _Step(NamedTuple):
    """A single step under way."""

    request: Request
    answer: Answer
    first_tick: int


class MissionLoop:
    """Flies the live mission in a thread of its own, at the pace that the operator chose."""

    def __init__(
        self,
        configuration: str,
        config: MissionConfig,
        feed: Feed,
        recorder: Recorder,
        disk: DiskGuard,
        link: RobotLink | None = None,
    ) -> None:
        """A loop that flies the robot at the other end of the link, or without one the simulation."""
        self._link = link
        self._awaited = ""
        self._feed = feed
        self._recorder = recorder
        self._disk = disk
        self._inbox = Inbox()
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._live, name="becalm-mission", daemon=True)
        self._numbers = itertools.count(1)
        self._step: _Step | None = None
        self._answers: list[tuple[Answer, CommandAnswer]] = []
        self._publish_at = 0.0
        self._mission: LiveMission | None = None
        self._pace = Pace(config.control.period, time.monotonic())
        self._flown_at: float | None = None
        self._armed = ArmedOrder()
        self.failure: str | None = None
        self.desk = ControlDesk()
        self.view = ConfigView(configuration, display_name(configuration, config), config)

    def start(self) -> None:
        """Start the thread; it prepares the simulation first."""
        self._thread.start()

    def end_soon(self) -> None:
        """Stop the robot, answer who waits, and close the run, all at the next turn; does not wait for it."""
        self._closing.set()
        self._inbox.wake.set()

    def shutdown(self, timeout: float = 2.0) -> None:
        """Stop the robot, close the run and end the thread."""
        self.end_soon()
        if self._mission is not None:  # compiling cannot be interrupted, and has no run to close
            self._thread.join(timeout)

    @property
    def status(self) -> LoopStatus:
        """Whether there is a mission to ask something of."""
        latest = self._feed.latest
        if self.failure or (latest and latest.snapshot.phase == Phase.FAULTED.label):
            return "faulted"
        return "ok" if latest else "preparing"

    @property
    def tick_age(self) -> float | None:
        """Wall time since the last tick was flown [s]."""
        return None if self._flown_at is None else time.monotonic() - self._flown_at

    @property
    def pace(self) -> Pace:
        """The clock, for readers of its counters in other threads."""
        return self._pace

    @property
    def waiting(self) -> int:
        """Requests that have not been looked at."""
        return self._inbox.waiting

    @property
    def flight(self) -> Flight:
        """What the mission has flown until now; for any thread.

        Raises:
            ServiceBusy: there is no mission yet.

        """
        flying = self._mission
        if flying is None:
            raise self.not_ready()
        return Flight(flying.run.id, flying.configuration, flying.history, flying.tick + 1)

    def ask(self, request: Request) -> Answer:
        """Put a request before the mission thread.

        Raises:
            ServiceBusy: the inbox is full, or there is no mission yet.

        """
        if request.command == "stop":
            self._stop_robot()
        if self._feed.latest is None or self._closing.is_set():
            raise self.not_ready()
        return self._inbox.put(request)

    def _stop_robot(self) -> None:
        """STOP does not wait for the mission thread, nor for there to be a mission."""
        if self._link is not None:
            self._link.stop()

    def not_ready(self) -> ServiceBusy:
        """Why there is no mission to show or to command."""
        if self.failure:
            return ServiceBusy(f"the simulation could not be prepared: {self.failure}", tip="restart the service")
        if self._closing.is_set():
            return ServiceBusy("the service is ending", tip="start it again")
        if self._awaited:
            return ServiceBusy(f"the mission waits for its robot: {self._awaited}", tip="GET /api/v1/link tells more")
        return ServiceBusy(
            "the simulation is being prepared", tip="its first start compiles for about half a minute; try again"
        )

    @punctual()
    def _live(self) -> None:
        try:
            prepare()
            if self._link is not None:
                self._link.warm_up(self.view.config)
            first = self._first_mission()
            if first is None:
                return
            self._begin(first)
        except Exception as error:
            log.exception("the simulation could not be prepared")
            self.failure = f"{type(error).__name__}: {error}"
            return
        while not self._closing.is_set():
            self._sleep()
            self._turn_guarded()
        self._end()

    def _first_mission(self) -> LiveMission | None:
        """The mission that the service opens with, as soon as its robot is there; None if the service ends before."""
        if self._link is None:
            return self._new_mission(self.view.configuration, self.view.config)
        self._awaited = "it begins when the robot has been heard without a gap for a second"
        while not self._closing.is_set():
            try:
                robot = self._robot(self._link, self.view.config)
                first = self._mission_with(self.view.configuration, self.view.config, robot=robot)
                # A start is no fault: whatever this process still loads holds up its threads, so it is let go by first.
                robot.require_held(START_SPAN)
                return first
            except (MissionRefused, LinkLost) as error:
                self._awaited = str(error)
                self._closing.wait(AWAIT_PERIOD)
        return None

    def _end(self) -> None:
        self._finish_step("the service ended")
        self._deliver()
        self._inbox.refuse_all(self.not_ready())
        try:
            self._leave_at_rest()
        except Exception as error:
            self._flying.fail(error)
        self._flying.close("cut off: the service ended")

    def _leave_at_rest(self) -> None:
        """The last that the robot hears of the service is to stand still."""
        if self._flying.phase in RESTING_PHASES:
            return
        self._flying.stop()
        self._flying.log_request(Request("stop", who="service"), accepted=True, message="the service ends")
        if self._pace.running:
            self._fly(1, time.monotonic())
        if self._link is not None:
            self._link.stop()
            self._link.await_stop(STOP_PATIENCE)
        self._publish(time.monotonic())

    @property
    def _flying(self) -> LiveMission:
        assert self._mission is not None, "the mission thread has begun one"
        return self._mission

    def _begin(self, following: LiveMission) -> None:
        """Fly this mission from now on."""
        self._mission = following
        following.begin()
        now = time.monotonic()
        self._pace.period = following.config.control.period
        self._pace.anchor(now)
        self._feed.begin(following.run.id, following.fork.past if following.fork else None)
        if following.fork is None:  # a fork stands where it was forked until the clock runs
            self._fly(1, now)
        self._publish(now)

    def _replace(self, request: Request, configuration: str, config: MissionConfig, reason: str, changes: str) -> str:
        """End the present mission and begin another, unless that one cannot be; the answer tells the changes."""
        following = self._new_mission(configuration, config)
        told = f"; {changes}" if changes else ""
        return self._succeed(request, following, reason, f"{reason}: a new mission with {following.name}{told}")

    def _succeed(self, request: Request, following: LiveMission, reason: str, message: str) -> str:
        """End the present mission and begin the following one."""
        self._finish_step(reason)
        self._flying.log_request(request, accepted=True, message=message)
        self._flying.close(f"ended by {reason}")
        self._begin(following)
        return message

    def _new_mission(self, configuration: str, config: MissionConfig, fork: Fork | None = None) -> LiveMission:
        robot = None if self._link is None else self._robot(self._link, config)
        return self._mission_with(configuration, config, fork, robot)

    def _mission_with(
        self, configuration: str, config: MissionConfig, fork: Fork | None = None, robot: ZenohPlant | None = None
    ) -> LiveMission:
        history = self._feed.history
        return LiveMission(configuration, config, self._recorder, self._feed.publish_event, history.keep, fork, robot)

    @staticmethod
    def _robot(link: RobotLink, config: MissionConfig) -> ZenohPlant:
        """The robot, for a new mission."""
        # A full collection of all that was loaded by now takes longer than the link's deadline: once, and here.
        gc.collect()
        gc.freeze()
        return ZenohPlant(link, config)

    @property
    def _paced_by_robot(self) -> bool:
        """Whether each tick waits for the robot's next state, which then is the clock."""
        return self._link is not None and self._flying.phase is not Phase.FAULTED

    def _sleep(self) -> None:
        if self._paced_by_robot:
            self._inbox.wake.clear()
            return
        wait = self._pace.wait(time.monotonic(), resting=self._flying.resting, longest=PUBLISH_PERIOD)
        if self._inbox.wake.wait(max(wait, WAKE_PERIOD) if wait else 0.0):
            self._inbox.wake.clear()

    def _turn_guarded(self) -> None:
        try:
            self._turn()
        except Exception as error:
            # The thread outlives every fault: the operator must see it, and be able to reset.
            self._flying.fail(error)

    def _turn(self) -> None:
        granted = [*self._obey_stops(), *self._obey_requests()]
        now = time.monotonic()
        due = self._due(now)
        if granted and self._pace.running:
            due = max(due, 1)  # what was granted begins with this tick, and the answer tells it
        self._fly(due, now)
        self._armed.watch(self._moment, now)
        self._answers += [(answer, self._answered(request, message)) for request, answer, message in granted]
        if self._answers or now >= self._publish_at:
            self._publish(now)
        self._deliver()  # after publishing: who has the answer finds it in the snapshot

    def _due(self, now: float) -> int:
        """Ticks to fly now."""
        if self._paced_by_robot:
            self._pace.anchor(now)
            return 1
        return self._pace.due(now, resting=self._flying.resting)

    def _obey_stops(self) -> list[tuple[Request, Answer, str]]:
        stops = self._inbox.stops()
        if stops:
            self._armed.disarm()
            self._flying.stop()
            # Nothing that was asked for before a STOP may set the arms in motion after it.
            tip = "look at the robot, then ask again"
            self._inbox.refuse_requests(MissionRefused("a STOP came before this was looked at", tip=tip))
            self._finish_step("stopped")
        granted = []
        for request, answer in stops:
            message = f"{self._stopped_words()}{self._acknowledgement()}"
            self._flying.log_request(request, accepted=True, message=message)
            granted.append((request, answer, message))
        return granted

    def _stopped_words(self) -> str:
        faulted = self._flying.phase is Phase.FAULTED
        return "the robot stays stopped; the fault is not mended" if faulted else "stopped: joint rates are zero"

    def _acknowledgement(self) -> str:
        """What the robot said to the STOP that it was sent."""
        if self._link is None:
            return ""
        after = self._link.await_stop(STOP_PATIENCE)
        if after is None:
            return "; the robot has NOT acknowledged it yet, and is told again"
        return f"; acknowledged by the robot after {1e3 * after:.0f} ms"

    def _obey_requests(self) -> list[tuple[Request, Answer, str]]:
        granted = []
        for request, answer in self._inbox.requests():
            flying = self._flying
            try:
                self._require_simulation(request)
                self._require_control(request)
                message = self._DO[request.command](self, request)
            except CaptureError as refusal:
                flying.log_request(request, accepted=False, message=str(refusal))
                answer.set_exception(refusal)
                continue
            except Exception as error:
                # What asked is at fault, not the mission: it flies on, and who asked is told.
                log.exception("%s could not be carried out", request.command)
                answer.set_exception(error)
                continue
            if request.command not in CONTROL_COMMANDS:  # the first one who commands has control
                self.desk.take(request.who, wall_clock())
            if request.command != "arm":
                self._armed.disarm()  # what was armed before it was armed for how things stood then
            if flying is self._mission:  # else it was logged in the run that it ended
                flying.log_request(request, accepted=True, message=message)
            if request.command == "step":
                self._step = _Step(request, answer, flying.tick)
            else:
                granted.append((request, answer, message))
        return granted

    def _require_simulation(self, request: Request) -> None:
        """Refuse what only a simulation can do.

        Raises:
            MissionRefused: a robot is flown, and its clock is nobody's to choose.

        """
        if self._link is not None and request.command in _SIMULATED:
            raise MissionRefused(_REAL_TIME.format(request.command), tip="hold or stop brings the robot to rest")

    def _require_control(self, request: Request) -> None:
        """Refuse a command of somebody who is not in control; an offer is taken by saying so, not by a command.

        Raises:
            MissionRefused: somebody else is in control.

        """
        if request.command not in CONTROL_COMMANDS:
            self.desk.require(request.who)

    @property
    def _moment(self) -> Moment:
        return Moment(self._flying.run.id, self._flying.phase.label)

    def _arm(self, request: Request) -> str:
        """Let the next request carry out what moves the robot, if that may be done now.

        Raises:
            MissionRefused: the phase does not allow it.

        """
        command = cast("ArmedCommand", request.arms)
        if command not in ("reset", "configure"):
            next_phase(self._flying.phase, Command(command))
        self._armed.arm(request, command, self._moment, time.monotonic())
        return f"{command} is armed for {ARMED_TIME:g} s"

    def _require_armed(self, request: Request) -> None:
        """With a robot, what moves it or takes it anew has to be armed; a simulation takes an arming that is brought.

        Raises:
            MissionRefused: it is not.

        """
        if self._link is not None or request.arming is not None:
            self._armed.redeem(request, self._moment, time.monotonic())

    def _change_control(self, request: Request) -> str:
        command = cast("ControlCommand", request.command)
        return self.desk.change(command, request.who, request.to, wall_clock())

    def _grant(self, request: Request) -> str:
        command = Command(request.command)
        next_phase(self._flying.phase, command)  # what the phase does not allow is refused for that reason
        if request.command in TO_BE_ARMED:
            self._require_armed(request)
        self._flying.grant(command)
        what = request.command.replace("_", " ")
        return f"{what} begins" if self._pace.running else f"{what} is granted; it begins when the clock runs"

    def _pause(self, request: Request) -> str:
        self._pace.pause()
        self._finish_step("paused")
        return "the clock is paused"

    def _run(self, request: Request) -> str:
        self._finish_step("the clock runs")
        speed = self._pace.speed if request.speed is None else request.speed
        self._pace.run(speed, time.monotonic())
        pace = "as fast as it goes" if speed == FULL_SPEED else f"at {speed:g} x real time"
        return f"the clock runs {pace}"

    def _begin_step(self, request: Request) -> str:
        refusal = self._clock_refusals()["step"]
        if refusal:
            raise MissionRefused(refusal, tip="pause the clock first")
        self._pace.steps_left = request.ticks
        return _ticks(request.ticks)

    def _reset(self, request: Request) -> str:
        configuration = request.configuration or self._flying.configuration
        config = named_configuration(configuration) if request.configuration else self._flying.config
        if request.revision is not None:
            config = self._checked(request.revision, config)
        self._require_armed(request)
        changes = changed_words(differences(named_configuration(configuration), config))
        return self._replace(request, configuration, config, "reset", changes)

    def _fork(self, request: Request) -> str:
        """Go on from a moment of the past, with the clock paused."""
        fork = request.fork
        assert fork is not None, "whoever asks has flown it there"
        following = self._new_mission(fork.parent.configuration, fork.mission.config, fork)
        self._pace.pause()
        message = f"forked from {fork.parent.run_id} at {following.time:.3f} s; the clock is paused"
        return self._succeed(request, following, "a fork", message)

    def _configure(self, request: Request) -> str:
        """Take a configuration that was checked by who asks, unless what it was made from has changed since.

        Raises:
            ConfigOutdated: it has.
            MissionRefused: it takes a new mission, and this one is under way.

        """
        assert request.revision is not None, "whoever asks has made it"
        config = self._checked(request.revision, self._flying.config)
        changes = changed_words(differences(self._flying.config, config))
        if self._flying.can_take(config):
            self._flying.configure(config)
            self._show_view()
            return f"parameters changed: {changes}" if changes else "no parameter differs"
        self._flying.require_replaceable(config)
        self._require_armed(request)
        return self._replace(request, self._flying.configuration, config, "parameters changed", changes)

    @staticmethod
    def _checked(revision: Revision, base: MissionConfig) -> MissionConfig:
        """The revised configuration, unless it was made from another one.

        Raises:
            ConfigOutdated: it was.

        """
        if revision.before is not base:
            raise ConfigOutdated("the parameters have changed meanwhile", tip="look at them, then change them again")
        return revision.after

    _DO: ClassVar[dict[str, Callable[[MissionLoop, Request], str]]] = {
        **dict.fromkeys([each.value for each in Command if each is not Command.STOP], _grant),
        "pause": _pause,
        "run": _run,
        "step": _begin_step,
        "reset": _reset,
        "fork": _fork,
        "configure": _configure,
        "arm": _arm,
        **dict.fromkeys(CONTROL_COMMANDS, _change_control),
    }

    def _fly(self, ticks: int, now: float) -> None:
        if ticks > 0 and self._recorder.backlog < BACKLOG_LIMIT:
            flown = self._flying.advance(ticks)
            self._pace.flown(flown or ticks, now)
            self._flown_at = time.monotonic()
        if self._step and not self._pace.steps_left:
            self._finish_step("")

    def _finish_step(self, reason: str) -> None:
        step, self._step = self._step, None
        self._pace.steps_left = 0
        if step is not None:
            flown = self._flying.tick - step.first_tick
            message = f"{flown} of {_ticks(step.request.ticks)} flown" + (f": {reason}" if reason else "")
            self._answers.append((step.answer, self._answered(step.request, message)))

    def _deliver(self) -> None:
        answers, self._answers = self._answers, []
        for answer, what in answers:
            if not answer.cancelled():
                answer.set_result(what)

    def _answered(self, request: Request, message: str) -> CommandAnswer:
        flying = self._flying
        return CommandAnswer(
            id=f"{flying.run.id}/{next(self._numbers)}",
            command=request.command,
            accepted=True,
            phase=flying.phase.label,
            tick=flying.tick,
            time=flying.time,
            message=message,
        )

    def _publish(self, now: float) -> None:
        self._publish_at = max(self._publish_at + PUBLISH_PERIOD, now)
        self._show_view()
        self._note_own_problems(now)
        flying = self._flying
        told = flying.snapshot()
        snapshot = MissionSnapshot(
            **{**dict(told), "readiness": self._ready(told.readiness)},
            made_at=wall_clock(),
            service_time=time.monotonic(),
            robot=None if self._link is None else robot_data(self._link, now),
            run_id=flying.run.id,
            configuration=flying.name,
            plant=self._plant_status(now),
            commands={**flying.refusals(), **self._clock_refusals()},
            control=self.desk.control,
            arming_needed=() if self._link is None else TO_BE_ARMED,
            armed=self._armed.shown(now),
            problems=flying.problems.shown(),
        )
        self._feed.publish(snapshot)

    def _ready(self, readiness: Readiness) -> Readiness:
        """Nothing comes next while the clock stands."""
        if self._pace.running or readiness.blocked is not None:
            return readiness
        return readiness.model_copy(update={"go": False, "blocked": "the clock is paused"})

    def _show_view(self) -> None:
        self.view = ConfigView(self._flying.configuration, self._flying.name, self._flying.config)

    def _plant_status(self, now: float) -> PlantStatus:
        return PlantStatus(
            kind="simulation" if self._link is None else "zenoh",
            running=self._pace.running,
            speed=self._pace.speed,
            lateness=self._pace.lateness(now),
            real_time_factor=self._pace.real_time_factor(now),
        )

    def _clock_refusals(self) -> dict[str, str | None]:
        paused = not self._pace.running
        stepping = "a step is under way" if self._pace.steps_left else None
        if self._link is not None:
            refused = {command: _REAL_TIME.format(command) for command in _SIMULATED}
            return {**dict.fromkeys(("pause", "run", "step", "reset", "fork")), **refused}
        return {
            "pause": "the clock is paused already" if paused and not stepping else None,
            "run": None,
            "step": stepping if paused else "step is refused while the clock runs; pause it first",
            "reset": None,
            "fork": None,
        }

    def _note_own_problems(self, now: float) -> None:
        lateness = self._pace.lateness(now)
        self._note_link(now)
        self._show_problem(
            "late",
            f"ticks came up to {1e3 * lateness:.0f} ms late in the last second" if lateness > LATE else None,
            "The clock runs late",
            "choose a lower speed, or end other programs on this machine",
        )
        self._show_problem(
            "recorder",
            self._recorder.failure,
            "The run is not being recorded",
            "make room on the disk or choose another BECALM_DATA_DIR, then reset",
        )
        self._show_problem("data_folder", self._disk.fault, "Nothing can be kept", FAULT_TIP)
        self._show_problem(
            "disk",
            self._disk.warning,
            "The disk is nearly full",
            "delete runs or studies; no more are queued until there is room",
        )

    def _note_link(self, now: float) -> None:
        """Trouble of the link, as old as it is now."""
        if self._link is None:
            return
        trouble, age = self._link.trouble(), self._link.age(now)
        heard = "never heard" if age is None else f"last heard {age:.1f} s ago"
        unheard = age is None or age > self._link.settings.deadline
        message = None if trouble is None else f"{trouble}; robot {heard}" if unheard else trouble
        title = "The robot cannot be flown now" if trouble is None else f"{cause_of('link', trouble).title} now"
        self._show_problem("link_now", message, title, "reset is possible when it can be flown again")
        stop_missing = self._link.stop_sent is not None and self._link.stop_acknowledged_after is None
        self._show_problem(
            "stop_unacknowledged",
            "the robot has not acknowledged STOP; it is told again until it does" if stop_missing else None,
            "STOP is not acknowledged",
            "use the robot's own emergency stop",
        )
        refusal = self._link.stranger()
        self._show_problem("stranger", refusal, "The robot refused somebody else", "see who else is on the network")

    def _show_problem(self, key: str, message: str | None, title: str, tip: str) -> None:
        if message is None:
            self._flying.problems.clear(key)
        else:
            severity: Literal["warning", "error"] = "error" if key in ("recorder", "data_folder") else "warning"
            problem = Problem(severity=severity, title=title, message=message, tip=tip, since=self._flying.time)
            self._flying.problems.show(key, problem)


def _ticks(count: int) -> str:
    return "1 tick" if count == 1 else f"{count} ticks"
