"""Multiple shooting: each stretch is flown from a state of its own, which the readings of the stretch decide.

Of a hypothesis, every stretch has the state that explains it best (Gauss-Newton); what is left are its residuals. How
they change with the hypothesis, states following, is the Jacobian without what states can explain (variable
projection: Golub and Pereyra 1973, in Kaufman's form).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sim.compiled import FloatArray
from sim.identification.parameters import yields
from sim.identification.recording import Recording
from sim.identification.rollout import MOUNTS, NODE, Model, Predicted
from sim.identification.stretches import Stretch

CHANNELS = 18
"""Of a row: base pose, target pose, six joints, two wrenches."""
BASE, TARGET, JOINTS, WRENCHES = slice(0, 3), slice(3, 6), slice(6, 12), slice(12, 18)

_STEP = np.array([1e-6, 1e-6, 1e-6, 1e-5, 1e-5, 1e-5] * 2 + [1e-6] * 2)
"""Of each number of a node, for differences."""

_NODE_SPREAD = np.array([0.01, 0.01, 0.05, 0.1, 0.1, 0.5] * 2 + [0.02] * 2)
"""Of a node about what a glance at the readings says: so wide that readings decide."""

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

_LOST = 1e3
"""Residual of a rollout that left all numbers, in standard deviations."""


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
    basis: FloatArray
    """Orthonormal columns: what the node can change of residuals and prior, shape (rows 18 + 14, numbers)."""
    jacobian: FloatArray
    """Of residuals and prior by the node's numbers, here or near, shape (rows 18 + 14, numbers)."""
    cost: float
    """Half the sum of squares, with the node's prior."""


