"""One run on disk: a folder that is written while the run happens and can be read at any moment of it.

    run.json      `RunRecord`: configuration, versions, status, outcome; replaced whole, never half-written
    remarks.json  what people added: notes and the star
    events.jsonl  one `LoggedEvent` a line: events, commands with their answers, configuration changes
    log.mcap      every tick, the events, and what other tools show of them; grows by whole chunks

A reader takes whole chunks and whole lines only, so that a write cut short by a crash costs that one.
"""

from __future__ import annotations

import errno
import math
import os
import stat
import time
from collections.abc import Iterator, Mapping
from functools import lru_cache
from io import FileIO
from pathlib import Path
from typing import Annotated, Any, BinaryIO, Literal, NamedTuple

import numpy as np
from mcap.records import ChunkIndex, Schema
from pydantic import AllowInfNan, Field, Strict, StringConstraints, field_validator

from server.errors import StoredUnreadable
from server.files import damaged_lines, read_document, read_lines, replace_file
from server.instants import instant, wall_clock
from server.log.scan import Scanned, chunk_data, payloads, scan
from server.log.stream import Contents
from server.log.ticks import TICK_CHANNEL, TickLayout, layout_in
from server.log.writer import LogWriter, nanoseconds
from server.texts import shortened
from server.versions import versions
from sim.capture.events import Event
from sim.capture.replay import FlightHistory, Intervention
from sim.claim import Claim, is_claimed
from sim.config import MissionConfig
from sim.control.phases import Command
from sim.schema_history import PARAMETER_CHANGES, RECORD_CHANGES, VERSION, config_version, under_todays_names
from sim.snapshot import Outcome, Published
from sim.stored import read_parameters, read_tree

RunKind = Literal["live", "scripted", "study", "fork"]
RunStatus = Literal["queued", "running", "finished", "failed", "cancelled"]
Integrity = Literal["complete", "recovered"]
TickArray = np.ndarray[Any, np.dtype[Any]]

RECORD_NAME = "run.json"
EVENTS_NAME = "events.jsonl"
REMARKS_NAME = "remarks.json"
LOG_NAME = "log.mcap"
CANCEL_NAME = ".cancel"
CLAIM_NAME = ".writing"

SYNC_PERIOD = 0.5
"""Wall time between two orders to the disk itself [s]: what a power cut may cost."""

LOST_AT_MOST = 1.0
"""Wall time that a crash or a power cut may cost [s]: half of it, and as much for a slow disk."""

SLACK = 1e-6
"""Mission times closer than this are the same [s]: no tick is as short."""

MOST_ABSENT_SHOWN = 8
"""Columns that a notice names."""

FIRST_YEAR, LAST_YEAR = 1971, 2499
"""Within which the nanoseconds of a log have room, whatever the time zone."""


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


class Note(Published):
    """What somebody has to say about a run, or about one moment of it."""

    text: str = Field(min_length=1, max_length=4000)
    time: Annotated[float, Strict(), AllowInfNan(False)] | None = Field(
        None, ge=0, description="The moment's mission time [s]; null of the whole run"
    )
    who: str = Field("operator", max_length=100)
    at: str = Field(default_factory=wall_clock, description="Wall clock, ISO 8601, UTC")


Tag = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=40, pattern=r"^[^,\n]*$")]
RunName = Annotated[str, StringConstraints(strip_whitespace=True, max_length=100, pattern=r"^[^\n]*$")]


class Remarks(Published):
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
    """The record of the run in that folder.

    Raises:
        FileNotFoundError: there is none.
        StoredUnreadable: it is damaged, of another version, of another run, or not permitted.

    """
    record = read_document(folder / RECORD_NAME, RunRecord, upgrade=record_of_today)
    if record.id != folder.name:
        raise StoredUnreadable(
            f"{RECORD_NAME} is that of run {shortened(record.id)}, of which this folder seems to be a copy",
            tip="rename the folder to that identifier if it is the only one, or remove it",
        )
    return record


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


def _event_of_today(stored: Any) -> Any:
    """An event of any version, with the parameters that it changes under the names of today."""
    if not isinstance(stored, dict) or not isinstance(stored.get("changes"), dict):
        return stored
    return {**stored, "changes": under_todays_names(stored["changes"], PARAMETER_CHANGES).values}


