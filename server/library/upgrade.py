"""Runs of earlier versions, brought to today's format at the first look, bit for bit, in their own folder.

    format 1    ticks.bin instead of log.mcap: raw records, whose layout stands in run.json, which names no format

The record is replaced last. A crash on the way leaves the old run, and the next look starts over.
"""

from __future__ import annotations

import hashlib
import json
import logging
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from server.library.folder import LOCK_NAME, LOG_NAME, LOST_AT_MOST, RECORD_NAME, read_events, write_record
from server.library.reader import RunReader
from server.library.record import RunRecord, TickArray, record_of_today
from server.library.writer import RunWriter
from server.log.ticks import StoredColumn, TickLayout, field_name, schema_of
from sim.capture.tick import QUANTITIES, columns_of
from sim.file_lock import ProcessLock
from sim.schema_history import TICK_CHANGES, todays_name

TICKS_NAME = "ticks.bin"
DRAFT_NAME = ".upgrade"
CHUNK_ROWS = 8192
"""Ticks read at once: about 5 MB, whatever the length of the run."""

log = logging.getLogger(__name__)


def upgraded(folder: Path) -> bool:
    """Bring the run in this folder to today's format; False if it is of none that is known, or cannot be written."""
    try:
        lock = ProcessLock(folder / LOCK_NAME)
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
        lock.release()
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
    record = RunRecord.model_validate_json(json.dumps(record_of_today(document)))
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


class _Elements(NamedTuple):
    """The numbers of one field of a record, and the column that each becomes."""

    field: str
    columns: list[StoredColumn]


def _elements(stored: np.dtype[Any]) -> list[_Elements]:
    """The columns that a log will have; those of a field that is not known are numbered."""
    known = {quantity.name: columns_of(quantity) for quantity in QUANTITIES}
    found = []
    for name in stored.names or ():
        kind, shape = stored[name].base.str[1:], stored[name].shape
        count = int(np.prod(shape, dtype=int))
        columns = known.get(todays_name(name, TICK_CHANGES) or "", [])
        if len(columns) == count:
            named = [StoredColumn(field_name(each), kind, each.unit) for each in columns]
        else:
            named = [StoredColumn(f"{name}_{place}" if shape else name, kind, "1") for place in range(count)]
        found.append(_Elements(name, named))
    return found


def _rewritten(folder: Path, record: RunRecord, stored: np.dtype[Any]) -> RunRecord:
    """The record of a log that has been rewritten beside the old one, and read back."""
    draft = folder / DRAFT_NAME
    shutil.rmtree(draft, ignore_errors=True)
    draft.mkdir()
    layout = TickLayout(schema_of([column for each in _elements(stored) for column in each.columns]))
    writer = RunWriter(draft, record, layout.schema)
    events = iter(list(read_events(folder)))
    event = next(events, None)
    for payloads in _payloads(folder / TICKS_NAME, stored, layout):
        ticks = layout.ticks(payloads)
        while event is not None and event.time <= ticks["time"][-1]:
            writer.log(event)
            event = next(events, None)
        writer.append(ticks, payloads)
    for late in (event, *events):
        if late is not None:
            writer.log(late)
    writer.close()
    _require_same(RunReader(draft, writer.record), _payloads(folder / TICKS_NAME, stored, layout))
    return writer.record if record.ended else writer.record.model_copy(update=_cut_off(record))


def _cut_off(record: RunRecord) -> dict[str, Any]:
    """Of a run whose process ended without closing it."""
    note = "recovered: the process that recorded it ended without closing it; every whole tick is here"
    status = "failed" if record.outcome is None else "finished"
    return {"status": status, "integrity": "recovered", "lost_at_most": LOST_AT_MOST, "note": note}


def _payloads(path: Path, stored: np.dtype[Any], layout: TickLayout) -> Iterator[TickArray]:
    """The whole ticks in that file, with every field that it has, as a log keeps them."""
    elements = _elements(stored)
    with path.open("rb") as file:
        while content := file.read(CHUNK_ROWS * stored.itemsize):
            rows = np.frombuffer(content[: len(content) // stored.itemsize * stored.itemsize], stored)
            values: dict[str, TickArray] = {}
            for field, columns in elements:
                numbers = rows[field].reshape(len(rows), len(columns))
                values |= {column.name: numbers[:, place] for place, column in enumerate(columns)}
            if len(rows):
                yield layout.packed(values, len(rows))


def _require_same(reader: RunReader, payloads: Iterator[TickArray]) -> None:
    """See that nothing is lost before the old file goes."""
    if _digest(payloads) != _digest(stored.payloads for stored in reader.stored_chunks()):
        raise ValueError("the rewritten log does not read as the old one did")


def _digest(chunks: Iterator[TickArray]) -> bytes:
    digest = hashlib.sha256()
    for payloads in chunks:
        digest.update(payloads.tobytes())
    return digest.digest()
