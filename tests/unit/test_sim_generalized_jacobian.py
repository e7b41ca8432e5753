"""Joint rates from hand velocities, elimination, damping (the matrices themselves: tests/physics)."""

from __future__ import annotations

import numpy as np
import pytest

from sim.config import RobotConfig
from sim.model.generalized_jacobian import (
    JOINT_RATES,
    damping_near_singularity,
    free_flying_model,
    is_finite,
    manipulability,
    momentum,
    solution,
    solve_joint_rates,
)
from sim.model.robot import FREEDOMS, chain, initial_joint_angles, robot_model

ROUNDING = 1e-9
ROBOT = robot_model(RobotConfig())


def start_model():
    links = chain(ROBOT, np.zeros(3), initial_joint_angles(RobotConfig().arm), np.zeros(2))
    return free_flying_model(ROBOT, np.zeros(3), links)


@pytest.mark.parametrize("size", [1, 3, 6, 8])
def test_solution_solves(size):
    random = np.random.default_rng(size)
    A, b = random.normal(size=(size, size)), random.normal(size=size)
    assert np.allclose(A @ solution(A, b), b, atol=ROUNDING)


def test_solution_pivots_past_a_zero():
    A = np.array([[0.0, 2.0], [3.0, 1.0]])
    assert solution(A, np.array([4.0, 5.0])) == pytest.approx([1.0, 2.0])


def test_solution_leaves_its_arguments_alone():
    A, b = np.array([[2.0, 1.0], [1.0, 3.0]]), np.array([1.0, 2.0])
    solution(A, b)
    assert A.tolist() == [[2.0, 1.0], [1.0, 3.0]]
    assert b.tolist() == [1.0, 2.0]


def test_solution_of_a_singular_system_is_not_finite_and_not_an_error():
    assert not np.isfinite(solution(np.zeros((2, 2)), np.ones(2))).any()


def joint_rates(jacobian, hand_velocity, damping):
    """What `solve_joint_rates` gives for a jacobian of shape (n, 6), n = 3 or 6."""
    problem, rows = np.zeros(1, JOINT_RATES)[0], len(hand_velocity)
    problem["jacobian"][:rows], problem["hand_velocity"][:rows] = jacobian, hand_velocity
    solve_joint_rates(problem, rows, damping)
    return problem["rates"].copy()


@pytest.mark.parametrize("rows", [slice(0, 3), slice(3, 6), slice(0, 6)], ids=["left", "right", "both"])
def test_joint_rates_are_the_pseudo_inverse(rows):
    J = start_model().generalized_jacobian[rows, :6]
    wanted = np.random.default_rng(0).normal(size=J.shape[0])
    rates = joint_rates(np.ascontiguousarray(J), wanted, 0.0)
    assert np.allclose(rates, np.linalg.pinv(J) @ wanted, atol=ROUNDING)
    assert np.allclose(J @ rates, wanted, atol=ROUNDING)


def test_one_hand_is_moved_by_all_six_joints():
    J = np.ascontiguousarray(start_model().generalized_jacobian[:3, :6])
    rates = joint_rates(J, np.array([0.1, 0.0, 0.0]), 0.0)
    assert np.abs(rates[3:]).max() > 1e-6


@pytest.mark.parametrize("damping", [0.01, 0.1, 1.0])
def test_damping_trades_accuracy_for_smaller_rates(damping):
    J = start_model().generalized_jacobian[:, :6].copy()
    wanted = np.array([0.1, -0.05, 0.2, 0.1, 0.0, -0.3])
    plain, damped = joint_rates(J, wanted, 0.0), joint_rates(J, wanted, damping)
    expected = J.T @ np.linalg.solve(J @ J.T + damping**2 * np.eye(6), wanted)
    assert np.allclose(damped, expected, atol=ROUNDING)
    assert np.linalg.norm(damped) < np.linalg.norm(plain)


def test_damped_rates_stay_finite_at_a_singularity():
    J = np.zeros((6, 6))
    J[0, 0] = 1.0
    assert np.isfinite(joint_rates(J, np.ones(6), 0.1)).all()


@pytest.mark.parametrize(
    ("smallest", "expected"),
    [(0.02, 0.0), (0.01, 0.0), (0.005, 0.05), (0.0, 0.1)],
    ids=["far", "edge", "half", "singular"],
)
def test_damping_grows_towards_a_singularity(smallest, expected):
    assert damping_near_singularity(smallest, 0.01, 0.1) == pytest.approx(expected)


def test_momentum_of_a_robot_that_moves_as_one_body():
    model = start_model()
    velocity = np.zeros(FREEDOMS)
    velocity[:2] = 0.3, -0.2
    assert momentum(model.momentum_matrix, velocity)[:2] == pytest.approx(ROBOT.total_mass * velocity[:2])


def test_manipulability_vanishes_with_a_straight_elbow():
    links = chain(ROBOT, np.zeros(3), np.array([[1.0, 0.0, 1.0], [1.0, 0.5, 1.0]]), np.zeros(2))
    assert manipulability(links, 0) == pytest.approx(0.0, abs=1e-15)
    assert manipulability(links, 1) > 0.01


def test_is_finite():
    assert is_finite(np.array([1.0, -2.0]))
    assert not is_finite(np.array([1.0, np.nan]))
    assert not is_finite(np.array([np.inf]))
