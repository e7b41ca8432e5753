"""Hypotheses, ready to be flown under a run's recorded commands and read by its sensors."""

from __future__ import annotations

import math
import threading
from typing import Any, NamedTuple

import numpy as np

from sim.compiled import FloatArray
from sim.config import Engine, MissionConfig, SimulationConfig
from sim.identification.flight import CHANNELS, COLUMNS, SOLID, Flight, Reader, Stepped, fly, read
from sim.identification.parameters import Hypothesis, changed
from sim.identification.recording import BoolArray, Recording, commands_at
from sim.plant.plant import PLANT_STATE
from sim.plant.reduced_plant import ReducedHandle, ReducedPlant
from sim.record import packed

_MOVING = slice(0, 12)
"""Columns of a flown row: pose and twist of base and target, as in a node."""
_MOUNTED = slice(26, 28)
"""... the mounts' angles."""


class Predicted(NamedTuple):
    """What the sensors would have read; arrays lead with the row."""

    readings: FloatArray
    """Shape (rows, 18): poses as late as the recorded ones, wrenches in world axes; not a number once a rollout has
    left all numbers."""
    end: FloatArray
    """The node of the last row, shape (14,)."""
    solid: bool
    """Whether anything but a tip touches the target."""

    @property
    def wrench(self) -> FloatArray:
        """Of the hands, shape (rows, 2, 3)."""
        return self.readings[:, 12:].reshape(-1, 2, 3)


class Model:
    """A hypothesis, ready to be flown from any row of one recording. For any thread: each rollout has its own plant."""

    def __init__(self, recorded: Recording, truth: Hypothesis) -> None:
        self.recorded = recorded
        self.truth = truth
        config = _flown(truth.config)
        self._solid = ReducedPlant(config)
        # Where nothing touches a step of a whole period is as good: all that is integrated then is the base's turn.
        self._free = ReducedPlant(changed(config, {"simulation.time_step": config.control.period}))
        self._rates = commands_at(recorded, truth.command_delay)
        self._own = threading.local()
        """Plants of each thread."""
        self._reader = packed(_reader(recorded, truth))[0]

    def predict(self, first: int, touchable: BoolArray, node: FloatArray) -> Predicted:
        """What the sensors would have read from a row on, had it been at that node.

        Args:
            first: the row.
            touchable: whether the robot may touch the target from each row to the next, shape (rows,).
            node: base pose and twist, target pose and twist, mounts' angles, shape (14,).

        """
        flight = self.flight(first, touchable)
        readings = np.empty((len(touchable), CHANNELS))
        count = fly(flight, node)
        flight.rows[count:] = np.nan
        read(flight.rows, flight.reader, readings)
        end = flight.rows[-1]
        solid = bool((flight.rows[:, SOLID] > 0.0).any())
        return Predicted(readings, np.concatenate([end[_MOVING], end[_MOUNTED]]), solid)

    def flight(self, first: int, touchable: BoolArray) -> Flight:
        """What compiled code flies from that row on.

        Args:
            first: the row.
            touchable: whether the robot may touch the target from each row to the next, shape (rows,).

        """
        own = self._own
        if not hasattr(own, "free"):
            own.free, own.solid, own.state = _stepped(self._free), _stepped(self._solid), np.zeros(2, PLANT_STATE)
        state = own.state
        state["joint_angle"][0] = self.recorded.joint_angle[first]
        state["joint_rate"][0] = joint_rates_at(self.recorded, first)
        return Flight(
            free=own.free,
            solid=own.solid,
            touchable=touchable,
            reader=self._reader,
            start=state[0],
            state=state[1],
            rates=self._rates[first : first + len(touchable)],
            rows=np.empty((len(touchable), COLUMNS)),
        )


def _stepped(plant: ReducedPlant) -> Stepped:
    """The plant, in a copy of its own."""
    return Stepped(ReducedHandle(plant.handle.plant.copy()), plant.parameters)


def _reader(recorded: Recording, truth: Hypothesis) -> Reader:
    smoothing, perception = recorded.smoothing, truth.config.perception
    wrists = perception.wrist.left, perception.wrist.right
    return Reader(
        gain=np.array([wrist.gain for wrist in wrists]),
        bias=np.array([[wrist.bias_x, wrist.bias_y, wrist.bias_torque] for wrist in wrists]),
        lag=perception.capture.stamp_error,
        part=1.0 - math.exp(-recorded.period / smoothing) if smoothing > 0.0 else 1.0,
        period=recorded.period,
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
    """As the reduced plant flies it; a wild guess of a fit is no fault of a plant."""
    own = SimulationConfig.model_fields
    update: dict[str, Any] = {
        name: own[name].default for name in ("solver_iterations", "joint_error_time", "collision_slop")
    }
    update |= {"engine": Engine.REDUCED, "momentum_jump_limit": 1e6}
    return config.model_copy(update={"simulation": config.simulation.model_copy(update=update)})
