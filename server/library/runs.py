"""The library of runs: a folder each, newest first.

Storage ends here: the rest of the service knows `RunStore`, `RunWriter`, `RunReader` and `RunRecord` only.
"""

from __future__ import annotations

import logging
import re
import secrets
import threading
from collections.abc import Iterator
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Self

from server.errors import StoredUnreadable
from server.files import remove_folder, replace_file
from server.instants import wall_clock
from server.library.folder import (
    BEGINNING_NAME,
    CANCEL_NAME,
    FORESEEN_NAME,
    LOCK_NAME,
    LOST_AT_MOST,
    RECORD_NAME,
    read_record,
    read_remarks,
    repair_log,
    write_record,
    write_remarks,
)
from server.library.reader import RunReader
from server.library.record import Remarks, RunKind, RunRecord
from server.library.upgrade import upgraded
from server.library.writer import RunWriter
from server.log.ticks import TICK_CHANNEL
from sim.capture.beginning import Beginning
from sim.config import MissionConfig
from sim.errors import MissionRefused, RunNotFound
from sim.file_lock import ProcessLock, is_locked

RECOVERED_NOTE = "recovered: the process that recorded it ended without closing it; every whole chunk of ticks is here"
"""Of a run that had not ended."""

log = logging.getLogger(__name__)

RUN_ID = re.compile(r"\d{8}T\d{9}-[0-9a-f]{6}")


def new_run_id() -> str:
    """An identifier that sorts by time and that no two processes share."""
    now = datetime.now(UTC)
    return f"{now:%Y%m%dT%H%M%S}{now.microsecond // 1000:03d}-{secrets.token_hex(3)}"


def new_record(kind: RunKind, configuration: str, config: MissionConfig, **further: Any) -> RunRecord:
    """The record of a run that begins now."""
    status = "running" if kind == "live" else "queued"
    chosen = {"status": status, **further}
    return RunRecord(
        id=new_run_id(), kind=kind, configuration=configuration, config=config, started=wall_clock(), **chosen
    )


