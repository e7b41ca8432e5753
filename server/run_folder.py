"""One run on disk: a folder that is written while the run happens and can be read at any moment of it.

    run.json      `RunRecord`: configuration, versions, status, outcome; replaced whole, never half-written
    events.jsonl  one `LoggedEvent` a line: events, commands with their answers, configuration changes
    ticks.bin     raw little-endian records, one a tick; their layout stands in run.json

A reader takes whole records only, so that a write cut short by a crash costs that one record.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO, Literal

import numpy as np
from pydantic import Field

from server.claim import Claim
from server.versions import versions
from sim.capture.events import Event
from sim.capture.replay import FlightHistory, Intervention
from sim.capture.snapshot import Outcome, Published
from sim.capture.tick import TICK
from sim.config import MissionConfig
from sim.control.phases import Command

RunKind = Literal["live", "scripted", "study", "fork"]
RunStatus = Literal["queued", "running", "finished", "failed", "cancelled"]
TickArray = np.ndarray[Any, np.dtype[Any]]

RECORD_NAME = "run.json"
EVENTS_NAME = "events.jsonl"
TICKS_NAME = "ticks.bin"
CANCEL_NAME = ".cancel"

STORED_TICK = TICK.newbyteorder("<")
CHUNK_ROWS = 8192
"""Ticks read at once: about 5 MB, whatever the length of the run."""


class FieldLayout(Published):
    """One field of a stored tick."""

    name: str
    kind: str = Field(description="numpy's name of the element type, with its byte order")
    shape: list[int]
    offset: int = Field(description="Bytes from the record's start")


class TickLayout(Published):
    """How a record of ticks.bin is laid out, so that later versions can read it."""

    size: int = Field(description="Bytes of one record")
    fields: list[FieldLayout]

    def dtype(self) -> np.dtype[Any]:
        """The numpy type of one record."""
        return np.dtype(
            {
                "names": [field.name for field in self.fields],
                "formats": [(field.kind, tuple(field.shape)) for field in self.fields],
                "offsets": [field.offset for field in self.fields],
                "itemsize": self.size,
            }
        )


def _stored_layout() -> TickLayout:
    fields = []
    for name in STORED_TICK.names or ():
        kind, offset = STORED_TICK.fields[name][:2]  # type: ignore[index]
        fields.append(FieldLayout(name=name, kind=kind.base.str, shape=list(kind.shape), offset=offset))
    return TickLayout(size=STORED_TICK.itemsize, fields=fields)


class RunRecord(Published):
    """What run.json holds."""

    id: str
    kind: RunKind
    status: RunStatus
    configuration: str = Field(description="Name of the configuration, with `(edited)` if it was changed")
    config: MissionConfig = Field(description="In force at the first command that moved the robot")
    direct: bool = False
    started: str = Field(description="ISO 8601, UTC")
    duration: float = Field(0.0, description="Mission time of the last recorded tick [s]")
    outcome: Outcome | None = None
    real_time_factor: float | None = Field(None, description="Simulated seconds a second; of a scripted run")
    note: str | None = None
    parent: str | None = Field(None, description="The run that this one was forked from, or the study that it is of")
    forked_at: int | None = Field(None, description="The tick of the parent from which on this run is its own")
    versions: dict[str, str] = Field(default_factory=versions)
    layout: TickLayout = Field(default_factory=_stored_layout)

    @property
    def ended(self) -> bool:
        """Whether nothing more will be written."""
        return self.status not in ("queued", "running")


class LoggedEvent(Event):
    """An event of a run as it is logged; a command also tells who asked and whether it was granted."""

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


def read_record(folder: Path) -> RunRecord:
    """The record of the run in that folder."""
    return RunRecord.model_validate_json((folder / RECORD_NAME).read_bytes())


def write_record(folder: Path, record: RunRecord) -> None:
    """Replace the record as a whole: after a crash there is the old one or the new one."""
    draft = folder / (RECORD_NAME + ".draft")
    with draft.open("wb") as file:
        file.write(record.model_dump_json(indent=2).encode())
        file.flush()
        os.fsync(file.fileno())
    draft.replace(folder / RECORD_NAME)


class RunWriter:
    """Appends to one run; claims its folder until it is closed."""

    def __init__(self, folder: Path, record: RunRecord) -> None:
        """Open a run that has begun or waits to.

        Raises:
            BlockingIOError: another process is writing it.

        """
        self._folder = folder
        self._claim = Claim(folder)
        self._ticks: BinaryIO = (folder / TICKS_NAME).open("ab")
        self._events: BinaryIO = (folder / EVENTS_NAME).open("ab")
        self._duration = record.duration
        self.record = record
        write_record(folder, record)

    def append(self, ticks: TickArray) -> None:
        """Append rows of `TICK`."""
        if len(ticks):
            self._ticks.write(ticks.astype(STORED_TICK, copy=False).tobytes())
            self._duration = float(ticks["time"][-1])

    def log(self, event: LoggedEvent) -> None:
        """Append one event."""
        self._events.write(event.model_dump_json(exclude_none=True).encode() + b"\n")

    def flush(self) -> None:
        """Hand everything to the system: from here on a killed process loses nothing of it."""
        self._ticks.flush()
        self._events.flush()

    def revise(self, **changes: Any) -> None:
        """Change the record, on disk as well, after everything that it speaks of."""
        self.flush()
        self.record = self.record.model_copy(update={"duration": self._duration, **changes})
        write_record(self._folder, self.record)

    def close(self, **changes: Any) -> None:
        """Put everything on disk, then the last word about the run, and give its folder free."""
        self.revise(**changes)
        for file in (self._ticks, self._events):
            os.fsync(file.fileno())
            file.close()
        self._claim.release()

    def abandon(self) -> None:
        """Close without a last word, after the disk has failed: the run will be found as it was left."""
        for file in (self._ticks, self._events):
            try:
                file.close()
            except OSError:
                continue  # what could not be written is lost; the caller has shown why
        self._claim.release()

    @property
    def is_cancelled(self) -> bool:
        """Whether somebody asked for the run to end."""
        return (self._folder / CANCEL_NAME).exists()


class RunReader:
    """Reads one run, also while it is written."""

    def __init__(self, folder: Path, record: RunRecord) -> None:
        self._folder = folder
        self._dtype = record.layout.dtype()
        self.record = record

    @property
    def tick_count(self) -> int:
        """Whole ticks on disk."""
        path = self._folder / TICKS_NAME
        return path.stat().st_size // self._dtype.itemsize if path.exists() else 0

    @property
    def size(self) -> int:
        """Bytes on disk."""
        return sum(path.stat().st_size for path in self._folder.iterdir() if path.is_file())

    def chunks(self, rows: int = CHUNK_ROWS) -> Iterator[TickArray]:
        """The ticks that are on disk now, oldest first, at most `rows` at once."""
        left = self.tick_count
        if not left:
            return
        with (self._folder / TICKS_NAME).open("rb") as file:
            while left > 0:
                content = file.read(min(rows, left) * self._dtype.itemsize)
                yield np.frombuffer(content, dtype=self._dtype)
                left -= rows

    def last_tick(self) -> TickArray | None:
        """The last whole tick on disk, shape (1,), or None."""
        count = self.tick_count
        if not count:
            return None
        with (self._folder / TICKS_NAME).open("rb") as file:
            file.seek((count - 1) * self._dtype.itemsize)
            return np.frombuffer(file.read(self._dtype.itemsize), dtype=self._dtype)

    def events(self) -> Iterator[Mapping[str, Any]]:
        """The events, oldest first; a line that a crash cut short is left out."""
        path = self._folder / EVENTS_NAME
        if not path.exists():
            return
        with path.open("rb") as file:
            for line in file:
                if line.endswith(b"\n"):
                    yield json.loads(line)

    def history(self) -> FlightHistory:
        """What the run's ticks follow from, for a simulated plant.

        Parameters that were edited before the first command are in the record's configuration already; none of them
        acts on a mission that idles.
        """
        events = map(LoggedEvent.model_validate, self.events())
        done = tuple(event.intervention for event in events if event.intervention is not None)
        return FlightHistory(config=self.record.config, interventions=done)
