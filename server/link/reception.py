"""What arrives from the robot, on zenoh's threads: read, judged, and believed or refused with the reason.

Each reading is held against what the contract, the settings and the clocks of both ends say that it can be
(`server.link.trust`); what is refused is counted by stream and never reaches what flies. Another robot than the one at
the other end is refused by its identity (`server.link.identity`).
"""

from __future__ import annotations

import logging
import re
import threading
import time
from collections.abc import Callable
from typing import NamedTuple, TypeVar

from server.link import contract, trust, wire
from server.link.bounds import Bounds, WristFrame
from server.link.clock import Clock
from server.link.contract import Channel
from server.link.identity import Identity
from server.link.perception import Perception
from server.link.refusals import Refusals, ThrottledLog
from server.link.reports import RobotReports
from server.link.session import LinkSession
from server.link.streams import OtherClock, Stream
from server.link.trouble import Trouble
from server.link.wire import Echo, JointSample, PlaneSample, StatusReport, WireError
from sim.compiled import FloatArray
from sim.errors import Cause

STEADY_SPAN = 1.0
"""How long the robot must have been heard without a gap before a mission begins; what broke is reported as long [s]."""
GAP_PERIODS = 3
"""Periods of a stream within which it comes, if it is steady: motion capture misses some pictures."""
MODE_DEADLINE = 2.0 / contract.MODE_RATE
"""How much later than a stream the robot's mode may be: it is sent less often, and has the lowest priority [s]."""
PING_PERIOD = 0.05
"""Between two heartbeats of no session, which keep the clock's offset known while nothing is flown [s]."""

NEEDED = (contract.JOINT_STATES, *contract.WRENCHES, contract.BASE_POSE, contract.TARGET_POSE)
"""Streams without which no mission flies. Twists are watched only: velocities are estimated here."""
NOISY = (*contract.WRENCHES, contract.BASE_POSE, contract.TARGET_POSE)
"""Streams that never repeat a reading, unless their sensor is frozen."""
JUDGED = (*contract.STREAMS, contract.MODE, contract.HEARTBEAT_ECHO, contract.ACKNOWLEDGEMENT)
"""Channels whose refusals are counted."""

SENT_KEPT = 4096
"""Heartbeats whose answers are awaited: of twenty seconds."""

log = logging.getLogger(__name__)

Sample = TypeVar("Sample")


class Expectations(NamedTuple):
    """What the settings say of the robot's messages."""

    bounds: Bounds
    world_frame: str
    wrists: tuple[WristFrame, WristFrame]
    detect_freeze: bool


class _Broken(NamedTuple):
    """What one reading showed to be broken."""

    trouble: Trouble
    at: float


