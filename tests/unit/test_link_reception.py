"""Any bytes on any key, at both ends: what is believed, what is refused, and that nothing else happens."""

from __future__ import annotations

import json
import logging
import math
import random
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from server.link import contract, reception, wire
from server.link.bounds import Bounds, WristFrame
from server.link.clock import Clock
from server.link.contract import RobotMode
from server.link.identity import Identity
from server.link.imperfections import Imperfections
from server.link.perception import Perception
from server.link.reception import Expectations, Reception
from server.link.robot_emulator import OBEYED, RobotSettings, _Robot
from server.link.session import Transport
from server.link.wire import Echo, JointCommand, JointSample, PlaneSample, RobotCall, StatusReport
from server.log.ros import ros, serialized
from sim.configurations import named_configuration
from sim.errors import Cause

CONFIG = named_configuration("testbed")
ROBOT, OTHER = "testbed.1f", "testbed.2e"
CONSOLE = "console"
MS = 1_000_000
START = 1_764_000_000_000 * MS
AHEAD = 3500 * MS
"""Of the robot's clock."""
DEADLINE = 0.1
GOLDEN = json.loads(Path(__file__).with_name("link_golden").joinpath("golden.json").read_text())


class Time:
    """Of both ends, at will."""

    def __init__(self) -> None:
        self.now_ns = START

    def monotonic(self) -> float:
        return 1e-9 * (self.now_ns - START) + 100.0

    def now(self) -> int:
        return self.now_ns

    @property
    def robot(self) -> int:
        return self.now_ns + AHEAD


class Ears:
    """A session that nobody is at the other end of."""

    def __init__(self) -> None:
        self.takes = {}

    def subscribe(self, channel, take) -> None:
        self.takes[channel] = take


class Console:
    """What a console makes of the bytes that a robot sends."""

    def __init__(self, time: Any, **expected) -> None:
        self.time = time
        wrists = expected.pop("wrists", (WristFrame(frame="left_hand"), WristFrame(frame="right_hand")))
        expectations = Expectations(Bounds(), "world", wrists, expected.pop("detect_freeze", False))
        self.identity = Identity()
        self.reception = Reception(CONSOLE, expectations, self.identity, Perception(CONFIG), time, lambda: DEADLINE)
        self.ears = cast(Any, Ears())
        self.acknowledged = []
        self.reception.listen(self.ears, self.acknowledged.append)

    def hear(self, channel, payload) -> None:
        self.ears.takes[channel](payload)

    def period(self, **changed) -> None:
        """One control period of a good robot, but for the readings that are given by the stream's name, or None."""
        self.time.now_ns += 5 * MS
        stamp = self.time.robot
        sent = self.time.now_ns - MS
        self.reception.sent(sent)
        good = {
            "echo": (contract.HEARTBEAT_ECHO, wire.encode_echo(Echo(stamp, sent, f"{CONSOLE}.1", ROBOT))),
            "left": (contract.WRENCHES[0], wire.encode_wrench(PlaneSample(stamp, "left_hand", np.zeros(3)))),
            "right": (contract.WRENCHES[1], wire.encode_wrench(PlaneSample(stamp, "right_hand", np.zeros(3)))),
            "base": (contract.BASE_POSE, wire.encode_pose(PlaneSample(stamp, "world", np.zeros(3)))),
            "target": (contract.TARGET_POSE, wire.encode_pose(PlaneSample(stamp, "world", np.array([0.0, 0.35, 0.0])))),
            "mode": (contract.MODE, wire.encode_report(StatusReport(stamp, ROBOT, "robot", True, "waiting", {}))),
            "joints": (
                contract.JOINT_STATES,
                wire.encode_joints(JointSample(stamp, np.zeros((2, 3)), np.zeros((2, 3)), ROBOT)),
            ),
        }
        for name, (channel, payload) in good.items():
            given = changed.get(name, payload)
            if given is not None:
                self.hear(channel, given)

    def periods(self, count: int, **made) -> None:
        """So many, with readings made of the robot's time."""
        for _ in range(count):
            stamp = self.time.robot + 5 * MS
            self.period(**{name: make(stamp) for name, make in made.items()})

    @property
    def trouble(self) -> str | None:
        trouble = self.reception.trouble(self.time.monotonic())
        return None if trouble is None else trouble.message

    @property
    def cause(self) -> Cause | None:
        trouble = self.reception.trouble(self.time.monotonic())
        return None if trouble is None else trouble.cause

    def refusals(self, channel):
        return self.reception.refusals[channel.key]


