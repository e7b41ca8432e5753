"""The table of a study on disk: kept row by row, whole again after an interruption, one study's only."""

from __future__ import annotations

import sqlite3

import pytest

from sim.study import table as table_module
from sim.study.design import study_of
from sim.study.run import MEASURES, failed_row
from sim.study.table import StudyTable, TableUnusable, fingerprint

GRID = {"published.impedance.mass": [0.05, 0.1, 0.2], "contact.corner": ["face", "radial"]}
STUDY = study_of({"grid": GRID})
VALUES = {float: 0.1 + 0.2, int: 7, bool: True, str: "caged_force_reduced"}


def row(index: int) -> dict:
    return {
        **failed_row(STUDY.cell(index), ""),
        **{column.name: VALUES[column.kind] for column in MEASURES},
        "error": None,
    }


@pytest.fixture
def path(tmp_path):
    return tmp_path / "cells.sqlite"


def test_rows_come_back_as_they_were_in_the_order_of_cells(path):
    rows = [row(5), failed_row(STUDY.cell(2), "odd"), row(0)]
    with StudyTable(path, STUDY) as table:
        for each in rows:
            table.add(each)
        assert list(table.rows()) == [rows[2], rows[1], rows[0]]
        assert len(table) == 3
        assert list(table.missing()) == [1, 3, 4]


def test_what_was_kept_is_there_after_reopening(path):
    with StudyTable(path, STUDY) as table:
        table.add(row(3))
    with StudyTable(path, STUDY) as table:
        assert len(table) == 1
        assert list(table.rows()) == [row(3)]
        assert list(table.missing()) == [0, 1, 2, 4, 5]


def test_a_cell_is_counted_once(path):
    with StudyTable(path, STUDY) as table:
        table.add(row(3))
        table.add(failed_row(STUDY.cell(3), "again"))
        assert list(table.rows()) == [row(3)]


def test_what_was_kept_survives_without_closing(path, tmp_path):
    with StudyTable(path, STUDY) as table:
        table.add(row(3))
        copy = tmp_path / "copy.sqlite"  # what a killed process leaves behind
        for suffix in ("", "-wal"):
            (tmp_path / f"copy.sqlite{suffix}").write_bytes((tmp_path / f"cells.sqlite{suffix}").read_bytes())
    with StudyTable(copy, STUDY) as table:
        assert list(table.rows()) == [row(3)]


@pytest.mark.parametrize(
    "other",
    [{"grid": GRID, "seed": 1}, {"grid": GRID, "direct": True}, {"grid": {"published.impedance.mass": [0.05]}},
     {"grid": dict(reversed(GRID.items()))}, {"grid": GRID, "changes": {"contact.friction": 0.2}}],
)  # fmt: skip
def test_another_study_is_refused(path, other):
    with StudyTable(path, STUDY) as table:
        table.add(row(0))
    with pytest.raises(TableUnusable, match="is not this one") as refused:
        StudyTable(path, study_of(other))
    assert "--out" in refused.value.tip
    with StudyTable(path, STUDY) as table:
        assert len(table) == 1


def test_another_study_may_have_a_table_that_nothing_was_kept_in(path):
    begun = StudyTable(path, STUDY)
    begun._rows.close()  # as if killed before the first row
    begun._lock.release()
    other = study_of({"grid": {"target.mass": [1.0]}})
    with StudyTable(path, other) as table:
        assert list(table.missing()) == [0]
        table.add(failed_row(other.cell(0), "odd"))


def test_another_version_of_the_code_is_refused(path, monkeypatch):
    with StudyTable(path, STUDY) as table:
        table.add(row(0))
    monkeypatch.setattr(table_module, "code_fingerprint", lambda: ("another",))
    with pytest.raises(TableUnusable, match="version of Becalm"):
        StudyTable(path, STUDY)


def test_name_and_description_do_not_matter():
    assert fingerprint(study_of({"grid": GRID, "name": "other", "description": "..."})) == fingerprint(STUDY)


def test_a_table_without_rows_leaves_no_file(path):
    with StudyTable(path, STUDY):
        assert path.exists()
    assert not path.exists()


def test_a_second_process_is_refused(path):
    with StudyTable(path, STUDY) as table:
        table.add(row(0))
        with pytest.raises(TableUnusable, match="another process"):
            StudyTable(path, STUDY)


def test_a_file_that_is_no_table_is_refused_and_kept(path):
    path.write_text("a letter to my mother " * 100)
    with pytest.raises(TableUnusable, match=r"cells\.sqlite.*not a database"):
        StudyTable(path, STUDY)
    assert path.read_text().startswith("a letter")


def test_a_folder_that_is_not_there_is_said(tmp_path):
    with pytest.raises(TableUnusable, match=r"nowhere.*No such file"):
        StudyTable(tmp_path / "nowhere" / "cells.sqlite", STUDY)


def test_a_full_disk_is_said(path):
    with StudyTable(path, STUDY) as table:
        table.add(row(0))
        table._rows.execute("PRAGMA max_page_count = 1")
        with pytest.raises(TableUnusable, match="full"):
            table.add({**row(1), "error": "x" * 100_000})
    with StudyTable(path, STUDY) as table:
        assert list(table.rows()) == [row(0)]


def test_it_is_a_file_that_sqlite_opens(path):
    with StudyTable(path, STUDY) as table:
        table.add(row(1))
    connection = sqlite3.connect(path)
    found = connection.execute('SELECT "published.impedance.mass", outcome FROM cells').fetchall()
    connection.close()
    assert found == [(0.05, "caged_force_reduced")]
