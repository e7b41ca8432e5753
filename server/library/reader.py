"""Reads one run, also while it is written."""

from __future__ import annotations

import math
import stat
from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

from mcap.records import ChunkIndex

from server.errors import StoredUnreadable
from server.files import damaged_lines
from server.library.folder import (
    BEGINNING_NAME,
    EVENTS_NAME,
    LOCK_NAME,
    LOG_NAME,
    read_events,
    read_foreseen,
    read_remarks,
)
from server.library.record import LoggedEvent, Remarks, RunRecord, TickArray, event_of_today
from server.log.scan import Scanned, chunk_data, payloads, scan
from server.log.stream import Contents
from server.log.ticks import TICK_CHANNEL, TickLayout, layout_in
from server.log.writer import nanoseconds
from sim.capture.beginning import Beginning
from sim.capture.replay import FlightHistory
from sim.errors import ConfigError
from sim.file_lock import is_locked
from sim.rehearsal.rehearsal import RehearsalResult

SLACK = 1e-6
"""Mission times closer than this are the same [s]: no tick is as short."""

MOST_ABSENT_SHOWN = 8
"""Columns that a notice names."""


class StoredTicks(NamedTuple):
    """Ticks of a log."""

    ticks: TickArray
    """Rows of `TICK`."""
    payloads: TickArray
    """The same as the log has them, for its layout to read."""


def _stored_ticks(file: BinaryIO, index: ChunkIndex, layout: TickLayout) -> StoredTicks:
    found = payloads(chunk_data(file, index), TICK_CHANNEL)
    return StoredTicks(layout.ticks(found), found)


def _size(path: Path) -> int:
    """Of a file [bytes]; 0 for one that is gone, that the system does not describe, and for a folder."""
    try:
        found = path.stat()
    except OSError:
        return 0
    return found.st_size if stat.S_ISREG(found.st_mode) else 0


@lru_cache(maxsize=256)
def _damaged_events(path: Path, _changed_at: int, _size: int) -> int:
    """Counted once for each state of the file."""
    return damaged_lines(path, LoggedEvent, upgrade=event_of_today)


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

    def foreseen(self) -> RehearsalResult | None:
        """What was foreseen of it when its sequence began, in outline; None if nothing was.

        Raises:
            StoredUnreadable: it is damaged, or of another version.

        """
        return read_foreseen(self._folder)

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
        return is_locked(self._folder / LOCK_NAME)

    @property
    def size(self) -> int:
        """Bytes on disk. What goes while it is looked at, as drafts and locks do, counts as nothing."""
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
        """What the run's ticks follow from; a robot's follow from more.

        Parameters that were edited before the first command are in the record's configuration already; none of them
        acts on a mission that idles.

        Raises:
            StoredUnreadable: an event is damaged: without it the run could not be flown again as it was.

        """
        events = read_events(self._folder, strict=True)
        done = tuple(event.intervention for event in events if event.intervention is not None)
        record = self.record
        return FlightHistory(config=record.config, interventions=done, beginning=self.beginning(), robot=record.robot)

    def beginning(self) -> Beginning | None:
        """Where the run began, if that was on the way; None of one that began as it was configured.

        Raises:
            StoredUnreadable: its file is damaged, or of another version.

        """
        path = self._folder / BEGINNING_NAME
        if not path.exists():
            return None
        try:
            return Beginning.read(path, self.record.config)
        except (ConfigError, OSError) as error:
            raise StoredUnreadable(str(error)) from None
