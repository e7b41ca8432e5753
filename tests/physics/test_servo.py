"""The joint servo as physics: a first-order rate loop, its compliance to contact, its torque limit."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.config import Engine, HandMount, MissionConfig
from sim.configurations import nested, revised
from sim.model.generalized_jacobian import free_flying_model, joint_acceleration_under_contact
from sim.model.robot import chain, inertia_matrix, robot_model
from sim.plant.plant import Plant
from tests.flying import after, laid_out
from tests.physics.free_flight import remote_target

FIRST_ORDER = {Engine.PYMUNK: 0.03, Engine.REDUCED: 1e-12}
"""Relative error of a step response: of a jump in one step 25 iterations of the solver leave 0.025, 40 leave 0.02."""
SETTLED = {Engine.PYMUNK: 5e-3, Engine.REDUCED: 1e-12}
"""Relative error twenty steps after a jump: what 25 iterations a step have not yet spread along the arm."""
COMPLIANCE = 0.02
"""Relative error of the yielding rates, of the reduced plant, and of a solver with 400
iterations: the force falls by 0.2 % a millisecond."""
COMPLIANCE_AS_FLOWN = 0.05
"""The same with the 25 iterations of a mission, in the mean of ten steps."""
TORQUE = {Engine.PYMUNK: 1e-3, Engine.REDUCED: 1e-9}
"""Relative excess over the torque limit: the reduced inertia is taken before the step, the impulse within it."""

COMMAND = np.array([[0.2, -0.3, 0.4], [-0.1, 0.25, 0.3]])


@pytest.fixture(params=list(Engine), ids=lambda engine: engine.value)
def engine(request) -> Engine:
    return request.param


def settled(plant: Plant, command, ticks: int) -> np.ndarray:
    """Joint rates after each of that many ticks, shape (ticks, 2, 3)."""
    return np.array([after(plant, command)["joint_rate"].copy() for _ in range(ticks)])


@pytest.mark.parametrize("time_constant", [5e-3, 20e-3])
def test_step_response_is_first_order(engine, time_constant):
    config = revised(remote_target(), nested({"robot.servo.time_constant": time_constant}))
    rates = settled(laid_out(engine, config), COMMAND, 100)
    after = np.arange(1, 101)[:, None, None] * config.control.period
    expected = COMMAND * (1.0 - np.exp(-after / time_constant))
    assert np.abs(rates - expected).max() < FIRST_ORDER[engine] * np.abs(COMMAND).max()


def test_step_response_does_not_depend_on_the_physics_step(engine):
    responses = []
    for step in (1e-3, 0.25e-3):
        config = revised(remote_target(), nested({"robot.servo.time_constant": 5e-3, "simulation.time_step": step}))
        responses.append(settled(laid_out(engine, config), COMMAND, 30))
    assert np.abs(responses[0] - responses[1]).max() < FIRST_ORDER[engine] * np.abs(COMMAND).max()


def test_ideal_servo_follows_at_once(engine):
    config = revised(remote_target(), nested({"robot.servo.time_constant": 0.0}))
    rates = settled(laid_out(engine, config), COMMAND, 20)
    assert np.abs(rates[-1] - COMMAND).max() < SETTLED[engine] * np.abs(COMMAND).max()


def pressed(changes) -> MissionConfig:
    """A target too heavy to move, still; the contact is soft and smooth, so that the force is held."""
    held = {
        "target.mass": 1e4,
        "target.inertia": 100.0,
        "target.initial_spin": 0.0,
        "contact.stiffness": 80.0,
        "contact.damping": 0.0,
        "contact.friction": 0.0,
    }
    return revised(MissionConfig(), nested({**held, **changes}))


def in_contact(engine: Engine, config: MissionConfig, depth: float) -> Plant:
    """A plant with the target that deep in a tip: only `Mission` refuses such a start."""
    target = config.target.model_copy(update={"initial_x": 0.1984 - 0.015 - 0.075 + depth, "initial_y": 0.385})
    return laid_out(engine, config.model_copy(update={"target": target}))


def rates_given_way(plant: Plant, config: MissionConfig, free_joints: int) -> np.ndarray:
    """T H*^-1 J*^T F at the plant's state, shape (8,)."""
    state, robot = plant.state, robot_model(config.robot)
    links = chain(robot, state["base_pose"], state["joint_angle"], state["mount_angle"])
    model = free_flying_model(robot, state["base_pose"], links)
    inertia = inertia_matrix(robot, state["base_pose"], links)
    acceleration = joint_acceleration_under_contact(model, inertia, state["hand_wrench"], free_joints)
    return config.robot.servo.time_constant * acceleration


