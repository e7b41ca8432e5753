"""What goes over the link: key expressions, messages, rates, frames and quality of service (docs/link.md).

The keys are those of zenoh's bridge to ROS 2 (zenoh-plugin-ros2dds): the topic without its leading slash. So a ROS 2
robot that has these topics needs no code of ours. Only this module and `server.link.wire` say what the bytes mean.
"""

from __future__ import annotations

from enum import StrEnum
from typing import Literal, NamedTuple

VERSION = "2"
"""Of the contract; both ends say theirs, and the console flies no robot of another one."""

LONGEST_MESSAGE = 8192
"""Bytes; no message of the contract is as long, and a longer one is refused before it is read."""
LONGEST_NAME = 200
"""Characters of a session, a frame or a robot's identity."""
ROBOT_IDENTITY = r"[A-Za-z0-9_-]{1,64}(?:\.[A-Za-z0-9_-]{1,64})?"
"""NAME.START of a robot: its name, and a text that it draws at each start. A robot may leave `.START` away."""
SESSION = rf"(?P<console>[A-Za-z0-9_-]{{1,64}})\.(?P<number>[0-9]{{1,18}})@(?P<robot>{ROBOT_IDENTITY})"
"""CONSOLE.NUMBER@ROBOT: it names the robot, so that no other one follows what is sent in it."""

PREFIX = "becalm"
WORLD = "world"
ARMS = ("left", "right")
JOINT_NAMES = tuple(f"{arm}_joint_{number}" for arm in ARMS for number in (1, 2, 3))
Body = Literal["base", "target"]
BODIES: tuple[Body, ...] = ("base", "target")
HAND_FRAMES = tuple(f"{arm}_hand" for arm in ARMS)

CONTROL_RATE = 200.0
"""Of joint states, wrenches and joint commands [Hz]."""
MOTION_CAPTURE_RATE = 100.0
"""Of poses and twists [Hz]."""
MODE_RATE = 20.0
"""Of the robot's mode, beside which it reports every change at once [Hz]."""
DEADLINE = 0.1
"""How old a heartbeat, joint command or stream may get before its receiver stops the robot, by default [s]."""


class Sender(StrEnum):
    """Who publishes a channel."""

    ROBOT = "robot"
    CONSOLE = "console"


class Urgency(StrEnum):
    """Quality of service. Nothing is ever queued for a receiver that does not keep up: what is late is dropped."""

    STOP = "stop"
    """zenoh's highest priority, sent again until it is acknowledged."""
    CONTROL = "control"
    """The next priority."""
    STREAM = "stream"
    """High."""
    REPORT = "report"
    """Normal."""


class Channel(NamedTuple):
    """One key expression of the link."""

    key: str
    message: str
    """ROS 2 type."""
    sender: Sender
    rate: float | None
    """Nominal [Hz]; None: when it happens."""
    frame: str
    """What stands in `header.frame_id`."""
    urgency: Urgency
    content: str
    """With units."""
    express: bool
    """Whether it is sent at once, in one batch with what its sender published before it. The last message of a control
    period is, and so are those that come alone; the others of a period go with the last."""


def _stream(key: str, message: str, rate: float, frame: str, content: str, *, express: bool = False) -> Channel:
    return Channel(f"{PREFIX}/{key}", message, Sender.ROBOT, rate, frame, Urgency.STREAM, content, express)


def _request(key: str, urgency: Urgency, content: str) -> Channel:
    return Channel(f"{PREFIX}/{key}", "std_msgs/msg/Header", Sender.CONSOLE, None, "(session)", urgency, content, True)


_POSE, _TWIST = "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/TwistStamped"

