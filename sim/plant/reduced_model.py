"""What a free-flying robot's motion about its centre of mass depends on: its shape, in base axes.

With the centre of mass drifting, one momentum is left, L about it: L = I (base rate) + h . (joint rates), so that
base rate = L / I + c . (joint rates) with c = -h / I. All of it follows from the joint angles alone; nothing here
allocates.
"""

from __future__ import annotations

import math

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.model.robot import LINKS, freedom
from sim.record import Record

FREE = 2 * LINKS
"""Joints, mounts included: left 1-3, right 1-3, both mounts."""


SHAPE = np.dtype(
    [
        ("direction", np.float64, (2, LINKS, 2)),  # cosine and sine of the angles of links 1-3 and hand
        ("joint", np.float64, (2, LINKS, 2)),  # joints 1-3 and mount
        ("hand", np.float64, (2, 2)),  # hand centres
        ("mass", np.float64, (2, LINKS)),  # of all that a joint carries
        ("moment", np.float64, (2, LINKS, 2)),  # its mass times its centre of mass
        ("second", np.float64, (2, LINKS)),  # its moment of inertia about the origin
        ("lean", np.float64, (FREE, 2)),  # its mass times its centre of mass from the joint
        ("spin", np.float64, (FREE,)),  # h: momentum about the robot's centre of mass per joint rate, base unturning
        ("base_per_joint", np.float64, (FREE,)),  # c = -h / I: base rate per joint rate at zero momentum
        ("centre", np.float64, (2,)),  # the robot's centre of mass
        ("inertia", np.float64),  # I of the robot about its centre of mass
        ("inverse_inertia", np.float64),
    ],
    align=True,
)
"""The robot with its base's centre of mass at the origin and unturned; SI, arrays lead with the arm."""


@compiled
def joint_place(arm: int, link: int) -> int:
    """Place among the eight joints of an arm's joint (0-2) or mount (3)."""
    return freedom(arm, link) - 3


@compiled
def set_shape(robot: Record, joint_angle: FloatArray, shape: Record) -> None:
    """Set a record of `SHAPE` for joint angles [rad], shape (8,); `robot` is the record of a `RobotModel`."""
    mass, second = robot.base_mass, robot.base_inertia
    moment_x = moment_y = 0.0
    for arm in range(2):
        _set_arm(robot, joint_angle, arm, shape)
        mass += shape.mass[arm, 0]
        moment_x += shape.moment[arm, 0, 0]
        moment_y += shape.moment[arm, 0, 1]
        second += shape.second[arm, 0]
    x, y = moment_x / mass, moment_y / mass
    shape.centre[0], shape.centre[1] = x, y
    inertia = second - (moment_x * x + moment_y * y)
    shape.inertia, shape.inverse_inertia = inertia, 1.0 / inertia
    for arm in range(2):
        for link in range(LINKS):
            place = joint_place(arm, link)
            spin = shape.second[arm, link] - (
                shape.moment[arm, link, 0] * shape.joint[arm, link, 0]
                + shape.moment[arm, link, 1] * shape.joint[arm, link, 1]
                + x * shape.lean[place, 0]
                + y * shape.lean[place, 1]
            )
            shape.spin[place] = spin
            shape.base_per_joint[place] = -spin * shape.inverse_inertia


@compiled
def _set_arm(robot: Record, joint_angle: FloatArray, arm: int, shape: Record) -> None:
    """Joints outwards, then inwards the masses that they carry."""
    x, y, turn = robot.shoulder_in_base[arm, 0], robot.shoulder_in_base[arm, 1], 0.0
    for link in range(LINKS):
        turn += joint_angle[joint_place(arm, link)]
        c, s = math.cos(turn), math.sin(turn)
        shape.direction[arm, link, 0], shape.direction[arm, link, 1] = c, s
        shape.joint[arm, link, 0], shape.joint[arm, link, 1] = x, y
        x -= robot.link_length[link] * s
        y += robot.link_length[link] * c
    shape.hand[arm, 0], shape.hand[arm, 1] = x, y
    mass = moment_x = moment_y = second = 0.0
    for link in range(LINKS - 1, -1, -1):
        m, place = robot.link_mass[link], joint_place(arm, link)
        joint_x, joint_y = shape.joint[arm, link, 0], shape.joint[arm, link, 1]
        x = joint_x - robot.link_centre[link] * shape.direction[arm, link, 1]
        y = joint_y + robot.link_centre[link] * shape.direction[arm, link, 0]
        mass += m
        moment_x += m * x
        moment_y += m * y
        second += robot.link_inertia[link] + m * (x * x + y * y)
        shape.mass[arm, link], shape.second[arm, link] = mass, second
        shape.moment[arm, link, 0], shape.moment[arm, link, 1] = moment_x, moment_y
        shape.lean[place, 0], shape.lean[place, 1] = moment_x - mass * joint_x, moment_y - mass * joint_y


@compiled
def reduced_inertia(total_mass: float, shape: Record, matrix: FloatArray) -> None:
    """H*: joint accelerations to joint torques with base and momentum free [kg m2], into an array of shape (8, 8).

    The inertia of the arms on a still base, less what centre of mass and base take part in.
    """
    lean, spin, inverse = shape.lean, shape.spin, shape.inverse_inertia
    for i in range(FREE):
        for j in range(FREE):
            taken = (lean[i, 0] * lean[j, 0] + lean[i, 1] * lean[j, 1]) / total_mass
            matrix[i, j] = -taken - spin[i] * spin[j] * inverse
    for arm in range(2):
        for outer in range(LINKS):
            column = joint_place(arm, outer)
            x, y = shape.joint[arm, outer, 0], shape.joint[arm, outer, 1]
            for inner in range(outer + 1):
                row = joint_place(arm, inner)
                inner_x, inner_y = shape.joint[arm, inner, 0], shape.joint[arm, inner, 1]
                value = shape.second[arm, outer] + shape.mass[arm, outer] * (x * inner_x + y * inner_y)
                value -= shape.moment[arm, outer, 0] * (x + inner_x) + shape.moment[arm, outer, 1] * (y + inner_y)
                matrix[row, column] += value
                if row != column:
                    matrix[column, row] += value


@compiled
def solve_in_place(matrix: FloatArray, right_side: FloatArray, size: int) -> None:
    """A x = b by Cholesky's factors for the first rows and columns of a symmetric positive A; x replaces b."""
    for j in range(size):
        for k in range(j):
            matrix[j, j] -= matrix[j, k] * matrix[j, k]
        matrix[j, j] = math.sqrt(matrix[j, j])
        for i in range(j + 1, size):
            for k in range(j):
                matrix[i, j] -= matrix[i, k] * matrix[j, k]
            matrix[i, j] /= matrix[j, j]
    for i in range(size):
        for k in range(i):
            right_side[i] -= matrix[i, k] * right_side[k]
        right_side[i] /= matrix[i, i]
    for i in range(size - 1, -1, -1):
        for k in range(i + 1, size):
            right_side[i] -= matrix[k, i] * right_side[k]
        right_side[i] /= matrix[i, i]
