"""The table as CSV, Parquet and JSON: the same rows in each, number for number."""

from __future__ import annotations

import csv
import json

import pyarrow.parquet
import pytest

from sim.study.design import study_of
from sim.study.export import TableFormat, export
from sim.study.run import MEASURES, failed_row
from sim.study.table import StudyTable

MASS = "published.impedance.mass"
STUDY = study_of({"grid": {MASS: [0.1 + 0.2, 2e-4, 2.0]}})
VALUES = {float: 1.0 / 3.0, int: 7, bool: False, str: "base_collision"}


@pytest.fixture
def table(tmp_path):
    with StudyTable(tmp_path / "cells", STUDY) as table:
        table.add(failed_row(STUDY.cell(2), 'worker died, "twice"\nhere'))
        for index in (1, 0):
            values = {column.name: VALUES[column.kind] for column in MEASURES}
            table.add({**failed_row(STUDY.cell(index), ""), **values, "error": None})
        yield table


def test_csv(table, tmp_path):
    path = tmp_path / "table.csv"
    export(table, path, TableFormat.CSV)
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == [column.name for column in table.columns]
    assert [float(row[MASS]) for row in rows] == [0.1 + 0.2, 2e-4, 2.0]
    assert (rows[0]["outcome"], rows[0]["caged"], float(rows[0]["duration"])) == ("base_collision", "false", 1 / 3)
    assert (rows[2]["outcome"], rows[2]["caged"], rows[2]["duration"]) == ("", "", "")
    assert rows[2]["error"] == 'worker died, "twice"\nhere'


def test_json(table, tmp_path):
    path = tmp_path / "table.json"
    export(table, path, TableFormat.JSON)
    assert json.loads(path.read_text()) == list(table.rows())


def test_parquet(table, tmp_path):
    path = tmp_path / "table.parquet"
    export(table, path, TableFormat.PARQUET)
    read = pyarrow.parquet.read_table(path)
    assert read.to_pylist() == list(table.rows())
    assert read.schema.field(MASS).metadata[b"unit"] == b"kg"
    assert json.loads(read.schema.metadata[b"study"])["grid"] == STUDY.definition()["grid"]
    assert json.loads(read.schema.metadata[b"config"])["target"]["mass"] == STUDY.base.target.mass


def test_a_file_that_was_there_stays_until_the_new_one_is_whole(table, tmp_path, monkeypatch):
    path = tmp_path / "table.csv"
    path.write_text("old")
    monkeypatch.setattr(StudyTable, "rows", lambda _table: (_ for _ in ()).throw(OSError("disk full")))
    with pytest.raises(OSError, match="disk full"):
        export(table, path, TableFormat.CSV)
    assert path.read_text() == "old"
