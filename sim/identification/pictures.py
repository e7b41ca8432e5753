"""Pictures of motion capture, got back from what a filter made of them.

A log has the filter's pose and twist at every tick, not the pictures. The filter is known, and linear: where it took a
picture its state jumped by gain times innovation, so each picture can be got back, with the white noise that it had.
Its stamp is taken to be as late as is configured; another delay moves the picture along its twist: nothing changes.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sim.capture.events import Ticks
from sim.compiled import FloatArray, compiled
from sim.config import MissionConfig
from sim.model.generalized_jacobian import momentum, solution
from sim.model.robot import FREEDOMS, JOINTS, RobotModel, chain, freedom, momentum_matrix, robot_model
from sim.perception.estimators import push_expected
from sim.record import Record, packed, record_of

_NEVER = -1e9
_SURE_AT_FIRST = 1e-2
"""Variance of the filter at the first row; after some pictures it does not matter."""
_UNSURE = 40
"""So many pictures are left out: until then the filter may have been surer than it is taken to be."""
_ROUNDING = 1e-9
"""A twist that changes by less has not taken a picture."""
_MOST_LATE = 8
"""Rows by which a picture may be later than it is configured to be."""
_CLEAR = 1e-2
"""A picture is taken for what its age says if this part of its jump is left at most, as a square; less than that are
those of two pictures at once, and of a filter that doubted."""


class Pictures(NamedTuple):
    """Poses that were seen, at the rows of their instants; not a number in all other rows; shape (rows, 3) each."""

    base: FloatArray
    target: FloatArray


def pictures(config: MissionConfig, rows: Ticks) -> Pictures:
    """The pictures that the filter of motion capture has taken.

    Args:
        config: that the run was flown with.
        rows: its ticks, an array of `TICK`, a control period apart.

    """
    expected, period = record_of(config.perception.filter), config.control.period
    late = round(config.perception.capture.delay / period)
    touched = _last_touched(rows) + config.perception.filter.contact_memory - rows["time"]
    drift = np.zeros((len(rows), 3))
    pose, twist = rows["base_perceived_pose"].copy(), rows["base_perceived_twist"].copy()
    angle = _encoded(rows["joint_angle"].copy(), config.perception.imperfections.encoder_resolution)
    _drift(packed(robot_model(config.robot))[0], pose, twist, angle, period, drift)
    way = np.cumsum(drift, axis=0) * period
    found = []
    for told, rate in (
        (pose - way, twist - drift),
        (rows["target_perceived_pose"], rows["target_perceived_twist"]),
    ):
        seen = np.full((len(rows), 3), np.nan)
        _develop(expected, np.ascontiguousarray(told), np.ascontiguousarray(rate), touched, period, late, seen)
        found.append(seen)
    return Pictures(found[0] + way, found[1])


def _encoded(angle: FloatArray, step: float) -> FloatArray:
    """Joint angles as the filter got them: a simulation logs the true ones."""
    return np.floor(angle / step + 0.5) * step if step > 0.0 else angle


def _last_touched(rows: Ticks) -> FloatArray:
    """When a hand was last felt to touch [s], shape (rows,)."""
    touching = (rows["perceived_contact"] != 0).any(axis=1)
    last: FloatArray = np.maximum.accumulate(np.where(touching, rows["time"], _NEVER))
    return last


@compiled
def _drift(
    robot: RobotModel,
    base_pose: FloatArray,
    base_twist: FloatArray,
    joint_angle: FloatArray,
    period: float,
    drift: FloatArray,
) -> None:
    """The base's twist by its arms alone, in each period before a row, shape (rows, 3); as the filter reckons it."""
    velocity = np.zeros(FREEDOMS)
    for row in range(1, len(drift)):
        pose = base_pose[row - 1] + period * (base_twist[row - 1] - drift[row - 1])
        links = chain(robot, pose, joint_angle[row], np.zeros(2))
        matrix = momentum_matrix(robot, pose, links)
        for arm in range(2):
            for link in range(JOINTS):
                rate = (joint_angle[row, arm, link] - joint_angle[row - 1, arm, link]) / period
                velocity[freedom(arm, link)] = rate
        drift[row, :] = solution(np.ascontiguousarray(matrix[:, :3]), -momentum(matrix, velocity))


