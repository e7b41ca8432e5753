"""The generalized Jacobian of a free-flying robot (eq. 2; Umetani, Yoshida 1989), its inverse and momentum.

Base and arms are coupled by momentum: J* = J_m - J_b H_b^-1 H_bm, and the hands of a robot that carries
momentum P move by J_b H_b^-1 P even with its joints at rest.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sim.compiled import FloatArray, compiled, compiled_inline
from sim.model.robot import FREEDOMS, Chain, RobotModel, hand_jacobian, momentum_matrix
from sim.record import Record, copy_rows, copy_vector


class FreeFlyingModel(NamedTuple):
    """The matrices of eq. 1 and 2 at one configuration, world axes; joints are left 1-3, right 1-3, both mounts."""

    generalized_jacobian: FloatArray
    """J*, shape (6, 8): joint rates to hand twists (left, right), for zero momentum; driven joints are [:, :6]."""
    momentum_map: FloatArray
    """J_b H_b^-1 of both hands, shape (6, 3): momentum about the base's centre of mass to hand twists."""
    hand_jacobian: FloatArray
    """[J_b, J_m], shape (6, 11): generalized velocity to hand twists."""
    momentum_matrix: FloatArray
    """[H_b, H_bm], shape (3, 11): generalized velocity to momentum about the base's centre of mass."""
    base_reaction: FloatArray
    """H_b^-1 H_bm, shape (3, 8): joint rates to minus the base twist they cause."""


@compiled
def free_flying_model(robot: RobotModel, base_pose: FloatArray, links: Chain) -> FreeFlyingModel:
    """All matrices of eq. 1 and 2 for the base's pose, shape (3,), and the chain."""
    H = momentum_matrix(robot, base_pose, links)
    hands = hand_jacobian(base_pose, links)
    Hb_inverse = _inverse_of_base_block(H)
    reaction = np.zeros((3, FREEDOMS - 3))
    for i in range(3):
        for j in range(FREEDOMS - 3):
            for k in range(3):
                reaction[i, j] += Hb_inverse[i, k] * H[k, 3 + j]
    generalized = np.empty((6, FREEDOMS - 3))
    momentum_map = np.zeros((6, 3))
    for row in range(6):
        for j in range(FREEDOMS - 3):
            generalized[row, j] = hands[row, 3 + j]
            for k in range(3):
                generalized[row, j] -= hands[row, k] * reaction[k, j]
        for j in range(3):
            for k in range(3):
                momentum_map[row, j] += hands[row, k] * Hb_inverse[k, j]
    return FreeFlyingModel(generalized, momentum_map, hands, H, reaction)


@compiled
def _inverse_of_base_block(H: FloatArray) -> FloatArray:
    """H_b^-1, shape (3, 3); H_b is [[m, 0, a], [0, m, b], [a, b, c]]."""
    m, a, b, c = H[0, 0], H[0, 2], H[1, 2], H[2, 2]
    about_centre = c - (a * a + b * b) / m  # inertia about the whole robot's centre of mass
    inverse = np.empty((3, 3))
    inverse[2, 2] = 1.0 / about_centre
    inverse[0, 2] = inverse[2, 0] = -a / (m * about_centre)
    inverse[1, 2] = inverse[2, 1] = -b / (m * about_centre)
    inverse[0, 0] = 1.0 / m + a * a / (m * m * about_centre)
    inverse[1, 1] = 1.0 / m + b * b / (m * m * about_centre)
    inverse[0, 1] = inverse[1, 0] = a * b / (m * m * about_centre)
    return inverse


@compiled
def momentum(matrix: FloatArray, velocity: FloatArray) -> FloatArray:
    """Robot momentum about the base's centre of mass (px, py [N s], angular [N m s]), shape (3,).

    P = H_b (base twist) + H_bm (joint rates): `momentum_matrix` on the generalized velocity, shape (11,).
    """
    P = np.zeros(3)
    for i in range(3):
        for j in range(FREEDOMS):
            P[i] += matrix[i, j] * velocity[j]
    return P


@compiled_inline
def manipulability(links: Chain, arm: int) -> float:
    """Volume of one hand's velocity ellipsoid on a still base, sqrt(det(J J^T)) [m2], J of joints 1-3, shape (3, 3).

    Yoshikawa 1985. For this arm it equals L1 L2 |sin(joint angle 2)|.
    """
    x, y, joint = links.hand_pose[arm, 0], links.hand_pose[arm, 1], links.joint
    x1, x2, x3 = -(y - joint[arm, 0, 1]), -(y - joint[arm, 1, 1]), -(y - joint[arm, 2, 1])
    y1, y2, y3 = x - joint[arm, 0, 0], x - joint[arm, 1, 0], x - joint[arm, 2, 0]
    return abs(float(x1 * (y2 - y3) - x2 * (y1 - y3) + x3 * (y1 - y2)))


