"""A run's ticks as CSV, Parquet and MCAP, in chunks of bounded size, also of a run in progress.

One row a tick; columns are named `group.quantity.axis` and every number keeps all its bits.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal, NamedTuple

import numpy as np
import pyarrow as pa

from server.log.writer import LogWriter
from server.run_folder import LoggedEvent, RunReader, TickArray
from sim.capture.tick import COLUMNS, TICK, column_values
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
    """A log of a part, written anew."""
    sink, record = Sink(), reader.record
    writer = LogWriter(sink, record.started, record.config)
    writer.describe(record, record.config)
    for ticks in reader.chunks(*span):
        writer.append(ticks)
        writer.flush()
        yield sink.taken()
    for event in reader.events():
        if (span.since or 0.0) <= event["time"] <= (math.inf if span.until is None else span.until):
            writer.log(LoggedEvent.model_validate(event))
    if record.outcome is not None:
        writer.conclude(record.outcome)
    writer.end()
    yield sink.taken()


def table_schema(reader: RunReader) -> pa.Schema:
    """The columns with their units, and what the run was flown with, as Parquet keeps them."""
    fields = [
        pa.field(column.name, pa.from_numpy_dtype(TICK[column.quantity].base), False, {"unit": column.unit})
        for column in COLUMNS
    ]
    record = reader.record
    outcome = record.outcome.model_dump_json() if record.outcome else "null"
    metadata = {"run": record.id, "config": record.config.model_dump_json(), "outcome": outcome}
    return pa.schema(fields, metadata)


def _batch(ticks: TickArray, schema: pa.Schema) -> pa.RecordBatch:
    arrays = [pa.array(np.ascontiguousarray(column_values(ticks, column))) for column in COLUMNS]
    return pa.RecordBatch.from_arrays(arrays, schema=schema)


def _csv(reader: RunReader, span: Span) -> Iterator[bytes]:
    schema = table_schema(reader)
    lines = [f"# Becalm run {reader.record.id}, one row a tick; units:"]
    lines += [f"# {column.name} [{column.unit}]" for column in COLUMNS]
    yield ("\n".join(lines) + "\n").encode() + csv_header(schema)
    for ticks in reader.chunks(*span):
        yield from csv_rows(_batch(ticks, schema))


def _parquet(reader: RunReader, span: Span) -> Iterator[bytes]:
    schema = table_schema(reader)
    return parquet(schema, (_batch(ticks, schema) for ticks in reader.chunks(*span)))
