"""What the service publishes of the live mission: the simulation's snapshot, and what only the service knows."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from sim.capture.events import Severity
from sim.snapshot import FrozenMessage, Snapshot

ArmedCommand = Literal["capture", "detumble", "cage", "direct_cage", "release", "reset", "configure"]
"""What may be armed: it moves the robot, or takes it for another mission."""


class PlantStatus(FrozenMessage):
    """The plant and its clock."""

    kind: Literal["simulation", "zenoh"] = "simulation"
    running: bool = Field(description="False while the clock is paused")
    speed: float = Field(description="Multiple of real time; 0 as fast as it goes")
    lateness: float = Field(description="Worst lateness of a tick in the last second [s]")
    real_time_factor: float = Field(description="Simulated seconds in the last second")


class RobotData(FrozenMessage):
    """Age of what the robot reported, when the snapshot is made."""

    silent_for: float | None = Field(description="Since its joints were last heard [s]; null before the first time")
    oldest: float | None = Field(description="Age of the stream that is needed and came longest ago [s]; null likewise")
    stream: str = Field(description="Which one that is")


class Control(FrozenMessage):
    """Who may command the mission now."""

    holder: str | None = Field(None, description="Name of the operator in control; null while nobody is")
    since: str | None = Field(None, description="When they took it, ISO 8601 in UTC")
    offered_to: str | None = Field(None, description="Name of who may take it over now; null without an offer")


class Armed(FrozenMessage):
    """A command that its next request will carry out, as everyone sees it: without its token."""

    command: ArmedCommand
    by: str = Field(description="Who armed it, and alone may give it")
    expires_in: float = Field(description="Until it is taken back [s]")


class Problem(FrozenMessage):
    """Something that the operator must see, and what to do about it."""

    severity: Severity
    title: str
    message: str
    tip: str
    since: float = Field(description="Mission time when it began [s]")


class MissionSnapshot(Snapshot):
    """The live mission at one tick, with its run, its clock, and what may be asked of it now."""

    made_at: str = Field(description="Wall clock when it was made, ISO 8601, UTC")
    service_time: float = Field(
        description="The same on the service's monotonic clock [s], which `GET /health` and `hello` have, too: "
        "how old a snapshot is follows from it"
    )
    robot: RobotData | None = Field(description="Null in simulation")
    run_id: str
    configuration: str = Field(description="Name of the configuration, with `(edited)` if it was changed")
    plant: PlantStatus
    commands: dict[str, str | None] = Field(
        description="Every command: null if it is allowed now, else the reason why not"
    )
    control: Control
    arming_needed: tuple[str, ...] = Field(
        description="Commands that need arming: with a robot all that move it or take it again; `configure` only for "
        "parameters that take a new mission"
    )
    armed: Armed | None = Field(description="The command that is armed now; null if none is")
    problems: tuple[Problem, ...]
