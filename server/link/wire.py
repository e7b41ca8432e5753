"""The bytes of the link: ROS 2 messages in CDR to numbers of the plane and back. Pure: no clock, no network.

Poses are (x, y, angle), twists (vx, vy, angular velocity), wrenches (fx, fy, torque); what a message has beside the
plane is written as zero, and read to be judged (`server.link.trust`). Stamps are whole nanoseconds of the sender's
clock. Whatever bytes come, a decoder gives a message of finite numbers and short printable texts, or a `WireError`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from server.link.contract import JOINT_NAMES, LONGEST_MESSAGE, LONGEST_NAME, ROBOT_IDENTITY, Channel
from server.log.ros import ros, serialized, store
from sim.compiled import FloatArray
from sim.errors import CaptureError

UNIT_TOLERANCE = 0.01
"""How far from one a quaternion's length may be: what rounding makes is taken out, what is no rotation is refused."""
PADDING = 4
"""Zero bytes after a message beyond the three that the standard leaves free: alignment to eight, CDR's largest."""
MOST_JOINTS = 64
"""Names in a `JointState`; a robot may have others beside ours."""
MOST_VALUES = 32
"""Values in a report."""
LONGEST_TEXT = 400
"""Characters of a report's text; what is longer is cut."""

_NANOSECONDS = 1_000_000_000
_EMPTY = np.empty(0)
_IN_PLANE = np.zeros(3)
_IN_PLANE.setflags(write=False)


class WireError(CaptureError):
    """Bytes that are not the message that their key promises."""


class JointSample(NamedTuple):
    """Joint angles [rad] and rates [rad/s], shape (2, 3) each."""

    stamp: int
    angle: FloatArray
    rate: FloatArray
    robot: str = ""
    """Identity of the robot; the decoder gives none that is empty."""


class JointCommand(NamedTuple):
    """Commanded joint rates [rad/s], shape (2, 3)."""

    stamp: int
    """Of the joint state that it answers, robot's clock [ns]."""
    session: str
    rate: FloatArray


class PlaneSample(NamedTuple):
    """A pose, twist or wrench of the plane, shape (3,), in the frame that the channel names."""

    stamp: int
    frame: str
    value: FloatArray
    rest: FloatArray = _IN_PLANE
    """What the message has out of the plane: of a pose (z [m], tilt [rad], 0), of a twist (vz, wx, wy), of a wrench
    (force z, torque x, torque y)."""


class RobotCall(NamedTuple):
    """A heartbeat or a request: who, and when by the console's clock [ns]."""

    stamp: int
    session: str


class Echo(NamedTuple):
    """A heartbeat that came back."""

    received: int
    """Robot's clock [ns]."""
    sent: int
    """Console's clock [ns]."""
    session: str
    robot: str


class StatusReport(NamedTuple):
    """Mode or acknowledgement."""

    stamp: int
    robot: str
    """Its identity."""
    name: str
    good: bool
    message: str
    values: Mapping[str, str]


def encode_joints(sample: JointSample) -> bytes:
    """As `sensor_msgs/JointState`."""
    header = _header(sample.stamp, sample.robot)
    return _joint_state(header, sample.angle.ravel(), sample.rate.ravel())


def decode_joints(payload: bytes) -> JointSample:
    """From `sensor_msgs/JointState`, the joints in any order.

    Raises:
        WireError: not such a message, a joint missing or named twice, a number not finite, or a robot without identity.

    """
    message = _message(payload, "sensor_msgs/msg/JointState")
    order = _order(message.name)
    angle, rate = _picked(message.position, order, "position"), _picked(message.velocity, order, "velocity")
    return JointSample(_stamp(message.header), angle, rate, _identity(message.header.frame_id, "header.frame_id"))


def encode_joint_command(command: JointCommand) -> bytes:
    """As `sensor_msgs/JointState` with velocities only."""
    return _joint_state(_header(command.stamp, command.session), _EMPTY, command.rate.ravel())


