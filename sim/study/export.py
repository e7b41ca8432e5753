"""A study's table as a file for other tools: CSV, Parquet or JSON, ordered by cell.

Numbers are written so that reading them gives the same double; a file is never there half.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from enum import StrEnum
from itertools import islice
from pathlib import Path

import pyarrow as pa

from sim.files import replacing
from sim.study.run import Column
from sim.study.table import StudyRows
from sim.tabular import csv_header, csv_rows, parquet

_BATCH = 10_000  # rows in memory at a time
_ARROW_TYPES = {float: pa.float64(), int: pa.int64(), bool: pa.bool_(), str: pa.string()}


class TableFormat(StrEnum):
    """The formats of a table file; also their suffixes."""

    CSV = "csv"
    PARQUET = "parquet"
    JSON = "json"


def export(table: StudyRows, path: Path, table_format: TableFormat) -> None:
    """Write the table; the file appears when it is whole, in place of one that was there.

    Args:
        table: the study's, whole or not.
        path: of the file.
        table_format: CSV has a header line, and values as `sim.tabular` writes them; JSON is a list of objects;
            Parquet carries each column's unit and description, and the study's definition.

    """
    write = {TableFormat.CSV: _csv, TableFormat.PARQUET: _parquet, TableFormat.JSON: _json}
    with replacing(path) as draft, draft.open("xb") as file:
        for piece in write[table_format](table):
            file.write(piece)


def _csv(table: StudyRows) -> Iterator[bytes]:
    schema = _schema(table)
    yield csv_header(schema)
    for batch in _batches(table, schema):
        yield from csv_rows(batch)


def _json(table: StudyRows) -> Iterator[bytes]:
    yield b"["
    for place, row in enumerate(table.rows()):
        yield (("," if place else "") + "\n" + json.dumps(row)).encode()
    yield b"\n]\n"


def _parquet(table: StudyRows) -> Iterator[bytes]:
    schema = _schema(table)
    return parquet(schema, _batches(table, schema))


def _schema(table: StudyRows) -> pa.Schema:
    metadata = {"study": json.dumps(table.study.definition()), "config": table.study.base.model_dump_json()}
    return pa.schema(map(_field, table.columns), metadata)


def _field(column: Column) -> pa.Field:
    return pa.field(
        column.name, _ARROW_TYPES[column.kind], metadata={"unit": column.unit, "description": column.description}
    )


def _batches(table: StudyRows, schema: pa.Schema) -> Iterator[pa.RecordBatch]:
    remaining = table.rows()
    while rows := list(islice(remaining, _BATCH)):
        yield pa.RecordBatch.from_pylist(rows, schema=schema)
