"""The impedance law, integrated exactly over a period (eq. 3)."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from sim.compiled import FloatArray
from sim.control.admittance import admittance_transition, admitted
from sim.method.published.parameters import ImpedanceConfig

PERIOD = 1e-3
AGAINST_INTEGRATION = 1e-9
"""Relative to the largest value: the tolerance that the integrator is asked for is 1e-12."""
compiling = settings(deadline=None)  # the first example may compile

EXTREMES = list(itertools.product([0.01, 0.1, 0.5], [0.0, 1.5, 15.0], [0.0, 10.0, 100.0]))
"""Of the paper's study: mass [kg], damping [N s/m], stiffness [N/m]."""


def stepped(impedance: ImpedanceConfig, displacement: float, velocity: float, forces, period=PERIOD):
    transition = admittance_transition(impedance, period)
    for force in forces:
        displacement, velocity = admitted(transition, displacement, velocity, float(force))
    return np.array([displacement, velocity])


def _oscillator(_time: float, state: FloatArray, m: float, d: float, k: float, force: float) -> FloatArray:
    return np.array([state[1], (force - d * state[1] - k * state[0]) / m])


def integrated(impedance: ImpedanceConfig, displacement: float, velocity: float, forces, period=PERIOD):
    """The same by a general-purpose integrator, a period at a time."""
    m, d, k = impedance.mass, impedance.damping, impedance.stiffness
    state = np.array([displacement, velocity])
    for force in forces:
        solution = solve_ivp(
            _oscillator, (0.0, period), state, method="DOP853", rtol=1e-12, atol=1e-15, args=(m, d, k, force)
        )
        state = solution.y[:, -1]
    return state


@pytest.mark.parametrize(("mass", "damping", "stiffness"), EXTREMES)
def test_step_is_exact_for_a_held_force(mass, damping, stiffness):
    impedance = ImpedanceConfig(mass=mass, damping=damping, stiffness=stiffness)
    forces = np.sin(np.arange(20) / 3.0)
    ours, theirs = (of(impedance, 0.003, -0.02, forces) for of in (stepped, integrated))
    assert np.abs(ours - theirs).max() < AGAINST_INTEGRATION * np.abs(theirs).max()


def test_step_is_exact_where_an_explicit_one_fails():
    """m 0.01, d 15 at 2 ms: explicit Euler multiplies the velocity by -2 a step."""
    impedance = ImpedanceConfig(mass=0.01, damping=15.0, stiffness=0.0)
    ours = stepped(impedance, 0.0, 0.1, np.zeros(50), period=2e-3)
    assert abs(ours[1]) < 1e-12
    assert ours[0] == pytest.approx(0.1 * 0.01 / 15.0)


def test_half_periods_compose_to_whole_ones():
    impedance = ImpedanceConfig()
    assert stepped(impedance, 0.01, 0.1, [0.5] * 20, PERIOD / 2) == pytest.approx(
        stepped(impedance, 0.01, 0.1, [0.5] * 10, PERIOD), rel=1e-12
    )


@compiling
@given(st.sampled_from(EXTREMES), st.floats(-0.1, 0.1), st.floats(-1.0, 1.0))
def test_never_gains_energy_without_force(numbers, displacement, velocity):
    mass, damping, stiffness = numbers
    impedance = ImpedanceConfig(mass=mass, damping=damping, stiffness=stiffness)

    def energy(state):
        return 0.5 * mass * state[1] ** 2 + 0.5 * stiffness * state[0] ** 2

    before = energy([displacement, velocity])
    assert energy(stepped(impedance, displacement, velocity, [0.0])) <= before * (1 + 1e-12) + 1e-300


@pytest.mark.parametrize(("damping", "stiffness"), [(1.5, 10.0), (15.0, 100.0)])
def test_settles_where_the_spring_holds_the_force(damping, stiffness):
    impedance = ImpedanceConfig(mass=0.1, damping=damping, stiffness=stiffness)
    assert stepped(impedance, 0.0, 0.0, [0.5] * 20_000) == pytest.approx([0.5 / stiffness, 0.0], abs=1e-6)


def test_without_a_spring_it_drifts_at_force_over_damping():
    impedance = ImpedanceConfig(mass=0.1, damping=2.0, stiffness=0.0)
    assert stepped(impedance, 0.0, 0.0, [0.5] * 5000)[1] == pytest.approx(0.25, rel=1e-9)


@pytest.mark.parametrize(
    "change", [{"mass": 0.5}, {"damping": 15.0}, {"stiffness": 100.0}, {"mass": 0.02, "damping": 0.0}]
)
def test_a_change_of_impedance_does_not_jump_the_velocity(change):
    """After it the velocity moves by no more than one period of the new impedance's largest acceleration."""
    before = stepped(ImpedanceConfig(), 0.0, 0.0, [0.3] * 40)
    impedance = ImpedanceConfig(**change)
    after = stepped(impedance, before[0], before[1], [0.3])
    drive = 0.3 + impedance.damping * abs(before[1]) + impedance.stiffness * abs(before[0])
    assert abs(after[1] - before[1]) <= PERIOD * drive / impedance.mass