def read_events(folder: Path, *, strict: bool = False) -> Iterator[LoggedEvent]:
    """The events of the run in that folder, oldest first.

    Args:
        folder: of the run.
        strict: whether a line that cannot be read ends it all; else it is left out.

    Raises:
        StoredUnreadable: the file cannot be read, or with `strict` a line of it.

    """
    return read_lines(folder / EVENTS_NAME, LoggedEvent, strict=strict, upgrade=_event_of_today)


class StoredTicks(NamedTuple):
    """Ticks of a log."""

    ticks: TickArray
    """Rows of `TICK`."""
    payloads: TickArray
    """The same as the log has them, for its layout to read."""


def _stored_ticks(file: BinaryIO, index: ChunkIndex, layout: TickLayout) -> StoredTicks:
    found = payloads(chunk_data(file, index), TICK_CHANNEL)
    return StoredTicks(layout.ticks(found), found)


def repair_log(path: Path) -> Scanned:
    """Cut what is not whole off the end of a log, and close it with its summary, so that every tool opens it.

    Raises:
        OSError: the disk does not take the summary; the log is left without.

    """
    with path.open("r+b") as file:
        found = scan(file)
        if not found.closed and found.intact:
            file.truncate(found.intact)
            file.seek(found.intact)
            file.write(found.contents.ending(found.intact))
            file.flush()
            os.fsync(file.fileno())
    return found


def write_record(folder: Path, record: RunRecord) -> None:
    """Replace the record as a whole: after a crash there is the old one or the new one."""
    _replace(folder / RECORD_NAME, record)


def _size(path: Path) -> int:
    """Of a file [bytes]; 0 for one that is gone, that the system does not tell of, and for a folder."""
    try:
        found = path.stat()
    except OSError:
        return 0
    return found.st_size if stat.S_ISREG(found.st_mode) else 0


def read_remarks(folder: Path) -> Remarks:
    """What people added to the run in that folder.

    Raises:
        StoredUnreadable: it is damaged or not permitted.

    """
    try:
        return read_document(folder / REMARKS_NAME, Remarks)
    except FileNotFoundError:
        return Remarks()


def write_remarks(folder: Path, remarks: Remarks) -> None:
    """Replace what people added, as a whole."""
    _replace(folder / REMARKS_NAME, remarks)


def _replace(path: Path, content: Published) -> None:
    replace_file(path, content.model_dump_json(indent=2).encode())


class _WholeWrites:
    """A file that holds whole pieces only: what the disk takes half of is taken back."""

    def __init__(self, path: Path) -> None:
        self.file: FileIO = path.open("xb", buffering=0)

    def write(self, content: bytes) -> None:
        """Append all of it, or nothing.

        Raises:
            OSError: the disk is full, or fails.

        """
        start, view = self.file.tell(), memoryview(content)
        try:
            while view:
                view = view[self.file.write(view) :]
        except OSError:
            self.file.truncate(start)
            raise


def _require_there(path: Path, descriptor: int) -> None:
    """See that an open file still stands under its name.

    Raises:
        FileNotFoundError: it was removed or moved away: what is written to it is lost.

    """
    if not path.exists() or not os.path.samestat(path.stat(), os.fstat(descriptor)):
        raise FileNotFoundError(errno.ENOENT, "the run's files are gone while it is recorded", str(path))