def decode_joint_command(payload: bytes) -> JointCommand:
    """From `sensor_msgs/JointState`, the joints in any order.

    Raises:
        WireError: not such a message, a joint missing or named twice, or a rate not finite.

    """
    message = _message(payload, "sensor_msgs/msg/JointState")
    rate = _picked(message.velocity, _order(message.name), "velocity")
    return JointCommand(_stamp(message.header), _name(message.header.frame_id, "header.frame_id"), rate)


def encode_wrench(sample: PlaneSample) -> bytes:
    """As `geometry_msgs/WrenchStamped`."""
    fx, fy, torque = sample.value.tolist()
    wrench = ros("geometry_msgs/msg/Wrench", _vector(fx, fy, 0.0), _vector(0.0, 0.0, torque))
    return _stamped(sample, "geometry_msgs/msg/WrenchStamped", wrench)


def decode_wrench(payload: bytes) -> PlaneSample:
    """From `geometry_msgs/WrenchStamped`.

    Raises:
        WireError: not such a message, or a number not finite.

    """
    message = _message(payload, "geometry_msgs/msg/WrenchStamped")
    force, torque = _vector_of(message.wrench.force, "force"), _vector_of(message.wrench.torque, "torque")
    return _plane(message.header, (force[0], force[1], torque[2]), (force[2], torque[0], torque[1]))


def encode_pose(sample: PlaneSample) -> bytes:
    """As `geometry_msgs/PoseStamped`, the angle as a rotation about z."""
    x, y, angle = sample.value.tolist()
    place = ros("geometry_msgs/msg/Point", x, y, 0.0)
    turn = ros("geometry_msgs/msg/Quaternion", 0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2))
    return _stamped(sample, "geometry_msgs/msg/PoseStamped", ros("geometry_msgs/msg/Pose", place, turn))


def decode_pose(payload: bytes) -> PlaneSample:
    """From `geometry_msgs/PoseStamped`; the angle is that about z, in (-pi, pi].

    Raises:
        WireError: not such a message, a number not finite, or a quaternion that is no rotation.

    """
    message = _message(payload, "geometry_msgs/msg/PoseStamped")
    place = _vector_of(message.pose.position, "position")
    x, y, z, w = _rotation(message.pose.orientation)
    angle = math.atan2(2 * (w * z + x * y), 1 - 2 * (y**2 + z**2))
    tilt = 2 * math.asin(min(1.0, math.hypot(x, y)))
    return _plane(message.header, (place[0], place[1], angle), (place[2], tilt, 0.0))


def encode_twist(sample: PlaneSample) -> bytes:
    """As `geometry_msgs/TwistStamped`."""
    vx, vy, spin = sample.value.tolist()
    twist = ros("geometry_msgs/msg/Twist", _vector(vx, vy, 0.0), _vector(0.0, 0.0, spin))
    return _stamped(sample, "geometry_msgs/msg/TwistStamped", twist)


def decode_twist(payload: bytes) -> PlaneSample:
    """From `geometry_msgs/TwistStamped`.

    Raises:
        WireError: not such a message, or a number not finite.

    """
    message = _message(payload, "geometry_msgs/msg/TwistStamped")
    linear, angular = _vector_of(message.twist.linear, "linear"), _vector_of(message.twist.angular, "angular")
    return _plane(message.header, (linear[0], linear[1], angular[2]), (linear[2], angular[0], angular[1]))


def encode_call(call: RobotCall) -> bytes:
    """As `std_msgs/Header`."""
    return serialized(_header(call.stamp, call.session), "std_msgs/msg/Header")


def decode_call(payload: bytes) -> RobotCall:
    """From `std_msgs/Header`.

    Raises:
        WireError: not such a message.

    """
    message = _message(payload, "std_msgs/msg/Header")
    return RobotCall(_time(message.stamp), _name(message.frame_id, "frame_id"))


