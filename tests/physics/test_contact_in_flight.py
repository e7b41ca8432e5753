"""The contact law at work in the plant: momentum, energy, action and reaction, sliding friction."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.config import Engine, MissionConfig
from sim.configurations import nested, revised
from sim.plant.plant import Plant
from tests.flying import after, laid_out

MOMENTUM_IN_CONTACT = 1e-6
"""Of the size of the momentum (mission.md): forces act in opposite pairs at one point."""
JUMP_OF_JOINT_RATES = 5e-5
"""Of its size, over a whole capture. Where absorbing ends the published method cuts the commanded joint rates
to zero at once; pymunk's solver then leaves 1e-8 to 1e-7 N m s, which no contact has to do with."""
BOUNCE_ENERGY = 2e-4
"""Relative, of one undamped bounce at 1 ms. Pymunk's plant: the force at the predicted pose makes the step symplectic
(findings: +1.4e-4; at the present pose it would be +8.5e-2). The reduced one: what the steps miss in which the tips
meet and leave the face, up to (omega h)^2 / 4 = 1.7e-4 each way, omega that of target and two springs."""
BOUNCE_ENERGY_AT_HALF_A_STEP = 5e-5
"""The same of the reduced plant at 0.5 ms: a quarter."""
MOMENTUM_IN_REDUCED_PLANT = 1e-9
"""Of its size, over a whole capture with all its jumps of joint rates."""
REDUCED = {"simulation.engine": "reduced"}
SAME_FORCE = 1e-9
"""[N s]: rounding of the momentum of ten bodies over a step."""


def spin_momentum(flown) -> float:
    """Size of the total momentum: the target's spin at the start [N m s]."""
    return float(np.abs(flown.ticks["momentum"][0]).max())


def largest_change(ticks) -> float:
    return float(np.abs(ticks["momentum"] - ticks["momentum"][0]).max())


def test_momentum_is_held_over_direct_caging(fly):
    flown = fly("published", direct=True)
    assert largest_change(flown.ticks) < MOMENTUM_IN_CONTACT * spin_momentum(flown)
    assert flown.outcome.momentum_error < 3 * MOMENTUM_IN_CONTACT * spin_momentum(flown)


@pytest.mark.parametrize("name", ["published", "published_figures"])
def test_momentum_is_held_over_whole_captures_of_the_reduced_plant(fly, name):
    """Half of each contact's impulse at the start of a step, half at its end, alike for robot and target."""
    flown = fly(name, changes=REDUCED)
    assert len(flown.outcome.contacts) > 2
    assert largest_change(flown.ticks) < MOMENTUM_IN_REDUCED_PLANT * spin_momentum(flown)


@pytest.mark.parametrize("name", ["published", "published_figures"])
def test_momentum_is_held_during_the_first_touch(fly, name):
    flown = fly(name)
    touch = flown.outcome.contacts[0]
    time = flown.ticks["time"]
    # The joint rates jump where absorbing ends, 0.28 s after the last contact; see the next test.
    during = flown.ticks[(time >= touch.start - 0.5) & (time <= touch.end)]
    assert largest_change(during) < MOMENTUM_IN_CONTACT * spin_momentum(flown)


@pytest.mark.parametrize("name", ["published", "published_figures"])
def test_momentum_over_a_whole_capture_with_its_jumps_of_joint_rates(fly, name):
    flown = fly(name)
    assert np.abs(flown.ticks["momentum"][:, :2]).max() < 1e-12
    assert largest_change(flown.ticks) < JUMP_OF_JOINT_RATES * spin_momentum(flown)


def test_target_is_pushed_by_what_the_hands_feel(fly):
    """Newton's third law, tick by tick: the target's change of momentum is minus the hands' wrenches."""
    flown = fly("published_figures")
    ticks, period = flown.ticks, MissionConfig().control.period
    target = MissionConfig().target
    impulse = -ticks["hand_wrench"][1:, :, :2].sum(axis=1) * period
    gained = target.mass * np.diff(ticks["target_twist"][:, :2], axis=0)
    solid = ticks["solid_contact"][1:].astype(bool) | ticks["solid_contact"][:-1].astype(bool)
    assert np.abs(gained - impulse)[~solid].max() < SAME_FORCE