class RunWriter:
    """Appends to one run; claims its folder until it is closed."""

    def __init__(self, folder: Path, record: RunRecord, schema: Schema | None = None) -> None:
        """Open a run that has begun or waits to; its ticks are kept in that schema, if not in today's.

        Raises:
            BlockingIOError: another process is writing it.

        """
        self._folder, self._schema = folder, schema
        self._claim = Claim(folder / CLAIM_NAME)
        self._events: BinaryIO = (folder / EVENTS_NAME).open("ab")
        self._sink: _WholeWrites | None = None
        self._log: LogWriter | None = None
        self._duration, self._ticks = record.duration, 0
        self._synced = time.monotonic()
        self.record = record
        write_record(folder, record)

    def append(self, ticks: TickArray, payloads: TickArray | None = None) -> None:
        """Append rows of `TICK`, and their payloads if the log has a schema of its own."""
        if len(ticks):
            self._open_log().append(ticks, payloads)
            self._duration = float(ticks["time"][-1])
            self._ticks += len(ticks)

    def log(self, event: LoggedEvent) -> None:
        """Append one event."""
        self._open_log().log(event)
        self._events.write(event.model_dump_json(exclude_none=True).encode() + b"\n")

    def _open_log(self) -> LogWriter:
        if self._log is None:
            self._sink = _WholeWrites(self._folder / LOG_NAME)
            self._log = LogWriter(self._sink, self.record.started, self.record.config, self._schema)
            self._log.describe(self.record, self.record.config)
        return self._log

    def flush(self) -> None:
        """Hand everything to the system: from here on a killed process loses nothing of it."""
        if self._log is not None:
            self._log.flush()
        self._events.flush()
        if time.monotonic() - self._synced > SYNC_PERIOD:
            self._sync()

    def _sync(self) -> None:
        """Have the disk itself hold everything: from here on a power cut loses nothing of it."""
        self._synced = time.monotonic()
        for file in (self._events, self._sink.file if self._sink else None):
            if file is not None:
                os.fsync(file.fileno())
                _require_there(Path(file.name), file.fileno())

    def revise(self, **changes: Any) -> None:
        """Change the record, on disk as well, after everything that it speaks of."""
        self.flush()
        before = self.record
        self.record = before.model_copy(update={"duration": self._duration, "ticks": self._ticks, **changes})
        self._restate(before)
        write_record(self._folder, self.record)

    def _restate(self, before: RunRecord) -> None:
        """Have the log know, too, what has changed of the record."""
        if self._log is not None and self.record.config != before.config:
            self._log.describe(self.record, self.record.config)
        if self._log is not None and self.record.outcome is not None and self.record.outcome != before.outcome:
            self._log.conclude(self.record.outcome)

    def close(self, **changes: Any) -> None:
        """Put everything on disk, then the last word about the run, and give its folder free."""
        before = self.record
        self.record = before.model_copy(update=changes)
        self._restate(before)
        self.flush()
        if self._log is not None:
            self._log.end()
        self._sync()
        self.revise(integrity="complete", **changes)
        self._events.close()
        if self._sink is not None:
            self._sink.file.close()
        self._claim.release()

    def abandon(self) -> None:
        """Close without a last word, after the disk has failed: the run will be found as it was left."""
        for file in (self._events, self._sink.file if self._sink else None):
            try:
                if file is not None:
                    file.close()
            except OSError:
                continue  # what could not be written is lost; the caller has shown why
        self._claim.release()

    @property
    def is_cancelled(self) -> bool:
        """Whether somebody asked for the run to end."""
        return (self._folder / CANCEL_NAME).exists()


@lru_cache(maxsize=256)
def _damaged_events(path: Path, _changed_at: int, _size: int) -> int:
    """Counted once for each state of the file."""
    return damaged_lines(path, LoggedEvent, upgrade=_event_of_today)


