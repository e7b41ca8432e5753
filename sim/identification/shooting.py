"""Multiple shooting: each stretch is flown from a state of its own, which the readings of the stretch decide.

Of a hypothesis, every stretch has the state that explains it best (Gauss-Newton); what is left are its residuals. How
they change with the hypothesis, states following, is the Jacobian without what states can explain (variable
projection: Golub and Pereyra 1973, in Kaufman's form).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.ndimage import binary_dilation

from sim.compiled import FloatArray
from sim.identification.flight import (
    BASE,
    CHANNELS,
    JOINTS,
    MOUNTS,
    NODE,
    TARGET,
    WRENCHES,
    Flight,
    Seen,
    add_product,
    fly_residual,
    fly_slopes,
    normal_equations,
    product,
)
from sim.identification.parameters import yields
from sim.identification.recording import BoolArray, Recording
from sim.identification.rollout import Model, Predicted
from sim.identification.stretches import Stretch

_STEP = np.array([1e-6, 1e-6, 1e-6, 1e-5, 1e-5, 1e-5] * 2 + [1e-6] * 2)
"""Of each number of a node, for differences."""

_NODE_SPREAD = np.array([0.01, 0.01, 0.05, 0.1, 0.1, 0.5] * 2 + [0.02] * 2)
"""Of a node about what a glance at the readings says: so wide that readings decide."""

_SCALES = np.array([_STEP, _NODE_SPREAD])

_GLANCE = 0.1
"""Of readings by which a node begins [s]."""

_HALVINGS = 6
_STEPS = 10
"""Gauss-Newton steps of a node at most."""
_ENOUGH = 1e-4
"""A step that lowers the misfit by a smaller part of it is the last."""

_ANEW = 0.02
"""After a step that lowers it by a greater part slopes are found again."""
WELL = 2.0
"""A stretch whose misfit is below this is explained well enough to look for no other state."""

UNFELT = 0.02
"""Before a touch is felt it may have begun this long ago [s]."""

LEAST_LEAD = 0.3
"""Less free flight does not tell from where a touch began [s]."""

_AROUND = 0.04
"""So long before and after rows in which the target is near, a touch may begin or end [s]."""


class Weights(NamedTuple):
    """Standard deviations of what is left, by which residuals are divided."""

    base_position: float
    base_angle: float
    target_position: float
    target_angle: float
    joint: float
    force: float
    torque: float

    @property
    def of_channels(self) -> FloatArray:
        """Of each channel of a row, shape (18,)."""
        wrist = [self.force, self.force, self.torque]
        base = [self.base_position, self.base_position, self.base_angle]
        target = [self.target_position, self.target_position, self.target_angle]
        return np.array([*base, *target, *[self.joint] * 6, *wrist, *wrist])


class Solved(NamedTuple):
    """A stretch, flown from the state that explains it best."""

    node: FloatArray
    """Shape (14,)."""
    residual: FloatArray
    """In standard deviations, shape (rows, 18)."""
    jacobian: FloatArray
    """Of residuals and prior by the node's numbers, here or near, shape (rows 18 + 14, numbers)."""
    cost: float
    """Half the sum of squares, with the node's prior."""


