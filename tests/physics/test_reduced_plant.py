"""The reduced plant: free flight, momentum, second order, copies of a state, solids, and pymunk's plant beside it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.capture.mission import Mission
from sim.config import Engine, HandMount, MissionConfig
from sim.configurations import nested, revised
from sim.control.phases import Command
from sim.errors import ConfigError, PlantDiverged
from sim.model.generalized_jacobian import free_flying_model
from sim.model.planar import cross
from sim.model.robot import chain, inertia_matrix, robot_model
from sim.plant.plant import GRAVITY, PLANT_STATE
from sim.plant.reduced_plant import ReducedPlant
from tests.flying import after, laid_out
from tests.physics.free_flight import AMPLITUDE, FREQUENCY, fly_freely, reference_base_pose, remote_target
from tests.physics.mujoco_reference import Reference

MINUTE = 60.0
REFERENCE = 1e-9
"""[m, rad] after a minute, of DOP853 on the same joint angles; measured 2e-10."""
MOMENTUM = 1e-12
"""[N s, N m s], of MuJoCo's momentum in the velocities that the plant reports."""
SECOND_ORDER = (3.4, 4.6)
"""What the error falls by when the step is halved: four, and the next order."""
FREE_FLIGHT_ORDER = 12.0
"""The same in free flight, at least: sixteen, since the base's angle is all that is not exact."""
BESIDE_PYMUNK = 1e-6
"""[m] of base and hands at the first touch, under the same commands; measured 3e-8."""
STILL = np.zeros((2, 3))
REDUCED = {"simulation.engine": "reduced"}


def reduced(changes) -> MissionConfig:
    return revised(MissionConfig(), nested({**REDUCED, **changes}))


def touching(changes=None, depth: float = 1e-3) -> MissionConfig:
    """The target that deep in both tips of the right hand at the start, turning."""
    near = {"target.initial_x": 0.1984 - 0.09 + depth, "target.initial_y": 0.385}
    config = reduced({"target.initial_spin": 0.3, **(changes or {})})
    x, y = near.values()
    return config.model_copy(update={"target": config.target.model_copy(update={"initial_x": x, "initial_y": y})})


def sway(tick: int):
    """Smooth joint rates [rad/s]."""
    return AMPLITUDE * np.sin(FREQUENCY * tick * 1e-3)


@pytest.fixture(scope="module")
def flight():
    return fly_freely(remote_target(Engine.REDUCED), MINUTE)


class TestFreeFlight:
    def test_base_follows_the_reference(self, flight):
        error = flight.base_pose[-1] - reference_base_pose(remote_target(), flight)
        assert np.abs(error).max() < REFERENCE
        assert np.ptp(flight.base_pose[:, 2]) > 0.1

    def test_velocities_carry_no_momentum_as_mujoco_sees_them(self, flight):
        reference = Reference(MissionConfig().robot)
        for tick in range(500, len(flight.time), 5000):
            shape = flight.shape[tick]
            velocity = np.concatenate([flight.base_twist[tick], flight.joint_rate[tick], np.zeros(2)])
            reference.place(flight.base_pose[tick], shape[:6].reshape(2, 3), shape[6:], velocity)
            assert np.abs(flight.joint_rate[tick]).max() > 0.05
            assert np.abs(reference.momentum_about_base()).max() < MOMENTUM

    def test_reported_twist_is_the_rate_of_the_pose(self, flight):
        """Central differences of the pose over 2 ms, within which each commanded rate makes two steps of 1 mrad/s."""
        rate = (flight.base_pose[2:] - flight.base_pose[:-2]) / 2e-3
        assert np.abs(rate - flight.base_twist[1:-1]).max() < 1e-4
        assert np.abs(flight.base_twist).max() > 0.1

    def test_mounts_stay_without_contact(self, flight):
        assert not flight.shape[:, 6:].any()

    def test_error_falls_with_the_fourth_power_of_the_step(self):
        soft = {"contact.stiffness": 1.0, "contact.damping": 0.0, "contact.solid_stiffness": 1.0}
        slow = {"contact.solid_damping": 0.0, "control.period": 0.04, "robot.servo.time_constant": 0.05}
        away = {"target.initial_y": 4.0}
        angles = []
        for step in (0.04, 0.02, 0.01):
            plant = ReducedPlant(reduced({**soft, **slow, **away, "simulation.time_step": step}))
            angles.append(after(plant, 4.0 * COMMAND, 10)["base_pose"][2])
        assert abs(angles[0] - angles[1]) > FREE_FLIGHT_ORDER * abs(angles[1] - angles[2]) > 0.0


