"""A run's ticks as CSV, Parquet and MCAP, in chunks of bounded size, also of a run in progress.

One row a tick; columns are named `group.quantity.axis` and every number keeps all its bits. Of a run of another version
what its log lacks is missing, and what today's version does not know is there under the name that the log has for it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal, NamedTuple

import numpy as np
import pyarrow as pa

from server.library.reader import RunReader, StoredTicks
from server.library.record import LoggedEvent
from server.log.writer import LogWriter
from sim.capture.tick import COLUMNS, TICK, all_column_values
from sim.tabular import Sink, csv_header, csv_rows, parquet

LogFormat = Literal["csv", "parquet", "mcap"]
MEDIA_TYPES: dict[LogFormat, str] = {
    "csv": "text/csv; charset=utf-8",
    "parquet": "application/vnd.apache.parquet",
    "mcap": "application/x-mcap",
}
_PIECE = 2**18


class Span(NamedTuple):
    """A part of a run, in mission time [s]."""

    since: float | None = None
    until: float | None = None


WHOLE = Span()


def exported(reader: RunReader, log_format: LogFormat, span: Span = WHOLE) -> Iterator[bytes]:
    """The run's ticks in that format, piece by piece."""
    if log_format == "mcap":
        return _mcap(reader) if span == WHOLE else _mcap_of(reader, span)
    return _csv(reader, span) if log_format == "csv" else _parquet(reader, span)


def _mcap(reader: RunReader) -> Iterator[bytes]:
    """The log as it stands on disk, up to its last whole chunk; closed if it is not yet."""
    found = reader.scanned()
    with reader.log_path.open("rb") as file:
        left = found.intact
        while left > 0 and (piece := file.read(min(_PIECE, left))):
            left -= len(piece)
            yield piece
    if not found.closed:
        yield found.contents.ending(found.intact)


def _mcap_of(reader: RunReader, span: Span) -> Iterator[bytes]:
    """A log of a part, written again."""
    sink, record = Sink(), reader.record
    writer = LogWriter(sink, record.started, record.config, reader.layout().schema)
    writer.describe(record, record.config)
    for ticks, payloads in reader.stored_chunks(*span):
        writer.append(ticks, payloads)
        writer.flush()
        yield sink.taken()
    for event in reader.events():
        if (span.since or 0.0) <= event["time"] <= (math.inf if span.until is None else span.until):
            writer.log(LoggedEvent.model_validate(event))
    if record.outcome is not None:
        writer.conclude(record.outcome)
    writer.end()
    yield sink.taken()


class _Table:
    """A run's ticks as rows: the columns of today, then those that only its log has; what it lacks is null."""

    def __init__(self, reader: RunReader) -> None:
        self._layout = reader.layout()
        self._absent = {column.name for column in self._layout.absent}
        todays = [
            pa.field(
                column.name,
                pa.from_numpy_dtype(TICK[column.quantity].base),
                column.name in self._absent,
                {"unit": column.unit},
            )
            for column in COLUMNS
        ]
        further = [
            pa.field(each.name, pa.from_numpy_dtype(np.dtype(each.kind)), False, {"unit": each.unit})
            for each in self._layout.further
        ]
        record = reader.record
        outcome = record.outcome.model_dump_json() if record.outcome else "null"
        metadata = {"run": record.id, "config": record.config.model_dump_json(), "outcome": outcome}
        self.schema = pa.schema([*todays, *further], metadata)

    def units(self) -> list[str]:
        """Every column with its unit, for people."""
        return [f"{field.name} [{field.metadata[b'unit'].decode()}]" for field in self.schema]

    def batch(self, stored: StoredTicks) -> pa.RecordBatch:
        """These ticks."""
        count = len(stored.ticks)
        todays = [
            pa.nulls(count, self.schema.field(column.name).type) if column.name in self._absent else pa.array(values)
            for column, values in zip(COLUMNS, all_column_values(stored.ticks), strict=True)
        ]
        further = [pa.array(self._layout.values(stored.payloads, each)) for each in self._layout.further]
        return pa.RecordBatch.from_arrays([*todays, *further], schema=self.schema)


def _csv(reader: RunReader, span: Span) -> Iterator[bytes]:
    table = _Table(reader)
    lines = [f"# Becalm run {reader.record.id}, one row a tick; units:"]
    lines += [f"# {column}" for column in table.units()]
    yield ("\n".join(lines) + "\n").encode() + csv_header(table.schema)
    for stored in reader.stored_chunks(*span):
        yield from csv_rows(table.batch(stored))


def _parquet(reader: RunReader, span: Span) -> Iterator[bytes]:
    table = _Table(reader)
    return parquet(table.schema, map(table.batch, reader.stored_chunks(*span)))