def test_hand_wrench_is_the_sum_of_its_tips(fly):
    ticks = fly("published").ticks
    assert np.allclose(ticks["tip_force"].sum(axis=2), ticks["hand_wrench"][..., :2], rtol=0.0, atol=1e-12)


@pytest.mark.parametrize(("name", "friction"), [("published", 0.3), ("as_printed", 0.1)])
def test_forces_stay_in_the_friction_cone_and_never_pull(fly, name, friction):
    """On the faces' normals as the target turns: F_n >= 0 along one of them, |F_t| <= mu F_n."""
    ticks = fly(name).ticks
    angle = ticks["target_pose"][:, 2][:, None, None]
    force = ticks["tip_force"]
    along = np.cos(angle) * force[..., 0] + np.sin(angle) * force[..., 1]
    across = -np.sin(angle) * force[..., 0] + np.cos(angle) * force[..., 1]
    normal = np.maximum(np.abs(along), np.abs(across))
    sliding = np.minimum(np.abs(along), np.abs(across))
    touching = normal > 1e-6
    # The force was computed a step before at the predicted angle, which differs by the spin's change in a step.
    assert (sliding[touching] <= (friction + 1e-3) * normal[touching]).all()


def bounce(engine: Engine, damping: float, side: float = 1.0, step: float = 1e-3) -> tuple[float, float]:
    """Energy of target and robot before and after the target strikes both tips of a hand head on [J]."""
    config = revised(
        MissionConfig(),
        nested({
            "simulation.time_step": step,
            "robot.base.mass": 1e4,
            "robot.base.inertia": 250.0,
            "robot.servo.time_constant": 0.0,
            "robot.servo.torque_limit": 1e3,
            "target.initial_x": side * 0.10,
            "target.initial_y": 0.385,
            "target.initial_velocity_x": side * 0.10,
            "target.initial_spin": 0.0,
            "contact.friction": 0.0,
            "contact.damping": damping,
        }),
    )  # fmt: skip
    plant = laid_out(engine, config)
    before = energy(plant, config)
    touched = False
    for _ in range(1000):
        state = after(plant, np.zeros((2, 3)))
        touching = bool(state["tip_contact"].any())
        if touched and not touching:
            return before, energy(plant, config)
        touched = touched or touching
    raise AssertionError("the target never left the hand")


def energy(plant: Plant, config: MissionConfig) -> float:
    """Kinetic energy of target and base; the arms are at rest on a base 4000 times as heavy."""
    state, base, target = plant.state, config.robot.base, config.target
    total = 0.0
    for body, twist in ((base, state["base_twist"]), (target, state["target_twist"])):
        total += 0.5 * body.mass * math.hypot(twist[0], twist[1]) ** 2 + 0.5 * body.inertia * twist[2] ** 2
    return float(total)


@pytest.mark.parametrize("side", [1.0, -1.0], ids=["right hand", "left hand"])
@pytest.mark.parametrize("engine", list(Engine))
def test_undamped_bounce_keeps_its_energy(engine, side):
    before, after = bounce(engine, 0.0, side)
    assert after == pytest.approx(before, rel=BOUNCE_ENERGY)


def test_undamped_bounce_of_the_reduced_plant_at_half_a_step():
    before, after = bounce(Engine.REDUCED, 0.0, step=0.5e-3)
    assert after == pytest.approx(before, rel=BOUNCE_ENERGY_AT_HALF_A_STEP)


@pytest.mark.parametrize("engine", list(Engine))
def test_damped_bounce_loses_energy(engine):
    before, after = bounce(engine, 2.0)
    assert 0.5 * before < after < 0.95 * before
