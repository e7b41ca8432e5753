"""The controller's reduced model against the general matrices of eq. 1 and 2, and the chain that follows from it."""

from __future__ import annotations

import numpy as np
import pytest

from sim.config import RobotConfig
from sim.control.hand_motion import generalized_velocity
from sim.model.generalized_jacobian import free_flying_model, momentum
from sim.model.reduced_model import (
    CHAIN,
    FREE,
    SHAPE,
    base_twist,
    hand_twist_by_joint,
    momentum_drift,
    momentum_of,
    set_chain,
    set_generalized_jacobian,
    shape_of_state,
)
from sim.model.robot import chain, robot_model
from sim.plant.plant import PLANT_STATE
from sim.record import packed

ROBOT = robot_model(RobotConfig())
EXACT = 1e-12


class Placement:
    """A robot anywhere, moving anyhow, and its shape."""

    def __init__(self, seed: int) -> None:
        random = np.random.default_rng(seed)
        self.state, self.shape, self.links = (np.zeros(1, kind)[0] for kind in (PLANT_STATE, SHAPE, CHAIN))
        for name in ("base_pose", "base_twist", "joint_angle", "joint_rate", "mount_angle", "mount_rate"):
            self.state[name] = random.normal(size=self.state[name].shape)
        shape_of_state(packed(ROBOT)[0], self.state, self.shape)
        set_chain(self.state["base_pose"], self.shape, self.links)
        self.general = chain(ROBOT, self.state["base_pose"], self.state["joint_angle"], self.state["mount_angle"])
        self.model = free_flying_model(ROBOT, self.state["base_pose"], self.general)
        c, s = np.cos(self.state["base_pose"][2]), np.sin(self.state["base_pose"][2])
        self.world_from_base = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


@pytest.fixture(params=range(4))
def placement(request: pytest.FixtureRequest) -> Placement:
    return Placement(request.param)


def test_chain_is_that_of_the_links(placement: Placement) -> None:
    assert np.abs(placement.links["joint"] - placement.general.joint).max() < EXACT
    assert np.abs(placement.links["hand_pose"] - placement.general.hand_pose).max() < EXACT


@pytest.mark.parametrize("arm", [0, 1])
def test_generalized_jacobian(placement: Placement, arm: int) -> None:
    matrix = np.zeros((3, 6))
    set_generalized_jacobian(placement.shape, arm, matrix, 0)
    expected = placement.model.generalized_jacobian[3 * arm : 3 * arm + 3, :6]
    assert np.abs(placement.world_from_base @ matrix - expected).max() < EXACT


def test_hands_drift_by_momentum_alone(placement: Placement) -> None:
    state, velocity = placement.state, generalized_velocity(placement.state)
    vx, vy, _ = placement.world_from_base.T @ state["base_twist"]
    x, y, turn = momentum_drift(placement.shape, vx, vy, state["base_twist"][2], velocity[3 : 3 + FREE])
    by_momentum = placement.model.momentum_map @ momentum(placement.model.momentum_matrix, velocity)
    for arm in range(2):
        from_x, from_y = placement.shape["hand"][arm] - placement.shape["centre"]
        ours = placement.world_from_base @ np.array([x - turn * from_y, y + turn * from_x, turn])
        assert np.abs(ours - by_momentum[3 * arm : 3 * arm + 3]).max() < EXACT


def test_momentum_and_base_twist_follow_from_each_other_and_the_joints(placement: Placement) -> None:
    state, shape = placement.state, placement.shape
    ours, twist = np.empty(3), np.empty(3)
    momentum_of(shape, state, ours)
    assert np.abs(ours - momentum(placement.model.momentum_matrix, generalized_velocity(state))).max() < EXACT
    base_twist(shape, state["base_pose"][2], ours, state["joint_rate"], state["mount_rate"], twist)
    assert np.abs(twist - state["base_twist"]).max() < EXACT


@pytest.mark.parametrize("arm", [0, 1])
def test_mounts_move_hands_as_joints_do(placement: Placement, arm: int) -> None:
    for side in range(2):
        ours = placement.world_from_base @ np.array(hand_twist_by_joint(placement.shape, arm, side, 3))
        expected = placement.model.generalized_jacobian[3 * arm : 3 * arm + 3, 6 + side]
        assert np.abs(ours - expected).max() < EXACT
