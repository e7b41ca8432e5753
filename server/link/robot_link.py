"""The console's end of the link, from the service's start to its end: what arrives, what is sent, how well it goes.

Missions come and go on it (`server.link.zenoh_plant`). zenoh's threads bring messages, the mission thread waits for
joint states and sends joint rates, any thread may send STOP. A ring of one holds what arrives: only the newest counts.
"""

from __future__ import annotations

import importlib
import itertools
import secrets
import threading
import time
from typing import NamedTuple

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from server.link import contract, wire
from server.link.bounds import Bounds, WristFrame
from server.link.clock import Clock
from server.link.contract import HAND_FRAMES, WORLD, Channel
from server.link.identity import Identity
from server.link.perception import Perception
from server.link.reception import PING_PERIOD, Expectations, Reception, topic_of
from server.link.reports import parse_count
from server.link.session import LinkSession, Transport
from server.link.trouble import Trouble
from server.link.wire import JointCommand, JointSample, PlaneSample, RobotCall, StatusReport
from server.process.realtime import realtime_priority
from sim.capture.mission import Mission
from sim.compiled import FloatArray
from sim.config import MissionConfig
from sim.control.phases import Command
from sim.errors import Cause, LinkLost, MissionRefused
from sim.perception.perceived import PERCEIVED
from sim.plant.engine import simulated_plant
from sim.plant.scripted_plant import ScriptedPlant
from sim.record import Record

REPEAT_PERIOD = 0.02
"""Between two sendings of a request that has not been acknowledged [s]."""
ANSWER_TIME = 1.0
"""How long the robot may take to acknowledge a request [s]."""
SETTLING_TIME = 1.5
"""How long a new mission may wait for that [s]."""


class LinkSettings(BaseModel):
    """The console's end."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    transport: Transport
    deadline: float = Field(contract.DEADLINE, ge=0.02, le=10, description="Age at which a needed stream is late [s]")
    detect_freeze: bool = Field(True, description="Whether a sensor that repeats itself for a deadline is frozen")
    robot: str | None = Field(None, description="Name of the robot that is flown; none: the first that is heard")
    world_frame: str = Field(WORLD, description="Name of the frame of poses and twists")
    left_wrist: WristFrame = Field(WristFrame(frame=HAND_FRAMES[0]), description="Of the left wrist's sensor")
    right_wrist: WristFrame = Field(WristFrame(frame=HAND_FRAMES[1]), description="Of the right wrist's sensor")
    bounds: Bounds = Field(Bounds(), description="What a reading may be")


class Answer(NamedTuple):
    """The robot's acknowledgement of a request."""

    granted: bool
    reason: str
    stamp: int
    """When, by the robot's clock [ns]."""


class Stop(NamedTuple):
    """A STOP on its way."""

    call: RobotCall
    sent_at: float
    """`time.monotonic` [s]."""


