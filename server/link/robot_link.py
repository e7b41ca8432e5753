"""The console's end of the link, from the service's start to its end: what arrives, what is sent, how well it goes.

Missions come and go on it (`server.link.zenoh_plant`). zenoh's threads bring messages, the mission thread waits for
joint states and sends commands, any thread may send STOP. A ring of one holds what arrives: only the newest counts.
"""

from __future__ import annotations

import importlib
import itertools
import logging
import secrets
import threading
import time
from collections.abc import Callable
from typing import NamedTuple

from pydantic import BaseModel, ConfigDict, Field

from server.link import contract, wire
from server.link.clock import Clock
from server.link.contract import Channel
from server.link.perception import Perception
from server.link.reports import RobotReports
from server.link.session import LinkSession, Transport
from server.link.streams import OtherClock, Stream
from server.link.wire import Call, Echo, JointCommand, JointSample, PlaneSample
from server.realtime import punctual
from sim.capture.mission import Mission
from sim.compiled import FloatArray
from sim.config import MissionConfig
from sim.control.phases import Command
from sim.errors import LinkLost, MissionRefused
from sim.plant.pymunk_plant import PymunkPlant
from sim.record import Record

PING_PERIOD = 0.05
"""Between two heartbeats of no session, which keep the clock's offset known while nothing is flown [s]."""
REPEAT_PERIOD = 0.02
"""Between two sendings of a request that has not been acknowledged [s]."""
ANSWER_TIME = 1.0
"""How long the robot may take to acknowledge a request [s]."""
SETTLING_TIME = 1.5
"""How long a new mission may wait for that [s]."""
STEADY_SPAN = 1.0
"""How long the robot must have been heard without a gap before a mission begins [s]."""

MODE_DEADLINE = 2.0 / contract.MODE_RATE
"""How much later than a stream the robot's mode may be: it is told less often, and of the lowest priority [s]."""

NEEDED = (contract.JOINT_STATES, *contract.WRENCHES, contract.BASE_POSE, contract.TARGET_POSE)
"""Streams without which no mission flies. Twists are watched only: velocities are estimated here."""
NOISY = (*contract.WRENCHES, contract.BASE_POSE, contract.TARGET_POSE)
"""Streams that never tell the same twice, unless their sensor is frozen."""

log = logging.getLogger(__name__)


class LinkSettings(BaseModel):
    """The console's end."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    transport: Transport
    deadline: float = Field(contract.DEADLINE, ge=0.02, le=10, description="Age at which a needed stream is late [s]")
    contact_threshold: float = Field(0.12, gt=0, le=100, description="Wrist force that counts as contact [N]")
    detect_freeze: bool = Field(True, description="Whether a sensor that repeats itself for a deadline is frozen")


class Answer(NamedTuple):
    """The robot's acknowledgement of a request."""

    granted: bool
    reason: str
    stamp: int
    """When, by the robot's clock [ns]."""


class Stop(NamedTuple):
    """A STOP on its way."""

    call: Call
    sent_at: float
    """`time.monotonic` [s]."""


class _StillPlant:
    """A plant that never moves, to run code once."""

    def __init__(self, state: Record) -> None:
        self.state = state

    def observe(self) -> None:
        """Leave the state as it is."""

    def command(self, joint_rate: FloatArray) -> None:
        """Do nothing."""