class Reception:
    """All that was heard. Other threads hold `change` to read more than one thing of it."""

    def __init__(
        self,
        console: str,
        expected: Expectations,
        identity: Identity,
        perception: Perception,
        clock: Clock,
        deadline: Callable[[], float],
    ) -> None:
        self.change = threading.Condition()
        self.identity = identity
        self.perception = perception
        self.other_clock = OtherClock()
        self.reports = RobotReports()
        self.joints: JointSample | None = None
        self.streams = {channel.key: Stream(channel.rate or 0.0) for channel in contract.STREAMS}
        self.refusals = {channel.key: Refusals() for channel in JUDGED}
        self._console = console
        self._sent: dict[int, None] = {}
        self._expected = expected
        self._clock = clock
        self._deadline = deadline
        self._throttled_log = ThrottledLog(log)
        self._broken: dict[str, _Broken] = {}
        self._joint_watch = trust.JointWatch()

    def listen(self, link: LinkSession, acknowledged: Callable[[StatusReport], None]) -> None:
        """Take what comes on that end; acknowledgements are given on, with `change` held."""
        bounds, world = self._expected.bounds, self._expected.world_frame
        link.subscribe(
            contract.JOINT_STATES, self._reader(contract.JOINT_STATES, wire.decode_joints, self._take_joints)
        )
        for arm, channel in enumerate(contract.WRENCHES):
            link.subscribe(channel, self._reader(channel, wire.decode_wrench, self._wrench_taker(arm, channel)))
        poses = ((contract.BASE_POSE, self.perception.take_base), (contract.TARGET_POSE, self.perception.take_target))
        for channel, perceive in poses:
            take = self._body_taker(channel, world, lambda sample: trust.pose_fault(sample, bounds), perceive)
            link.subscribe(channel, self._reader(channel, wire.decode_pose, take))
        for channel in (contract.BASE_TWIST, contract.TARGET_TWIST):
            take = self._body_taker(channel, world, lambda sample: trust.twist_fault(sample, bounds), None)
            link.subscribe(channel, self._reader(channel, wire.decode_twist, take))
        link.subscribe(
            contract.HEARTBEAT_ECHO, self._reader(contract.HEARTBEAT_ECHO, wire.decode_echo, self._take_echo)
        )
        link.subscribe(contract.MODE, self._reader(contract.MODE, wire.decode_report, self._take_mode))

        def take_acknowledgement(report: StatusReport, at: float) -> str:
            refusal = self.identity.refusal(report.robot, at)
            if not refusal:
                acknowledged(report)
            return refusal

        reader = self._reader(contract.ACKNOWLEDGEMENT, wire.decode_report, take_acknowledgement)
        link.subscribe(contract.ACKNOWLEDGEMENT, reader)

    def sent(self, stamp: int) -> None:
        """Note a heartbeat of that stamp [ns], which the robot sends back."""
        with self.change:
            self._sent[stamp] = None
            if len(self._sent) > SENT_KEPT:
                del self._sent[next(iter(self._sent))]

    def reset(self) -> None:
        """Forget what was perceived, and judge the other clock afresh; with `change` held."""
        self.perception.reset()
        self.other_clock.reset()
        self._joint_watch.forget()

    def settled(self, now: float) -> bool:
        """Whether all that is needed has come without a gap for a while, and is enough to fly by."""
        gap = 0.5 * self._deadline()
        steady = (
            self._stream(each).steady(now, STEADY_SPAN, max(gap, GAP_PERIODS / (each.rate or 1))) for each in NEEDED
        )
        return all(steady) and self.perception.complete and self.other_clock.offset is not None

    def trouble(self, now: float) -> Trouble | None:
        """Why what arrives cannot be flown with; None if it can."""
        others = self.identity.trouble(now)
        if others is not None:
            return others
        for channel in NEEDED:
            trouble = self._trouble_of(channel, now)
            if trouble is not None:
                return trouble
        return self._breakage(now) or self._silent(now) or self._jump()

    def unheard(self, now: float) -> Trouble | None:
        """Why nobody reports a mode that counts, if somebody does."""
        refused = self.refusals[contract.MODE.key].age(now)
        return self._late(contract.MODE, None, now) if refused is not None and refused <= STEADY_SPAN else None

    def staleness(self, stamp: int) -> float:
        """How long ago the robot measured what has that stamp, by both clocks [s]; 0 before the offset is known."""
        present = self._present
        return 0.0 if present is None else 1e-9 * (present - stamp)

    @property
    def _present(self) -> int | None:
        """The robot's clock now [ns]; None before the offset is known."""
        offset = self.other_clock.offset
        return None if offset is None else self._clock.now() + round(1e9 * offset)

    def _stream(self, channel: Channel) -> Stream:
        return self.streams[channel.key]

    def _reader(
        self, channel: Channel, decode: Callable[[bytes], Sample], take: Callable[[Sample, float], str]
    ) -> Callable[[bytes], None]:
        """Decodes a message and gives it to `take`, which says why it is not believed, if so."""

        def received(payload: bytes) -> None:
            at = time.monotonic()
            try:
                sample = decode(payload)
            except WireError as error:
                self._refuse(channel, str(error), at)
                return
            with self.change:
                reason = take(sample, at)
                self.change.notify_all()
            if reason:
                self._refuse(channel, reason, at)

        return received

    def _refuse(self, channel: Channel, reason: str, at: float) -> None:
        self.refusals[channel.key].note(reason, at)
        kind = re.sub(r"[-+.\d]+", "#", reason)
        self._throttled_log.warning(f"{channel.key} {kind}", f"{name_of(channel)} refused: {reason}", at)

    def _arrived(self, channel: Channel, stamp: int, value: FloatArray, at: float) -> str:
        """Note a reading that is of the present and newer than all before; why it is not, if so."""
        stream, joints = self._stream(channel), self._stream(contract.JOINT_STATES)
        fresh = (joints.age(at) or 0.0) <= self._deadline() and channel is not contract.JOINT_STATES
        times = trust.Times(self._present, joints.latest if fresh else 0, self._deadline())
        fault = trust.stamp_fault(stamp, times, self._expected.bounds)
        if fault:
            return fault
        latest = stream.latest
        return "" if stream.arrive(stamp, value, at) else trust.order_fault(stamp, latest)

    def _take_joints(self, sample: JointSample, at: float) -> str:
        fault = (
            self.identity.refusal(sample.robot, at)
            or trust.joints_fault(sample, self._expected.bounds)
            or self._arrived(contract.JOINT_STATES, sample.stamp, sample.angle, at)
        )
        if fault:
            return fault
        drift = self._joint_watch.drift(sample)
        if drift:
            return self._break(contract.JOINT_STATES, drift, at)
        self.joints = sample
        self.perception.take_joints(sample)
        return ""

    def _wrench_taker(self, arm: int, channel: Channel) -> Callable[[PlaneSample, float], str]:
        watch = trust.WristWatch(self._expected.wrists[arm], self._expected.bounds)

        def take(sample: PlaneSample, at: float) -> str:
            fault = watch.fault(sample) or self._arrived(channel, sample.stamp, sample.value, at)
            if fault:
                return fault
            jump = watch.jump(sample)
            if jump:
                return self._break(channel, Trouble(Cause.READING_JUMPED, jump), at)
            self.perception.take_wrench(arm, watch.in_hand(sample))
            return ""

        return take

    def _body_taker(
        self,
        channel: Channel,
        world: str,
        judge: Callable[[PlaneSample], str],
        perceive: Callable[[PlaneSample], str] | None,
    ) -> Callable[[PlaneSample, float], str]:
        def take(sample: PlaneSample, at: float) -> str:
            fault = (
                trust.frame_fault(sample.frame, world)
                or judge(sample)
                or self._arrived(channel, sample.stamp, sample.value, at)
            )
            if not fault and perceive is not None and (outlier := perceive(sample)):
                self.refusals[channel.key].note(outlier, at)  # every motion capture has some: nothing to warn of
            return fault

        return take

    def _take_echo(self, echo: Echo, at: float) -> str:
        refusal = self.identity.refusal(echo.robot, at)
        if refusal or not echo.session.startswith(f"{self._console}."):
            return refusal
        if echo.sent not in self._sent:
            return "it answers no heartbeat of this console, or one that was answered already"
        del self._sent[echo.sent]
        self.other_clock.note(echo.sent, echo.received, self._clock.now(), at)
        return ""

    def _take_mode(self, report: StatusReport, at: float) -> str:
        refusal = self.identity.refusal(report.robot, at)
        if refusal:
            return refusal
        times = trust.Times(self._present, 0, self._deadline() + MODE_DEADLINE)
        fault = trust.stamp_fault(report.stamp, times, self._expected.bounds)
        if fault:
            return fault
        before, latest = self.reports.value("last_refusal"), self.reports.latest
        if not self.reports.take(report, at) and latest is not None:
            return trust.order_fault(report.stamp, latest.stamp)
        refusal = self.reports.value("last_refusal")
        if refusal and refusal != before:
            self._throttled_log.warning("last_refusal", f"the robot refused {refusal}", at)
        return ""

    def _break(self, channel: Channel, shown: Trouble, at: float) -> str:
        """A reading that shows its sensor to be broken ends what is flown, however good the next one is."""
        trouble = shown._replace(message=f"{name_of(channel)}: {shown.message}")
        self._broken[channel.key] = _Broken(trouble, at)
        return shown.message

    def _breakage(self, now: float) -> Trouble | None:
        recent = (each.trouble for each in list(self._broken.values()) if now - each.at <= STEADY_SPAN)
        return next(recent, None) or self.other_clock.jump(now, STEADY_SPAN)

    def _trouble_of(self, channel: Channel, now: float) -> Trouble | None:
        stream, deadline = self._stream(channel), self._deadline()
        age = stream.age(now)
        if age is None or age > deadline:
            return self._late(channel, age, now)
        if channel in NOISY and self._expected.detect_freeze and stream.unchanged_for > deadline:
            words = f"{name_of(channel)} frozen: the same for {1e3 * stream.unchanged_for:.0f} ms"
            return Trouble(Cause.SENSOR_FROZEN, words)
        return None

    def _late(self, channel: Channel, age: float | None, now: float) -> Trouble:
        """Of a channel of which nothing was believed for so long [s]; None: ever."""
        refusals = self.refusals[channel.key]
        refused = refusals.age(now)
        # Only what was refused since explains the silence: an outlier, or another robot, before the last that was
        # believed does not.
        if refused is not None and refused < (STEADY_SPAN if age is None else min(age, STEADY_SPAN)):
            return Trouble(Cause.READING_REFUSED, f"{name_of(channel)} refused: {refusals.reason}")
        if age is None:
            return Trouble(Cause.STREAM_LATE, f"{name_of(channel)}: none has come yet")
        cause = Cause.ROBOT_SILENT if channel is contract.JOINT_STATES else Cause.STREAM_LATE
        return Trouble(cause, f"no {name_of(channel)} for {1e3 * age:.0f} ms")

    def _silent(self, now: float) -> Trouble | None:
        """Whether the robot no longer reports its mode, or sends back no heartbeat, by which its clock is known."""
        deadline = self._deadline()
        mode = now - self.reports.at
        if self.reports.latest is not None and mode > deadline + MODE_DEADLINE:
            return self._late(contract.MODE, mode, now)
        back = self.other_clock.age(now)
        if back is not None and back > deadline + PING_PERIOD:
            return self._late(contract.HEARTBEAT_ECHO, back, now)
        return None

    def _jump(self) -> Trouble | None:
        deadline = self._deadline() * 1e9
        for body in contract.BODIES:
            since = self.perception.outlying_since(body)
            if since is not None:
                latest = self.streams[f"{contract.PREFIX}/{body}/pose"].latest
                if latest - since > deadline:
                    span = f"{1e-6 * (latest - since):.0f} ms"
                    words = f"{body} pose jumped: it has been where it cannot be for {span}"
                    return Trouble(Cause.READING_JUMPED, words)
        return None


def topic_of(channel: Channel) -> str:
    """A channel's key without the prefix."""
    return channel.key.removeprefix(f"{contract.PREFIX}/")


def name_of(channel: Channel) -> str:
    """A channel's name for people."""
    return topic_of(channel).replace("/", " ").replace("_", " ")
