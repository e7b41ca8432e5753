"""Rollouts of the reduced plant under recorded commands, and what the sensors would have read of them."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from scipy.signal import lfilter

from sim.compiled import FloatArray, compiled
from sim.config import Engine, MissionConfig, SimulationConfig
from sim.identification.parameters import Hypothesis, changed
from sim.identification.recording import Recording, commands_at
from sim.plant.plant import PLANT_STATE, PlantHandle, advance_plant
from sim.plant.reduced_plant import ReducedHandle, ReducedPlant, stand
from sim.record import Record

NODE = 14
"""Numbers that a rollout begins with: pose and twist of the base, of the target, and the mounts' angles."""
MOUNTS = slice(12, 14)

_BASE, _BASE_TWIST, _TARGET, _TARGET_TWIST = slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 12)
_JOINTS, _WRENCH, _HAND = slice(12, 18), slice(18, 24), slice(24, 26)
_MOUNT = slice(26, 28)
_COLUMNS = 28


class Predicted(NamedTuple):
    """What the sensors would have read; arrays lead with the row."""

    base_pose: FloatArray
    """Shape (rows, 3), as late as the recorded ones."""
    target_pose: FloatArray
    joint_angle: FloatArray
    """Shape (rows, 6)."""
    wrench: FloatArray
    """Shape (rows, 2, 3), world axes, with gain and bias."""
    force: FloatArray
    """Size of the true force on each hand [N], shape (rows, 2)."""
    end: FloatArray
    """The node of the last row, shape (14,)."""
    finite: bool
    """Whether the rollout stayed within numbers."""


@compiled
def roll(
    handle: PlantHandle, parameters: Record, where: Record, rates: FloatArray, state: Record, rows: FloatArray
) -> int:
    """Fly from a state under joint rates, one row of them a control period.

    Args:
        handle: of the reduced plant; changed.
        parameters: record of the configuration.
        where: the state to begin with, one element of `PLANT_STATE`.
        rates: joint rates [rad/s], shape (rows, 2, 3); the last is not flown.
        state: one element of `PLANT_STATE`, to work with.
        rows: shape (rows, 28); written: the state at each row's instant.

    Returns:
        How many rows are finite.

    """
    stand(handle, parameters, where, state)
    for row in range(rows.shape[0]):
        into = rows[row]
        for axis in range(3):
            into[axis], into[3 + axis] = state.base_pose[axis], state.base_twist[axis]
            into[6 + axis], into[9 + axis] = state.target_pose[axis], state.target_twist[axis]
            for arm in range(2):
                into[12 + 3 * arm + axis] = state.joint_angle[arm, axis]
                into[18 + 3 * arm + axis] = state.hand_wrench[arm, axis]
        for arm in range(2):
            angle = state.base_pose[2] + state.mount_angle[arm]
            for joint in range(3):
                angle += state.joint_angle[arm, joint]
            into[24 + arm], into[26 + arm] = angle, state.mount_angle[arm]
        if row + 1 < rows.shape[0] and not advance_plant(handle, parameters, rates[row], state):
            return row + 1
    return int(rows.shape[0])


