"""A study's table as a file for other tools: CSV, Parquet or JSON, ordered by cell.

Numbers are written so that reading them gives the same double; a file is never there half.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable, Iterator, Sequence
from enum import StrEnum
from itertools import islice
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet

from sim.study.run import Column, Row
from sim.study.table import StudyRows

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
        table_format: CSV has a header line, an empty field where there is no value, `true` and `false`; JSON is a
            list of objects; Parquet carries each column's unit and description, and the study's definition.

    """
    draft = path.with_name(path.name + ".part")
    write = {TableFormat.CSV: _write_csv, TableFormat.PARQUET: _write_parquet, TableFormat.JSON: _write_json}
    write[table_format](table, draft)
    draft.replace(path)


def _write_csv(table: StudyRows, path: Path) -> None:
    names = [column.name for column in table.columns]
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, names, lineterminator="\n")
        writer.writeheader()
        writer.writerows(map(_with_words, table.rows()))


def _with_words(row: Row) -> dict[str, Any]:
    """Truth values as JSON writes them."""
    return {name: str(value).lower() if isinstance(value, bool) else value for name, value in row.items()}


def _write_json(table: StudyRows, path: Path) -> None:
    with path.open("w", encoding="utf-8") as file:
        file.write("[")
        for place, row in enumerate(table.rows()):
            file.write(("," if place else "") + "\n" + json.dumps(row))
        file.write("\n]\n")


def _write_parquet(table: StudyRows, path: Path) -> None:
    schema = _schema(table)
    with pyarrow.parquet.ParquetWriter(path, schema, compression="zstd") as writer:
        for rows in _batches(table.rows()):
            writer.write_batch(pa.RecordBatch.from_pylist(rows, schema=schema))


def _schema(table: StudyRows) -> pa.Schema:
    metadata = {"study": json.dumps(table.study.definition()), "config": table.study.base.model_dump_json()}
    return pa.schema(map(_field, table.columns), metadata)


def _field(column: Column) -> pa.Field:
    return pa.field(
        column.name, _ARROW_TYPES[column.kind], metadata={"unit": column.unit, "description": column.description}
    )


def _batches(rows: Iterable[dict[str, Any]]) -> Iterator[Sequence[dict[str, Any]]]:
    remaining = iter(rows)
    while batch := list(islice(remaining, _BATCH)):
        yield batch
