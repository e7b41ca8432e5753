"""How base and target move, as it is believed: readings in, estimates out, the forces that were felt fed forward.

Three things are known beside the readings. The arms move the base by what the encoders say; what the hands feel is the
robot's momentum gained and the target's lost. So the filters (`sim.perception.estimators`) estimate only what is left,
and estimate the target's inverse inertia from how far its motion follows the torque that was put on it.
"""

from __future__ import annotations

import math

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.model.planar import cross
from sim.perception.estimators import (
    BODY_ESTIMATE,
    DRIFT,
    ENOUGH,
    NO_STAMP,
    body_at,
    forget_body,
    forget_drift,
    go_on,
    push_expected,
    set_way,
    take_joints,
    take_picture,
    take_twist,
)
from sim.perception.sensing import gaussian
from sim.record import Record

_SURE = (1e-4, 1e-4, 5e-4)
"""Standard deviations of poses that have been watched for a while [m, m, rad]."""
_SURE_OF_RATE = (3e-4, 3e-4, 2e-3)
"""... of twists [m/s, m/s, rad/s]."""
_LONG_AGO = -1e9
"""Before every contact [s]."""
_FIRST_CHANNEL = 100
"""Of the draws of what was watched before the first tick; beyond those of the sensors' noise."""
_LEAST = 0.2
"""The inverse inertia is not believed to fall under this part of what was assumed."""

MOTION = np.dtype(
    [
        ("begun", np.int64),
        ("base", BODY_ESTIMATE),  # of the base's motion without what arms and felt momentum make of it
        ("base_drift", DRIFT),
        ("target", BODY_ESTIMATE),
        ("target_drift", DRIFT),  # times the inertia
        ("robot_momentum", np.float64, (3,)),  # that the hands have felt, about the world's origin [N s, N m s]
        ("wrench_on_robot", np.float64, (3,)),  # felt in the last tick, about the world's origin
        ("wrench_on_target", np.float64, (3,)),  # ... about the target's centre
        ("last_contact", np.float64),  # as the wrists felt it [s]
        ("last_tick", np.float64),  # [s]
        ("joint_angle", np.float64, (2, 3)),  # by the encoders at the tick before: rates are their differences
        ("pose", np.float64, (3,)),  # to work with
        ("twist", np.float64, (3,)),  # likewise
        ("push", np.float64, (3,)),  # likewise
        ("nothing", np.float64, (3,)),  # zeros
    ],
    align=True,
)
"""What is remembered from tick to tick."""


@compiled
def stamp_of(time: float) -> int:
    """An instant [s] in whole nanoseconds."""
    return round(1e9 * time)


def count_from(motion: Record, origin: int) -> None:
    """Count all instants from that one on [ns]: what is remembered of readings goes on in another clock.

    Args:
        motion: one element of `MOTION`; changed.
        origin: of the new clock, by the old one.

    """
    for name in ("last_contact", "last_tick"):
        motion[name] -= 1e-9 * origin
    for body in ("base", "target"):
        estimate = motion[body]
        estimate["stamp"] -= origin
        if estimate["outlying_since"] != NO_STAMP:
            estimate["outlying_since"] -= origin
        motion[f"{body}_drift"]["stamp"] -= origin


@compiled
def begin_estimating(motion: Record, joint_angle: FloatArray, time: float) -> None:
    """Know nothing."""
    forget_body(motion.base)
    forget_body(motion.target)
    forget_drift(motion.base_drift)
    forget_drift(motion.target_drift)
    motion.begun, motion.last_contact, motion.last_tick = 1, _LONG_AGO, time
    motion.robot_momentum[:], motion.wrench_on_robot[:], motion.wrench_on_target[:] = 0.0, 0.0, 0.0
    motion.nothing[:] = 0.0
    motion.joint_angle[:] = joint_angle


@compiled
def assume(target: Record, perception: Record) -> None:
    """Begin with the inverse mass and inertia that are assumed, and how sure that is."""
    for axis in range(3):
        assumed = perception.assumed_inertia if axis == 2 else perception.assumed_mass
        part = perception.assumed_inertia_uncertainty if axis == 2 else perception.assumed_mass_uncertainty
        target.x[axis, 2] = 1.0 / assumed
        target.p[axis, 2, 2] = (part / assumed) ** 2