def encode_echo(echo: Echo) -> bytes:
    """As `sensor_msgs/TimeReference`."""
    header = _header(echo.received, echo.robot)
    message = ros("sensor_msgs/msg/TimeReference", header, _ros_time(echo.sent), echo.session)
    return serialized(message, "sensor_msgs/msg/TimeReference")


def decode_echo(payload: bytes) -> Echo:
    """From `sensor_msgs/TimeReference`.

    Raises:
        WireError: not such a message, or of a robot without identity.

    """
    message = _message(payload, "sensor_msgs/msg/TimeReference")
    robot = _identity(message.header.frame_id, "header.frame_id")
    return Echo(_stamp(message.header), _time(message.time_ref), _name(message.source, "source"), robot)


def encode_report(report: StatusReport) -> bytes:
    """As `diagnostic_msgs/DiagnosticArray` of one status."""
    values = [ros("diagnostic_msgs/msg/KeyValue", key, value) for key, value in report.values.items()]
    level = 0 if report.good else 1
    status = ros("diagnostic_msgs/msg/DiagnosticStatus", level, report.name, report.message, report.robot, values)
    message = ros("diagnostic_msgs/msg/DiagnosticArray", _header(report.stamp, ""), [status])
    return serialized(message, "diagnostic_msgs/msg/DiagnosticArray")


def decode_report(payload: bytes) -> StatusReport:
    """From `diagnostic_msgs/DiagnosticArray` of one status.

    Raises:
        WireError: not such a message, or of a robot without identity.

    """
    message = _message(payload, "diagnostic_msgs/msg/DiagnosticArray")
    if len(message.status) != 1:
        raise WireError(f"status has {len(message.status)} entries; it must have 1")
    status = message.status[0]
    if len(status.values) > MOST_VALUES:
        raise WireError(f"values has {len(status.values)} entries; at most {MOST_VALUES} are read")
    values = {printable(each.key): printable(each.value) for each in status.values}
    robot = _identity(status.hardware_id, "hardware_id")
    return StatusReport(
        _stamp(message.header), robot, printable(status.name), status.level == 0, printable(status.message), values
    )


def described(channel: Channel) -> str:
    """The channel's row in docs/link.md."""
    rate = "when it happens" if channel.rate is None else f"{channel.rate:g} Hz"
    frame = f"`{channel.frame}`" if channel.frame else "none"
    service = f"{channel.urgency}, express" if channel.express else channel.urgency
    cells = (f"`{channel.key}`", f"`{channel.message}`", rate, channel.content, frame, channel.sender, service)
    return f"| {' | '.join(cells)} |"


def printable(text: str, longest: int = LONGEST_TEXT) -> str:
    """A text of somebody else's as it may stand in a log and on a page: printable, of one line and not long."""
    shown = "".join(each if each.isprintable() else "\N{REPLACEMENT CHARACTER}" for each in text[: longest + 1])
    return shown if len(shown) <= longest else f"{shown[: longest - 3]}..."


def _message(payload: bytes, name: str) -> Any:
    if len(payload) > LONGEST_MESSAGE:
        raise WireError(f"{len(payload)} bytes: no message of the contract has more than {LONGEST_MESSAGE}")
    try:
        return store().deserialize_cdr(payload, name)
    except Exception as error:  # rosbags raises what numpy and struct raise, and asserts
        padded = _unpadded(payload, name)
        if padded is not None:
            return padded
        raise WireError(f"{len(payload)} bytes are no {name}: {printable(str(error), 120)}") from None


def _unpadded(payload: bytes, name: str) -> Any | None:
    """The message without the zeros to which it was aligned; None if that is not what is wrong with it."""
    if not payload.endswith(bytes(PADDING)):
        return None
    try:
        return store().deserialize_cdr(payload[:-PADDING], name)
    except Exception:
        return None


def _name(text: str, field: str) -> str:
    """A name or an identifier, which may be empty."""
    if len(text) > LONGEST_NAME or not text.isprintable():
        raise WireError(f"{field} has {len(text)} characters: at most {LONGEST_NAME}, all printable, are a name")
    return text