@pytest.fixture
def console(monkeypatch) -> Console:
    time = Time()
    monkeypatch.setattr(reception, "time", SimpleNamespace(monotonic=time.monotonic))
    console = Console(time)
    console.periods(5)
    assert console.trouble is None
    return console


def _wrench(frame="left_hand", value=(0.0, 0.0, 0.0), rest=(0.0, 0.0, 0.0), late=0):
    """A wrench with all six numbers, which our own encoder has no use for."""

    def made(stamp: int) -> bytes:
        force = wire._vector(value[0], value[1], rest[0])
        torque = wire._vector(rest[1], rest[2], value[2])
        sample = PlaneSample(stamp - late, frame, np.zeros(3))
        return wire._stamped(sample, "geometry_msgs/msg/WrenchStamped", ros("geometry_msgs/msg/Wrench", force, torque))

    return made


def _pose(quaternion=(0.0, 0.0, 0.0, 1.0), place=(0.0, 0.35, 0.0), frame="world", late=0):
    def made(stamp: int) -> bytes:
        pose = ros(
            "geometry_msgs/msg/Pose",
            ros("geometry_msgs/msg/Point", *place),
            ros("geometry_msgs/msg/Quaternion", *quaternion),
        )
        return wire._stamped(PlaneSample(stamp - late, frame, np.zeros(3)), "geometry_msgs/msg/PoseStamped", pose)

    return made


@pytest.mark.parametrize(
    ("stream", "refused", "name"),
    [
        ("target", _pose(place=(0.1, 0.35, 0.0)), "target pose"),
        ("base", _pose(late=500 * MS), "base pose"),
        ("left", _wrench(late=500 * MS), "left wrist wrench"),
        ("mode", lambda _: b"rubbish", "robot mode"),
    ],
)
def test_a_silence_is_not_blamed_on_what_was_refused_before_it(console, stream, refused, name):
    console.periods(1, **{stream: refused})
    console.periods(1)
    console.periods(70, **{stream: lambda _: None})
    assert sum(each.count for each in console.reception.refusals.values()) == 1
    assert console.trouble == f"no {name} for 350 ms"


@pytest.mark.parametrize(
    ("stream", "made", "words"),
    [
        ("left", _wrench(value=(math.nan, 0.0, 0.0)), "left wrist wrench refused: not finite: force.x = nan"),
        ("left", _wrench(rest=(0.0, math.inf, 0.0)), "left wrist wrench refused: not finite: torque.x = inf"),
        ("left", _wrench(value=(1e300, 0.0, 0.0)), "left wrist wrench refused: beyond the sensor's range"),
        ("left", _wrench("left_sensor"), "left wrist wrench refused: frame 'left_sensor', not in 'left_hand'"),
        ("left", _wrench(""), "left wrist wrench refused: header.frame_id is empty"),
        ("left", _wrench(late=500 * MS), "left wrist wrench refused: measured 50"),
        ("target", _pose(late=500 * MS), "target pose refused: measured 50"),
        ("target", _pose(late=3_600_000 * MS), "target pose refused: measured 3.6e+03 s ago"),
        ("target", _pose(late=-3_600_000 * MS), "target pose refused: stamped 3.6e+03 s in the future"),
        ("base", _pose(late=500 * MS), "base pose refused: measured 50"),
        ("target", _pose((0.0, 0.0, 0.0, 1.02)), "target pose refused: orientation has length 1.02"),
        ("target", _pose((0.0, 0.0, 11585.0, 11585.0)), "target pose refused: orientation has length"),
        ("target", _pose((0.0, 0.0, 0.0, 0.0)), "target pose refused: orientation has length 0"),
        ("target", _pose((0.0, 0.0, math.nan, 1.0)), "target pose refused: not finite: orientation.z"),
        ("target", _pose((0.5, 0.5, 0.5, 0.5)), "target pose refused: out of the plane: tilted by 1.57 rad"),
        ("target", _pose(place=(0.0, 0.35, 0.8)), "target pose refused: out of the plane: z = 0.8 m"),
        ("target", _pose(place=(0.0, 350.0, 0.0)), "target pose refused: outside of the testbed"),
        ("target", _pose(frame="map"), "target pose refused: frame 'map', not in 'world'"),
        ("base", lambda _: b"rubbish", "base pose refused: 7 bytes are no geometry_msgs/msg/PoseStamped"),
    ],
)
def test_what_cannot_be_believed_is_refused_by_its_name(console, caplog, stream, made, words):
    console.periods(50, **{stream: made})
    assert str(console.trouble).startswith(words)
    assert console.cause is Cause.READING_REFUSED
    assert console.reception.settled(console.time.monotonic()) is False
    channel = next(each for each in contract.STREAMS if reception.name_of(each) == words.partition(" refused")[0])
    assert console.refusals(channel).count == 50
    lines = [record for record in caplog.records if record.levelno >= logging.WARNING]
    assert len(lines) == 1  # in a quarter of a second
    assert all(record.exc_info is None for record in lines)
    console.periods(5)
    assert console.trouble is None


