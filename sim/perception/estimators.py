"""Pose and twist of a body from readings that may be late, and how far what is known has moved it meanwhile.

A Kalman filter for each body (constant velocity, white acceleration; Bar-Shalom, Li, Kirubarajan 2001, sec. 6.2)
estimates only its *free* motion; what is known to have moved it is added. The base moves with its arms and with the
momentum that the hands have felt: `way` is that motion itself. The target moves with the forces that the hands put on
it, divided by an inertia that nobody knows: there `way` is what a unit inverse inertia would have done, and the
inverse inertia of each axis is the filter's third state. The pose is linear in it, so the filter stays exact, and a
reading that is late is compared with what was known until *its* instant.

Instants are whole nanoseconds, of one clock. The same on the robot and in the simulation.
"""

from __future__ import annotations

import math

import numpy as np

from sim.compiled import FloatArray, compiled, compiled_inline
from sim.model.planar import folded
from sim.model.reduced_model import base_twist
from sim.record import Record

GATE = 6.0
"""Standard deviations beyond which a picture is an outlier."""
ENOUGH = 50
"""Pictures after which a velocity is good to 0.3 mm/s and 2 mrad/s: a plan reaches two seconds ahead."""
NO_STAMP = -1
"""In place of an instant: there is none."""
_FASTEST = 5.0
"""Between its first two pictures a body does not move faster [m/s]."""
_DOUBTFUL = 3
"""So many outliers in a row are no chance: the velocity is doubted."""
_DOUBT = (0.05, 0.05, 0.5)
"""... by so much more with each [m/s, rad/s]: something moved the body that no wrist felt."""
_BIG = 1e4
_DRIFT_KEPT = 200
"""Joint states that motion capture may be behind; a second of the link's. `sim.config` bounds the delay by it."""
_NS = 1e-9

BODY_ESTIMATE = np.dtype(
    [
        ("stamp", np.int64),  # of the last picture that was taken [ns]
        ("taken", np.int64),  # pictures
        ("outliers", np.int64),
        ("outlying_since", np.int64),  # stamp of the first of the outliers that have come in a row [ns]; or NO_STAMP
        ("in_a_row", np.int64),
        ("x", np.float64, (3, 3)),  # of (x, y, angle): free motion, its rate, inverse inertia [1/kg, 1/(kg m2)]
        ("p", np.float64, (3, 3, 3)),  # its covariance, one block an axis
    ],
    align=True,
)

DRIFT = np.dtype(
    [
        ("count", np.int64),  # instants so far
        ("stamp", np.int64, (_DRIFT_KEPT,)),  # of the last of them, in turn [ns]
        ("way", np.float64, (_DRIFT_KEPT, 3)),  # until then: of the base [m, m, rad], of the target times its inertia
        ("twist", np.float64, (3,)),  # at the last one; likewise
        ("way_until", np.float64, (3,)),  # the instant that was last asked for; likewise
    ],
    align=True,
)


@compiled
def forget_body(estimate: Record) -> None:
    """Know nothing of a body, one element of `BODY_ESTIMATE`."""
    estimate.stamp, estimate.taken, estimate.outliers, estimate.in_a_row = 0, 0, 0, 0
    estimate.outlying_since = NO_STAMP
    estimate.x[:] = 0.0
    estimate.p[:] = 0.0


@compiled
def forget_drift(drift: Record) -> None:
    """Know of nothing that has moved the body, one element of `DRIFT`."""
    drift.count = 0
    drift.twist[:] = 0.0


@compiled
def take_picture(
    estimate: Record, expected: Record, stamp: int, pose: FloatArray, push: FloatArray, way: FloatArray
) -> tuple[bool, float, float]:
    """Take a pose that a body was seen at, unless it is an outlier or not newer than the last one.

    Args:
        estimate: one element of `BODY_ESTIMATE`; changed.
        expected: record of `FilterConfig`.
        stamp: of the picture [ns].
        pose: shape (3,) [m, m, rad]; without the way of what is known, of a body whose inertia is.
        push: standard deviation of the acceleration that is not known, of each axis, shape (3,) [m/s2, rad/s2].
        way: that a unit inverse inertia would have gone until then, shape (3,); zero for a body of known inertia.

    Returns:
        Whether it is an outlier, and how far from where the body can be [m, rad].

    """
    if estimate.taken == 0:
        _begin(estimate, expected, stamp, pose, way)
        return False, 0.0, 0.0
    dt = _NS * (stamp - estimate.stamp)
    if dt <= 0.0:
        return False, 0.0, 0.0
    x, y = _innovation(estimate, 0, dt, pose, way), _innovation(estimate, 1, dt, pose, way)
    turn = _innovation(estimate, 2, dt, pose, way)
    apart = math.hypot(x, y)
    if estimate.taken == 1 and apart > _FASTEST * dt:
        _begin(estimate, expected, stamp, pose, way)  # one of the two is an outlier, and the next will tell
        return False, 0.0, 0.0
    innovations = (x, y, turn)
    for axis in range(3):
        if abs(innovations[axis]) > GATE * math.sqrt(_spread(estimate, expected, axis, dt, push, way)):
            _doubt(estimate, stamp)
            return True, apart, abs(turn)
    for axis in range(3):
        estimate.x[axis, 0] += dt * estimate.x[axis, 1]
        _predict_covariance(estimate.p[axis], push[axis] * push[axis], dt)
        _correct(estimate, axis, 1.0, 0.0, way[axis], innovations[axis], _variance(expected, axis))
    estimate.stamp, estimate.outlying_since, estimate.in_a_row = stamp, NO_STAMP, 0
    estimate.taken += 1
    return False, 0.0, 0.0


