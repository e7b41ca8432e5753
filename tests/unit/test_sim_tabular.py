"""Tables for other tools: what a column is stands in every field of it, and no number loses a bit."""

from __future__ import annotations

import csv
import io
import math
import re
import struct

import numpy as np
import pandas
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet
import pytest
from hypothesis import given
from hypothesis import strategies as some

from sim.tabular import CSV_ROWS, ROW_GROUP, csv_header, csv_rows, parquet

DOUBLE = re.compile(r"-?(\d+\.\d+(e[+-]\d+)?|\d+e[+-]\d+|inf)|NaN")
ODD = [0.0, -0.0, 1.0, -3.0, 1e-5, 1e16, 1e20, 1e22, 2.0**53, 5e-324, 1.7976931348623157e308, math.nan, math.inf,
       -math.inf, 0.1 + 0.2, None]  # fmt: skip


def _written(batch) -> str:
    return (csv_header(batch.schema) + b"".join(csv_rows(batch))).decode()


def _bits(value: float) -> bytes:
    return b"NaN" if math.isnan(value) else struct.pack("<d", value)


@given(some.lists(some.one_of(some.floats(), some.integers(-(2**60), 2**60).map(float), some.none()), min_size=1))
def test_every_double_reads_as_a_double_and_as_itself(values):
    lines = _written(pa.record_batch({"x": pa.array(values, pa.float64())})).split("\n")
    assert (lines[0], lines[-1]) == ("x", "")
    for text, value in zip(lines[1:-1], values, strict=True):
        if value is None:
            assert text == ""
        else:
            assert DOUBLE.fullmatch(text), text
            assert _bits(float(text)) == _bits(value)


def test_each_kind_of_column_is_what_readers_take_it_for():
    texts = ["a,b", 'say "no"', "two\nlines", "", None, "=1+1", "é"] * 2 + ["x", "y"]
    batch = pa.record_batch(
        {
            "float": pa.array(ODD, pa.float64()),
            "whole": pa.array(np.arange(16.0)),
            "int": pa.array([7, None] * 8, pa.int64()),
            "bool": pa.array([True, None] * 8),
            "text": pa.array(texts, pa.string()),
        }
    )
    text = _written(batch)
    rows = list(csv.DictReader(io.StringIO(text, newline="")))
    assert [row["text"] for row in rows] == [each or "" for each in texts]
    assert (rows[0]["int"], rows[1]["int"], rows[0]["bool"], rows[1]["bool"]) == ("7", "", "true", "")
    found = pandas.read_csv(io.StringIO(text))
    assert [found[name].dtype.kind for name in ("float", "whole")] == ["f", "f"]
    read = pyarrow.csv.read_csv(
        io.BytesIO(text.encode()), parse_options=pyarrow.csv.ParseOptions(newlines_in_values=True)
    )
    assert read.schema.types == [pa.float64(), pa.float64(), pa.int64(), pa.bool_(), pa.string()]


def test_columns_of_other_kinds_may_stand_beside_doubles():
    columns = {"x": [0.5, 2.0], "text": ["a", "b"], "y": [1.0, 3.0], "bool": [True, False], "z": [4.0, None]}
    columns |= {"n": [5, 6], "w": [7.0, 8.0]}
    text = _written(pa.RecordBatch.from_pydict(columns))
    assert text == "x,text,y,bool,z,n,w\n0.5,a,1.0,true,4.0,5,7.0\n2.0,b,3.0,false,,6,8.0\n"


def test_many_rows_come_in_pieces():
    pieces = list(csv_rows(pa.record_batch({"x": np.arange(2.5 * CSV_ROWS)})))
    assert [piece.count(b"\n") for piece in pieces] == [CSV_ROWS, CSV_ROWS, CSV_ROWS // 2]


@pytest.mark.parametrize("batch_rows", [700, 100_000, 230_001])
def test_parquet_has_groups_of_one_size_and_keeps_what_columns_are(batch_rows):
    rows = 2 * ROW_GROUP + 5
    schema = pa.schema([pa.field("x", pa.float64(), False, {"unit": "m"})], {"run": "r"})
    numbers = np.random.default_rng(1).normal(size=rows)
    batches = (
        pa.record_batch([pa.array(numbers[start : start + batch_rows])], schema=schema)
        for start in range(0, rows, batch_rows)
    )
    file = pyarrow.parquet.ParquetFile(io.BytesIO(b"".join(parquet(schema, batches))))
    assert [file.metadata.row_group(n).num_rows for n in range(file.num_row_groups)] == [ROW_GROUP, ROW_GROUP, 5]
    assert file.read()["x"].to_numpy().tobytes() == numbers.tobytes()
    assert (file.schema_arrow.metadata[b"run"], file.schema_arrow.field("x").metadata[b"unit"]) == (b"r", b"m")


def test_parquet_without_rows_is_a_table_all_the_same():
    schema = pa.schema([("x", pa.float64())])
    assert pyarrow.parquet.read_table(io.BytesIO(b"".join(parquet(schema, [])))).num_rows == 0


def test_parquet_takes_no_more_memory_for_more_rows():
    def most(groups: int) -> int:
        schema = pa.schema([(f"x{n}", pa.float64()) for n in range(8)])
        random = np.random.default_rng(1)
        batches = (
            pa.record_batch([random.normal(size=1000)] * 8, schema=schema) for _ in range(groups * ROW_GROUP // 1000)
        )
        before = pa.total_allocated_bytes()
        return max(pa.total_allocated_bytes() - before for _ in parquet(schema, batches))

    assert most(6) <= most(2) + 1_000_000