@pytest.mark.parametrize("length", [0.995, 1.0, 1.005])
def test_quaternions_nearly_of_unit_length_are_normalised(length):
    half = 0.5 * math.radians(50.0)
    payload = _pose((0.0, 0.0, length * math.sin(half), length * math.cos(half)))(START)
    assert wire.decode_pose(payload).value[2] == pytest.approx(math.radians(50.0), abs=1e-12)


@pytest.mark.parametrize("stream", ["joints", "left", "base", "target", "mode", "echo"])
def test_a_stream_whose_stamp_stands_still_runs_late(console, stream):
    held = {}

    def frozen(stamp: int, name: str) -> bytes:
        if name not in held:
            held[name] = {
                "joints": wire.encode_joints(JointSample(stamp, np.zeros((2, 3)), np.zeros((2, 3)), ROBOT)),
                "left": _wrench()(stamp),
                "base": _pose(place=(0.0, 0.0, 0.0))(stamp),
                "target": _pose()(stamp),
                "mode": wire.encode_report(StatusReport(stamp, ROBOT, "robot", True, "waiting", {})),
                "echo": wire.encode_echo(Echo(stamp, stamp - AHEAD - MS, f"{CONSOLE}.1", ROBOT)),
            }[name]
        return held[name]

    console.periods(60, **{stream: lambda stamp: frozen(stamp, stream)})
    assert console.cause is Cause.READING_REFUSED


@pytest.mark.parametrize(
    ("stream", "cause"),
    [("joints", Cause.ROBOT_SILENT), ("left", Cause.STREAM_LATE), ("target", Cause.STREAM_LATE),
     ("mode", Cause.STREAM_LATE)],
)  # fmt: skip
def test_what_comes_no_more_is_told_by_its_cause(console, stream, cause):
    for _ in range(60):
        console.period(**{stream: None})
    assert console.cause is cause


def test_a_sensor_that_repeats_itself_is_frozen(monkeypatch):
    time = Time()
    monkeypatch.setattr(reception, "time", SimpleNamespace(monotonic=time.monotonic))
    console = Console(time, detect_freeze=True)
    console.periods(60)
    assert str(console.trouble).startswith("left wrist wrench frozen: the same for")
    assert console.cause is Cause.SENSOR_FROZEN


@pytest.mark.parametrize("force", [20.0, -20.0, 49.0])
def test_one_reading_of_a_wrist_that_jumps_ends_what_is_flown(console, force):
    console.periods(1, left=_wrench(value=(force, 0.0, 0.0)))
    state_force = console.reception.perception._wrench[0].copy()
    assert "left wrist wrench: force jumped by" in str(console.trouble)
    assert console.cause is Cause.READING_JUMPED
    assert not state_force.any()  # it moves nothing
    console.periods(1)
    assert "jumped" in str(console.trouble)  # however good the next one is
    console.periods(220)
    assert console.trouble is None


def test_a_wrench_of_a_configured_sensor_frame_is_turned_into_the_hands(monkeypatch):
    time = Time()
    monkeypatch.setattr(reception, "time", SimpleNamespace(monotonic=time.monotonic))
    sensor = WristFrame(frame="left_sensor", angle=math.pi)
    console = Console(time, wrists=(sensor, WristFrame(frame="right_hand")))
    console.periods(5, left=_wrench("left_sensor", (0.5, 0.25, 0.0)))
    np.testing.assert_allclose(console.reception.perception._wrench[0], [-0.5, -0.25, 0.0], atol=1e-12)
    console.periods(50)
    assert "frame 'left_hand', not in 'left_sensor'" in str(console.trouble)


