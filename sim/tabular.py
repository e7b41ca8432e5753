"""Tables as CSV and Parquet, in pieces of bounded size: every export of Becalm is written by it.

CSV keeps what a column is, so that readers which guess by the text see it: a double always has a point or an exponent
(`0.0`, `1e-7`) and reads back as the same double, an integer has neither; `NaN`, `inf` and `-inf`; `true` and
`false`; an empty field where there is no value, quotes around a text that needs them.
"""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator
from itertools import groupby
from typing import Any

import numpy as np
import orjson
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet

ROW_GROUP = 100_000
"""Rows of a group of a Parquet file: readers take one at a time."""

CSV_ROWS = 4096
"""Rows that are text at the same time."""


def csv_header(schema: pa.Schema) -> bytes:
    """The line of the columns' names."""
    return (",".join(_quoted(pa.array(schema.names)).to_pylist()) + "\n").encode()


def csv_rows(batch: pa.RecordBatch) -> Iterator[bytes]:
    """The lines of the rows."""
    for start in range(0, batch.num_rows, CSV_ROWS):
        part = batch.slice(start, CSV_ROWS)
        fields = [_block_texts(columns) for columns in _blocks(part.columns)]
        yield ("\n".join(map(",".join, zip(*fields, strict=True))) + "\n").encode()


def _blocks(columns: list[pa.Array]) -> Iterator[list[pa.Array]]:
    """Columns of numbers of one type that stand together, and every other one for itself."""
    for kind, alike in groupby(columns, _number_type):
        standing_together = list(alike)
        yield from [standing_together] if kind is not None else ([column] for column in standing_together)


def _number_type(column: pa.Array) -> str | None:
    """The name of Numpy's type for a column of numbers that all are there; None for any other column.

    The name, for Numpy takes None for float64 when it compares types.
    """
    if column.null_count or not (pa.types.is_floating(column.type) or pa.types.is_integer(column.type)):
        return None
    kind = np.dtype(column.type.to_pandas_dtype())
    return "int64" if kind.kind in "iu" and kind != np.uint64 else kind.name


def _block_texts(columns: list[pa.Array]) -> list[str]:
    """The text of each row of these columns, with commas between them."""
    kind = _number_type(columns[0])
    if kind is not None:
        return _number_texts(np.column_stack([column.to_numpy() for column in columns]).astype(kind, copy=False))
    (column,) = columns
    if pa.types.is_floating(column.type):
        numbers = column.to_numpy(zero_copy_only=False)[:, np.newaxis]
        missing = column.is_null().to_pylist()
        return ["" if none else text for none, text in zip(missing, _number_texts(numbers), strict=True)]
    text = _quoted(column) if pa.types.is_string(column.type) else column.cast(pa.string())
    return [each or "" for each in text.to_pylist()]


def _number_texts(numbers: np.ndarray[Any, np.dtype[Any]]) -> list[str]:
    """The text of each row of numbers, shape (rows, columns); a double's is the shortest that reads back the same."""
    rows = orjson.dumps(numbers, option=orjson.OPT_SERIALIZE_NUMPY).decode()[2:-2].split("],[")
    if numbers.dtype.kind != "f":
        return rows
    for place in np.flatnonzero(~np.isfinite(numbers).all(axis=1)).tolist():  # JSON has no word for them
        odd = ((text, _ODD.get(text)) for text in map(str, numbers[place].tolist()))
        rows[place] = ",".join(fitting or text for text, (_, fitting) in zip(rows[place].split(","), odd, strict=True))
    return rows


_ODD = {"nan": "NaN", "inf": "inf", "-inf": "-inf"}


def _quoted(column: pa.Array) -> pa.Array:
    """Texts in quotes where a comma, a quote, a line's end or nothing at all would be misread."""
    doubled = pc.replace_substring(column, '"', '""')
    needs = pc.match_substring_regex(column, '[",\r\n]|^$')
    return pc.if_else(needs, pc.binary_join_element_wise('"', doubled, '"', ""), column)


def parquet(schema: pa.Schema, batches: Iterable[pa.RecordBatch]) -> Iterator[bytes]:
    """A Parquet file with these columns and their metadata, piece by piece."""
    sink = Sink()
    waiting: list[pa.RecordBatch] = []
    rows = 0
    # Doubles hardly ever repeat: a dictionary of them costs twice the time and a quarter more space.
    repeating = [field.name for field in schema if not pa.types.is_floating(field.type)]
    with pyarrow.parquet.ParquetWriter(sink, schema, compression="zstd", use_dictionary=repeating) as writer:
        for batch in batches:
            waiting.append(batch)
            rows += batch.num_rows
            while rows >= ROW_GROUP:
                table = pa.Table.from_batches(waiting, schema)
                writer.write_table(table.slice(0, ROW_GROUP), ROW_GROUP)
                waiting = table.slice(ROW_GROUP).to_batches()
                rows -= ROW_GROUP
                yield sink.taken()
        if rows:
            writer.write_table(pa.Table.from_batches(waiting, schema), ROW_GROUP)
    yield sink.taken()


class Sink(io.RawIOBase):
    """A file that only remembers what was written to it since it was last emptied."""

    def __init__(self) -> None:
        super().__init__()
        self._pieces: list[bytes] = []
        self._position = 0

    def writable(self) -> bool:
        """Always."""
        return True

    def tell(self) -> int:
        """Bytes written until now."""
        return self._position

    def write(self, piece: Any) -> int:
        """Take it all."""
        content = bytes(piece)
        self._pieces.append(content)
        self._position += len(content)
        return len(content)

    def taken(self) -> bytes:
        """What was written since the last call."""
        pieces, self._pieces = self._pieces, []
        return b"".join(pieces)
