"""The simulated plants as plants: their start, what they report, what is solid and what is not."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.config import Engine, MissionConfig
from sim.configurations import nested, revised
from sim.errors import PlantDiverged
from sim.model.planar import in_frame
from sim.model.robot import base_shape, chain, initial_joint_angles, robot_model
from sim.model.shape import signed_distance
from sim.plant.pymunk_plant import PymunkPlant
from tests.flying import after, laid_out

STILL = np.zeros((2, 3))
ROUNDING = 1e-12


@pytest.fixture(params=list(Engine), ids=lambda engine: engine.value)
def engine(request) -> Engine:
    return request.param


def with_target(**target) -> MissionConfig:
    """The default configuration with another target, unchecked: a plant may begin in contact, a mission may not."""
    config = MissionConfig()
    return config.model_copy(update={"target": config.target.model_copy(update=target)})


class TestStart:
    def test_is_as_configured(self, engine):
        state = laid_out(engine, MissionConfig()).state
        assert state["time"] == 0.0
        assert state["base_pose"].tolist() == [0.0, 0.076078, 0.0]
        assert state["target_pose"].tolist() == [0.0, 0.35, 0.0]
        assert state["target_twist"].tolist() == [0.0, 0.0, 1.0]
        assert state["joint_angle"] == pytest.approx(initial_joint_angles(MissionConfig().robot.arm))
        assert not state["joint_rate"].any()

    def test_total_momentum_is_the_targets_spin(self, engine):
        target = MissionConfig().target
        assert laid_out(engine, MissionConfig()).state["momentum"] == pytest.approx([0.0, 0.0, target.inertia])

    def test_momentum_of_a_drifting_target_is_about_the_origin(self, engine):
        plant = laid_out(engine, with_target(initial_velocity_x=0.1, initial_spin=0.0))
        p = MissionConfig().target.mass * 0.1
        assert plant.state["momentum"] == pytest.approx([p, 0.0, -0.35 * p])


class TestJointRates:
    def test_takes_one_control_period(self, engine):
        plant = laid_out(engine, MissionConfig())
        assert after(plant, STILL)["time"] == pytest.approx(1e-3)

    def test_takes_as_many_physics_steps_as_the_period_has(self, engine):
        config = revised(MissionConfig(), nested({"simulation.time_step": 0.1e-3, "target.initial_spin": 2.0}))
        assert after(laid_out(engine, config), STILL)["target_pose"][2] == pytest.approx(2.0e-3)

    def test_a_free_target_drifts_and_spins_on(self, engine):
        plant = laid_out(engine, with_target(initial_velocity_y=0.05, initial_spin=0.7))
        state = after(plant, STILL, 500)
        assert state["target_pose"] == pytest.approx([0.0, 0.375, 0.35], abs=1e-9)
        assert state["target_twist"] == pytest.approx([0.0, 0.05, 0.7], abs=ROUNDING)

    def test_a_robot_at_rest_stays(self, engine):
        plant = laid_out(engine, MissionConfig())
        before = plant.state["base_pose"].copy(), plant.state["joint_angle"].copy()
        state = after(plant, STILL, 200)
        assert state["base_pose"] == pytest.approx(before[0], abs=ROUNDING)
        assert state["joint_angle"] == pytest.approx(before[1], abs=ROUNDING)

    def test_joint_angles_are_those_of_the_chain(self):
        """The bodies and the model tell the same story: hands by the chain are where pymunk has them."""
        plant, rates = PymunkPlant(MissionConfig()), np.array([[0.3, -0.2, 0.5], [-0.4, 0.1, 0.2]])
        state = after(plant, rates, 500)
        robot = robot_model(MissionConfig().robot)
        links = chain(robot, state["base_pose"], state["joint_angle"], state["mount_angle"])
        for arm in range(2):
            for link in range(4):
                body = plant._bodies[1 + 4 * arm + link]
                assert tuple(body.position) == pytest.approx(links.centre[arm, link], abs=1e-6)

    def test_the_base_reacts_to_the_arms(self, engine):
        plant = laid_out(engine, MissionConfig())
        state = after(plant, np.array([[0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]), 500)
        assert state["base_pose"][2] < -0.01

    def test_a_state_that_is_not_finite_is_refused(self):
        plant = PymunkPlant(MissionConfig())
        plant._bodies[0].angular_velocity = math.nan
        with pytest.raises(PlantDiverged, match="not finite, or its momentum jumped, at"):
            after(plant, STILL)


class TestContact:
    def test_none_at_the_start(self, engine):
        state = after(laid_out(engine, MissionConfig()), STILL)
        assert not state["tip_contact"].any()
        assert not state["hand_wrench"].any()

    def test_of_a_tip_pushes_hand_and_target_apart(self, engine):
        plant = laid_out(engine, with_target(initial_x=0.1984 - 0.09 + 1e-3, initial_y=0.385, initial_spin=0.0))
        state = after(plant, STILL)
        assert state["tip_contact"].tolist() == [[0, 0], [1, 1]]
        assert state["hand_wrench"][1, 0] > 0.5
        assert state["target_twist"][0] < 0.0
        assert not state["hand_wrench"][0].any()

    def test_wrench_is_about_the_hand_centre(self, engine):
        """The face's corner lies between the tips: only the inner tip is touched, and it turns the hand."""
        config = with_target(initial_x=0.1984 - 0.09 + 1e-3, initial_y=0.30, initial_spin=0.0)
        smooth = config.contact.model_copy(update={"friction": 0.0})
        state = after(laid_out(engine, config.model_copy(update={"contact": smooth})), STILL)
        (touching,) = np.flatnonzero(state["tip_contact"][1])
        arm = (2 * touching - 1) * MissionConfig().robot.arm.hand.tip_offset
        # Hand's x axis points along the world's y: tip 1 is above the centre, and a push to +x there turns it back.
        assert state["hand_wrench"][1, 2] == pytest.approx(-arm * state["hand_wrench"][1, 0], rel=1e-6)

    def test_ends_and_leaves_no_force_behind(self, engine):
        plant = laid_out(engine, with_target(initial_x=0.1984 - 0.09 + 1e-3, initial_y=0.385, initial_spin=0.0))
        state = after(plant, STILL, 1500)
        assert not state["tip_contact"].any()
        assert not state["hand_wrench"].any()

    def test_of_the_base_is_solid_and_reported(self, engine):
        plant = laid_out(engine, with_target(initial_y=0.17, initial_velocity_y=-0.2, initial_spin=0.0))
        told = False
        for _ in range(500):
            state = after(plant, STILL)
            told = told or state["base_contact"] > 0
        assert told
        middle = in_frame(state["base_pose"], *state["target_pose"][:2].tolist())
        assert signed_distance(base_shape(MissionConfig().robot.base), *middle) - 0.075 > -1e-3
        assert state["momentum"] == pytest.approx([0.0, -0.2 * MissionConfig().target.mass, 0.0], abs=1e-6)

    def test_of_the_palm_is_solid_and_reported(self, engine):
        plant = laid_out(
            engine, with_target(side=0.04, initial_x=0.17, initial_y=0.385, initial_velocity_x=0.2, initial_spin=0.0)
        )
        told = False
        for _ in range(500):
            state = after(plant, STILL)
            told = told or state["arm_contact"] > 0
        assert told
        assert state["target_pose"][0] < 0.23


class TestHandle:
    def test_solid_counts_begin_at_none(self):
        assert PymunkPlant(MissionConfig()).handle.solid.tolist() == [0, 0]

    def test_masses_and_inertias_are_the_models(self):
        handle = PymunkPlant(MissionConfig()).handle
        robot = robot_model(MissionConfig().robot)
        assert handle.masses[:-1].sum() == pytest.approx(robot.total_mass)
        assert handle.inertias[-1] == MissionConfig().target.inertia


def test_an_air_table_tilts_and_drags_and_is_no_fault():
    table = {"table": {"drag": 0.4, "tilt_x": 2e-3}}
    plant = PymunkPlant(revised(MissionConfig(), {**table, "target": {"initial_y": 4.0}}))
    for _ in range(1000):
        plant.apply_joint_rates(np.zeros((2, 3)))
    kept = math.exp(-0.4)
    for body in ("base_twist", "target_twist"):
        assert plant.state[body][0] == pytest.approx(9.81 * math.sin(2e-3) * (1.0 - kept) / 0.4, rel=1e-3)
    assert plant.state["target_twist"][2] == pytest.approx(MissionConfig().target.initial_spin * kept, rel=1e-3)