def test_a_second_robot_grounds_both_and_nothing_of_it_is_believed(console):
    elbow = np.full((2, 3), 1.0)

    def joints(stamp: int) -> bytes:
        return wire.encode_joints(JointSample(stamp, elbow, np.zeros((2, 3)), OTHER))

    before = console.reception.joints
    console.hear(contract.JOINT_STATES, joints(console.time.robot + MS))
    assert console.reception.joints is before
    assert f"two robots answer on the same keys, {ROBOT} and {OTHER}" in str(console.trouble)
    assert console.cause is Cause.SEVERAL_ROBOTS
    mode = wire.encode_report(StatusReport(console.time.robot, OTHER, "robot", True, "following", {"session": "x.1"}))
    console.hear(contract.MODE, mode)
    assert console.reception.reports.value("session") == ""
    granted = StatusReport(
        console.time.robot, OTHER, "session/open", True, "", {"session": f"{CONSOLE}.1", "stamp": "1"}
    )
    console.hear(contract.ACKNOWLEDGEMENT, wire.encode_report(granted))
    assert console.acknowledged == []
    console.periods(250)
    assert console.trouble is None


def test_a_clock_that_jumps_is_reported_and_known_again(console):
    console.time.now_ns += 5 * MS
    sent = console.time.now_ns - MS
    console.reception.sent(sent)
    echo = Echo(console.time.robot + 3_000 * MS, sent, f"{CONSOLE}.1", ROBOT)
    console.hear(contract.HEARTBEAT_ECHO, wire.encode_echo(echo))
    assert console.trouble == "the robot's clock jumped by +3000 ms"
    assert console.cause is Cause.CLOCK_JUMPED


def test_an_answer_to_a_heartbeat_that_was_never_sent_does_not_set_the_clock(console):
    before = console.reception.other_clock.offset
    for sent in (console.time.now_ns - 1, console.time.now_ns + 10**12, 0):
        echo = Echo(console.time.robot + 10**12, sent, f"{CONSOLE}.1", ROBOT)
        console.hear(contract.HEARTBEAT_ECHO, wire.encode_echo(echo))
    assert console.reception.other_clock.offset == before
    assert console.refusals(contract.HEARTBEAT_ECHO).count == 3


@pytest.mark.parametrize("stamp", ["", "\u00b2", "\u0661", "-1", "1e3", "9" * 5000, "nan"])
def test_numbers_in_reports_are_numbers_or_nothing(console, stamp):
    values = {"session": f"{CONSOLE}.1", "stamp": stamp, "commands": stamp, "command_age_p50": stamp}
    for channel in (contract.ACKNOWLEDGEMENT, contract.MODE):
        console.hear(
            channel, wire.encode_report(StatusReport(console.time.robot, ROBOT, "stop", True, "waiting", values))
        )
    assert console.reception.reports.joint_command_ages is None


