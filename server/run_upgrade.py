"""Runs of earlier versions, brought to today's format at the first look, bit for bit, in their own folder.

    format 1    ticks.bin instead of log.mcap: raw records, whose layout stands in run.json, which names no format

The record is replaced last. A crash on the way leaves the old run, and the next look begins anew.
"""

from __future__ import annotations

import hashlib
import json
import logging
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from server.files import read_lines
from server.run_folder import (
    CLAIM_NAME,
    EVENTS_NAME,
    LOG_NAME,
    LOST_AT_MOST,
    RECORD_NAME,
    LoggedEvent,
    RunReader,
    RunRecord,
    RunWriter,
    TickArray,
    write_record,
)
from sim.capture.tick import TICK
from sim.claim import Claim

TICKS_NAME = "ticks.bin"
DRAFT_NAME = ".upgrade"
CHUNK_ROWS = 8192
"""Ticks read at once: about 5 MB, whatever the length of the run."""

log = logging.getLogger(__name__)


def upgraded(folder: Path) -> bool:
    """Bring the run in this folder to today's format; False if it is of none that is known, or cannot be written."""
    try:
        claim = Claim(folder / CLAIM_NAME)
    except OSError:  # the earlier version still writes it, or nobody may write here
        return False
    try:
        document = _document(folder)
        if document is None or "layout" not in document:
            return False
        _from_format_1(folder, document)
    except Exception as error:  # anything may stand where a layout or its ticks should
        log.warning("run %s is of an earlier version and cannot be upgraded: %s", folder.name, error)
        return False
    finally:
        shutil.rmtree(folder / DRAFT_NAME, ignore_errors=True)
        claim.release()
    log.info("run %s of an earlier version is upgraded", folder.name)
    return True


def _document(folder: Path) -> dict[str, Any] | None:
    """What run.json holds, if it is a document at all."""
    try:
        found = json.loads((folder / RECORD_NAME).read_bytes())
    except (ValueError, RecursionError):
        return None
    return found if isinstance(found, dict) else None


def _from_format_1(folder: Path, document: dict[str, Any]) -> None:
    layout = document.pop("layout")
    record = RunRecord.model_validate_json(json.dumps(document))
    if record.ended:
        record = record.model_copy(update={"integrity": "complete"})
    if (folder / TICKS_NAME).exists():
        record = _rewritten(folder, record, _dtype(layout))
        (folder / DRAFT_NAME / LOG_NAME).replace(folder / LOG_NAME)
    write_record(folder, record)
    (folder / TICKS_NAME).unlink(missing_ok=True)


def _dtype(layout: dict[str, Any]) -> np.dtype[Any]:
    fields = layout["fields"]
    return np.dtype(
        {
            "names": [field["name"] for field in fields],
            "formats": [(field["kind"], tuple(field["shape"])) for field in fields],
            "offsets": [field["offset"] for field in fields],
            "itemsize": layout["size"],
        }
    )


def _rewritten(folder: Path, record: RunRecord, stored: np.dtype[Any]) -> RunRecord:
    """The record of a log that has been written anew beside the old one, and read back."""
    draft = folder / DRAFT_NAME
    shutil.rmtree(draft, ignore_errors=True)
    draft.mkdir()
    writer = RunWriter(draft, record)
    events = iter(list(_events(folder)))
    event = next(events, None)
    for ticks in _ticks(folder / TICKS_NAME, stored):
        while event is not None and event.time <= ticks["time"][-1]:
            writer.log(event)
            event = next(events, None)
        writer.append(ticks)
    for late in (event, *events):
        if late is not None:
            writer.log(late)
    writer.close()
    _require_same(RunReader(draft, writer.record), folder / TICKS_NAME, stored)
    return writer.record if record.ended else writer.record.model_copy(update=_cut_off(record))


def _cut_off(record: RunRecord) -> dict[str, Any]:
    """Of a run whose process ended without closing it."""
    note = "recovered: the process that recorded it ended without closing it; every whole tick is here"
    status = "failed" if record.outcome is None else "finished"
    return {"status": status, "integrity": "recovered", "lost_at_most": LOST_AT_MOST, "note": note}


def _events(folder: Path) -> Iterator[LoggedEvent]:
    return read_lines(folder / EVENTS_NAME, LoggedEvent)


def _ticks(path: Path, stored: np.dtype[Any]) -> Iterator[TickArray]:
    """The whole ticks in that file; fields that there were not yet are zero."""
    with path.open("rb") as file:
        while content := file.read(CHUNK_ROWS * stored.itemsize):
            rows = np.frombuffer(content[: len(content) // stored.itemsize * stored.itemsize], stored)
            ticks = np.zeros(len(rows), TICK)
            for name in set(TICK.names or ()) & set(stored.names or ()):
                ticks[name] = rows[name]
            yield ticks


def _require_same(reader: RunReader, path: Path, stored: np.dtype[Any]) -> None:
    """See that nothing is lost before the old file goes."""
    if _digest(_ticks(path, stored)) != _digest(reader.chunks()):
        raise ValueError("what was written anew does not read as it was")


def _digest(chunks: Iterator[TickArray]) -> bytes:
    digest = hashlib.sha256()
    for ticks in chunks:
        digest.update(ticks.tobytes())
    return digest.digest()
