"""Where a simulated mission begins that does not begin as its configuration lays it out: in a state on the way.

It holds what the controller remembers and the plant's state, and nothing that follows from the configuration. As a file
it describes itself: one of other records than today's is refused, not misread.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple, Self
from zipfile import BadZipFile

import numpy as np

from sim.capture.chronicle import Happened
from sim.capture.events import Ticks
from sim.capture.mission import Mark, Mission
from sim.capture.monitor import MONITOR
from sim.capture.tick import TICK
from sim.capture.tick_loop import FLIGHT
from sim.config import Engine, MissionConfig
from sim.control.memory import MEMORY
from sim.control.phases import Command
from sim.errors import ConfigError
from sim.method.method import method_of
from sim.perception.perceived import PERCEIVED
from sim.plant.plant import PLANT_STATE
from sim.plant.reduced_plant import ReducedPlant
from sim.record import Record

_Array = np.ndarray[Any, np.dtype[Any]]


class Beginning(NamedTuple):
    """The start of a mission in the reduced engine; arrays of one record each."""

    state: _Array
    """`PLANT_STATE`: what is true, before the first tick."""
    memory: _Array
    """`MEMORY`."""
    monitor: _Array
    """`MONITOR`."""
    known: _Array
    """`PERCEIVED`."""
    own: _Array
    """What the method remembers."""
    last: Ticks
    """The tick before the first one."""
    command: str
    """That is granted at the first tick, a value of `Command`; empty for none."""

    @classmethod
    def at(cls, mark: Mark, state: Record, config: MissionConfig, command: Command | None) -> Self:
        """Where another mission was.

        Args:
            mark: of that mission.
            state: what is true, one element of `PLANT_STATE`.
            config: that is flown from there; of another method, nothing of the old one's own is remembered.
            command: that is granted at the first tick.

        """
        flight, true = mark.flight, np.zeros(1, PLANT_STATE)
        true[0] = state
        same = mark.config.method == config.method
        return cls(
            true,
            flight["memory"].copy(),
            flight["monitor"].copy(),
            flight["known"].copy(),
            mark.own if same else np.zeros(1, method_of(config).memory),
            mark.happened.last,
            "" if command is None else command.value,
        )

    @property
    def tick(self) -> int:
        """The first one."""
        return int(self.state[0]["tick"])

    @property
    def request(self) -> Command | None:
        """What is granted at the first tick."""
        return Command(self.command) if self.command else None

    def mission(self, config: MissionConfig) -> Mission:
        """The mission with that configuration, before its first tick, and before anything is granted at it.

        Raises:
            ConfigError: another engine than the reduced one cannot begin there.

        """
        if config.simulation.engine is not Engine.REDUCED:
            raise ConfigError(
                f"simulation.engine = {config.simulation.engine.value}: only the reduced engine begins on the way"
            )
        mission = Mission(config, ReducedPlant.standing(config, self.state[0]))
        mission.take_over(self._mark(config))
        return mission

    def _mark(self, config: MissionConfig) -> Mark:
        flight = np.zeros(1, FLIGHT)
        for name in ("memory", "monitor", "known"):
            flight[name] = getattr(self, name)
        happened = Happened.until(self.last, flight[0]["monitor"], config)
        return Mark(config, flight, self.own, self.state[0], happened)

    def write(self, path: Path) -> None:
        """Write it to a file of numpy's (.npz)."""
        with path.open("xb") as file:
            np.savez_compressed(file, **self._asdict())

    @classmethod
    def read(cls, path: Path, config: MissionConfig) -> Self:
        """Read it from a file.

        Raises:
            ConfigError: it is damaged, or of a version whose records are others.
            OSError: it cannot be read.

        """
        try:
            with np.load(path, allow_pickle=False) as file:
                found = {name: file[name] for name in cls._fields}
        except (BadZipFile, KeyError, ValueError, EOFError) as error:
            raise ConfigError(f"{path.name} is damaged: {error}") from None
        own = method_of(config).memory
        kinds = dict(zip(cls._fields, (PLANT_STATE, MEMORY, MONITOR, PERCEIVED, own, TICK), strict=False))
        for name, kind in kinds.items():
            if found[name].dtype.descr != np.zeros(1, kind).dtype.descr or found[name].shape != (1,):
                raise ConfigError(
                    f"{path.name} was written by another version of Becalm: its {name} has other fields",
                    tip="its ticks can be read all the same; it cannot be flown again",
                )
            kept = np.zeros(1, kind)
            kept[:] = found[name]
            found[name] = kept
        return cls(**{**found, "command": str(found["command"])})