@compiled_inline
def _innovation(estimate: Record, axis: int, dt: float, pose: FloatArray, way: FloatArray) -> float:
    """How far a coordinate was seen from where it was expected, so long [s] after the last picture."""
    x = estimate.x
    apart = pose[axis] - x[axis, 0] - dt * x[axis, 1] - way[axis] * x[axis, 2]
    return folded(apart, 2.0 * math.pi) if axis == 2 else apart


@compiled_inline
def _spread(estimate: Record, expected: Record, axis: int, dt: float, push: FloatArray, way: FloatArray) -> float:
    """Variance of an innovation."""
    p, q, w = estimate.p, push[axis] * push[axis], way[axis]
    place = p[axis, 0, 0] + dt * (2.0 * p[axis, 0, 1] + dt * (p[axis, 1, 1] + 0.25 * q * dt * dt))
    with_inverse = p[axis, 0, 2] + dt * p[axis, 1, 2]
    return float(place + w * (2.0 * with_inverse + w * p[axis, 2, 2]) + _variance(expected, axis))


@compiled
def take_twist(estimate: Record, expected: Record, twist: FloatArray, known: FloatArray) -> None:
    """Take a twist that was measured at the instant of the last picture.

    Args:
        estimate: one element of `BODY_ESTIMATE`; changed.
        expected: record of `FilterConfig`.
        twist: shape (3,) [m/s, m/s, rad/s]; without the twist of what is known, of a body whose inertia is.
        known: twist that a unit inverse inertia would have by now, shape (3,); zero for a body of known inertia.

    """
    for axis in range(3):
        deviation = expected.spin if axis == 2 else expected.velocity
        innovation = twist[axis] - estimate.x[axis, 1] - known[axis] * estimate.x[axis, 2]
        _correct(estimate, axis, 0.0, 1.0, known[axis], innovation, deviation * deviation)


@compiled
def _correct(
    estimate: Record, axis: int, of_place: float, of_rate: float, of_inverse: float, innovation: float, variance: float
) -> None:
    """Correct one axis by a reading that is this combination of its three states, of that variance."""
    p, x = estimate.p, estimate.x
    place = of_place * p[axis, 0, 0] + of_rate * p[axis, 0, 1] + of_inverse * p[axis, 0, 2]
    rate = of_place * p[axis, 0, 1] + of_rate * p[axis, 1, 1] + of_inverse * p[axis, 1, 2]
    inverse = of_place * p[axis, 0, 2] + of_rate * p[axis, 1, 2] + of_inverse * p[axis, 2, 2]
    certainty = 1.0 / (variance + of_place * place + of_rate * rate + of_inverse * inverse)
    x[axis, 0] += place * certainty * innovation
    x[axis, 1] += rate * certainty * innovation
    x[axis, 2] += inverse * certainty * innovation
    p[axis, 0, 0] -= place * certainty * place
    p[axis, 1, 1] -= rate * certainty * rate
    p[axis, 2, 2] -= inverse * certainty * inverse
    p[axis, 0, 1] = p[axis, 1, 0] = p[axis, 0, 1] - place * certainty * rate
    p[axis, 0, 2] = p[axis, 2, 0] = p[axis, 0, 2] - place * certainty * inverse
    p[axis, 1, 2] = p[axis, 2, 1] = p[axis, 1, 2] - rate * certainty * inverse


@compiled
def _begin(estimate: Record, expected: Record, stamp: int, pose: FloatArray, way: FloatArray) -> None:
    estimate.x[:, 0], estimate.x[:, 1] = pose - way * estimate.x[:, 2], 0.0
    for axis in range(3):
        estimate.p[axis, :2, :] = 0.0
        estimate.p[axis, 2, :2] = 0.0
        estimate.p[axis, 0, 0], estimate.p[axis, 1, 1] = _variance(expected, axis), _BIG
    estimate.stamp, estimate.taken = stamp, 1


