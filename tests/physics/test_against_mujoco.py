"""The robot's model against MuJoCo, which shares no line of it (architecture.md: independent references)."""

from __future__ import annotations

import numpy as np
import pytest

from sim.config import RobotConfig
from sim.model.generalized_jacobian import free_flying_model, joint_acceleration_under_contact, momentum
from sim.model.robot import FREEDOMS, chain, inertia_matrix, robot_model
from tests.physics.mujoco_reference import Reference

RELATIVE = 1e-9
"""Figure of the mission; both sides compute in double precision, some 1e-14 apart."""


class Pair:
    """One random configuration and motion, in both libraries."""

    def __init__(self, seed: int) -> None:
        random = np.random.default_rng(seed)
        config = RobotConfig()
        self.robot = robot_model(config)
        self.base_pose = random.uniform(-1.5, 1.5, 3)
        joint_angle, mount_angle = random.uniform(-2.5, 2.5, (2, 3)), random.uniform(-0.2, 0.2, 2)
        self.velocity = random.uniform(-2.0, 2.0, FREEDOMS)
        self.links = chain(self.robot, self.base_pose, joint_angle, mount_angle)
        self.model = free_flying_model(self.robot, self.base_pose, self.links)
        self.inertia = inertia_matrix(self.robot, self.base_pose, self.links)
        self.reference = Reference(config)
        self.reference.place(self.base_pose, joint_angle, mount_angle, self.velocity)


@pytest.fixture(params=range(6), ids=lambda seed: f"seed {seed}")
def pair(request) -> Pair:
    return Pair(request.param)


def agrees(ours, theirs) -> bool:
    return np.abs(ours - theirs).max() <= RELATIVE * np.abs(theirs).max()


def test_inertia_matrix(pair):
    assert agrees(pair.inertia, pair.reference.inertia())
    assert agrees(pair.model.momentum_matrix, pair.reference.inertia()[:3])


def test_hand_poses(pair):
    assert agrees(pair.links.hand_pose[:, :2], pair.reference.hand_pose()[:, :2])
    turn = pair.links.hand_pose[:, 2] - pair.reference.hand_pose()[:, 2]
    assert np.abs(np.sin(turn / 2)).max() <= RELATIVE


def test_hand_jacobian(pair):
    assert agrees(pair.model.hand_jacobian, pair.reference.hand_jacobian())


def test_momentum(pair):
    ours = momentum(pair.model.momentum_matrix, pair.velocity)
    assert agrees(ours, pair.reference.momentum_about_base())


def test_generalized_jacobian_and_momentum_map(pair):
    H, J = pair.reference.inertia(), pair.reference.hand_jacobian()
    reaction = np.linalg.solve(H[:3, :3], H[:3, 3:])
    assert agrees(pair.model.base_reaction, reaction)
    assert agrees(pair.model.generalized_jacobian, J[:, 3:] - J[:, :3] @ reaction)
    assert agrees(pair.model.momentum_map, J[:, :3] @ np.linalg.inv(H[:3, :3]))


def test_generalized_jacobian_gives_the_hands_of_a_robot_with_momentum(pair):
    """Eq. 2: J* (joint rates) + J_b H_b^-1 P are the hand twists, whatever the momentum."""
    P = pair.reference.momentum_about_base()
    hands = pair.model.generalized_jacobian @ pair.velocity[3:] + pair.model.momentum_map @ P
    assert agrees(hands, pair.reference.hand_jacobian() @ pair.velocity)


@pytest.mark.parametrize("free_joints", [8, 6])
def test_joint_acceleration_under_hand_wrenches(pair, free_joints):
    """MuJoCo applies the wrenches to a resting robot; joints that are not free are left out of eq. 1."""
    wrench = np.random.default_rng(1).uniform(-1.0, 1.0, (2, 3))
    free = 3 + free_joints
    H, J = pair.reference.inertia()[:free, :free], pair.reference.hand_jacobian()[:, :free]
    expected = np.linalg.solve(H, J.T @ wrench.ravel())[3:]
    ours = joint_acceleration_under_contact(pair.model, pair.inertia, wrench, free_joints)
    assert agrees(ours[:free_joints], expected)
    assert not ours[free_joints:].any()
