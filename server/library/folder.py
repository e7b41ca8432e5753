"""One run on disk: a folder that is written while the run happens and can be read at any moment of it.

    run.json      `RunRecord`: configuration, versions, status, outcome; replaced whole, never half-written
    remarks.json  what people added: notes and the star
    foreseen.json of a live run that was rehearsed, or looked ahead of: a `RehearsalResult` in outline
    events.jsonl  one `LoggedEvent` a line: events, commands with their answers, configuration changes
    beginning.npz of a run that begins on the way: what was remembered, and the plant's state (`Beginning`)
    log.mcap      every tick, the events, and what other tools show of them; grows by whole chunks

A reader takes whole chunks and whole lines only, so that a write cut short by a crash costs that one.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from server.errors import StoredUnreadable
from server.files import read_document, read_lines, replace_file
from server.library.record import LoggedEvent, Remarks, RunRecord, event_of_today, record_of_today
from server.log.scan import Scanned, scan
from server.texts import shortened
from sim.rehearsal.rehearsal import RehearsalResult
from sim.snapshot import FrozenMessage

RECORD_NAME = "run.json"
EVENTS_NAME = "events.jsonl"
REMARKS_NAME = "remarks.json"
FORESEEN_NAME = "foreseen.json"
LOG_NAME = "log.mcap"
BEGINNING_NAME = "beginning.npz"
CANCEL_NAME = ".cancel"
LOCK_NAME = ".writing"

LOST_AT_MOST = 1.0
"""Wall time that a crash or a power cut may cost [s]: half of it, and as much for a slow disk."""


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


def read_events(folder: Path, *, strict: bool = False) -> Iterator[LoggedEvent]:
    """The events of the run in that folder, oldest first.

    Args:
        folder: of the run.
        strict: whether a line that cannot be read ends it all; else it is left out.

    Raises:
        StoredUnreadable: the file cannot be read, or with `strict` a line of it.

    """
    return read_lines(folder / EVENTS_NAME, LoggedEvent, strict=strict, upgrade=event_of_today)


def read_foreseen(folder: Path) -> RehearsalResult | None:
    """What was foreseen of the run in that folder, in outline; None if nothing was.

    Raises:
        StoredUnreadable: it is damaged, or of another version.

    """
    try:
        return read_document(folder / FORESEEN_NAME, RehearsalResult)
    except FileNotFoundError:
        return None


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


def _replace(path: Path, content: FrozenMessage) -> None:
    replace_file(path, content.model_dump_json(indent=2).encode())
