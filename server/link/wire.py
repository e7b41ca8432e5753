"""The bytes of the link: ROS 2 messages in CDR to numbers of the plane and back. Pure: no clock, no network.

Poses are (x, y, angle), twists (vx, vy, angular velocity), wrenches (fx, fy, torque); what a message has beside the
plane is written as zero and not read. Stamps are whole nanoseconds of the sender's clock.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from server.link.contract import JOINT_NAMES, Channel
from server.log.ros import ros, serialized, store
from sim.compiled import FloatArray
from sim.errors import CaptureError

_NANOSECONDS = 1_000_000_000
_EMPTY = np.empty(0)


class WireError(CaptureError):
    """Bytes that are not the message that their key promises."""


class JointSample(NamedTuple):
    """Joint angles [rad] and rates [rad/s], shape (2, 3) each."""

    stamp: int
    angle: FloatArray
    rate: FloatArray


class JointCommand(NamedTuple):
    """Joint rates to command [rad/s], shape (2, 3)."""

    stamp: int
    """Of the joint state that it answers, robot's clock [ns]."""
    session: str
    rate: FloatArray


class PlaneSample(NamedTuple):
    """A pose, twist or wrench of the plane, shape (3,), in the frame that the channel names."""

    stamp: int
    frame: str
    value: FloatArray


class Call(NamedTuple):
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


class Report(NamedTuple):
    """Mode or acknowledgement."""

    stamp: int
    name: str
    good: bool
    message: str
    values: Mapping[str, str]


def encode_joints(sample: JointSample) -> bytes:
    """As `sensor_msgs/JointState`."""
    header = _header(sample.stamp, "")
    return _joint_state(header, sample.angle.ravel(), sample.rate.ravel())


def decode_joints(payload: bytes) -> JointSample:
    """From `sensor_msgs/JointState`, the joints in any order.

    Raises:
        WireError: not such a message, a joint missing, or a number not finite.

    """
    message = _message(payload, "sensor_msgs/msg/JointState")
    order = _order(message.name)
    angle, rate = _picked(message.position, order, "position"), _picked(message.velocity, order, "velocity")
    return JointSample(_stamp(message.header), angle, rate)


def encode_command(command: JointCommand) -> bytes:
    """As `sensor_msgs/JointState` with velocities only."""
    return _joint_state(_header(command.stamp, command.session), _EMPTY, command.rate.ravel())


def decode_command(payload: bytes) -> JointCommand:
    """From `sensor_msgs/JointState`, the joints in any order.

    Raises:
        WireError: not such a message, a joint missing, or a rate not finite.

    """
    message = _message(payload, "sensor_msgs/msg/JointState")
    rate = _picked(message.velocity, _order(message.name), "velocity")
    return JointCommand(_stamp(message.header), message.header.frame_id, rate)


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
    wrench = message.wrench
    return _plane(message.header, wrench.force.x, wrench.force.y, wrench.torque.z)


def encode_pose(sample: PlaneSample) -> bytes:
    """As `geometry_msgs/PoseStamped`, the angle as a rotation about z."""
    x, y, angle = sample.value.tolist()
    place = ros("geometry_msgs/msg/Point", x, y, 0.0)
    turn = ros("geometry_msgs/msg/Quaternion", 0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2))
    return _stamped(sample, "geometry_msgs/msg/PoseStamped", ros("geometry_msgs/msg/Pose", place, turn))


def decode_pose(payload: bytes) -> PlaneSample:
    """From `geometry_msgs/PoseStamped`; the angle is that about z, in (-pi, pi].

    Raises:
        WireError: not such a message, a number not finite, or no rotation.

    """
    message = _message(payload, "geometry_msgs/msg/PoseStamped")
    turn, place = message.pose.orientation, message.pose.position
    if turn.x == turn.y == turn.z == turn.w == 0.0:
        raise WireError("orientation = 0: a quaternion of length zero is no rotation")
    sine, cosine = 2 * (turn.w * turn.z + turn.x * turn.y), 1 - 2 * (turn.y**2 + turn.z**2)
    return _plane(message.header, place.x, place.y, math.atan2(sine, cosine))


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
    twist = message.twist
    return _plane(message.header, twist.linear.x, twist.linear.y, twist.angular.z)


