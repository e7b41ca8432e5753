"""The simulated plants by the name of their engine, as `simulation.engine` chooses one."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from sim.config import Engine, MissionConfig
from sim.plant.plant import Plant
from sim.plant.pymunk_plant import PymunkPlant
from sim.plant.reduced_plant import ReducedPlant

ENGINES: Mapping[Engine, Callable[[MissionConfig], Plant]] = {
    Engine.PYMUNK: PymunkPlant,
    Engine.REDUCED: ReducedPlant,
}
"""Each makes robot and target as configured."""


def simulated_plant(config: MissionConfig) -> Plant:
    """Robot and target laid out as configured, at rest but for the target's motion, in the configured engine."""
    return ENGINES[config.simulation.engine](config)