COMMAND = np.array([[0.2, -0.3, 0.4], [-0.1, 0.25, 0.3]])


class TestContact:
    @pytest.mark.parametrize("mount", list(HandMount))
    def test_of_second_order(self, mount):
        """Held contact from the start on, friction smooth, a servo slower than the step."""
        smooth = {"contact.friction_speed": 0.5, "robot.servo.time_constant": 4e-3, "control.period": 2e-3}
        ends = []
        for step in (0.5e-3, 0.25e-3, 0.125e-3):
            config = touching({**smooth, "simulation.time_step": step, "robot.servo.hand_mount": mount.value}, 3e-3)
            plant = ReducedPlant(config)
            state = after(plant, COMMAND, 10)
            assert state["tip_contact"][1].all()
            ends.append(np.concatenate([state[name].ravel() for name in MOTION]))
        for coarse, fine in zip(groups(ends[0] - ends[1]), groups(ends[1] - ends[2]), strict=True):
            ratio = np.abs(coarse).max() / np.abs(fine).max()
            assert SECOND_ORDER[0] < ratio < SECOND_ORDER[1]

    def test_is_there_at_the_start(self):
        state = ReducedPlant(touching()).state
        assert state["tip_contact"].tolist() == [[0, 0], [1, 1]]
        assert state["hand_wrench"][1, 0] > 0.5

    def test_total_momentum_stays_as_mujoco_sees_it(self):
        config = touching()
        plant, reference = ReducedPlant(config), Reference(config.robot)
        before = plant.state["momentum"].copy()
        for tick in range(300):
            after(plant, sway(tick))
        state = plant.state
        velocity = np.concatenate([state["base_twist"], state["joint_rate"].ravel(), state["mount_rate"]])
        reference.place(state["base_pose"], state["joint_angle"], state["mount_angle"], velocity)
        px, py, about_base = reference.momentum_about_base()
        assert math.hypot(px, py) > 1e-3
        base, target = state["base_pose"], state["target_pose"]
        mass, inertia = config.target.mass, config.target.inertia
        tx, ty, spin = state["target_twist"] * (mass, mass, inertia)
        about_origin = about_base + cross(base[0], base[1], px, py) + spin + cross(target[0], target[1], tx, ty)
        assert [px + tx, py + ty, about_origin] == pytest.approx(before, abs=MOMENTUM)
        assert state["momentum"] == pytest.approx(before, abs=1e-15)

    def test_an_ideal_servo_gives_no_way(self):
        state = after(ReducedPlant(touching({"robot.servo.time_constant": 0.0})), STILL, 20)
        assert state["tip_contact"][1].any()
        assert not state["joint_rate"].any()
        assert not state["mount_rate"].any()

    def test_a_rigid_mount_does_not_turn(self):
        state = after(ReducedPlant(touching({"robot.servo.hand_mount": "rigid"})), STILL, 50)
        assert np.abs(state["joint_rate"]).max() > 1e-5
        assert not state["mount_angle"].any()


MOTION = ("base_pose", "base_twist", "joint_angle", "joint_rate", "target_pose", "target_twist")


def groups(values):
    """Base poses and twists, joints and their rates, target: each has errors of its own size."""
    return values[:3], values[3:6], values[6:12], values[12:18], values[18:21], values[21:]


