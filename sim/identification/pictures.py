"""Pictures of motion capture, got back from what a filter made of them.

A log has the filter's pose and twist at every tick, not the pictures. The filter is known, and linear: where it took a
picture its state jumped by gain times innovation, so each picture can be got back, with the white noise that it had.
Its stamp is taken to be as late as is configured; another delay moves the picture along its twist: nothing changes.
"""

from __future__ import annotations

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


class Pictures(NamedTuple):
    """Poses that were seen, at the rows of their instants; not a number in all other rows; shape (rows, 3) each."""

    base: FloatArray
    target: FloatArray


def pictures(config: MissionConfig, rows: Ticks) -> Pictures:
    """The pictures that the filter of motion capture has taken.

    Args:
        config: that the run was flown with.
        rows: its ticks, an array of `TICK`.

    """
    expected, period = record_of(config.perception.filter), config.control.period
    late = round(config.perception.capture.delay / period)
    touched = _touched(rows, config.perception.filter.contact_memory + late * period)
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


def _touched(rows: Ticks, memory: float) -> FloatArray:
    """Whether a contact may have shown in a picture that was taken at that row: 1 or 0."""
    touching = (rows["perceived_contact"] != 0).any(axis=1)
    last = np.maximum.accumulate(np.where(touching, rows["time"], _NEVER))
    return (rows["time"] - last < memory).astype(float)


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
    late: int,
    seen: FloatArray,
) -> None:
    """The pictures of one body.

    Args:
        expected: record of `FilterConfig`.
        pose: that the filter tells at each row, shape (rows, 3).
        twist: likewise.
        touched: whether a contact may show in the picture that arrives at that row, shape (rows,).
        period: between rows [s].
        late: rows from a picture to its arrival.
        seen: shape (rows, 3), not a number; written where a picture was taken.

    """
    p, push, age, taken = np.zeros((3, 2, 2)), np.empty(3), 0.0, 0
    p[:, 0, 0] = p[:, 1, 1] = _SURE_AT_FIRST
    for row in range(1, len(pose)):
        age += period
        jumped = False
        for axis in range(3):
            jumped = jumped or abs(twist[row, axis] - twist[row - 1, axis]) > _ROUNDING
        if not jumped or row < late:
            continue
        taken += 1
        push_expected(expected, touched[row] > 0.0, push)
        for axis in range(3):
            deviation = expected.angle if axis == 2 else expected.position
            q, block = push[axis] * push[axis], p[axis]
            a = block[0, 0] + 2.0 * age * block[0, 1] + age * age * block[1, 1] + q * age**4 / 4.0
            b = block[0, 1] + age * block[1, 1] + q * age**3 / 2.0
            c = block[1, 1] + q * age * age
            gain, of_rate = a / (a + deviation * deviation), b / (a + deviation * deviation)
            block[0, 0], block[1, 1] = (1.0 - gain) * a, c - of_rate * b
            block[0, 1] = block[1, 0] = (1.0 - gain) * b
            if taken <= _UNSURE:
                continue
            before = pose[row - 1, axis] + (1 - late) * period * twist[row - 1, axis]
            after = pose[row, axis] - late * period * twist[row, axis]
            seen[row - late, axis] = before + (after - before) / gain
        age = 0.0