@compiled_inline
def _variance(expected: Record, axis: int) -> float:
    """Of a measured coordinate."""
    deviation = expected.angle if axis == 2 else expected.position
    return float(deviation * deviation)


@compiled_inline
def _predict_covariance(p: FloatArray, q: float, dt: float) -> None:
    """Of one axis, shape (3, 3), a time [s] later; q is the variance of the acceleration that is not known."""
    p[0, 0] += dt * (2.0 * p[0, 1] + dt * (p[1, 1] + 0.25 * q * dt * dt))
    p[0, 1] = p[1, 0] = p[0, 1] + dt * (p[1, 1] + 0.5 * q * dt * dt)
    p[1, 1] += q * dt * dt
    p[0, 2] = p[2, 0] = p[0, 2] + dt * p[1, 2]


@compiled
def push_expected(expected: Record, touched: bool, push: FloatArray) -> None:
    """The acceleration of a body whose contacts nobody measures, standard deviations, shape (3,) [m/s2, rad/s2]."""
    push[:2] = expected.touched_acceleration if touched else expected.free_acceleration
    push[2] = expected.touched_angular_acceleration if touched else expected.free_angular_acceleration


@compiled
def _doubt(estimate: Record, stamp: int) -> None:
    """Count an outlier; after some in a row the velocity may be another."""
    estimate.outliers += 1
    estimate.in_a_row += 1
    if estimate.outlying_since == NO_STAMP:
        estimate.outlying_since = stamp
    if estimate.in_a_row >= _DOUBTFUL:
        for axis in range(3):
            estimate.p[axis, 1, 1] += _DOUBT[axis] * _DOUBT[axis]


@compiled
def body_at(estimate: Record, stamp: int, pose: FloatArray, twist: FloatArray) -> None:
    """Pose and twist at that instant [ns], shape (3,) each, as if the body had moved freely since the last picture."""
    dt = _NS * (stamp - estimate.stamp)
    for axis in range(3):
        pose[axis] = estimate.x[axis, 0] + dt * estimate.x[axis, 1]
        twist[axis] = estimate.x[axis, 1]


@compiled
def take_joints(
    drift: Record,
    shape: Record,
    stamp: int,
    base_angle: float,
    joint_rate: FloatArray,
    mount_rate: FloatArray,
    robot_momentum: FloatArray,
) -> None:
    """Go on with what arms and momentum make of the base to that instant [ns]; rates are the means since the last one.

    Args:
        drift: one element of `DRIFT`, of the base; changed.
        shape: of the robot by that joint state, one element of `SHAPE`.
        stamp: of the joint state [ns].
        base_angle: as it is believed [rad].
        joint_rate: of the driven joints, shape (2, 3) [rad/s].
        mount_rate: of the mounts, at least two [rad/s].
        robot_momentum: as far as it is known, about the base's centre of mass, shape (3,) [N s, N m s].

    """
    base_twist(shape, base_angle, robot_momentum, joint_rate, mount_rate, drift.twist)
    go_on(drift, stamp)


@compiled
def go_on(drift: Record, stamp: int) -> None:
    """Go on to that instant [ns] with its twist, that has been the mean since the last one."""
    place = drift.count % _DRIFT_KEPT
    before = (drift.count - 1) % _DRIFT_KEPT
    for axis in range(3):
        way = 0.0
        if drift.count > 0:
            way = drift.way[before, axis] + _NS * (stamp - drift.stamp[before]) * drift.twist[axis]
        drift.way[place, axis] = way
    drift.stamp[place] = stamp
    drift.count += 1


@compiled
def set_way(drift: Record, stamp: int) -> None:
    """Set `way_until`: of what is known, until that instant [ns]."""
    kept, until = min(drift.count, _DRIFT_KEPT), drift.way_until
    after = (drift.count - 1) % _DRIFT_KEPT
    for axis in range(3):
        until[axis] = drift.way[after, axis] if kept > 0 else 0.0
    for back in range(1, kept):
        before = (drift.count - 1 - back) % _DRIFT_KEPT
        if drift.stamp[after] <= stamp:
            return
        span = drift.stamp[after] - drift.stamp[before]
        part = max(0.0, (stamp - drift.stamp[before]) / span) if span > 0 else 0.0
        for axis in range(3):
            until[axis] = drift.way[before, axis] + part * (drift.way[after, axis] - drift.way[before, axis])
        after = before