class TestSolids:
    @pytest.mark.parametrize("initial_angle", [0.0, math.pi / 4], ids=["face first", "corner first"])
    def test_of_the_base_keep_the_target_out_and_momentum(self, initial_angle):
        config = MissionConfig()
        near = {"initial_y": 0.21, "initial_velocity_y": -0.2, "initial_spin": 0.0, "initial_angle": initial_angle}
        plant = laid_out(Engine.REDUCED, config.model_copy(update={"target": config.target.model_copy(update=near)}))
        before, deepest = plant.state["momentum"].copy(), math.inf
        for _ in range(600):
            state = after(plant, STILL)
            deepest = min(deepest, state["target_pose"][1] - state["base_pose"][1])
        assert state["target_twist"][1] > 0.0
        reach = 0.075 * (math.sqrt(2.0) if initial_angle else 1.0)
        assert deepest > 0.003922 + reach - 5e-3
        assert state["momentum"] == pytest.approx(before, abs=1e-15)

    def test_of_a_link_push_the_target_away(self):
        """The target drifts from the left on the left arm's first link, between its clearance and joint 2."""
        config = MissionConfig()
        beside = {"side": 0.05, "initial_x": -0.36, "initial_y": 0.16, "initial_spin": 0.0, "initial_velocity_x": 0.1}
        plant = laid_out(Engine.REDUCED, config.model_copy(update={"target": config.target.model_copy(update=beside)}))
        before, met = plant.state["momentum"].copy(), False
        for _ in range(1500):
            state = after(plant, STILL)
            met = met or bool(state["arm_contact"])
        assert met
        assert state["target_twist"][0] < 0.05
        assert state["momentum"] == pytest.approx(before, abs=1e-15)


class TestTorqueLimit:
    def test_saturated_joints_take_the_limit_and_others_keep_their_rates(self):
        config = reduced({"robot.servo.torque_limit": 0.3, "robot.servo.time_constant": 0.0, "target.initial_y": 4.0})
        wanted = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.01]])
        plant = ReducedPlant(config)
        robot, state = robot_model(config.robot), plant.state
        links = chain(robot, state["base_pose"], state["joint_angle"], state["mount_angle"])
        inertia = inertia_matrix(robot, state["base_pose"], links)
        model = free_flying_model(robot, state["base_pose"], links)
        after(plant, wanted)
        change = np.array([*state["joint_rate"].ravel(), *state["mount_rate"]])
        torque = (inertia[3:, 3:] - inertia[:3, 3:].T @ model.base_reaction) @ change / config.simulation.time_step
        short = np.array([*wanted.ravel(), 0.0, 0.0]) - change
        at_limit = np.abs(np.abs(torque) - 0.3) < 1e-9
        assert 0.0 < state["joint_rate"][1, 0] < 3.0
        assert 1 <= np.count_nonzero(at_limit) < 8
        assert np.abs(torque).max() < 0.3 + 1e-9
        assert np.abs(short[~at_limit]).max() < 1e-12
        assert (short * torque)[at_limit].min() > 0.0  # a joint at its limit is pushed towards its rate

    def test_a_limit_just_above_what_is_needed_changes_nothing(self):
        away = {"target.initial_y": 4.0, "robot.servo.time_constant": 5e-3}
        rates = [
            after(ReducedPlant(reduced({**away, "robot.servo.torque_limit": limit})), COMMAND, 5)["joint_rate"].copy()
            for limit in (10.0, 1e3)
        ]
        assert np.array_equal(rates[0], rates[1])


class TestSavedStates:
    def test_flown_again_from_one_bit_for_bit(self):
        plant = ReducedPlant(touching())
        for tick in range(50):
            after(plant, sway(tick))
        saved = plant.save()
        ends = []
        for _ in range(2):
            for tick in range(50, 550):
                after(plant, sway(tick))
            ends.append(plant.state.copy())
            plant.restore(saved)
        assert all(np.array_equal(ends[0][name], ends[1][name]) for name in PLANT_STATE.names or ())
        assert plant.state["tick"] == 50

    def test_another_plant_flies_on_from_it(self):
        first, second = ReducedPlant(touching()), ReducedPlant(touching())
        after(first, COMMAND, 40)
        second.restore(first.save())
        ends = [after(plant, STILL, 100) for plant in (first, second)]
        assert all(np.array_equal(ends[0][name], ends[1][name]) for name in PLANT_STATE.names or ())