class Shot:
    """One stretch of one recording."""

    def __init__(self, recorded: Recording, stretch: Stretch) -> None:
        self.recorded, self.stretch = recorded, stretch
        self.glance = _glance(recorded, stretch)
        rows = slice(stretch.first, stretch.last)
        self.measured = np.concatenate(
            [
                recorded.base_pose[rows],
                recorded.target_pose[rows],
                recorded.joint_angle[rows].reshape(-1, 6),
                recorded.wrench[rows].reshape(-1, 6),
            ],
            axis=1,
        )
        self.known = np.isfinite(self.measured)
        self._columns = _columns(stretch.touches, stretch.touches and yields(recorded.config))

    def predict(self, model: Model, node: FloatArray) -> Predicted:
        """What the sensors would have read."""
        return model.predict(self.stretch.first, self.stretch.last, node, touches=self.stretch.touches)

    def residual(self, predicted: Predicted, weights: FloatArray) -> FloatArray:
        """Predicted less measured in standard deviations, shape (rows, 18); zero where nothing was measured.

        The joints' mean is taken out: the offset of an encoder reading at the node is none of the motion.
        """
        if not predicted.finite:
            return np.full((self.stretch.rows, CHANNELS), _LOST)
        residual = np.empty((self.stretch.rows, CHANNELS))
        residual[:, BASE], residual[:, TARGET] = predicted.base_pose, predicted.target_pose
        residual[:, JOINTS] = predicted.joint_angle
        residual[:, WRENCHES] = predicted.wrench.reshape(-1, 6)
        residual -= self.measured
        if self.recorded.gated:
            self._gate(residual, predicted)
        residual[~self.known] = 0.0
        count = np.maximum(1, self.known[:, JOINTS].sum(axis=0))
        residual[:, JOINTS] -= np.where(self.known[:, JOINTS], residual[:, JOINTS].sum(axis=0) / count, 0.0)
        residual /= weights
        return residual

    def _gate(self, residual: FloatArray, predicted: Predicted) -> None:
        """Where no touch was felt a wrench says no more than that the force was under the threshold."""
        rows = slice(self.stretch.first, self.stretch.last)
        for arm in range(2):
            untouched = ~self.recorded.touching[rows, arm]
            force = np.hypot(predicted.wrench[:, arm, 0], predicted.wrench[:, arm, 1])
            excess = np.maximum(0.0, 1.0 - self.recorded.threshold / np.maximum(force, 1e-12))
            wrench = predicted.wrench[:, arm] * excess[:, None]
            wrench[:, 2] = 0.0
            residual[untouched, 12 + 3 * arm : 15 + 3 * arm] = wrench[untouched]

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
        residual = self.residual(self.predict(model, node), weights)
        cost, fresh = self._cost(residual, node), jacobian is None
        slopes = self._jacobian(model, node, residual, weights) if jacobian is None else jacobian
        for _ in range(_STEPS):
            toward = slopes.T @ self._with_prior(residual, node)
            step = np.linalg.solve(slopes.T @ slopes, -toward).astype(np.float64)
            tried = self._try(model, node, step, weights, cost)
            gained = 0.0 if tried is None else cost - tried[2]
            if tried is not None:
                node, residual, cost = tried
            if gained < _ENOUGH * cost and (fresh or tried is not None):
                break
            if gained > _ANEW * cost or tried is None:
                slopes, fresh = self._jacobian(model, node, residual, weights), True
        # By Cholesky: many times as fast as QR of a tall matrix, and the prior keeps it well conditioned.
        triangle = np.linalg.cholesky(slopes.T @ slopes)
        return Solved(node, residual, np.linalg.solve(triangle, slopes.T).T, slopes, cost)

    def _try(
        self, model: Model, node: FloatArray, step: FloatArray, weights: FloatArray, cost: float
    ) -> tuple[FloatArray, FloatArray, float] | None:
        """The step, or the largest half of halves of it that lowers the misfit."""
        for _ in range(_HALVINGS):
            moved = node.copy()
            moved[: len(step)] += step
            residual = self.residual(self.predict(model, moved), weights)
            found = self._cost(residual, moved)
            if found < cost:
                return moved, residual, found
            step = 0.5 * step
        return None

    def _cost(self, residual: FloatArray, node: FloatArray) -> float:
        away = (node - self.glance) / _NODE_SPREAD
        return 0.5 * float(np.vdot(residual, residual) + away @ away)

    def _with_prior(self, residual: FloatArray, node: FloatArray) -> FloatArray:
        return np.concatenate([residual.ravel(), (node - self.glance) / _NODE_SPREAD])

    def _jacobian(self, model: Model, node: FloatArray, residual: FloatArray, weights: FloatArray) -> FloatArray:
        """Of residuals and prior by the node's numbers, by differences, shape (rows 18 + 14, numbers).

        In free flight base and target know nothing of each other: one rollout moves both.
        """
        count = max(max(together) for together in self._columns) + 1
        slopes = np.zeros((*residual.shape, count))
        for together in self._columns:
            moved = node.copy()
            moved[list(together)] += _STEP[list(together)]
            changed = self.residual(self.predict(model, moved), weights) - residual
            if len(together) == 1:
                slopes[..., together[0]] = changed / _STEP[together[0]]
                continue
            base, target = together
            slopes[:, BASE, base] = changed[:, BASE] / _STEP[base]
            slopes[:, TARGET, target] = changed[:, TARGET] / _STEP[target]
        prior = np.zeros((NODE, count))
        prior[np.arange(count), np.arange(count)] = 1.0 / _NODE_SPREAD[:count]
        return np.concatenate([slopes.reshape(-1, count), prior])


def projected(solved: Solved, slopes: FloatArray) -> FloatArray:
    """How residuals change while the node follows, shape (rows 18, parameters).

    Args:
        solved: the stretch.
        slopes: how they change with the node as it is, shape (rows 18, parameters).

    """
    rows = len(slopes)
    basis = solved.basis
    result: FloatArray = slopes - basis[:rows] @ (basis[:rows].T @ slopes)
    return result


def _columns(touches: bool, mounts: bool) -> Sequence[tuple[int, ...]]:
    """Which numbers of a node are moved, and which of them at once."""
    if not touches:
        return [(axis, axis + 6) for axis in range(6)]
    return [(number,) for number in range(NODE if mounts else MOUNTS.start)]


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