@compiled
def watched(estimate: Record, pose: FloatArray, twist: FloatArray, seed: int, tick: int, body: int, stamp: int) -> None:
    """Know a body as well as after a while of watching it, and as wrong, drawn by the seed; 0 is the base."""
    channel = _FIRST_CHANNEL + 6 * body
    for axis in range(3):
        sure, of_rate = _SURE[axis], _SURE_OF_RATE[axis]
        estimate.x[axis, 0] = pose[axis] + sure * gaussian(seed, tick, channel + axis)
        estimate.x[axis, 1] = twist[axis] + of_rate * gaussian(seed, tick, channel + 3 + axis)
        estimate.p[axis, 0, 0], estimate.p[axis, 1, 1] = sure * sure, of_rate * of_rate
    estimate.taken, estimate.stamp = ENOUGH, stamp


@compiled
def predict(motion: Record, shape: Record, known: Record) -> None:
    """Go on with what is known to the instant of one element of `PERCEIVED`: arms, momentum, forces on the target.

    Args:
        motion: one element of `MOTION`; changed.
        shape: of the robot by the joint angles of that instant, one element of `SHAPE`.
        known: one element of `PERCEIVED`.

    """
    stamp, dt = stamp_of(known.time), known.time - motion.last_tick
    motion.last_tick = known.time
    for axis in range(3):
        motion.robot_momentum[axis] += dt * motion.wrench_on_robot[axis]
        motion.target_drift.twist[axis] += dt * motion.wrench_on_target[axis]
    go_on(motion.target_drift, stamp)
    pose, about_base = motion.pose, motion.twist
    body_at(motion.base, stamp, pose, motion.twist)
    set_way(motion.base_drift, stamp)
    for axis in range(3):
        pose[axis] += motion.base_drift.way_until[axis]
        about_base[axis] = motion.robot_momentum[axis]
    about_base[2] -= cross(pose[0], pose[1], about_base[0], about_base[1])
    take_joints(motion.base_drift, shape, stamp, pose[2], known.joint_rate, known.mount_rate, about_base)


@compiled
def take_readings(motion: Record, perception: Record, known: Record, touched: bool) -> None:
    """Take the poses and twists of one element of `PERCEIVED`, measured at its instant."""
    stamp, push, nothing = stamp_of(known.time), motion.push, motion.nothing
    push_expected(perception.filter, False, push)
    set_way(motion.base_drift, stamp)
    for axis in range(3):
        motion.pose[axis] = known.base_pose[axis] - motion.base_drift.way_until[axis]
        motion.twist[axis] = known.base_twist[axis] - motion.base_drift.twist[axis]
    take_picture(motion.base, perception.filter, stamp, motion.pose, push, nothing)
    take_twist(motion.base, perception.filter, motion.twist, nothing)
    expect_push(motion, perception, touched, push)
    set_way(motion.target_drift, stamp)
    take_picture(motion.target, perception.filter, stamp, known.target_pose, push, motion.target_drift.way_until)
    take_twist(motion.target, perception.filter, known.target_twist, motion.target_drift.twist)


@compiled
def see_base(
    motion: Record, perception: Record, stamp: int, pose: FloatArray, modelled: bool
) -> tuple[bool, float, float]:
    """Take a pose that the base was seen at, unless it is an outlier.

    Args:
        motion: one element of `MOTION`; changed.
        perception: record of `PerceptionConfig`.
        stamp: of the picture [ns].
        pose: shape (3,) [m, m, rad].
        modelled: whether felt forces are fed forward.

    Returns:
        Whether it is an outlier, and how far from where the base can be [m, rad].

    """
    push_expected(perception.filter, _touched_at(motion, perception, stamp) and not modelled, motion.push)
    set_way(motion.base_drift, stamp)
    for axis in range(3):
        motion.pose[axis] = pose[axis] - motion.base_drift.way_until[axis]
    return take_picture(motion.base, perception.filter, stamp, motion.pose, motion.push, motion.nothing)


