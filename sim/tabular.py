"""Tables as CSV and Parquet, in pieces of bounded size: every export of Becalm is written by it.

CSV keeps what a column is, so that readers which guess by the text see it: a double always has a point or an exponent
(`0.0`, `1e-05`) and reads back as the same double, an integer has neither; `NaN`, `inf` and `-inf`; `true` and
`false`; an empty field where there is no value, quotes around a text that needs them.
"""

from __future__ import annotations

import io
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
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
        fields = [_as_text(column) for column in part.columns]
        lines = pc.binary_join_element_wise(*fields, ",", null_handling="replace", null_replacement="")
        yield ("\n".join(lines.to_pylist()) + "\n").encode()


def _as_text(column: pa.Array) -> pa.Array:
    if pa.types.is_floating(column.type):
        return _doubles(column)
    if pa.types.is_string(column.type):
        return _quoted(column)
    return column.cast(pa.string())


def _doubles(column: pa.Array) -> pa.Array:
    """The shortest text of each number that reads back the same, with a point or an exponent."""
    values = column.to_numpy(zero_copy_only=False)
    text = column.cast(pa.string())
    if np.isnan(values).any():
        text = pc.if_else(pc.is_nan(column), "NaN", text)
    with np.errstate(invalid="ignore"):  # of a NaN of any bits
        whole = np.isfinite(values) & (np.trunc(values) == values)
    if not whole.any():
        return text
    bare = pc.and_(pa.array(whole), pc.invert(pc.match_substring_regex(text, "[.e]")))
    return pc.if_else(bare, pc.binary_join_element_wise(text, ".0", ""), text)


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
    with pyarrow.parquet.ParquetWriter(sink, schema, compression="zstd") as writer:
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
