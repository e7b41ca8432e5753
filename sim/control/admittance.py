"""Admittance of a hand (eq. 3), integrated exactly for a force held over one control period.

M ddx + D dx + K x = F per axis, solved for velocity, which the generalized Jacobian turns into joint
rates. An explicit update would fail from 1.1 ms on at m = 0.01 kg, d = 15 N s/m; this one cannot.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
import scipy

from sim.compiled import FloatArray, compiled


class Impedance(Protocol):
    """What a hand under admittance behaves like."""

    @property
    def mass(self) -> float:
        """Virtual mass [kg]."""
        ...

    @property
    def damping(self) -> float:
        """[N s/m]."""
        ...

    @property
    def stiffness(self) -> float:
        """[N/m]."""
        ...


def admittance_transition(impedance: Impedance, period: float) -> FloatArray:
    """The exact step of eq. 3 over one period [s] (zero-order hold), shape (2, 3).

    Rows: displacement [m], velocity [m/s] after it; columns: both before it, and the force [N].
    """
    m, d, k = impedance.mass, impedance.damping, impedance.stiffness
    dynamics = np.array([[0.0, 1.0, 0.0], [-k / m, -d / m, 1.0 / m], [0.0, 0.0, 0.0]])
    transition: FloatArray = scipy.linalg.expm(dynamics * period)
    return np.ascontiguousarray(transition[:2])


@compiled
def admitted(transition: FloatArray, displacement: float, velocity: float, force: float) -> tuple[float, float]:
    """Displacement [m] and velocity [m/s] of one axis a period later, under that force [N]."""
    return (
        transition[0, 0] * displacement + transition[0, 1] * velocity + transition[0, 2] * force,
        transition[1, 0] * displacement + transition[1, 1] * velocity + transition[1, 2] * force,
    )