class TestAirTable:
    def test_drag_slows_target_and_robot_alike(self):
        config = reduced({"target.initial_y": 4.0, "target.initial_velocity_x": 0.1, "table.drag": 0.4})
        state = after(ReducedPlant(config), STILL, 1000)
        assert state["target_twist"] == pytest.approx([0.1 * math.exp(-0.4), 0.0, math.exp(-0.4)], rel=1e-9)
        assert state["target_pose"][0] == pytest.approx(0.1 * -math.expm1(-0.4) / 0.4, rel=1e-6)

    def test_tilt_accelerates_everything_alike(self):
        tilt = {"table.tilt_x": math.asin(0.02 / GRAVITY), "table.tilt_y": -math.asin(0.01 / GRAVITY)}
        plant = ReducedPlant(reduced({"target.initial_y": 4.0, "target.initial_spin": 0.0, **tilt}))
        before = {name: plant.state[name].copy() for name in ("base_pose", "target_pose")}
        state = after(plant, STILL, 1000)
        for name, start in before.items():
            assert state[name] - start == pytest.approx([0.01, -0.005, 0.0], abs=1e-12)
            assert state[name.replace("pose", "twist")] == pytest.approx([0.02, -0.01, 0.0], abs=1e-12)


def test_beside_pymunk_to_the_first_touch():
    """The same commands to both plants, those of a capture to just before its first touch at 3.456 s."""
    mission = Mission(MissionConfig())
    mission.request(Command.CAPTURE)
    ticks = mission.advance(3450)
    assert not ticks["tip_contact"].any()
    poses = []
    for engine in Engine:
        plant = laid_out(engine, MissionConfig())
        for rates in ticks["commanded_joint_rate"]:
            plant.apply_joint_rates(rates)
        state = plant.state
        links = chain(
            robot_model(MissionConfig().robot), state["base_pose"], state["joint_angle"], state["mount_angle"]
        )
        poses.append(np.concatenate([state["base_pose"][:2], links.hand_pose[:, :2].ravel()]))
    assert np.abs(poses[0] - poses[1]).max() < BESIDE_PYMUNK
    assert np.abs(ticks["hand_pose"][-1] - ticks["hand_pose"][0]).max() > 0.05


def test_a_state_that_is_not_finite_is_refused():
    plant = ReducedPlant(reduced({}))
    plant.handle.plant["own"]["momentum"][0, 2] = math.nan
    with pytest.raises(PlantDiverged, match="not finite, or its momentum jumped, at"):
        after(plant, STILL)


class TestBadInput:
    def test_a_step_too_long_for_the_stiffest_contact(self):
        with pytest.raises(ConfigError, match=r"time_step = 0.001 s is too long.*solid_stiffness.*stable up to.*take"):
            reduced({"contact.solid_stiffness": 1e6})
        with pytest.raises(ConfigError, match=r"too long for contact\.stiffness"):
            reduced({"contact.stiffness": 1e6})

    def test_the_step_that_is_offered_is_taken(self):
        reduced({"contact.solid_stiffness": 1e6, "simulation.time_step": 1e-4})

    @pytest.mark.parametrize(
        ("path", "value"),
        [
            ("simulation.solver_iterations", 40),
            ("simulation.joint_error_time", 0.1),
            ("simulation.collision_slop", 1e-3),
        ],
    )
    def test_a_parameter_of_pymunk_alone(self, path, value):
        with pytest.raises(ConfigError, match=rf"{path} = .* 'pymunk' only"):
            reduced({path: value})

    def test_at_the_bound_a_touch_stays_bounded(self):
        """One tip's spring at the longest step that is let through, without a servo to damp it."""
        config = touching({"contact.stiffness": 1e5, "contact.damping": 0.0, "robot.servo.time_constant": 0.1}, 1e-4)
        state = after(ReducedPlant(config), STILL, 2000)
        assert np.abs(state["target_twist"][:2]).max() < 1.0
