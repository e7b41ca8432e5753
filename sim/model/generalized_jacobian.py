"""The generalized Jacobian of a free-flying robot (eq. 2; Umetani, Yoshida 1989), its inverse and momentum.

Base and arms are coupled by momentum: J* = J_m - J_b H_b^-1 H_bm, and the hands of a robot that carries
momentum P move by J_b H_b^-1 P even with its joints at rest.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.model.robot import FREEDOMS, Chain, RobotModel, hand_jacobian, momentum_matrix


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


@compiled
def manipulability(jacobian: FloatArray) -> float:
    """Volume of one hand's velocity ellipsoid on a still base, sqrt(det(J J^T)) [m2], J of shape (3, 3).

    Yoshikawa 1985. For this arm it equals L1 L2 |sin(joint angle 2)|.
    """
    J = jacobian
    determinant = (
        J[0, 0] * (J[1, 1] * J[2, 2] - J[1, 2] * J[2, 1])
        - J[0, 1] * (J[1, 0] * J[2, 2] - J[1, 2] * J[2, 0])
        + J[0, 2] * (J[1, 0] * J[2, 1] - J[1, 1] * J[2, 0])
    )
    return abs(float(determinant))


@compiled
def solution(matrix: FloatArray, right_side: FloatArray) -> FloatArray:
    """X of A x = b by Gaussian elimination with partial pivoting, A of shape (n, n).

    A pivot of zero gives infinities, not an error: the rate bound that follows deals with them.
    """
    n = right_side.shape[0]
    A, x = matrix.copy(), right_side.copy()
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
    return x


@compiled
def joint_rates(jacobian: FloatArray, hand_velocity: FloatArray, damping: float) -> FloatArray:
    """Joint rates, shape (6,), of least norm that give the hand velocity, shape (n,), n = 3 or 6.

    J^T (J J^T + damping^2 I)^-1 v: for damping zero the Moore-Penrose inverse of a J of full row rank.
    """
    rows = hand_velocity.shape[0]
    if rows == 6 and damping == 0.0:
        return solution(jacobian, hand_velocity)
    gram = np.empty((rows, rows))
    for i in range(rows):
        for j in range(rows):
            total = damping * damping if i == j else 0.0
            for k in range(6):
                total += jacobian[i, k] * jacobian[j, k]
            gram[i, j] = total
    weights = solution(gram, hand_velocity)
    rates = np.zeros(6)
    for k in range(6):
        for i in range(rows):
            rates[k] += jacobian[i, k] * weights[i]
    return rates


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


@compiled
def damping_near_singularity(smallest_manipulability: float, warning: float, greatest: float) -> float:
    """Damping [m] that grows from zero at the warning level to `greatest` at a singularity.

    Nakamura and Hanafusa 1986: damping^2 = greatest^2 (1 - w / warning)^2.
    """
    if smallest_manipulability >= warning:
        return 0.0
    return greatest * (1.0 - smallest_manipulability / warning)


@compiled
def is_finite(values: FloatArray) -> bool:
    """Whether every element is a finite number."""
    for value in values.flat:  # noqa: SIM110  (compiled)
        if not math.isfinite(value):
            return False
    return True
