"""Writes one run: its ticks and events as they come, its record when something about it changes."""

from __future__ import annotations

import errno
import os
import time
from io import FileIO
from pathlib import Path
from typing import Any, BinaryIO

from mcap.records import Schema

from server.library.folder import CANCEL_NAME, EVENTS_NAME, LOCK_NAME, LOG_NAME, write_record
from server.library.record import LoggedEvent, RunRecord, TickArray
from server.log.writer import LogWriter
from sim.file_lock import ProcessLock

SYNC_PERIOD = 0.5
"""Wall time between two orders to the disk itself [s]: what a power cut may cost."""


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
    """Appends to one run; locks its folder until it is closed."""

    def __init__(
        self, folder: Path, record: RunRecord, schema: Schema | None = None, topic_rate: float | None = None
    ) -> None:
        """Open a run that has begun or waits to; its ticks are kept in that schema, if not in today's.

        Args:
            folder: of the run.
            record: of the run.
            schema: of its ticks, if not today's.
            topic_rate: as of `LogWriter`.

        Raises:
            BlockingIOError: another process is writing it.

        """
        self._folder, self._schema, self._topic_rate = folder, schema, topic_rate
        self._lock = ProcessLock(folder / LOCK_NAME)
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
            config = self.record.config
            self._log = LogWriter(self._sink, self.record.started, config, self._schema, self._topic_rate)
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
        self._lock.release()

    def abandon(self) -> None:
        """Close without a last word, after the disk has failed: the run will be found as it was left."""
        for file in (self._events, self._sink.file if self._sink else None):
            try:
                if file is not None:
                    file.close()
            except OSError:
                continue  # what could not be written is lost; the caller has shown why
        self._lock.release()

    @property
    def is_cancelled(self) -> bool:
        """Whether somebody asked for the run to end."""
        return (self._folder / CANCEL_NAME).exists()
