"""What is kept of a run beside its log: its record, what people added, and its events; shapes, no files."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AllowInfNan, Field, Strict, StringConstraints, field_validator

from server.instants import instant, wall_clock
from server.versions import versions
from sim.capture.events import Event
from sim.capture.replay import Intervention
from sim.config import MissionConfig
from sim.control.phases import Command
from sim.schema_history import PARAMETER_CHANGES, RECORD_CHANGES, VERSION, config_version, under_todays_names
from sim.snapshot import FrozenMessage, Outcome
from sim.stored import read_parameters, read_tree

RunKind = Literal["live", "scripted", "study", "fork", "imported"]
RunStatus = Literal["queued", "running", "finished", "failed", "cancelled"]
Integrity = Literal["complete", "recovered"]
TickArray = np.ndarray[Any, np.dtype[Any]]
"""Rows of `TICK`, shape (ticks,)."""
FIRST_YEAR, LAST_YEAR = 1971, 2499
"""Within which the nanoseconds of a log have room, whatever the time zone."""


class RunRecord(FrozenMessage):
    """What run.json holds."""

    id: str
    kind: RunKind
    status: RunStatus
    configuration: str = Field(description="Name of the configuration, with `(edited)` if it was changed")
    config: MissionConfig = Field(description="In force at the first command that moved the robot")
    direct: bool = False
    robot: bool = Field(False, description="Whether a robot was flown over the link: its ticks hold what it perceived")
    started: str = Field(description="ISO 8601, UTC")
    duration: float = Field(0.0, description="Mission time of the last recorded tick [s]")
    outcome: Outcome | None = Field(None, description="How its last sequence with a verdict ended")
    earlier_outcomes: tuple[Outcome, ...] = Field((), description="How the sequences before that one ended, in order")
    real_time_factor: float | None = Field(None, description="Simulated seconds a second; of a scripted run")
    note: str | None = None
    parent: str | None = Field(None, description="The run that this one was forked from, or the study that it is of")
    forked_at: int | None = Field(None, description="The tick of the parent from which on this run is its own")
    idempotency_key: str | None = Field(None, description="Of the request that queued it")
    request_digest: str | None = Field(None, description="Of that request's body")
    versions: dict[str, str] = Field(default_factory=versions)
    format: Literal[2] = Field(2, description="Of the folder")
    ticks: int = Field(0, description="Recorded, when the record was last written")
    integrity: Integrity | None = Field(
        None, description="complete, or recovered up to the last whole chunk after a crash; null until it is closed"
    )
    lost_at_most: float | None = Field(None, description="Of a recovered run: wall time that may be missing [s]")
    notices: tuple[str, ...] = Field(
        (), exclude=True, description="What this version ignores of what an earlier one stored, and why"
    )

    @field_validator("started")
    @classmethod
    def _an_instant(cls, value: str) -> str:
        """A date without a time zone is no instant, and none of a run is far from today's."""
        if not FIRST_YEAR <= instant(value).year <= LAST_YEAR:
            raise ValueError(f"{value} is no time at which a run can have started")
        return value

    @property
    def ended(self) -> bool:
        """Whether nothing more will be written."""
        return self.status not in ("queued", "running")


class Note(FrozenMessage):
    """What somebody has to say about a run, or about one moment of it."""

    text: str = Field(min_length=1, max_length=4000)
    time: Annotated[float, Strict(), AllowInfNan(False)] | None = Field(
        None, ge=0, description="The moment's mission time [s]; null of the whole run"
    )
    who: str = Field("operator", max_length=100)
    at: str = Field(default_factory=wall_clock, description="Wall clock, ISO 8601, UTC")


Tag = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=40, pattern=r"^[^,\n]*$")]
RunName = Annotated[str, StringConstraints(strip_whitespace=True, max_length=100, pattern=r"^[^\n]*$")]


class Remarks(FrozenMessage):
    """What people add to a run at any time; it stands in a file of its own, so that no writer is disturbed."""

    starred: bool = False
    name: RunName = Field("", description="What people call the run; empty without a name")
    tags: tuple[Tag, ...] = Field((), max_length=20, description="Words that runs are grouped by, each once")
    notes: tuple[Note, ...] = Field((), max_length=500)

    @field_validator("tags")
    @classmethod
    def _each_once(cls, tags: tuple[str, ...]) -> tuple[str, ...]:
        return tuple(dict.fromkeys(tags))


class LoggedEvent(Event):
    """An event of a run as it is logged; a command also says who asked and whether it was granted."""

    at: str = Field(description="Wall clock, ISO 8601, UTC")
    who: str | None = None
    command: str | None = None
    accepted: bool | None = None
    takes_effect: int | None = Field(None, description="First tick flown under the command or the changes")
    changes: dict[str, Any] | None = Field(None, description="Full path of each changed parameter to its new value")

    @property
    def intervention(self) -> Intervention | None:
        """What a re-run has to do again, if this event is of that kind."""
        if self.takes_effect is None:
            return None
        if self.changes is not None:
            return Intervention(tick=self.takes_effect, changes=self.changes)
        return None if self.command is None else Intervention(tick=self.takes_effect, command=Command(self.command))


def record_of_today(stored: Any) -> Any:
    """A run's record of any version, under the names of today.

    Raises:
        ConfigError: its configuration is of a later version.

    """
    if not isinstance(stored, dict) or not isinstance(stored.get("config"), dict):
        return stored
    config = read_parameters(stored["config"])
    record = read_tree({name: value for name, value in stored.items() if name != "config"}, RECORD_CHANGES)
    return {
        **record.values,
        "config": {**config.values, VERSION: config_version()},
        "notices": (*config.notices, *record.notices),
    }


def event_of_today(stored: Any) -> Any:
    """An event of any version, with the parameters that it changes under the names of today."""
    if not isinstance(stored, dict) or not isinstance(stored.get("changes"), dict):
        return stored
    return {**stored, "changes": under_todays_names(stored["changes"], PARAMETER_CHANGES).values}