@pytest.mark.parametrize(
    ("engine", "numerics", "tolerance"),
    [
        (Engine.PYMUNK, {"simulation.solver_iterations": 400}, COMPLIANCE),
        (Engine.PYMUNK, {"simulation.solver_iterations": 40}, COMPLIANCE_AS_FLOWN),
        (Engine.REDUCED, {}, COMPLIANCE),
    ],
    ids=["pymunk, exact solver", "pymunk, as flown", "reduced"],
)
@pytest.mark.parametrize("mount", list(HandMount))
def test_hands_give_way_to_contact_by_the_stated_compliance(engine, mount, numerics, tolerance):
    """Joint rates under a held force and a zero command: T H*^-1 J*^T F (config: ServoConfig)."""
    config = pressed({"robot.servo.hand_mount": mount.value, **numerics})
    plant = in_contact(engine, config, 5e-3)
    settled(plant, np.zeros((2, 3)), 10)
    measured = []
    for _ in range(10):
        state = after(plant, np.zeros((2, 3)))
        measured.append(np.array([*state["joint_rate"].ravel(), *state["mount_rate"]]))
    expected = rates_given_way(plant, config, 8 if mount is HandMount.YIELDING else 6)
    assert np.hypot(*plant.state["hand_wrench"][1, :2]) > 0.5
    assert np.abs(np.mean(measured, axis=0) - expected).max() < tolerance * np.abs(expected).max()


def test_a_stiffer_servo_gives_way_less(engine):
    given = []
    for time_constant in (1e-3, 0.5e-3, 0.0):
        plant = in_contact(engine, pressed({"robot.servo.time_constant": time_constant}), 5e-3)
        rates = settled(plant, np.zeros((2, 3)), 20)[-1]
        given.append(np.abs(rates).max() / np.hypot(*plant.state["hand_wrench"][1, :2]))
    assert given[1] == pytest.approx(given[0] / 2, rel=COMPLIANCE_AS_FLOWN)
    assert given[2] < COMPLIANCE_AS_FLOWN * given[0]


@pytest.mark.parametrize("limit", [0.05, 0.5])
def test_torque_stays_within_its_limit(engine, limit):
    """The torque that the first step's jump from rest took: H* (change of rates) / dt."""
    config = revised(remote_target(), nested({"robot.servo.torque_limit": limit, "robot.servo.time_constant": 0.0}))
    plant = laid_out(engine, config)
    state, robot = plant.state, robot_model(config.robot)
    links = chain(robot, state["base_pose"], state["joint_angle"], state["mount_angle"])
    model = free_flying_model(robot, state["base_pose"], links)
    inertia = inertia_matrix(robot, state["base_pose"], links)
    reduced = inertia[3:, 3:] - inertia[:3, 3:].T @ model.base_reaction
    after(plant, 20.0 * COMMAND)
    change = np.array([*state["joint_rate"].ravel(), *state["mount_rate"]])
    torque = np.abs(reduced @ change) / config.simulation.time_step
    assert torque[:6].max() < limit * (1.0 + TORQUE[engine])
    assert torque[:6].max() > 0.9 * limit


def test_torque_limit_slows_the_response(engine):
    slow = revised(remote_target(), nested({"robot.servo.torque_limit": 0.02}))
    rates = [settled(laid_out(engine, config), COMMAND, 5)[-1] for config in (remote_target(), slow)]
    assert np.abs(rates[1]).max() < 0.5 * np.abs(rates[0]).max()
    assert math.isclose(np.abs(rates[0]).max(), np.abs(COMMAND).max(), rel_tol=FIRST_ORDER[Engine.PYMUNK])