@compiled
def solution(matrix: FloatArray, right_side: FloatArray) -> FloatArray:
    """X of A x = b by Gaussian elimination with partial pivoting, A of shape (n, n).

    A pivot of zero gives infinities, not an error: the rate bound that follows deals with them.
    """
    A, x = matrix.copy(), right_side.copy()
    eliminate(A, x, right_side.shape[0])
    return x


@compiled_inline
def eliminate(A: FloatArray, x: FloatArray, n: int) -> None:
    """Replace the first n elements of x, the right side, by the `solution`; A is used up."""
    for column in range(n):
        pivot = column
        for row in range(column + 1, n):
            if abs(A[row, column]) > abs(A[pivot, column]):
                pivot = row
        if pivot != column:
            for k in range(column, n):
                A[column, k], A[pivot, k] = A[pivot, k], A[column, k]
            x[column], x[pivot] = x[pivot], x[column]
        for row in range(column + 1, n):
            factor = A[row, column] / A[column, column]
            for k in range(column + 1, n):
                A[row, k] -= factor * A[column, k]
            x[row] -= factor * x[column]
    for row in range(n - 1, -1, -1):
        for k in range(row + 1, n):
            x[row] -= A[row, k] * x[k]
        x[row] /= A[row, row]


JOINT_RATES = np.dtype(
    [
        ("jacobian", np.float64, (6, 6)),  # joint rates to the hand velocity
        ("hand_velocity", np.float64, (6,)),  # of one hand or both
        ("matrix", np.float64, (6, 6)),  # to work with
        ("weights", np.float64, (6,)),  # likewise
        ("rates", np.float64, (6,)),  # the joint rates
    ],
    align=True,
)
"""Which joint rates give a hand velocity: what `solve_joint_rates` is given, works with and gives."""


@compiled_inline
def solve_joint_rates(problem: Record, rows: int, damping: float) -> None:
    """Joint rates of least norm that give the hand velocity, its first rows, 3 or 6; `problem` is of `JOINT_RATES`.

    J^T (J J^T + damping^2 I)^-1 v: for damping zero the Moore-Penrose inverse of a J of full row rank.
    """
    J, matrix, weights, rates = problem.jacobian, problem.matrix, problem.weights, problem.rates
    if rows == 6 and damping == 0.0:
        copy_rows(matrix, J)
        copy_vector(rates, problem.hand_velocity)
        eliminate(matrix, rates, 6)
        return
    for i in range(rows):
        weights[i] = problem.hand_velocity[i]
        for j in range(i, rows):
            total = damping * damping if i == j else 0.0
            for k in range(6):
                total += J[i, k] * J[j, k]
            matrix[i, j] = matrix[j, i] = total
    eliminate(matrix, weights, rows)
    for k in range(6):
        total = 0.0
        for i in range(rows):
            total += J[i, k] * weights[i]
        rates[k] = total


@compiled
def joint_acceleration_under_contact(
    model: FreeFlyingModel, inertia: FloatArray, hand_wrench: FloatArray, free_joints: int
) -> FloatArray:
    """H*^-1 J*^T F: joint accelerations [rad/s2], shape (8,), that the hands' wrenches cause in free joints.

    Args:
        model: matrices of eq. 2.
        inertia: matrix of eq. 1, shape (11, 11).
        hand_wrench: on both hands about their centres (fx, fy [N], torque [N m]), world axes, shape (2, 3).
        free_joints: 8, or 6 if the mounts are rigid: their accelerations are then zero.

    """
    H, reaction, J = inertia, model.base_reaction, model.generalized_jacobian
    H_star = np.empty((free_joints, free_joints))
    torque = np.zeros(free_joints)
    for i in range(free_joints):
        for j in range(free_joints):
            H_star[i, j] = H[3 + i, 3 + j]
            for k in range(3):
                H_star[i, j] -= H[k, 3 + i] * reaction[k, j]
        for row in range(6):
            torque[i] += J[row, i] * hand_wrench[row // 3, row % 3]
    acceleration = np.zeros(FREEDOMS - 3)
    acceleration[:free_joints] = solution(H_star, torque)
    return acceleration


@compiled_inline
def damping_near_singularity(smallest_manipulability: float, warning: float, greatest: float) -> float:
    """Damping [m] that grows from zero at the warning level to `greatest` at a singularity.

    Nakamura and Hanafusa 1986: damping^2 = greatest^2 (1 - w / warning)^2.
    """
    if smallest_manipulability >= warning:
        return 0.0
    return greatest * (1.0 - smallest_manipulability / warning)


@compiled_inline
def is_finite(values: FloatArray) -> bool:
    """Whether every element of an array of one axis is a finite number."""
    for value in values:  # noqa: SIM110  (compiled)
        if not math.isfinite(value):
            return False
    return True