class RunStore:
    """The runs under one folder. Safe from any thread and process."""

    def __init__(self, root: Path, topic_rate: float | None = None) -> None:
        """Under that folder; `topic_rate` is the most messages a second of each topic of a log beside its ticks."""
        self.root, self.topic_rate = root, topic_rate
        self.remarks_lock = threading.RLock()
        """Held by who changes what people added, from reading to writing it."""

    def make_root(self) -> Self:
        """Make the folder of all runs, if it is not there; at a start only: one that goes later has been lost."""
        self.root.mkdir(parents=True, exist_ok=True)
        return self

    def create(self, record: RunRecord, beginning: Beginning | None = None) -> None:
        """Make the folder of a run that waits for its writer; one that begins on the way begins there.

        Raises:
            FileNotFoundError: the folder of all runs is gone.

        """
        folder = self.root / record.id
        folder.mkdir()
        try:
            if beginning is not None:
                beginning.write(folder / BEGINNING_NAME)
            write_record(folder, record)
        except BaseException:
            remove_folder(folder, RECORD_NAME)
            raise

    def write(self, record: RunRecord) -> RunWriter:
        """A writer for this run.

        Raises:
            BlockingIOError: another process is writing it.
            FileNotFoundError: the folder of all runs is gone.

        """
        folder = self.root / record.id
        folder.mkdir(exist_ok=True)
        return RunWriter(folder, record, topic_rate=self.topic_rate)

    def read(self, run_id: str) -> RunReader:
        """A reader of this run.

        Raises:
            RunNotFound: there is none with that identifier.
            StoredUnreadable: its record cannot be read.

        """
        return RunReader(self._folder(run_id), self.record(run_id))

    def find(self, run_id: str) -> RunReader | None:
        """A reader of this run, or None if it is gone or cannot be read."""
        try:
            return self.read(run_id)
        except (RunNotFound, StoredUnreadable):
            return None

    def record(self, run_id: str) -> RunRecord:
        """The record of this run, recovered first if the process that wrote it is gone, or of an earlier version.

        Raises:
            RunNotFound: there is none with that identifier.
            StoredUnreadable: it cannot be read: damaged, of another version or another run, not permitted.

        """
        folder = self._folder(run_id)
        try:
            record = _current_record(folder)
            if record.integrity is None and record.status != "queued" and not is_locked(folder / LOCK_NAME):
                record = _recovered(folder)
        except FileNotFoundError:  # perhaps removed at this very moment
            raise _not_found(run_id) from None
        except OSError as error:
            what = Path(str(error.filename)).name if error.filename else RECORD_NAME
            raise StoredUnreadable(f"{what} cannot be read: {error.strerror}") from error
        return record

    def newest(self) -> Iterator[RunReader]:
        """The runs, newest first."""
        names = (path.name for path in self.root.glob("*") if RUN_ID.fullmatch(path.name)) if self.root.exists() else ()
        for name in sorted(names, reverse=True):
            reader = self.find(name)
            if reader is not None:  # else deleted since, only just made, or of another version: the index reports it
                yield reader

    def recover(self) -> None:
        """Put right what a crash has left, before anything asks for it."""
        for _ in self.newest():
            continue

    def latest(self) -> RunReader:
        """The newest run with ticks.

        Raises:
            RunNotFound: there is none.

        """
        for reader in self.newest():
            if reader.tick_count:
                return reader
        raise RunNotFound("the library holds no run with ticks yet", tip="becalm run flies one")

    def remark(self, run_id: str, remarks: Remarks) -> None:
        """Put these remarks in place of the run's.

        Raises:
            RunNotFound: there is none with that identifier.
            StoredUnreadable: those that are there cannot be read, and are left for whoever can repair them.

        """
        folder = self._folder(run_id)
        with self.remarks_lock:
            read_remarks(folder)
            write_remarks(folder, remarks)

    def keep_foreseen(self, run_id: str, outline: bytes) -> None:
        """Keep what was foreseen of a run (JSON); of one that is gone nothing is."""
        with suppress(RunNotFound, FileNotFoundError):
            replace_file(self._folder(run_id) / FORESEEN_NAME, outline)

    def cancel(self, run_id: str) -> None:
        """Ask the process that writes this run to end it."""
        (self._folder(run_id) / CANCEL_NAME).touch()

    def delete(self, run_id: str) -> None:
        """Remove a run that has ended, or one that cannot be read and that nobody writes.

        Raises:
            RunNotFound: there is none with that identifier.
            MissionRefused: it has not ended.
            OSError: it cannot be removed.

        """
        folder = self._folder(run_id)
        try:
            ended = self.record(run_id).ended
        except StoredUnreadable:
            ended = True  # for all that can be known
        if not ended or is_locked(folder / LOCK_NAME):
            raise MissionRefused(f"run {run_id} has not ended", tip="cancel or reset it first")
        self.discard(run_id)

    def discard(self, run_id: str) -> None:
        """Remove a run, whatever its state; one that was never written is gone already."""
        if not RUN_ID.fullmatch(run_id):
            raise _not_found(run_id)
        folder = self.root / run_id
        remove_folder(folder, RECORD_NAME)

    def _folder(self, run_id: str) -> Path:
        folder = self.root / run_id
        if not RUN_ID.fullmatch(run_id) or not folder.is_dir():
            raise _not_found(run_id)
        return folder


def _current_record(folder: Path) -> RunRecord:
    """The record in that folder, brought to today's format."""
    try:
        return read_record(folder)
    except StoredUnreadable as error:
        if isinstance(error.__cause__, OSError) or not upgraded(folder):
            raise
    return read_record(folder)


def _not_found(run_id: str) -> RunNotFound:
    return RunNotFound(f"run {run_id!r} does not exist", tip="GET /api/v1/runs lists the runs")


def _recovered(folder: Path) -> RunRecord:
    """The run of a process that is gone, with what it truly has; its log and record are put right on disk."""
    try:
        lock = ProcessLock(folder / LOCK_NAME)
    except BlockingIOError:
        return read_record(folder)  # somebody is at it
    try:
        record = read_record(folder)
        if record.integrity is None and record.status != "queued":
            record = _repaired(folder, record)
    finally:
        lock.release()
    return record


def _repaired(folder: Path, record: RunRecord) -> RunRecord:
    reader = RunReader(folder, record)
    found = reader.scanned()
    last = reader.last_tick()
    changes = {
        "status": record.status if record.ended else "failed" if record.outcome is None else "finished",
        "duration": 0.0 if last is None else float(last["time"][0]),
        "ticks": found.contents.statistics.channel_message_counts.get(TICK_CHANNEL, 0),
        "integrity": "complete" if found.closed else "recovered",
        "lost_at_most": None if found.closed else LOST_AT_MOST,
        "note": record.note if found.closed or record.ended else RECOVERED_NOTE,
    }
    recovered = record.model_copy(update=changes)
    try:
        if reader.has_log:
            repair_log(reader.log_path)
        write_record(folder, recovered)
    except OSError as error:  # a full disk, for one: it is reported as it is, and repaired at a later look
        log.warning("run %s is recovered in memory only: %s", record.id, error)
    return recovered
