"""The simulated plants by the name of their engine, as `simulation.engine` chooses one."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from sim.config import Engine, MissionConfig
from sim.plant.plant import AirTable, Plant
from sim.plant.pymunk_plant import PymunkPlant
from sim.plant.reduced_plant import ReducedPlant

ENGINES: Mapping[Engine, Callable[[MissionConfig, AirTable], Plant]] = {
    Engine.PYMUNK: PymunkPlant,
    Engine.REDUCED: ReducedPlant,
}
"""Each makes robot and target as configured, floating free or on an air table."""


def simulated_plant(config: MissionConfig, table: AirTable | None = None) -> Plant:
    """Robot and target laid out as configured, at rest but for the target's motion, in the configured engine.

    A table takes momentum: `simulation.momentum_jump_limit` must leave room for what it takes in one period.
    """
    return ENGINES[config.simulation.engine](config, table or AirTable())
