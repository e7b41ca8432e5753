"""The service's store of studies: whole records, newest first, rows beside them."""

from __future__ import annotations

import pytest

from server.errors import StudyNotFound
from server.studies.store import RECORD_NAME, StudyStore
from sim.study.design import study_of
from sim.study.run import failed_row
from sim.study.table import StudyTable

STUDY = study_of({"name": "three", "grid": {"published.impedance.mass": [0.05, 0.1, 0.2]}})


@pytest.fixture
def store(tmp_path):
    return StudyStore(tmp_path / "studies").make_root()


def test_a_study_comes_back_as_it_was(store):
    record = store.create(STUDY)
    assert store.record(record.id) == record
    assert record.study == STUDY
    assert (record.status, record.cells, record.done) == ("queued", 3, 0)


def test_the_newest_comes_first_and_a_cursor_goes_on(store):
    ids = [store.create(STUDY).id for _ in range(3)]
    newest = sorted(ids, reverse=True)
    assert [record.id for record in store.newest()] == newest
    assert [record.id for record in store.newest(before=newest[0])] == newest[1:]


def test_a_revision_is_on_disk(store):
    record = store.create(STUDY)
    store.revise(record.id, status="failed", note="no room")
    assert StudyStore(store.root).record(record.id).note == "no room"


def test_rows_are_read_while_they_are_written(store):
    record = store.create(STUDY)
    rows = store.rows(record)
    assert list(rows.rows()) == []
    with StudyTable(store.table_path(record.id), STUDY) as table:
        table.add(failed_row(STUDY.cell(2), "odd"))
        table.add(failed_row(STUDY.cell(0), "odd"))
        assert [row["cell"] for row in rows.rows()] == [0, 2]
        assert list(rows.rows("cell")) == [{"cell": 0}, {"cell": 2}]
        first = rows.rows_after(0, 1)
        assert [kept.row["cell"] for kept in first] == [2]
        assert [kept.row["cell"] for kept in rows.rows_after(first[-1].sequence, 10)] == [0]
    assert len(rows) == 2


@pytest.mark.parametrize("study_id", ["20261125T103000123-4f9a2c", "../../etc", ""])
def test_an_unknown_study_is_said(store, study_id):
    store.create(STUDY)
    with pytest.raises(StudyNotFound, match="does not exist"):
        store.record(study_id)


def test_a_record_of_another_version_hides_no_other(store):
    kept, odd = store.create(STUDY), store.create(STUDY)
    (store.root / odd.id / RECORD_NAME).write_text('{"id": "of tomorrow"}')
    assert [record.id for record in store.newest()] == [kept.id]


def test_what_is_deleted_is_gone(store):
    record = store.create(STUDY)
    store.delete(record.id)
    assert not list(store.root.iterdir())