class RunReader:
    """Reads one run, also while it is written."""

    def __init__(self, folder: Path, record: RunRecord) -> None:
        self._folder = folder
        self.record = record

    @property
    def log_path(self) -> Path:
        """The log, which a run that waits does not have yet."""
        return self._folder / LOG_NAME

    @property
    def has_log(self) -> bool:
        """Whether anything has been recorded."""
        return self.log_path.exists()

    def scanned(self) -> Scanned:
        """What the log holds now."""
        if not self.has_log:
            return Scanned(Contents(), 0, False)
        with self.log_path.open("rb") as file:
            return scan(file)

    @property
    def tick_count(self) -> int:
        """Whole ticks on disk."""
        if self.record.integrity is not None:
            return self.record.ticks
        return self.scanned().contents.statistics.channel_message_counts.get(TICK_CHANNEL, 0)

    @property
    def remarks(self) -> Remarks:
        """What people added; nothing, as far as is known, if that cannot be read."""
        try:
            return read_remarks(self._folder)
        except StoredUnreadable:
            return Remarks()

    @property
    def remarks_damage(self) -> str | None:
        """Why what people added cannot be read, in words; None if it can."""
        try:
            read_remarks(self._folder)
        except StoredUnreadable as error:
            return f"its star and notes cannot be read: {error}"
        return None

    @property
    def damaged_events(self) -> int | None:
        """Lines of its events that cannot be read, and are left out wherever they are listed; None if none can be.

        Of a run that has not ended nobody has looked yet: 0.
        """
        path = self._folder / EVENTS_NAME
        try:
            found = path.stat()
            return _damaged_events(path, found.st_mtime_ns, found.st_size) if self.record.ended else 0
        except FileNotFoundError:
            return 0
        except (OSError, StoredUnreadable):
            return None

    @property
    def is_open(self) -> bool:
        """Whether a living process may still write it, whatever its record says."""
        return is_claimed(self._folder / CLAIM_NAME)

    @property
    def size(self) -> int:
        """Bytes on disk. What goes while it is looked at, as drafts and claims do, is nothing."""
        try:
            return sum(_size(path) for path in self._folder.iterdir())
        except OSError:  # the whole run is being removed, or may not be looked into
            return 0

    def layout(self) -> TickLayout:
        """How the log keeps its ticks.

        Raises:
            StoredUnreadable: the schema in it cannot be understood.

        """
        return layout_in(self.scanned().contents)

    @property
    def log_notices(self) -> tuple[str, ...]:
        """What the log, of another version, has not of today's ticks, or why none of it can be read; in words."""
        try:
            absent = self.layout().absent
        except StoredUnreadable as error:
            return (str(error),)
        names = ", ".join(column.name for column in absent[:MOST_ABSENT_SHOWN])
        left = len(absent) - MOST_ABSENT_SHOWN
        more = f" and {left} more" if left > 0 else ""
        return (f"its log, of another version, has no {names}{more}",) if absent else ()

    def chunks(self, since: float | None = None, until: float | None = None) -> Iterator[TickArray]:
        """The ticks that are on disk now, oldest first, a chunk at once, from one mission time to another [s].

        Raises:
            StoredUnreadable: the schema in the log cannot be understood.

        """
        for stored in self.stored_chunks(since, until):
            yield stored.ticks

    def stored_chunks(self, since: float | None = None, until: float | None = None) -> Iterator[StoredTicks]:
        """The same, and as the log has them.

        Raises:
            StoredUnreadable: the schema in the log cannot be understood.

        """
        if not self.has_log:
            return
        began = nanoseconds(self.record.started)
        earliest = -math.inf if since is None else since - SLACK
        latest = math.inf if until is None else until + SLACK
        with self.log_path.open("rb") as file:
            contents = scan(file).contents
            for index in contents.chunks:
                first, last = (1e-9 * (at - began) for at in (index.message_start_time, index.message_end_time))
                if last < earliest or first > latest:
                    continue
                ticks, kept = _stored_ticks(file, index, layout_in(contents))
                wanted = (ticks["time"] >= earliest) & (ticks["time"] <= latest)
                if wanted.all() and len(ticks):
                    yield StoredTicks(ticks, kept)
                elif wanted.any():
                    yield StoredTicks(ticks[wanted], kept[wanted])

    def last_tick(self) -> TickArray | None:
        """The last whole tick on disk, shape (1,), or None.

        Raises:
            StoredUnreadable: the schema in the log cannot be understood.

        """
        if not self.has_log:
            return None
        with self.log_path.open("rb") as file:
            contents = scan(file).contents
            for index in reversed(contents.chunks):
                if TICK_CHANNEL in index.message_index_offsets:
                    ticks = _stored_ticks(file, index, layout_in(contents)).ticks
                    if len(ticks):
                        return ticks[-1:]
        return None

    def events(self) -> Iterator[Mapping[str, Any]]:
        """The events, oldest first; a line that a crash cut short, or that is damaged, is left out."""
        for event in read_events(self._folder):
            yield event.model_dump(mode="json", exclude_none=True)

    def history(self) -> FlightHistory:
        """What the run's ticks follow from, for a simulated plant.

        Parameters that were edited before the first command are in the record's configuration already; none of them
        acts on a mission that idles.

        Raises:
            StoredUnreadable: an event is damaged: without it the run could not be flown again as it was.

        """
        events = read_events(self._folder, strict=True)
        done = tuple(event.intervention for event in events if event.intervention is not None)
        return FlightHistory(config=self.record.config, interventions=done)
