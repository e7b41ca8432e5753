"""Plants flown by hand, for tests."""

from __future__ import annotations

from sim.compiled import FloatArray
from sim.plant.plant import Plant
from sim.record import Record


def after(plant: Plant, joint_rate: FloatArray, ticks: int = 1) -> Record:
    """The plant's state after so many control periods under these joint rates [rad/s], shape (2, 3)."""
    for _ in range(ticks):
        plant.command(joint_rate)
    return plant.state