@compiled
def _develop(
    expected: Record,
    pose: FloatArray,
    twist: FloatArray,
    touched: FloatArray,
    period: float,
    usual: int,
    seen: FloatArray,
) -> None:
    """The pictures of one body.

    How old a picture was when it came follows from its jump: of the pose it is more, the older the picture.

    Args:
        expected: record of `FilterConfig`.
        pose: that the filter tells at each row, shape (rows, 3).
        twist: likewise.
        touched: for how much longer a contact may show in a picture [s], shape (rows,).
        period: between rows [s].
        usual: rows from a picture to its arrival, as configured.
        seen: shape (rows, 3), not a number; written where a picture was taken.

    """
    variance, grown, best = np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3))
    jump, push = np.zeros((2, 3)), np.empty(3)
    variance[:, 0] = variance[:, 2] = _SURE_AT_FIRST
    last, taken = -usual, 0
    for row in range(1, len(pose)):
        if not _jumped(pose, twist, row, period, jump) or row < usual:
            continue
        taken += 1
        late, least = usual, math.inf
        sure = taken > _UNSURE
        for candidate in range(0 if sure else usual, (usual + _MOST_LATE if sure else usual) + 1):
            age = (row - candidate - last) * period
            if age <= 0.0:
                break
            push_expected(expected, touched[row] + candidate * period > 0.0, push)
            _grow(variance, push, age, grown)
            left = _left_over(grown, jump, candidate * period, expected)
            if left < least:
                late, least = candidate, left
                best[:] = grown
        if math.isinf(least):
            continue
        last = row - late
        if taken > _UNSURE and least < _CLEAR:
            _look_back(pose, twist, row, late, period, best, expected, seen)
        _correct(best, expected, variance)


@compiled
def _jumped(pose: FloatArray, twist: FloatArray, row: int, period: float, jump: FloatArray) -> bool:
    """Whether a picture was taken since the row before; by how much it changed pose and twist into `jump`, (2, 3)."""
    jumped = False
    for axis in range(3):
        jump[0, axis] = pose[row, axis] - pose[row - 1, axis] - period * twist[row - 1, axis]
        jump[1, axis] = twist[row, axis] - twist[row - 1, axis]
        jumped = jumped or abs(jump[1, axis]) > _ROUNDING
    return jumped


@compiled
def _grow(variance: FloatArray, push: FloatArray, age: float, grown: FloatArray) -> None:
    """Variance of place, covariance, variance of rate of each axis, shape (3, 3), so long [s] later, into `grown`."""
    for axis in range(3):
        q = push[axis] * push[axis]
        place, both, rate = variance[axis, 0], variance[axis, 1], variance[axis, 2]
        grown[axis, 0] = place + 2.0 * age * both + age * age * rate + q * age**4 / 4.0
        grown[axis, 1] = both + age * rate + q * age**3 / 2.0
        grown[axis, 2] = rate + q * age * age


@compiled
def _left_over(grown: FloatArray, jump: FloatArray, late: float, expected: Record) -> float:
    """The part of a jump, as a square, that a picture so late [s] does not make."""
    left, whole = 0.0, 0.0
    for axis in range(3):
        deviation = expected.angle if axis == 2 else expected.position
        usual = grown[axis, 0] / grown[axis, 1] * jump[1, axis]
        left += ((jump[0, axis] - late * jump[1, axis] - usual) / deviation) ** 2
        whole += (usual / deviation) ** 2
    return left / whole


@compiled
def _look_back(
    pose: FloatArray,
    twist: FloatArray,
    row: int,
    late: int,
    period: float,
    grown: FloatArray,
    expected: Record,
    seen: FloatArray,
) -> None:
    """What was in the picture that came at a row, into `seen` where it was taken."""
    for axis in range(3):
        deviation = expected.angle if axis == 2 else expected.position
        gain = grown[axis, 0] / (grown[axis, 0] + deviation * deviation)
        before = pose[row - 1, axis] + (1 - late) * period * twist[row - 1, axis]
        after = pose[row, axis] - late * period * twist[row, axis]
        seen[row - late, axis] = before + (after - before) / gain


@compiled
def _correct(grown: FloatArray, expected: Record, variance: FloatArray) -> None:
    """Variances after a picture, into `variance`, shape (3, 3)."""
    for axis in range(3):
        deviation = expected.angle if axis == 2 else expected.position
        place, both, rate = grown[axis, 0], grown[axis, 1], grown[axis, 2]
        certainty = 1.0 / (place + deviation * deviation)
        variance[axis, 0] = place - place * certainty * place
        variance[axis, 1] = both - place * certainty * both
        variance[axis, 2] = rate - both * certainty * both