@compiled
def see_target(
    motion: Record, perception: Record, stamp: int, pose: FloatArray, modelled: bool
) -> tuple[bool, float, float]:
    """Take a pose that the target was seen at, unless it is an outlier; as `see_base`."""
    touched = _touched_at(motion, perception, stamp)
    if modelled:
        expect_push(motion, perception, touched, motion.push)
    else:
        push_expected(perception.filter, touched, motion.push)
    set_way(motion.target_drift, stamp)
    return take_picture(motion.target, perception.filter, stamp, pose, motion.push, motion.target_drift.way_until)


@compiled
def _touched_at(motion: Record, perception: Record, stamp: int) -> bool:
    """Whether a contact may show in a picture of that instant [ns]."""
    return bool(1e-9 * stamp - motion.last_contact < perception.filter.contact_memory)


@compiled
def expect_push(motion: Record, perception: Record, touched: bool, push: FloatArray) -> None:
    """The target's acceleration that is not known, standard deviations, shape (3,): in touch, the wrists' noise."""
    expected = perception.filter
    push_expected(expected, False, push)
    if not touched:
        return
    for axis in range(3):
        arm = 0.15  # from the target's centre to a hand's, about [m]
        noise = math.hypot(expected.torque, arm * expected.force) if axis == 2 else expected.force
        push[axis] = math.hypot(push[axis], math.sqrt(2.0) * noise * abs(motion.target.x[axis, 2]))


@compiled
def tell(motion: Record, perception: Record, known: Record) -> None:
    """What is believed at the instant of one element of `PERCEIVED`, in place of its readings of base and target."""
    stamp, pose, twist = stamp_of(known.time), motion.pose, motion.twist
    body_at(motion.base, stamp, pose, twist)
    set_way(motion.base_drift, stamp)
    for axis in range(3):
        known.base_pose[axis] = pose[axis] + motion.base_drift.way_until[axis]
        known.base_twist[axis] = twist[axis] + motion.base_drift.twist[axis]
    target, known_twist, way = motion.target, motion.target_drift.twist, motion.target_drift.way_until
    body_at(target, stamp, pose, twist)
    set_way(motion.target_drift, stamp)
    for axis in range(3):
        p, w = target.p, known_twist[axis]
        known.target_pose[axis] = pose[axis] + target.x[axis, 2] * way[axis]
        known.target_twist[axis] = twist[axis] + target.x[axis, 2] * w
        variance = p[axis, 1, 1] + 2.0 * w * p[axis, 1, 2] + w * w * p[axis, 2, 2]
        known.target_twist_deviation[axis] = math.sqrt(max(0.0, variance))
    inverse = max(target.x[2, 2], _LEAST / perception.assumed_inertia)
    known.target_inertia = 1.0 / inverse
    known.target_inertia_deviation = math.sqrt(max(0.0, target.p[2, 2, 2])) / (inverse * inverse)


@compiled
def feel(motion: Record, known: Record, wrench: FloatArray) -> None:
    """Note the forces that the hands feel, shape (2, 3) as `hand_wrench`, for what they do until the next tick."""
    motion.wrench_on_robot[:], motion.wrench_on_target[:] = 0.0, 0.0
    for arm in range(2):
        if not known.touching[arm]:
            continue
        x, y = known.links.hand_pose[arm, 0], known.links.hand_pose[arm, 1]
        fx, fy, torque = wrench[arm, 0], wrench[arm, 1], wrench[arm, 2]
        from_x, from_y = x - known.target_pose[0], y - known.target_pose[1]
        motion.wrench_on_robot[0] += fx
        motion.wrench_on_robot[1] += fy
        motion.wrench_on_robot[2] += torque + cross(x, y, fx, fy)
        motion.wrench_on_target[0] -= fx
        motion.wrench_on_target[1] -= fy
        motion.wrench_on_target[2] -= torque + cross(from_x, from_y, fx, fy)