def _identity(text: str, field: str) -> str:
    if not re.fullmatch(ROBOT_IDENTITY, text):
        shown = printable(text, 40)
        raise WireError(f"{field} = {shown!r}: it must name the robot, as NAME.START in letters, digits, - and _")
    return text


def _order(names: list[str]) -> list[int]:
    """Where each of our joints stands."""
    if len(names) > MOST_JOINTS:
        raise WireError(f"name has {len(names)} entries; at most {MOST_JOINTS} joints are read")
    for joint in JOINT_NAMES:
        if names.count(joint) != 1:
            shown = printable(", ".join(names), 120)
            raise WireError(f"name = {shown or 'nothing'}: it must hold {', '.join(JOINT_NAMES)}, each once")
    return [names.index(joint) for joint in JOINT_NAMES]


def _picked(values: FloatArray, order: list[int], field: str) -> FloatArray:
    if len(values) <= max(order):
        raise WireError(f"{field} has {len(values)} numbers; one for each name is needed")
    picked = np.array([values[place] for place in order], np.float64)
    bad = np.flatnonzero(~np.isfinite(picked))
    if len(bad):
        raise WireError(f"not finite: {field} of {JOINT_NAMES[bad[0]]} = {picked[bad[0]]}")
    return picked.reshape(2, 3)


def _vector_of(vector: Any, field: str) -> tuple[float, float, float]:
    """The three numbers of a `Vector3` or a `Point`, every one of them finite."""
    numbers = (vector.x, vector.y, vector.z)
    for axis, number in zip("xyz", numbers, strict=True):
        if not math.isfinite(number):
            raise WireError(f"not finite: {field}.{axis} = {number}")
    return numbers


def _rotation(turn: Any) -> tuple[float, float, float, float]:
    """A quaternion (x, y, z, w) of unit length."""
    parts = (*_vector_of(turn, "orientation"), turn.w)
    if not math.isfinite(turn.w):
        raise WireError(f"not finite: orientation.w = {turn.w}")
    length = math.hypot(*parts)
    if not abs(length - 1.0) <= UNIT_TOLERANCE:
        raise WireError(f"orientation has length {length:.4g}: a rotation's is 1 (within {UNIT_TOLERANCE:g})")
    x, y, z, w = (part / length for part in parts)
    return x, y, z, w


def _plane(header: Any, value: tuple[float, float, float], rest: tuple[float, float, float]) -> PlaneSample:
    return PlaneSample(_stamp(header), _name(header.frame_id, "header.frame_id"), np.array(value), np.array(rest))


def _joint_state(header: Any, position: FloatArray, velocity: FloatArray) -> bytes:
    names = list(JOINT_NAMES)
    message = ros("sensor_msgs/msg/JointState", header, names, position, velocity, _EMPTY)
    return serialized(message, "sensor_msgs/msg/JointState")


def _stamped(sample: PlaneSample, name: str, content: Any) -> bytes:
    return serialized(ros(name, _header(sample.stamp, sample.frame), content), name)


def _vector(x: float, y: float, z: float) -> Any:
    return ros("geometry_msgs/msg/Vector3", x, y, z)


def _header(stamp: int, frame: str) -> Any:
    return ros("std_msgs/msg/Header", _ros_time(stamp), frame)


def _ros_time(stamp: int) -> Any:
    return ros("builtin_interfaces/msg/Time", stamp // _NANOSECONDS, stamp % _NANOSECONDS)


def _stamp(header: Any) -> int:
    return _time(header.stamp)


def _time(time: Any) -> int:
    seconds, nanoseconds = int(time.sec), int(time.nanosec)
    if seconds < 0 or nanoseconds >= _NANOSECONDS:
        raise WireError(
            f"stamp = {seconds} s and {nanoseconds} ns: an instant has no negative seconds, and less than 1e9 ns"
        )
    return seconds * _NANOSECONDS + nanoseconds