def encode_call(call: Call) -> bytes:
    """As `std_msgs/Header`."""
    return serialized(_header(call.stamp, call.session), "std_msgs/msg/Header")


def decode_call(payload: bytes) -> Call:
    """From `std_msgs/Header`.

    Raises:
        WireError: not such a message.

    """
    message = _message(payload, "std_msgs/msg/Header")
    return Call(_time(message.stamp), message.frame_id)


def encode_echo(echo: Echo) -> bytes:
    """As `sensor_msgs/TimeReference`."""
    header = _header(echo.received, "")
    message = ros("sensor_msgs/msg/TimeReference", header, _ros_time(echo.sent), echo.session)
    return serialized(message, "sensor_msgs/msg/TimeReference")


def decode_echo(payload: bytes) -> Echo:
    """From `sensor_msgs/TimeReference`.

    Raises:
        WireError: not such a message.

    """
    message = _message(payload, "sensor_msgs/msg/TimeReference")
    return Echo(_stamp(message.header), _time(message.time_ref), message.source)


def encode_report(report: Report) -> bytes:
    """As `diagnostic_msgs/DiagnosticArray` of one status."""
    values = [ros("diagnostic_msgs/msg/KeyValue", key, value) for key, value in report.values.items()]
    level = 0 if report.good else 1
    status = ros("diagnostic_msgs/msg/DiagnosticStatus", level, report.name, report.message, "becalm", values)
    message = ros("diagnostic_msgs/msg/DiagnosticArray", _header(report.stamp, ""), [status])
    return serialized(message, "diagnostic_msgs/msg/DiagnosticArray")


def decode_report(payload: bytes) -> Report:
    """From `diagnostic_msgs/DiagnosticArray` of one status.

    Raises:
        WireError: not such a message.

    """
    message = _message(payload, "diagnostic_msgs/msg/DiagnosticArray")
    if len(message.status) != 1:
        raise WireError(f"status has {len(message.status)} entries; it must have 1")
    status = message.status[0]
    values = {each.key: each.value for each in status.values}
    return Report(_stamp(message.header), status.name, status.level == 0, status.message, values)


def described(channel: Channel) -> str:
    """The channel's row in docs/link.md."""
    rate = "when it happens" if channel.rate is None else f"{channel.rate:g} Hz"
    frame = f"`{channel.frame}`" if channel.frame else "none"
    service = f"{channel.urgency}, express" if channel.express else channel.urgency
    cells = (f"`{channel.key}`", f"`{channel.message}`", rate, channel.content, frame, channel.sender, service)
    return f"| {' | '.join(cells)} |"


def _message(payload: bytes, name: str) -> Any:
    try:
        return store().deserialize_cdr(payload, name)
    except Exception as error:  # rosbags raises what numpy and struct raise, and asserts
        raise WireError(f"{len(payload)} bytes are no {name}: {error}") from None


def _order(names: list[str]) -> list[int]:
    try:
        return [names.index(name) for name in JOINT_NAMES]
    except ValueError:
        raise WireError(f"name = {names}: it must hold {', '.join(JOINT_NAMES)}") from None


def _picked(values: FloatArray, order: list[int], field: str) -> FloatArray:
    if len(values) <= max(order):
        raise WireError(f"{field} has {len(values)} numbers; one for each name is needed")
    picked = np.array([values[place] for place in order], np.float64).reshape(2, 3)
    if not np.isfinite(picked).all():
        raise WireError(f"{field} = {values.tolist()}: every number must be finite")
    return picked


def _plane(header: Any, x: float, y: float, z: float) -> PlaneSample:
    if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(z)):
        raise WireError(f"({x}, {y}, {z}): every number must be finite")
    return PlaneSample(_stamp(header), header.frame_id, np.array([x, y, z]))


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
    return int(time.sec) * _NANOSECONDS + int(time.nanosec)
