"""The index of the library: always as the folders are, whatever happened to it."""

from __future__ import annotations

import sqlite3

import pytest

from server import run_index
from server.run_folder import Note, Remarks, write_record
from server.run_index import FILE_NAME, RunIndex, RunQuery
from server.runs import RunStore, new_record
from sim.config import MissionConfig
from sim.errors import ConfigError


@pytest.fixture
def store(tmp_path):
    return RunStore(tmp_path / "runs")


@pytest.fixture
def index(store):
    return RunIndex(store)


def kept(store, **fields):
    """A run that has ended."""
    record = new_record("scripted", fields.pop("configuration", "published"), MissionConfig())
    record = record.model_copy(update={"status": "finished", "integrity": "complete", **fields})
    store.create(record)
    return record.id


def found(index, limit=100, after=None, **wishes):
    return index.find(RunQuery(**wishes), limit, after).ids


def test_newest_first_page_by_page(store, index):
    ids = sorted((kept(store) for _ in range(5)), reverse=True)
    first = index.find(RunQuery(), 2)
    assert first == (ids[:2], ids[1])
    second = index.find(RunQuery(), 2, first.following)
    assert index.find(RunQuery(), 2, second.following) == (ids[4:], None)


def test_what_is_written_changed_or_removed_is_known_at_once(store, index):
    assert found(index) == []
    run = kept(store)
    assert found(index, starred=True) == []
    store.remark(run, Remarks(starred=True, notes=(Note(text="The left hand SLIPS"),)))
    assert found(index, starred=True) == found(index, text="hand slips") == [run]
    store.delete(run)
    assert found(index) == []


def test_filters_fit_together(store, index):
    soft = kept(store, configuration="published (edited)", parent="p", duration=2.0)
    kept(store, configuration="as_printed", duration=1.0)
    assert found(index, configuration="published") == [soft]
    assert found(index, parent="p", kind="scripted", status="finished") == [soft]
    assert found(index, parent="p", kind="live") == []


@pytest.mark.parametrize(("ascending", "order"), [(False, [3.0, 2.0, 1.0]), (True, [1.0, 2.0, 3.0])])
def test_by_any_figure_and_over_pages(store, index, ascending, order):
    runs = {kept(store, duration=duration): duration for duration in (2.0, 3.0, 1.0)}
    pages, after = [], None
    while True:
        page = index.find(RunQuery(sort="duration", ascending=ascending), 1, after)
        pages += page.ids
        after = page.following
        if after is None:
            break
    assert [runs[run] for run in pages] == order


@pytest.mark.parametrize("ascending", [True, False])
def test_runs_without_the_figure_come_last(store, index, ascending):
    without = {kept(store) for _ in range(2)}
    assert set(found(index, sort="peak_tip_force", ascending=ascending)) == without
    assert set(found(index, sort="outcome", ascending=ascending)) == without


def test_a_cursor_that_is_gone_is_said(store, index):
    kept(store)
    with pytest.raises(ConfigError, match="that run is gone"):
        found(index, sort="duration", after="20260101T000000000-abcdef")


def test_of_another_schema_it_is_made_anew(store, index, monkeypatch):
    run = kept(store)
    assert found(index) == [run]
    monkeypatch.setattr(run_index, "SCHEMA", run_index.SCHEMA + 1)
    assert found(index) == [run]


def test_damaged_it_is_made_anew(store, index):
    run = kept(store)
    assert found(index) == [run]
    (store.root / FILE_NAME).write_bytes(b"no database at all" * 100)
    assert found(index) == [run]


def test_without_room_for_it_runs_are_found_all_the_same(store, index, monkeypatch):
    run = kept(store)
    connect = sqlite3.connect

    def full(path, **options):
        if path != ":memory:":
            raise sqlite3.OperationalError("database or disk is full")
        return connect(path, **options)

    monkeypatch.setattr(sqlite3, "connect", full)
    assert found(index) == [run]


def test_a_damaged_record_is_told_until_it_is_mended(store, index):
    run = kept(store)
    record = store.record(run)
    (store.root / run / "run.json").write_text("{")
    assert found(index) == []
    assert "damaged" in index.unreadable()[run]
    write_record(store.root / run, record)
    assert (found(index), index.unreadable()) == ([run], {})
