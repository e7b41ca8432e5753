"""Plants flown by hand, for tests."""

from __future__ import annotations

from sim.compiled import FloatArray
from sim.config import Engine, MissionConfig
from sim.plant.engine import simulated_plant
from sim.plant.plant import Plant
from sim.record import Record


def after(plant: Plant, joint_rate: FloatArray, ticks: int = 1) -> Record:
    """The plant's state after so many control periods under these joint rates [rad/s], shape (2, 3)."""
    for _ in range(ticks):
        plant.apply_joint_rates(joint_rate)
    return plant.state


def laid_out(engine: Engine, config: MissionConfig) -> Plant:
    """That engine's plant of a configuration, unchecked: a plant may begin in contact, a mission may not."""
    simulation = config.simulation.model_copy(update={"engine": engine})
    return simulated_plant(config.model_copy(update={"simulation": simulation}))