def _mangled(random_: random.Random, good: bytes) -> bytes:
    """The bytes, cut, padded, changed or replaced."""
    raw = bytearray(good)
    way = random_.randrange(6)
    if way == 0:
        return random_.randbytes(random_.randrange(300))
    if way == 1:
        return bytes(raw[: random_.randrange(len(raw) + 1)])
    if way == 2:
        return bytes(raw) + random_.randbytes(random_.randrange(1, 40))
    if way == 3:
        return bytes(raw) + bytes(random_.choice((1, 3, 4, 7, 8, 100_000)))
    for _ in range(random_.randrange(1, 6)):
        raw[random_.randrange(len(raw))] = random_.choice((0, 1, 0x7F, 0x80, 0xFF, random_.randrange(256)))
    if way == 4:
        raw[4 : 4 + 4] = random_.choice((b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f", b"\0\0\0\0"))
    return bytes(raw)


DECODERS = {
    "joint_states": wire.decode_joints,
    "joint_command": wire.decode_joint_command,
    "wrench": wire.decode_wrench,
    "pose": wire.decode_pose,
    "twist": wire.decode_twist,
    "call": wire.decode_call,
    "echo": wire.decode_echo,
    "report": wire.decode_report,
}


@pytest.mark.parametrize("name", DECODERS)
def test_whatever_the_bytes_a_decoder_gives_a_message_or_refuses(name):
    random_ = random.Random(name)
    good = bytes.fromhex(GOLDEN[name])
    for _ in range(600):
        refusal, message = "", cast(tuple[Any, ...], ())
        try:
            message = DECODERS[name](_mangled(random_, good))
        except wire.WireError as error:
            refusal = str(error)
        assert len(refusal) < 600
        assert refusal.isprintable()
        for value in message:
            if isinstance(value, np.ndarray):
                assert np.isfinite(value).all()
            elif isinstance(value, str):
                assert value.isprintable()
                assert len(value) <= wire.LONGEST_TEXT


@pytest.mark.parametrize(("padding", "good"), [(0, True), (3, True), (4, True), (7, True), (8, False), (4096, False)])
def test_zeros_to_the_next_multiple_of_eight_are_no_part_of_a_message(padding, good):
    payload = bytes.fromhex(GOLDEN["pose"]) + bytes(padding)
    if good:
        assert wire.decode_pose(payload).frame == "world"
        return
    with pytest.raises(wire.WireError):
        wire.decode_pose(payload)


def test_what_follows_a_message_and_is_not_zero_is_refused():
    with pytest.raises(wire.WireError):
        wire.decode_pose(bytes.fromhex(GOLDEN["pose"]) + b"\0\0\0\0\0\1")


def test_three_hundred_thousand_joints_are_not_even_read():
    names = [f"j{i}" for i in range(300_000)]
    header = wire._header(START, f"{CONSOLE}.1@{ROBOT}")
    message = ros("sensor_msgs/msg/JointState", header, names, np.zeros(0), np.zeros(300_000), np.zeros(0))
    with pytest.raises(wire.WireError, match="no message of the contract has more than"):
        wire.decode_joint_command(serialized(message, "sensor_msgs/msg/JointState"))


def test_a_joint_that_is_named_twice_is_refused():
    names = [*contract.JOINT_NAMES, "left_joint_1"]
    message = ros(
        "sensor_msgs/msg/JointState", wire._header(START, ROBOT), names, np.zeros(7), np.zeros(7), np.zeros(0)
    )
    with pytest.raises(wire.WireError, match="each once"):
        wire.decode_joints(serialized(message, "sensor_msgs/msg/JointState"))


@pytest.mark.parametrize("robot", ["", "two words", "a\nb", "\u00e9mulateur", "a.b.c", "x" * 65])
def test_a_robot_without_a_proper_identity_is_refused(robot):
    sample = JointSample(START, np.zeros((2, 3)), np.zeros((2, 3)), robot)
    with pytest.raises(wire.WireError, match="must name the robot"):
        wire.decode_joints(wire.encode_joints(sample))


def test_a_console_outlives_any_bytes_on_any_key(console):
    random_ = random.Random(11)
    goods = [bytes.fromhex(each) for each in GOLDEN.values()]
    for take in console.ears.takes.values():
        for _ in range(200):
            take(_mangled(random_, random_.choice(goods)))
    console.time.now_ns += 2_000 * MS
    console.periods(250)
    assert console.trouble is None


@pytest.fixture(scope="module")
def robot():
    """A robot whose cycles are turned by hand."""
    settings = RobotSettings(transport=Transport(), config=CONFIG, imperfections=Imperfections())
    robot = _Robot(settings, Clock(), 0)
    yield robot
    robot.close()


def _tell(robot: _Robot, channel, payload: bytes) -> None:
    robot._taker(channel)(payload)


def _take(robot: _Robot, number: int) -> str:
    """Open a session and have a rate followed."""
    session, now = f"{CONSOLE}.{number}@{robot._identity}", robot._clock.now()
    _tell(robot, contract.OPEN, wire.encode_call(RobotCall(now, session)))
    robot._take_all()
    return session


def test_a_robot_outlives_any_bytes_on_any_key_and_can_be_taken(robot):
    random_ = random.Random(5)
    goods = [bytes.fromhex(each) for each in GOLDEN.values()]
    for channel in OBEYED:
        for _ in range(100):
            _tell(robot, channel, _mangled(random_, random_.choice(goods)))
            robot._take_all()
    for session in ("a.\u00b2", "", "\u0661.\u0661", f"a.{'9' * 190}"):
        for channel in (contract.OPEN, contract.TARE, contract.HEARTBEAT):
            _tell(robot, channel, wire.encode_call(RobotCall(robot._clock.now(), session)))
            robot._take_all()
    assert robot._gate.refused > 100
    session = _take(robot, 1)
    assert robot._gate.session == session
    assert robot._gate.mode is RobotMode.FOLLOWING


def test_a_stop_is_obeyed_among_any_number_of_other_messages_and_even_if_it_cannot_be_read(robot):
    session = _take(robot, 2)
    now = robot._clock.now()
    rates = wire.encode_joint_command(JointCommand(now, session, np.full((2, 3), 0.3)))
    _tell(robot, contract.STOP, b"\0")
    for channel in (contract.JOINT_COMMAND, contract.HEARTBEAT):
        for _ in range(5000):
            _tell(robot, channel, rates)
    assert sum(map(len, robot._inboxes.values())) < 200
    robot._take_all()
    assert robot._gate.mode is RobotMode.STOPPED
    assert not robot._gate.rates(robot._clock.now(), 0.005).any()