class Model:
    """A hypothesis, ready to be flown from any row of one recording. For any thread: each rollout has its own plant."""

    def __init__(self, recorded: Recording, truth: Hypothesis) -> None:
        self.recorded = recorded
        self.truth = truth
        config = _flown(truth.config)
        self._touching = ReducedPlant(config, truth.table)
        # Without contact a step of a whole period is as good: all that is integrated then is the base's turn.
        self._free = ReducedPlant(changed(config, {"simulation.time_step": config.control.period}), truth.table)
        self._rates = commands_at(recorded, truth.command_delay)

    def predict(self, first: int, last: int, node: FloatArray, *, touches: bool = True) -> Predicted:
        """What the sensors would have read in rows `first` to `last` (excluded), had the first been at that node.

        Args:
            first: row that the node is of.
            last: row after the last.
            node: base pose and twist, target pose and twist, mounts' angles, shape (14,).
            touches: whether hands may touch.

        """
        rows = np.full((last - first, _COLUMNS), np.nan)
        state = np.zeros(2, PLANT_STATE)
        self._place(state[0], first, node)
        plant = self._touching if touches else self._free
        handle = ReducedHandle(plant.handle.plant.copy())
        count = roll(handle, plant.parameters, state[0], self._rates[first:last], state[1], rows)
        if count < len(rows):
            rows[count:] = np.nan
        return self._read(rows)

    def _place(self, state: Any, first: int, node: FloatArray) -> None:
        state["base_pose"], state["base_twist"] = node[_BASE], node[_BASE_TWIST]
        state["target_pose"], state["target_twist"] = node[_TARGET], node[_TARGET_TWIST]
        state["joint_angle"] = self.recorded.joint_angle[first]
        state["joint_rate"] = joint_rates_at(self.recorded, first)
        state["mount_angle"] = node[MOUNTS]

    def _read(self, rows: FloatArray) -> Predicted:
        """What gain, bias, smoothing and lag make of a rollout."""
        wrench = rows[:, _WRENCH].reshape(-1, 2, 3).copy()
        force = np.hypot(wrench[..., 0], wrench[..., 1])
        if self.recorded.smoothing > 0.0:
            wrench = _smoothed(wrench, self.recorded.period, self.recorded.smoothing)
        for arm in range(2):
            cosine, sine = np.cos(rows[:, _HAND][:, arm]), np.sin(rows[:, _HAND][:, arm])
            x, y, torque = self.truth.bias[arm]
            wrench[:, arm] *= self.truth.gain[arm]
            wrench[:, arm] += np.stack(
                [cosine * x - sine * y, sine * x + cosine * y, np.full(len(rows), torque)], axis=1
            )
        lag, period = self.truth.pose_lag, self.recorded.period
        return Predicted(
            base_pose=_late(rows[:, _BASE], rows[:, _BASE_TWIST], lag, period),
            target_pose=_late(rows[:, _TARGET], rows[:, _TARGET_TWIST], lag, period),
            joint_angle=rows[:, _JOINTS],
            wrench=wrench,
            force=force,
            end=np.concatenate([rows[-1, : _TARGET_TWIST.stop], rows[-1, _MOUNT]]),
            finite=bool(np.isfinite(rows).all()),
        )


def joint_rates_at(recorded: Recording, row: int) -> FloatArray:
    """Joint rates at a row from the angles beside it [rad/s], shape (2, 3)."""
    angle, segment = recorded.joint_angle, recorded.segment
    before = row - 1 if row > 0 and segment[row - 1] == segment[row] else row
    after = row + 1 if row + 1 < len(angle) and segment[row + 1] == segment[row] else row
    if after == before:
        return np.zeros((2, 3))
    rate: FloatArray = (angle[after] - angle[before]) / (recorded.period * (after - before))
    return np.nan_to_num(rate)


def _flown(config: MissionConfig) -> MissionConfig:
    """As the reduced plant flies it; a table may take momentum, and a wild guess of a fit is no fault of a plant."""
    own = SimulationConfig.model_fields
    update: dict[str, Any] = {
        name: own[name].default for name in ("solver_iterations", "joint_error_time", "collision_slop")
    }
    update |= {"engine": Engine.REDUCED, "momentum_jump_limit": 1e6}
    return config.model_copy(update={"simulation": config.simulation.model_copy(update=update)})


def _late(pose: FloatArray, twist: FloatArray, lag: float, period: float) -> FloatArray:
    """Poses that long ago [s], shape (rows, 3); before the first row as its twist says."""
    if lag == 0.0:
        return pose
    place = np.arange(len(pose)) - lag / period
    start = np.clip(np.floor(place).astype(int), 0, max(0, len(pose) - 2))
    part = (place - start)[:, None]
    inside = pose[start] + part * (pose[np.minimum(start + 1, len(pose) - 1)] - pose[start])
    outside = pose[0] + (place * period)[:, None] * twist[0]
    result: FloatArray = np.where((place < 0.0)[:, None], outside, inside)
    return result


def _smoothed(wrench: FloatArray, period: float, time_constant: float) -> FloatArray:
    """Wrenches behind a first-order filter, as `sim.perception.wrists` smooths them, from the first row's value on."""
    part = 1.0 - math.exp(-period / time_constant)
    start = (1.0 - part) * wrench[:1]
    result: FloatArray = lfilter([part], [1.0, part - 1.0], wrench, axis=0, zi=start)[0]
    return result