class Shot:
    """One stretch of one recording."""

    def __init__(self, recorded: Recording, stretch: Stretch) -> None:
        self.recorded, self.stretch = recorded, stretch
        self.glance = _glance(recorded, stretch)
        self.measured = _measured(recorded, stretch)
        self.known = np.isfinite(self.measured)
        self.touchable = _touchable(recorded, stretch)
        rows = slice(stretch.first, stretch.last)
        untouched = ~recorded.touching[rows] if recorded.gated else np.zeros((stretch.rows, 2), dtype=bool)
        self._seen = Seen(self.measured, self.known, untouched, recorded.threshold)
        self._numbers = NODE if stretch.touches and yields(recorded.config) else MOUNTS.start
        """Of a node that are free: no reading tells how far mounts have turned but those of a touch."""

    def predict(self, model: Model, node: FloatArray) -> Predicted:
        """What the sensors would have read."""
        return model.predict(self.stretch.first, self.touchable, node)

    def residual(self, model: Model, node: FloatArray, weights: FloatArray) -> tuple[FloatArray, float]:
        """What is left of the readings, in standard deviations, shape (rows, 18), and the sum of its squares."""
        left = np.empty((self.stretch.rows, CHANNELS))
        return left, fly_residual(self._flight(model), self._seen, weights, node, left)

    def _flight(self, model: Model) -> Flight:
        return model.flight(self.stretch.first, self.touchable)

    def solve(self, model: Model, before: Solved | None, weights: FloatArray) -> Solved:
        """The state that explains the stretch best.

        Args:
            model: the hypothesis.
            before: what was found under one nearby, with the same weights; None begins with a glance at the readings.
            weights: standard deviations of the channels, shape (18,).

        """
        if before is None:
            return self._descended(model, self.glance, weights)
        return self._descended(model, before.node, weights, before.jacobian)

    def glanced(self, model: Model, weights: FloatArray) -> Solved:
        """The stretch from a glance at its readings, and no state looked for."""
        residual, squares = self.residual(model, self.glance, weights)
        nothing = np.empty((residual.size + NODE, 0))
        return Solved(self.glance, residual, nothing, self._cost(squares, self.glance))

    def reweighed(self, solved: Solved, ratio: FloatArray) -> Solved:
        """The same under other weights; readings that are no longer known count no more.

        Args:
            solved: with the former weights.
            ratio: of the former weights to the new ones, shape (18,).

        """
        factors = self.known * ratio
        residual = solved.residual * factors
        jacobian = solved.jacobian.copy()
        jacobian[: residual.size] *= factors.reshape(-1, 1)
        squares = float(np.einsum("ij,ij", residual, residual))
        return Solved(solved.node, residual, jacobian, self._cost(squares, solved.node))

    def better(self, model: Model, found: Solved, guess: FloatArray, weights: FloatArray) -> Solved:
        """The state found, or one from another guess if that explains the stretch better."""
        if self.misfit(found) < WELL or not np.isfinite(guess).all():
            return found
        other = self._descended(model, guess, weights)
        return other if other.cost < found.cost else found

    def misfit(self, solved: Solved) -> float:
        """Mean square of what is left of the readings; 1 where weights are right."""
        return 2.0 * solved.cost / max(1, self.readings)

    @property
    def readings(self) -> int:
        """How many numbers the stretch is explained by."""
        count = int(self.known[:, : JOINTS.stop].sum())
        if not self.recorded.gated:
            return count + int(self.known[:, WRENCHES].sum())
        return count + 3 * int(self.recorded.touching[self.stretch.first : self.stretch.last].sum())

    def lead(self) -> Shot | None:
        """The free flight before the touch as a stretch of its own; None if there is too little of it."""
        period, stretch = self.recorded.period, self.stretch
        end = stretch.onset - round(UNFELT / period)
        if not stretch.touches or end - stretch.first < round(LEAST_LEAD / period):
            return None
        return Shot(self.recorded, Stretch(stretch.first, end, False, end))

    def _descended(
        self, model: Model, node: FloatArray, weights: FloatArray, jacobian: FloatArray | None = None
    ) -> Solved:
        """Gauss-Newton from a node; with slopes from nearby as long as they do, which spares most rollouts."""
        residual, squares = self.residual(model, node, weights)
        cost, fresh = self._cost(squares, node), jacobian is None
        slopes = self._jacobian(model, node, residual, weights) if jacobian is None else jacobian
        for _ in range(_STEPS):
            curvature, toward = self._normal(slopes, residual, node)
            tried = self._try(model, node, np.linalg.solve(curvature, -toward).astype(np.float64), weights, cost)
            gained = 0.0 if tried is None else cost - tried[2]
            if tried is not None:
                node, residual, cost = tried
            if gained < _ENOUGH * cost and (fresh or tried is not None):
                break
            if gained > _ANEW * cost or tried is None:
                slopes, fresh = self._jacobian(model, node, residual, weights), True
        return Solved(node, residual, slopes, cost)

    def _try(
        self, model: Model, node: FloatArray, step: FloatArray, weights: FloatArray, cost: float
    ) -> tuple[FloatArray, FloatArray, float] | None:
        """The step, or the largest half of halves of it that lowers the misfit."""
        for _ in range(_HALVINGS):
            moved = node.copy()
            moved[: len(step)] += step
            residual, squares = self.residual(model, moved, weights)
            found = self._cost(squares, moved)
            if found < cost:
                return moved, residual, found
            step = 0.5 * step
        return None

    def _cost(self, squares: float, node: FloatArray) -> float:
        away = (node - self.glance) / _NODE_SPREAD
        return 0.5 * (squares + float(away @ away))

    def _normal(self, slopes: FloatArray, residual: FloatArray, node: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Square of the slopes, and slopes by residuals, the prior's among them."""
        left = np.concatenate([residual.ravel(), (node - self.glance) / _NODE_SPREAD])
        numbers = slopes.shape[1]
        curvature, gradient = np.zeros((numbers, numbers)), np.zeros(numbers)
        normal_equations(slopes, left, curvature, gradient)
        return curvature, gradient

    def _jacobian(self, model: Model, node: FloatArray, residual: FloatArray, weights: FloatArray) -> FloatArray:
        """Of residuals and prior by the node's numbers, by differences, shape (rows 18 + 14, numbers)."""
        slopes = np.empty((residual.size + NODE, self._numbers))
        fly_slopes(self._flight(model), self._seen, weights, node, residual, _SCALES, slopes)
        return slopes


def projected(solved: Solved, slopes: FloatArray) -> FloatArray:
    """How residuals change while the node follows, shape (rows 18, parameters).

    Args:
        solved: the stretch.
        slopes: how they change with the node as it is, shape (rows 18, parameters).

    """
    jacobian, numbers, parameters = solved.jacobian, solved.jacobian.shape[1], slopes.shape[1]
    curvature, followed = np.zeros((numbers, numbers)), np.empty((numbers, parameters))
    normal_equations(jacobian, np.zeros(len(jacobian)), curvature, np.zeros(numbers))
    product(jacobian, slopes, followed)
    result = slopes.copy()
    add_product(jacobian, -np.linalg.solve(curvature, followed).astype(np.float64), result)
    return result


def _measured(recorded: Recording, stretch: Stretch) -> FloatArray:
    """All readings of a stretch, shape (rows, 18); not a number where there is none."""
    rows = slice(stretch.first, stretch.last)
    measured = np.empty((stretch.rows, CHANNELS))
    measured[:, BASE], measured[:, TARGET] = recorded.base_pose[rows], recorded.target_pose[rows]
    measured[:, JOINTS] = recorded.joint_angle[rows].reshape(-1, 6)
    measured[:, WRENCHES] = recorded.wrench[rows].reshape(-1, 6)
    return measured


def _touchable(recorded: Recording, stretch: Stretch) -> BoolArray:
    """Whether the robot may touch the target from each row of a stretch to the next, shape (rows,)."""
    if not stretch.touches:
        return np.zeros(stretch.rows, dtype=bool)
    around = round(_AROUND / recorded.period)
    near = recorded.near | recorded.touching.any(axis=1)
    spread: BoolArray = binary_dilation(near, iterations=around)[stretch.first : stretch.last]
    return spread


def _glance(recorded: Recording, stretch: Stretch) -> FloatArray:
    """A node as the first readings say, by straight lines through them, shape (14,)."""
    node = np.zeros(NODE)
    node[MOUNTS] = recorded.mount_angle[stretch.first]
    rows = slice(stretch.first, min(stretch.last, stretch.first + max(4, round(_GLANCE / recorded.period))))
    time = recorded.time[rows] - recorded.time[stretch.first]
    for start, pose in ((0, recorded.base_pose), (6, recorded.target_pose)):
        for axis in range(3):
            value = pose[rows, axis]
            seen = np.isfinite(value)
            if seen.sum() >= 3:
                slope, place = np.polyfit(time[seen], value[seen], 1)
                node[start + axis], node[start + 3 + axis] = place, slope
            else:
                node[start + axis] = _nearest(pose[:, axis], stretch.first)
    return node


def _nearest(values: FloatArray, row: int) -> float:
    """The known value nearest to that row; 0 where none is known."""
    known = np.flatnonzero(np.isfinite(values))
    return float(values[known[np.argmin(np.abs(known - row))]]) if len(known) else 0.0