JOINT_STATES = _stream(
    "joint_states",
    "sensor_msgs/msg/JointState",
    CONTROL_RATE,
    "(robot)",
    "joint angles [rad], rates [rad/s]; effort unused",
    express=True,
)
WRENCHES = tuple(
    _stream(
        f"{arm}_wrist/wrench",
        "geometry_msgs/msg/WrenchStamped",
        CONTROL_RATE,
        frame,
        "target on hand, about the hand's centre, hand's axes: force x, y [N], torque z [N m]",
    )
    for arm, frame in zip(ARMS, HAND_FRAMES, strict=True)
)
BASE_POSE = _stream("base/pose", _POSE, MOTION_CAPTURE_RATE, WORLD, "centre of mass x, y [m], rotation about z")
BASE_TWIST = _stream("base/twist", _TWIST, MOTION_CAPTURE_RATE, WORLD, "velocity x, y [m/s], spin z [rad/s]")
TARGET_POSE = _stream("target/pose", _POSE, MOTION_CAPTURE_RATE, WORLD, "outline's centroid x, y [m], rotation about z")
TARGET_TWIST = _stream("target/twist", _TWIST, MOTION_CAPTURE_RATE, WORLD, "its velocity x, y [m/s], spin z [rad/s]")

MODE = Channel(
    f"{PREFIX}/robot/mode",
    "diagnostic_msgs/msg/DiagnosticArray",
    Sender.ROBOT,
    MODE_RATE,
    "",
    Urgency.REPORT,
    "one status: `hardware_id` is the robot, `message` its mode; values: contract, session, why, refusals, ages",
    express=False,
)
ACKNOWLEDGEMENT = Channel(
    f"{PREFIX}/robot/acknowledgement",
    "diagnostic_msgs/msg/DiagnosticArray",
    Sender.ROBOT,
    None,
    "",
    Urgency.CONTROL,
    "one status: `hardware_id` is the robot, `name` the request, level OK or WARN, `message` why not; values: session, "
    "stamp of the request",
    express=True,
)
HEARTBEAT_ECHO = Channel(
    f"{PREFIX}/robot/heartbeat",
    "sensor_msgs/msg/TimeReference",
    Sender.ROBOT,
    CONTROL_RATE,
    "(robot)",
    Urgency.CONTROL,
    "header.stamp: when the robot received a heartbeat; time_ref: that heartbeat's stamp; source: its session",
    express=True,
)

JOINT_COMMAND = Channel(
    f"{PREFIX}/joint_command",
    "sensor_msgs/msg/JointState",
    Sender.CONSOLE,
    CONTROL_RATE,
    "(session)",
    Urgency.CONTROL,
    "commanded joint rates [rad/s] in `velocity`; header.stamp: of the joint state that it answers (robot's clock)",
    express=False,
)
HEARTBEAT = Channel(
    f"{PREFIX}/heartbeat",
    "std_msgs/msg/Header",
    Sender.CONSOLE,
    CONTROL_RATE,
    "(session)",
    Urgency.CONTROL,
    "stamp: console's clock",
    express=True,
)
STOP = _request("stop", Urgency.STOP, "joint rates zero at once, whoever asks; ended only by a new session")
OPEN = _request(
    "session/open",
    Urgency.CONTROL,
    "take the robot that the session names; stamp: that of a joint state which it answers",
)
TARE = _request("tare", Urgency.CONTROL, "what the wrists read now is zero from here on; stamp: as of session/open")

STREAMS = (JOINT_STATES, *WRENCHES, BASE_POSE, BASE_TWIST, TARGET_POSE, TARGET_TWIST)
"""What the robot measures."""
CHANNELS = (*STREAMS, MODE, ACKNOWLEDGEMENT, HEARTBEAT_ECHO, JOINT_COMMAND, HEARTBEAT, STOP, OPEN, TARE)
"""All of the contract."""


class RobotMode(StrEnum):
    """What the robot does with joint commands."""

    WAITING = "waiting"
    """Nobody holds it; joint rates zero."""
    FOLLOWING = "following"
    """It follows its session's joint commands."""
    HOLDING = "holding"
    """Heartbeat or joint commands were late; joint rates ramped to zero, until a new session."""
    STOPPED = "stopped"
    """A STOP came; joint rates zero, until a new session."""
