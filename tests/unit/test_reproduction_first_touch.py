"""The first touch as a collision: closed form against known limits, the planar model against the closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.config import ContactConfig, MissionConfig
from sim.method.published.parameters import ImpedanceConfig, PublishedConfig
from sim.reproduction.first_touch import (
    TouchState,
    collision,
    damping_ratio,
    effective_mass,
    lever_of,
    planar_touch,
    restitution,
)

LEVER = 0.056


def touching(lever: float = LEVER, spin: float = 1.0) -> TouchState:
    """The square's right face runs into a tip that stands at that lever; the other tip is clear of it."""
    config = MissionConfig()
    offset = config.robot.arm.hand.tip_offset
    hand = np.array([config.target.side / 2 + config.robot.arm.hand.tip_radius, -lever - offset, math.pi / 2])
    return TouchState(hand, np.array([offset, -offset]), np.zeros(3), np.array([0.0, 0.0, spin]))


def impedance(mass: float, damping: float, stiffness: float, friction: float = 0.3) -> MissionConfig:
    law = ImpedanceConfig(mass=mass, damping=damping, stiffness=stiffness)
    return MissionConfig(published=PublishedConfig(impedance=law), contact=ContactConfig(friction=friction))


def test_effective_mass_is_the_mass_through_the_centre_and_less_beside_it():
    assert effective_mass(2.0, 0.01, 0.0) == 2.0
    assert effective_mass(2.0, 0.02, 0.1) == pytest.approx(1.0)


@pytest.mark.parametrize(("ratio", "rebound"), [(0.0, 1.0), (1.0, math.exp(-2.0)), (math.inf, 0.0)])
def test_restitution_limits(ratio, rebound):
    assert restitution(ratio) == pytest.approx(rebound)


def test_restitution_falls_without_a_jump_through_critical_damping():
    values = [restitution(ratio) for ratio in np.linspace(0.0, 4.0, 401)]
    steps = np.diff(values)
    assert (steps < 0.0).all()
    assert np.abs(steps).max() < 0.04


@pytest.mark.parametrize("ratio", [0.2, 0.8, 1.5])
def test_restitution_is_that_of_the_integrated_oscillator(ratio):
    position, velocity, step = 0.0, 1.0, 1e-5
    while True:
        acceleration = -position - 2.0 * ratio * velocity
        if acceleration > 0.0:  # the contact would pull: it has ended
            break
        velocity += step * acceleration
        position += step * velocity
    assert restitution(ratio) == pytest.approx(-velocity, abs=1e-3)


def test_damping_ratio_without_stiffness():
    assert damping_ratio(1.0, 0.0, 1.0) == math.inf
    assert damping_ratio(0.0, 0.0, 1.0) == 0.0
    assert damping_ratio(2.0, 1.0, 1.0) == 1.0


def test_lever_is_that_of_the_tip_at_the_face():
    assert lever_of(touching(), MissionConfig()) == pytest.approx(LEVER)


def test_a_short_hard_touch_is_the_collision_in_closed_form():
    """A stiff hand without friction ends its touch before the face has turned: both models are then one."""
    config = impedance(mass=0.01, damping=3.0, stiffness=800.0, friction=0.0)
    closed, planar = collision(config, LEVER, 0.1), planar_touch(config, touching(spin=0.1))
    assert planar.spin == pytest.approx(closed.spin, abs=0.01)
    assert planar.drift == pytest.approx(closed.drift, rel=0.12)


@pytest.mark.parametrize("spin", [1.0, -1.0])
def test_collision_keeps_the_sign_of_a_spin_that_it_slows(spin):
    left = collision(impedance(0.1, 15.0, 1.0), LEVER, spin)
    assert 0.0 < left.spin / spin < 1.0


def test_more_damping_leaves_more_spin_and_less_drift():
    soft, dead = (planar_touch(impedance(0.1, damping, 60.0), touching()) for damping in (3.0, 15.0))
    assert abs(dead.spin) > abs(soft.spin)
    assert dead.drift < soft.drift