class RobotLink:
    """The console's end of the link."""

    def __init__(self, settings: LinkSettings, config: MissionConfig) -> None:
        """For a robot and target of that configuration; nothing is opened yet."""
        self.settings = settings
        self.console = secrets.token_hex(4)
        self.clock = Clock()
        self.other_clock = OtherClock()
        self.streams = {channel.key: Stream(channel.rate or 0.0) for channel in contract.STREAMS}
        self.session = ""
        self.reports = RobotReports()
        self.stop_sent: Stop | None = None
        self.stop_acknowledged_after: float | None = None
        self._perception = Perception(config, settings.contact_threshold)
        self._joints: JointSample | None = None
        self._sessions = itertools.count(1)
        self._answers: dict[tuple[str, int], Answer] = {}
        self._change = threading.Condition()
        self._ended = threading.Event()
        self._urgent = threading.Event()
        self._flown_at = 0.0
        self._zenoh: LinkSession | None = None
        self._thread = threading.Thread(target=self._keep_alive, name="becalm-link", daemon=True)

    @staticmethod
    def warm_up(config: MissionConfig) -> None:
        """Load all code that a mission with a robot runs; half a minute at the first start.

        Also what others load later: an import holds all threads for longer than a robot waits.
        """
        importlib.import_module("scipy.stats")
        plant = PymunkPlant(config)
        joints = JointSample(0, plant.state["joint_angle"], plant.state["joint_rate"])
        Perception(config, 1.0).tell(joints, plant.state)
        mission = Mission(config, _StillPlant(plant.state))
        mission.request(Command.DIRECT_CAGE)
        mission.advance(2)

    @punctual()
    def start(self) -> None:
        """Open the link.

        Raises:
            ConfigError: it cannot be opened.

        """
        link = self._zenoh = LinkSession(self.settings.transport)
        link.subscribe(contract.JOINT_STATES, self._take_joints)
        for arm, channel in enumerate(contract.WRENCHES):
            link.subscribe(channel, self._sampled(channel, wire.decode_wrench, self._wrench_taker(arm)))
        see_base, see_target = self._perception.take_base, self._perception.take_target
        for channel, take in ((contract.BASE_POSE, see_base), (contract.TARGET_POSE, see_target)):
            link.subscribe(channel, self._sampled(channel, wire.decode_pose, take))
        for channel in (contract.BASE_TWIST, contract.TARGET_TWIST):
            link.subscribe(channel, self._sampled(channel, wire.decode_twist, None))
        link.subscribe(contract.HEARTBEAT_ECHO, self._take_echo)
        link.subscribe(contract.MODE, self._take_mode)
        link.subscribe(contract.ACKNOWLEDGEMENT, self._take_acknowledgement)
        self._thread.start()

    def shutdown(self) -> None:
        """Close it; the robot holds at its deadline."""
        self._ended.set()
        self._urgent.set()
        if self._zenoh is not None:
            self._thread.join()
            self._zenoh.close()

    @property
    def connected(self) -> bool:
        """Whether any other end is there."""
        return self._zenoh is not None and self._zenoh.connected

    def age(self, now: float | None = None) -> float | None:
        """Since the robot's joints were last heard of [s]; None before the first time."""
        return self.streams[contract.JOINT_STATES.key].age(time.monotonic() if now is None else now)

    def open_session(self) -> str:
        """Take the robot for a new session, and begin to perceive anew.

        Raises:
            MissionRefused: the robot is not heard, speaks another contract, or somebody else holds it.

        """
        self._require_ready()
        session = f"{self.console}.{next(self._sessions)}"
        self.stop_sent = None  # one that the robot has not acknowledged must not end the new session
        answer = self._request(contract.OPEN, session)
        if not answer.granted:
            raise MissionRefused(f"the robot refuses this console: {answer.reason}", tip=_TIP)
        with self._change:
            self.session = session
            self.reports.granted(answer.stamp)
        return session

    def tare(self) -> Answer:
        """Take what the wrists read now as zero.

        Raises:
            LinkLost: the robot did not answer.

        """
        return self._request(contract.TARE, self.session)

    def stop(self) -> None:
        """Send STOP at once, and again until the robot acknowledges it; for any thread."""
        now = time.monotonic()
        call = Call(self.clock.now(), self.session or f"{self.console}.0")
        with self._change:
            self.stop_sent, self.stop_acknowledged_after = Stop(call, now), None
        self._send(contract.STOP, wire.encode_call(call))
        self._urgent.set()

    def await_stop(self, timeout: float) -> float | None:
        """How long the robot took to acknowledge the last STOP [s]; None if it has not within the time-out [s]."""
        with self._change:
            self._change.wait_for(lambda: self.stop_acknowledged_after is not None, timeout)
            return self.stop_acknowledged_after

    def command(self, stamp: int, rate: FloatArray) -> None:
        """Send joint rates that answer the joint state of that stamp, and a heartbeat."""
        self._send(contract.JOINT_COMMAND, wire.encode_command(JointCommand(stamp, self.session, rate)))
        self.heartbeat()  # with which the command is sent

    def heartbeat(self) -> None:
        """Tell the robot that its session's mission thread is alive."""
        self._flown_at = time.monotonic()
        self._send(contract.HEARTBEAT, wire.encode_call(Call(self.clock.now(), self.session)))

    def await_joints(self, after: int, timeout: float) -> JointSample | None:
        """The newest joint state later than that stamp [ns]; None if none comes within the time-out [s]."""
        with self._change:
            self._change.wait_for(lambda: self._joints is not None and self._joints.stamp > after, timeout)
            joints = self._joints
        return joints if joints is not None and joints.stamp > after else None

    def perceive_anew(self) -> None:
        """Forget what was perceived: it was with wrists that had not been tared."""
        with self._change:
            self._perception.begin_anew()

    @property
    def perceives(self) -> bool:
        """Whether both bodies have been seen for long enough."""
        with self._change:
            return self._perception.complete

    def tell(self, joints: JointSample, state: Record) -> None:
        """What is perceived at that joint state, into one element of `PLANT_STATE`."""
        with self._change:
            self._perception.tell(joints, state)

    def trouble(self) -> str | None:
        """Why what arrives cannot be flown with now; None if it can."""
        now, deadline = time.monotonic(), self.settings.deadline
        for channel in NEEDED:
            stream = self.streams[channel.key]
            age = stream.age(now)
            if age is None:
                return f"{name_of(channel)}: none has come yet"
            if age > deadline:
                return f"{name_of(channel)} late: none for {1e3 * age:.0f} ms"
            if channel in NOISY and self.settings.detect_freeze and stream.unchanged_for > deadline:
                return f"{name_of(channel)} frozen: the same for {1e3 * stream.unchanged_for:.0f} ms"
        return self._silent(now) or self._jump()

    def staleness(self, stamp: int) -> float:
        """How long ago the robot measured what has that stamp, by both clocks [s]; 0 before the offset is known."""
        offset = self.other_clock.offset
        return 0.0 if offset is None else 1e-9 * (self.clock.now() - stamp) + offset

    def stranger(self) -> str | None:
        """Whom the robot last refused beside this console's own; None if nobody."""
        refusal = self.reports.value("last_refusal")
        return refusal if refusal and not refusal.startswith(f"{self.console}.") else None

    def _require_ready(self) -> None:
        """Refuse to begin with a robot that cannot be flown.

        Raises:
            MissionRefused: the reason and how long it has been so.

        """
        where = ", ".join((*self.settings.transport.connect, *self.settings.transport.listen))
        reports = self.reports
        if reports.latest is None or time.monotonic() - reports.at > max(0.5, self.settings.deadline):
            raise MissionRefused(f"no robot is heard at {where}", tip=_TIP)
        spoken = reports.value("contract")
        if spoken != contract.VERSION:
            raise MissionRefused(
                f"the robot speaks contract {spoken!r}, this console {contract.VERSION!r}",
                tip="use the same version of Becalm at both ends",
            )
        with self._change:
            self._perception.begin_anew()
            self.other_clock.begin_anew()
            self._change.wait_for(self._settled, SETTLING_TIME)
            settled = self._settled()
        trouble = self.trouble() or (None if settled else "what it tells comes unevenly")
        if trouble:
            raise MissionRefused(f"the robot cannot be flown: {trouble}", tip=_TIP)

    def _settled(self) -> bool:
        now = time.monotonic()
        joints = self.streams[contract.JOINT_STATES.key]
        steady = joints.steady(now, STEADY_SPAN, 0.5 * self.settings.deadline)
        return steady and self._perception.complete and self.other_clock.offset is not None

    def _silent(self, now: float) -> str | None:
        """Whether the robot tells its mode no more, or sends back no heartbeat, by which its clock is known."""
        deadline = self.settings.deadline
        mode = now - self.reports.at
        if self.reports.latest is not None and mode > deadline + MODE_DEADLINE:
            return f"{name_of(contract.MODE)} late: none for {1e3 * mode:.0f} ms"
        back = self.other_clock.age(now)
        if back is not None and back > deadline + PING_PERIOD:
            return f"{name_of(contract.HEARTBEAT_ECHO)} late: none for {1e3 * back:.0f} ms"
        return None

    def _jump(self) -> str | None:
        deadline = self.settings.deadline * 1e9
        for body, estimate in (("base", self._perception.base), ("target", self._perception.target)):
            since = estimate.outlying_since
            if since is not None:
                latest = self.streams[f"{contract.PREFIX}/{body}/pose"].latest
                if latest - since > deadline:
                    return f"{body} pose jumped: it has been where it cannot be for {1e-6 * (latest - since):.0f} ms"
        return None

    def _request(self, channel: Channel, session: str) -> Answer:
        """Send a request until it is acknowledged.

        Raises:
            LinkLost: it is not.

        """
        call = Call(self.clock.now(), session)
        key = (_name(channel), call.stamp)
        payload = wire.encode_call(call)
        until = time.monotonic() + ANSWER_TIME
        while time.monotonic() < until:
            self._send(channel, payload)
            with self._change:
                if self._change.wait_for(lambda: key in self._answers, REPEAT_PERIOD):
                    return self._answers.pop(key)
        raise LinkLost(f"the robot did not acknowledge {key[0]} within {ANSWER_TIME:g} s", tip=_TIP)

    def _send(self, channel: Channel, payload: bytes) -> None:
        if self._zenoh is not None and not self._ended.is_set():
            self._zenoh.publish(channel, payload)

    def _keep_alive(self) -> None:
        """Repeat STOP until it is acknowledged; time the way while nothing is flown."""
        while not self._ended.is_set():
            stop = self.stop_sent
            pending = stop is not None and self.stop_acknowledged_after is None
            self._urgent.wait(REPEAT_PERIOD if pending else PING_PERIOD)
            self._urgent.clear()
            if stop is not None and pending:
                self._send(contract.STOP, wire.encode_call(stop.call))
            if time.monotonic() - self._flown_at > PING_PERIOD:
                self._send(contract.HEARTBEAT, wire.encode_call(Call(self.clock.now(), f"{self.console}.0")))

    def _take_joints(self, payload: bytes) -> None:
        sample = wire.decode_joints(payload)
        with self._change:
            if self._note(contract.JOINT_STATES, sample.stamp, sample.angle):
                self._joints = sample
                self._perception.take_joints(sample)
                self._change.notify_all()

    def _sampled(
        self,
        channel: Channel,
        decode: Callable[[bytes], PlaneSample],
        take: Callable[[PlaneSample], None] | None,
    ) -> Callable[[bytes], None]:
        def received(payload: bytes) -> None:
            sample = decode(payload)
            with self._change:
                if self._note(channel, sample.stamp, sample.value) and take is not None:
                    take(sample)
                    self._change.notify_all()

        return received

    def _wrench_taker(self, arm: int) -> Callable[[PlaneSample], None]:
        return lambda sample: self._perception.take_wrench(arm, sample)

    def _note(self, channel: Channel, stamp: int, value: FloatArray) -> bool:
        return self.streams[channel.key].arrive(stamp, value, time.monotonic())

    def _take_echo(self, payload: bytes) -> None:
        returned, at = self.clock.now(), time.monotonic()
        echo: Echo = wire.decode_echo(payload)
        if not echo.session.startswith(f"{self.console}."):
            return
        with self._change:
            self.other_clock.note(echo.sent, echo.received, returned, at)

    def _take_mode(self, payload: bytes) -> None:
        report = wire.decode_report(payload)
        with self._change:
            before = self.reports.value("last_refusal")
            self.reports.take(report, time.monotonic())
            refusal = self.reports.value("last_refusal")
        if refusal and refusal != before:
            log.warning("the robot refused %s", refusal)

    def _take_acknowledgement(self, payload: bytes) -> None:
        report = wire.decode_report(payload)
        session, stamp = report.values.get("session", ""), int(report.values.get("stamp", "0"))
        if not session.startswith(f"{self.console}."):
            return
        with self._change:
            stop = self.stop_sent
            if report.name == _name(contract.STOP):
                if stop is not None and stamp == stop.call.stamp and self.stop_acknowledged_after is None:
                    self.stop_acknowledged_after = time.monotonic() - stop.sent_at
            else:
                self._answers = {(report.name, stamp): Answer(report.good, report.message, report.stamp)}
            self._change.notify_all()


_TIP = "see that the robot runs and is connected (GET /api/v1/link), then reset"


def _name(channel: Channel) -> str:
    return channel.key.removeprefix(f"{contract.PREFIX}/")


def name_of(channel: Channel) -> str:
    """A channel's name for people."""
    return _name(channel).replace("/", " ").replace("_", " ")
