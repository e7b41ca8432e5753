"""A plant that plays the states given to it and keeps the joint rates that it is given.

For tests and tools that want exact states in place of physics: `Mission(config, ScriptedPlant(states))`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from sim.compiled import FloatArray
from sim.errors import PlantError
from sim.plant.plant import PLANT_STATE, copy_state
from sim.record import Record


class ScriptedPlant:
    """A plant whose states are those of its script, tick by tick, whatever joint rates are commanded."""

    handle = None
    perceived = None
    copyable = None

    def __init__(self, states: np.ndarray[Any, np.dtype[Any]]) -> None:
        """Start before the first of the states, a non-empty array of `PLANT_STATE`.

        Raises:
            ValueError: there is none, or it is of another type.

        """
        if states.dtype != PLANT_STATE or not len(states):
            raise ValueError(f"states = {states.dtype}, {len(states)} of them: an array of PLANT_STATE is needed")
        self.commanded_joint_rates: list[FloatArray] = []
        """Those of all ticks so far [rad/s], one array of shape (2, 3) a tick."""
        self._states = states
        self._observed = 0
        self._state: Record = states[:1].copy()[0]

    @property
    def state(self) -> Record:
        """The latest state, one element of `PLANT_STATE`."""
        return self._state

    @property
    def next_tick(self) -> int:
        """The tick whose state is observed next."""
        return int(self._states["tick"][min(self._observed, len(self._states) - 1)])

    def observe(self) -> None:
        """Take the next state of the script.

        Raises:
            PlantError: the script is at its end.

        """
        if self._observed == len(self._states):
            raise PlantError(f"the script has ended after {self._observed} states", tip="give it more states")
        copy_state(self._state, self._states[self._observed])
        self._observed += 1

    def apply_joint_rates(self, joint_rate: FloatArray) -> None:
        """Keep the joint rates [rad/s], shape (2, 3)."""
        self.commanded_joint_rates.append(joint_rate.copy())
