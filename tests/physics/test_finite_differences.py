"""Every Jacobian against central differences of the poses that it claims to differentiate."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.config import RobotConfig
from sim.model.generalized_jacobian import free_flying_model, manipulability, momentum
from sim.model.robot import FREEDOMS, chain, hand_jacobian, inertia_matrix, robot_model

STEP = 1e-6
"""Of the differences: truncation and rounding are then both near 1e-10 for lengths under a metre."""
DIFFERENCE = 2e-9
"""Twenty times those."""
EXACT = 1e-13
"""Identities without a difference: rounding of sums of a few tens of terms near one."""

ROBOT = robot_model(RobotConfig())


class Placement:
    """Generalized coordinates, shape (11,), in the order of the generalized velocity."""

    def __init__(self, seed: int) -> None:
        random = np.random.default_rng(seed)
        self.coordinates = random.uniform(-1.5, 1.5, FREEDOMS)
        self.velocity = random.uniform(-1.0, 1.0, FREEDOMS)

    @staticmethod
    def links(coordinates):
        return chain(ROBOT, coordinates[:3], coordinates[3:9].reshape(2, 3), coordinates[9:])


@pytest.fixture(params=range(4), ids=lambda seed: f"seed {seed}")
def placement(request) -> Placement:
    return Placement(request.param)


def derivative(of, placement: Placement, direction) -> np.ndarray:
    """Central difference of a function of the coordinates along a direction."""
    ahead, behind = placement.coordinates + STEP * direction, placement.coordinates - STEP * direction
    return (of(ahead) - of(behind)) / (2.0 * STEP)


def test_hand_jacobian(placement):
    jacobian = hand_jacobian(placement.coordinates[:3], placement.links(placement.coordinates))
    for column, direction in enumerate(np.eye(FREEDOMS)):
        difference = derivative(lambda at: placement.links(at).hand_pose, placement, direction)
        assert np.abs(jacobian[:, column] - difference.ravel()).max() < DIFFERENCE


def test_arms_do_not_move_each_other_on_a_still_base(placement):
    whole = hand_jacobian(placement.coordinates[:3], placement.links(placement.coordinates))
    assert not whole[:3, [6, 7, 8, 10]].any()
    assert not whole[3:, [3, 4, 5, 9]].any()


def body_momentum(placement: Placement) -> np.ndarray:
    """Momentum about the base's centre of mass, body by body from differences of their poses."""
    masses = np.array([ROBOT.base_mass, *ROBOT.link_mass, *ROBOT.link_mass])
    inertias = np.array([ROBOT.base_inertia, *ROBOT.link_inertia, *ROBOT.link_inertia])

    def poses(at):
        links = placement.links(at)
        bodies = [[*links.centre[arm, link], links.angle[arm, link]] for arm in range(2) for link in range(4)]
        return np.array([at[:3], *bodies])

    twists = derivative(poses, placement, placement.velocity)
    arms = poses(placement.coordinates)[:, :2] - placement.coordinates[:2]
    linear = masses[:, None] * twists[:, :2]
    angular = inertias * twists[:, 2] + arms[:, 0] * linear[:, 1] - arms[:, 1] * linear[:, 0]
    return np.array([*linear.sum(axis=0), angular.sum()])


def test_momentum_is_that_of_the_bodies(placement):
    model = free_flying_model(ROBOT, placement.coordinates[:3], placement.links(placement.coordinates))
    ours = momentum(model.momentum_matrix, placement.velocity)
    # Momenta reach some tens of kg m/s: the difference's error grows with the mass of the robot.
    assert np.abs(ours - body_momentum(placement)).max() < DIFFERENCE * ROBOT.total_mass


def test_generalized_jacobian_moves_the_hands_of_a_robot_without_momentum(placement):
    """Joint rates with the base twist that keeps all momentum zero, integrated over one small difference."""
    model = free_flying_model(ROBOT, placement.coordinates[:3], placement.links(placement.coordinates))
    for column, rates in enumerate(np.eye(FREEDOMS - 3)):
        direction = np.concatenate([-model.base_reaction @ rates, rates])
        assert np.abs(momentum(model.momentum_matrix, direction)).max() < EXACT * ROBOT.total_mass
        difference = derivative(lambda at: placement.links(at).hand_pose, placement, direction)
        assert np.abs(model.generalized_jacobian[:, column] - difference.ravel()).max() < DIFFERENCE


def test_inertia_matrix_is_symmetric_and_positive(placement):
    H = inertia_matrix(ROBOT, placement.coordinates[:3], placement.links(placement.coordinates))
    assert np.array_equal(H, H.T)
    assert np.linalg.eigvalsh(H).min() > 0.0


@pytest.mark.parametrize("elbow", [-2.5, -1.0, -0.1, 0.0, 0.4, 3.0])
def test_manipulability_is_the_area_of_both_links_at_the_elbow(elbow):
    """L1 L2 |sin q2|, whatever the other joints and the base do, on rigid mounts."""
    joint_angle = np.array([[0.7, elbow, -1.1], [-0.3, elbow, 2.0]])
    base_pose = np.array([0.2, -0.5, 1.0])
    links = chain(ROBOT, base_pose, joint_angle, np.zeros(2))
    whole = hand_jacobian(base_pose, links)
    expected = ROBOT.link_length[0] * ROBOT.link_length[1] * abs(math.sin(elbow))
    for arm in range(2):
        assert manipulability(links, arm) == pytest.approx(expected, abs=EXACT)
        J = whole[3 * arm : 3 * arm + 3, 3 + 3 * arm : 6 + 3 * arm]
        assert expected == pytest.approx(math.sqrt(max(np.linalg.det(J @ J.T), 0.0)), abs=1e-8)
