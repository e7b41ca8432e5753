"""What the service publishes of the live mission: the simulation's snapshot, and what only the service knows."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from server.arming import Armed
from server.control import Control
from server.problems import Problem
from sim.capture.snapshot import Published, Snapshot


class PlantStatus(Published):
    """The plant and its clock."""

    kind: Literal["simulation", "zenoh"] = "simulation"
    running: bool = Field(description="False while the clock is paused")
    speed: float = Field(description="Multiple of real time; 0 as fast as it goes")
    lateness: float = Field(description="Worst lateness of a tick in the last second [s]")
    real_time_factor: float = Field(description="Simulated seconds in the last second")


class MissionSnapshot(Snapshot):
    """The live mission at one tick, with its run, its clock, and what may be asked of it now."""

    run_id: str
    configuration: str = Field(description="Name of the configuration, with `(edited)` if it was changed")
    plant: PlantStatus
    commands: dict[str, str | None] = Field(
        description="Every command: null if it is allowed now, else the reason why not"
    )
    control: Control
    arming_needed: tuple[str, ...] = Field(
        description="Commands that take an arming: with a robot all that move it or take it anew; `configure` only for "
        "parameters that take a new mission"
    )
    armed: Armed | None = Field(description="The command that is armed now; null if none is")
    problems: tuple[Problem, ...]