class RobotLink:
    """The console's end of the link."""

    def __init__(self, settings: LinkSettings, config: MissionConfig) -> None:
        """For a robot and target of that configuration; nothing is opened yet."""
        self.settings = settings
        self.console = secrets.token_hex(4)
        self.clock = Clock()
        self.session = ""
        self.stop_sent: Stop | None = None
        self.stop_acknowledged_after: float | None = None
        perception = Perception(config)
        self.identity = Identity(settings.robot)
        self.reception = Reception(
            self.console, _expected(settings), self.identity, perception, self.clock, lambda: self.settings.deadline
        )
        self.streams, self.other_clock = self.reception.streams, self.reception.other_clock
        self.reports = self.reception.reports
        self._sessions = itertools.count(1)
        self._answer: tuple[str, str, int, Answer] | None = None
        self._change = self.reception.change
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
        plant = simulated_plant(config)
        state = plant.state
        joints = JointSample(0, state["joint_angle"], state["joint_rate"])
        perception, perceived = Perception(config), np.zeros(1, PERCEIVED)
        for stamp in (0, 1):
            perception.take_wrench(0, PlaneSample(stamp, HAND_FRAMES[0], np.zeros(3)))
            perception.take_base(PlaneSample(stamp, WORLD, state["base_pose"].copy()))
            perception.take_target(PlaneSample(stamp, WORLD, state["target_pose"].copy()))
            perception.take_joints(joints)
        perception.write_state(plant.state, perceived[0])
        mission = Mission(config, ScriptedPlant(np.array([plant.state, plant.state])))
        mission.request(Command.CAPTURE)
        mission.advance(2)
        mission.cage()

    @realtime_priority()
    def start(self) -> None:
        """Open the link.

        Raises:
            ConfigError: it cannot be opened.

        """
        link = self._zenoh = LinkSession(self.settings.transport)
        self.reception.listen(link, self._take_acknowledgement)
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

    def open_session(self, config: MissionConfig) -> str:
        """Take the robot for a new session, which perceives by that configuration.

        If that is refused, whatever flies goes on to perceive as it did.

        Raises:
            MissionRefused: the robot is not heard, speaks another contract, or somebody else holds it.

        """
        self._require_ready()
        session = f"{self.console}.{next(self._sessions)}@{self.identity.robot}"
        self.stop_sent = None  # one that the robot has not acknowledged must not end the new session
        answer = self._request(contract.OPEN, session)
        if not answer.granted:
            raise MissionRefused(f"the robot refuses this console: {answer.reason}", tip=_TIP)
        with self._change:
            self.session = session
            self.reports.granted(answer.stamp)
            self.reception.perception.begin(config)
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
        call = RobotCall(self.clock.now(), self.session or f"{self.console}.0")
        with self._change:
            self.stop_sent, self.stop_acknowledged_after = Stop(call, now), None
        self._send(contract.STOP, wire.encode_call(call))
        self._urgent.set()

    def await_stop(self, timeout: float) -> float | None:
        """How long the robot took to acknowledge the last STOP [s]; None if it has not within the time-out [s]."""
        with self._change:
            self._change.wait_for(lambda: self.stop_acknowledged_after is not None, timeout)
            return self.stop_acknowledged_after

    def send_joint_rates(self, stamp: int, rate: FloatArray) -> None:
        """Send joint rates that answer the joint state of that stamp, and a heartbeat."""
        self._send(contract.JOINT_COMMAND, wire.encode_joint_command(JointCommand(stamp, self.session, rate)))
        self.heartbeat()  # with which they are sent

    def heartbeat(self) -> None:
        """Tell the robot that its session's mission thread is alive."""
        self._flown_at = time.monotonic()
        self._ping(self.session)

    def await_joints(self, after: int, timeout: float) -> JointSample | None:
        """The newest joint state later than that stamp [ns]; None if none comes within the time-out [s]."""
        with self._change:
            heard = self.reception
            self._change.wait_for(lambda: heard.joints is not None and heard.joints.stamp > after, timeout)
            joints = heard.joints
        return joints if joints is not None and joints.stamp > after else None

    @property
    def contact_threshold(self) -> float:
        """Wrist force that counts as contact [N]."""
        return self.reception.perception.contact_threshold

    def configure(self, config: MissionConfig) -> None:
        """Perceive by that configuration from now on."""
        with self._change:
            self.reception.perception.configure(config)

    def reset_perception(self) -> None:
        """Forget what was perceived: it was with wrists that had not been tared."""
        with self._change:
            self.reception.perception.reset()

    @property
    def perceives(self) -> bool:
        """Whether both bodies have been seen for long enough."""
        with self._change:
            return self.reception.perception.complete

    def count_from_now(self) -> int:
        """Tell times of what is perceived from the newest joint state on; its stamp, by the robot's clock [ns]."""
        with self._change:
            joints = self._newest_joints()
            self.reception.perception.count_from(joints.stamp)
            return joints.stamp

    def write_state(self, state: Record, perceived: Record) -> JointSample:
        """What is known at the newest joint state, which is given back.

        Args:
            state: one element of `PLANT_STATE`; all but `tick` and `time` are set.
            perceived: one element of `PERCEIVED`; all but `tick` is set.

        """
        with self._change:
            self.reception.perception.write_state(state, perceived)
            return self._newest_joints()

    def _newest_joints(self) -> JointSample:
        joints = self.reception.joints
        assert joints is not None, "a plant is made of what was heard"
        return joints

    def trouble(self) -> Trouble | None:
        """Why what arrives cannot be flown with now; None if it can."""
        return self.reception.trouble(time.monotonic())

    def staleness(self, stamp: int) -> float:
        """How long ago the robot measured what has that stamp, by both clocks [s]; 0 before the offset is known."""
        return self.reception.staleness(stamp)

    def last_refused_sender(self) -> str | None:
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
        now = time.monotonic()
        if reports.latest is None or now - reports.at > max(0.5, self.settings.deadline):
            unheard = self.reception.unheard(now)
            raise MissionRefused(unheard.message if unheard else f"no robot is heard at {where}", tip=_TIP)
        spoken = reports.value("contract")
        if spoken != contract.VERSION:
            raise MissionRefused(
                f"the robot speaks contract {spoken!r}, this console {contract.VERSION!r}",
                tip="use the same version of Becalm at both ends",
            )
        with self._change:
            self.reception.reset()
            self._change.wait_for(self._settled, SETTLING_TIME)
            settled = self._settled()
        trouble = self.trouble()
        why = trouble.message if trouble else "" if settled else "it has not been heard without a gap for a second yet"
        if why:
            raise MissionRefused(f"the robot cannot be flown: {why}", tip=_TIP)

    def _settled(self) -> bool:
        return self.reception.settled(time.monotonic())

    def _request(self, channel: Channel, session: str) -> Answer:
        """Send a request until it is acknowledged.

        Raises:
            LinkLost: it is not.

        """
        name, sent = topic_of(channel), set[int]()
        until = time.monotonic() + ANSWER_TIME
        while time.monotonic() < until:
            # It answers a joint state, as a joint command does: the robot judges by its own clock whether it is of now.
            stamp = self.streams[contract.JOINT_STATES.key].latest
            sent.add(stamp)
            self._send(channel, wire.encode_call(RobotCall(stamp, session)))
            with self._change:
                self._change.wait_for(lambda: self._answer_to(name, session, sent) is not None, REPEAT_PERIOD)
                answer = self._answer_to(name, session, sent)
            if answer is not None:
                return answer
        what = f"the robot did not acknowledge {name} within {ANSWER_TIME:g} s"
        raise LinkLost(what, cause=Cause.NO_ANSWER, tip=_TIP)

    def _answer_to(self, name: str, session: str, stamps: set[int]) -> Answer | None:
        """The robot's answer to a request in that session of one of these stamps."""
        answer = self._answer
        return answer[3] if answer is not None and answer[:2] == (name, session) and answer[2] in stamps else None

    def _ping(self, session: str) -> None:
        """Send a heartbeat of that session."""
        call = RobotCall(self.clock.now(), session)
        self.reception.sent(call.stamp)
        self._send(contract.HEARTBEAT, wire.encode_call(call))

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
                self._ping(f"{self.console}.0")

    def _take_acknowledgement(self, report: StatusReport) -> None:
        """Take an answer of the robot's; called with `_change` held."""
        session, stamp = report.values.get("session", ""), parse_count(report.values.get("stamp", ""))
        if not session.startswith(f"{self.console}.") or stamp is None:
            return
        stop = self.stop_sent
        if report.name != topic_of(contract.STOP):
            self._answer = (report.name, session, stamp, Answer(report.good, report.message, report.stamp))
        elif stop is not None and stamp == stop.call.stamp and self.stop_acknowledged_after is None:
            self.stop_acknowledged_after = time.monotonic() - stop.sent_at


_TIP = "see that the robot runs and is connected (GET /api/v1/link), then reset"


def _expected(settings: LinkSettings) -> Expectations:
    wrists = (settings.left_wrist, settings.right_wrist)
    return Expectations(settings.bounds, settings.world_frame, wrists, settings.detect_freeze)
