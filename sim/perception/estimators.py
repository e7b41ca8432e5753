"""Pose and twist of a body from pictures that arrive late, and how far the arms have moved the base meanwhile.

A Kalman filter for each body (constant velocity, white acceleration; Bar-Shalom, Li, Kirubarajan 2001, sec. 6.2) gives
its velocity, and its free motion is extrapolated to the instant that is asked for. The base moves with its arms: what
they make of it at zero momentum follows from the encoders at once, and the filter estimates only the rest.

Instants are whole nanoseconds, of one clock. The same on the robot and in the simulation.
"""

from __future__ import annotations

import math

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.model.generalized_jacobian import momentum, solution
from sim.model.planar import folded
from sim.model.robot import FREEDOMS, JOINTS, RobotModel, chain, freedom, momentum_matrix
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
        ("x", np.float64, (3, 2)),  # (x, y, angle), and their rates
        ("p", np.float64, (3, 2, 2)),  # its covariance, one block an axis
    ],
    align=True,
)

BASE_DRIFT = np.dtype(
    [
        ("count", np.int64),  # joint states so far
        ("stamp", np.int64, (_DRIFT_KEPT,)),  # of the last of them, in turn [ns]
        ("way", np.float64, (_DRIFT_KEPT, 3)),  # until then [m, m, rad]
        ("twist", np.float64, (3,)),  # at the last one
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
    """Know nothing of the arms' part in the base's motion, one element of `BASE_DRIFT`."""
    drift.count = 0
    drift.twist[:] = 0.0


@compiled
def take_picture(
    estimate: Record, expected: Record, stamp: int, pose: FloatArray, touched: bool
) -> tuple[bool, float, float]:
    """Take a pose that a body was seen at, unless it is an outlier or not newer than the last one.

    Args:
        estimate: one element of `BODY_ESTIMATE`; changed.
        expected: record of `FilterConfig`.
        stamp: of the picture [ns].
        pose: shape (3,) [m, m, rad].
        touched: whether a contact may have moved the body since the last picture.

    Returns:
        Whether it is an outlier, and how far from where the body can be [m, rad].

    """
    if estimate.taken == 0:
        _begin(estimate, expected, stamp, pose)
        return False, 0.0, 0.0
    dt = _NS * (stamp - estimate.stamp)
    if dt <= 0.0:
        return False, 0.0, 0.0
    innovation = np.empty(3)
    for axis in range(3):
        innovation[axis] = pose[axis] - estimate.x[axis, 0] - dt * estimate.x[axis, 1]
    innovation[2] = folded(innovation[2], 2.0 * math.pi)
    way, turn = math.hypot(innovation[0], innovation[1]), abs(innovation[2])
    if estimate.taken == 1 and way > _FASTEST * dt:
        _begin(estimate, expected, stamp, pose)  # one of the two is an outlier, and the next will tell
        return False, 0.0, 0.0
    predicted = _predicted_covariance(estimate, expected, dt, touched)
    if _is_outlier(predicted, expected, innovation):
        _doubt(estimate, stamp)
        return True, way, turn
    for axis in range(3):
        spread = predicted[axis, 0, 0] + _variance(expected, axis)
        for row in range(2):
            gain = predicted[axis, row, 0] / spread
            ahead = estimate.x[axis, row] + (dt * estimate.x[axis, 1] if row == 0 else 0.0)
            estimate.x[axis, row] = ahead + gain * innovation[axis]
            for column in range(2):
                estimate.p[axis, row, column] = predicted[axis, row, column] - gain * predicted[axis, 0, column]
    estimate.stamp, estimate.outlying_since, estimate.in_a_row = stamp, NO_STAMP, 0
    estimate.taken += 1
    return False, 0.0, 0.0


@compiled
def _begin(estimate: Record, expected: Record, stamp: int, pose: FloatArray) -> None:
    estimate.x[:, 0], estimate.x[:, 1] = pose, 0.0
    estimate.p[:] = 0.0
    for axis in range(3):
        estimate.p[axis, 0, 0], estimate.p[axis, 1, 1] = _variance(expected, axis), _BIG
    estimate.stamp, estimate.taken = stamp, 1


@compiled
def _variance(expected: Record, axis: int) -> float:
    """Of a measured coordinate."""
    deviation = expected.angle if axis == 2 else expected.position
    return float(deviation * deviation)


@compiled
def _predicted_covariance(estimate: Record, expected: Record, dt: float, touched: bool) -> FloatArray:
    """Shape (3, 2, 2), a time [s] after the last picture."""
    predicted = np.empty((3, 2, 2))
    for axis in range(3):
        if axis == 2:
            push = expected.touched_angular_acceleration if touched else expected.free_angular_acceleration
        else:
            push = expected.touched_acceleration if touched else expected.free_acceleration
        q, p = push * push, estimate.p[axis]
        predicted[axis, 0, 0] = p[0, 0] + dt * (p[0, 1] + p[1, 0]) + dt * dt * p[1, 1] + q * dt**4 / 4.0
        predicted[axis, 0, 1] = p[0, 1] + dt * p[1, 1] + q * dt**3 / 2.0
        predicted[axis, 1, 0] = p[1, 0] + dt * p[1, 1] + q * dt**3 / 2.0
        predicted[axis, 1, 1] = p[1, 1] + q * dt * dt
    return predicted


@compiled
def _is_outlier(predicted: FloatArray, expected: Record, innovation: FloatArray) -> bool:
    for axis in range(3):
        if abs(innovation[axis]) > GATE * math.sqrt(predicted[axis, 0, 0] + _variance(expected, axis)):
            return True
    return False


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
    drift: Record, robot: RobotModel, stamp: int, base_pose: FloatArray, joint_angle: FloatArray, joint_rate: FloatArray
) -> None:
    """Go on with the arms' part in the base's motion to that instant [ns]; rates are the means since the last one.

    Args:
        drift: one element of `BASE_DRIFT`; changed.
        robot: the robot's model.
        stamp: of the joint state [ns].
        base_pose: as it is believed, shape (3,).
        joint_angle: shape (2, 3) [rad].
        joint_rate: shape (2, 3) [rad/s].

    """
    links = chain(robot, base_pose, joint_angle, np.zeros(2))
    matrix = momentum_matrix(robot, base_pose, links)
    velocity = np.zeros(FREEDOMS)
    for arm in range(2):
        for link in range(JOINTS):
            velocity[freedom(arm, link)] = joint_rate[arm, link]
    base_block = np.ascontiguousarray(matrix[:, :3])
    drift.twist[:] = -solution(base_block, momentum(matrix, velocity))
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
def drift_until(drift: Record, stamp: int) -> FloatArray:
    """The way that the arms have moved the base until that instant [ns], shape (3,) [m, m, rad]."""
    way = np.zeros(3)
    kept = min(drift.count, _DRIFT_KEPT)
    after = (drift.count - 1) % _DRIFT_KEPT
    if kept == 0:
        return way
    way[:] = drift.way[after]
    for back in range(1, kept):
        before = (drift.count - 1 - back) % _DRIFT_KEPT
        if drift.stamp[after] <= stamp:
            return way
        span = drift.stamp[after] - drift.stamp[before]
        part = max(0.0, (stamp - drift.stamp[before]) / span) if span > 0 else 0.0
        for axis in range(3):
            way[axis] = drift.way[before, axis] + part * (drift.way[after, axis] - drift.way[before, axis])
        after = before
    return way
