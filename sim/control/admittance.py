"""Admittance of a hand (eq. 3), integrated exactly for a force held over one control period.

M ddx + D dx + K x = F per axis, solved for velocity, which the generalized Jacobian turns into joint
rates. An explicit update would fail from 1.1 ms on at m = 0.01 kg, d = 15 N s/m; this one cannot.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from sim.compiled import FloatArray, compiled, compiled_inline

_ORDER = 14
"""Of the series of an exponential whose argument is at most an eighth: the rest is below rounding."""


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
    return np.ascontiguousarray(_exponential(dynamics * period)[:2])


@compiled
def _exponential(matrix: FloatArray) -> FloatArray:
    """Of a matrix of shape (3, 3), by its series and squaring (Moler, Van Loan 2003, methods 1 and 3).

    Libraries of linear algebra wake a thread on every core for it, which takes longer than a second of a capture.
    """
    norm = 0.0
    for row in range(3):
        norm = max(norm, abs(matrix[row, 0]) + abs(matrix[row, 1]) + abs(matrix[row, 2]))
    halvings = 0
    while norm > 0.125:
        norm *= 0.5
        halvings += 1
    small = matrix / 2.0**halvings
    result = term = np.eye(3)
    for order in range(1, _ORDER):
        term = _product(term, small) / order
        result = result + term
    for _ in range(halvings):
        result = _product(result, result)
    return result


@compiled
def _product(left: FloatArray, right: FloatArray) -> FloatArray:
    """Of two matrices of shape (3, 3)."""
    product = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            for k in range(3):
                product[i, j] += left[i, k] * right[k, j]
    return product


@compiled_inline
def admitted(transition: FloatArray, displacement: float, velocity: float, force: float) -> tuple[float, float]:
    """Displacement [m] and velocity [m/s] of one axis a period later, under that force [N]."""
    return (
        transition[0, 0] * displacement + transition[0, 1] * velocity + transition[0, 2] * force,
        transition[1, 0] * displacement + transition[1, 1] * velocity + transition[1, 2] * force,
    )
