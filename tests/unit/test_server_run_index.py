"""The index of the library: always as the folders are, whatever happened to it."""

from __future__ import annotations

import os
import shutil
import sqlite3
import sys
from contextlib import closing
from datetime import datetime, timedelta, timezone

import pytest

from server.library import index as run_index
from server.library.folder import RECORD_NAME, write_record
from server.library.index import FILE_NAME, RunIndex, RunQuery
from server.library.record import Note, Remarks
from server.library.runs import RunStore, new_record
from sim.config import MissionConfig
from sim.configurations import nested, revised
from sim.errors import ConfigError
from sim.snapshot import Outcome, OutcomeClass


@pytest.fixture
def store(tmp_path):
    (tmp_path / "runs").mkdir()
    return RunStore(tmp_path / "runs").make_root()


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
    assert first == (ids[:2], ids[1], 5)
    second = index.find(RunQuery(), 2, first.following)
    assert index.find(RunQuery(), 2, second.following) == (ids[4:], None, 5)
    assert index.find(RunQuery(), 2, skipped=3) == (ids[3:], None, 5)


def test_what_is_written_changed_or_removed_is_known_at_once(store, index):
    assert found(index) == []
    run = kept(store)
    assert found(index, starred=True) == []
    store.remark(run, Remarks(starred=True, notes=(Note(text="The left hand SLIPS"),)))
    assert found(index, starred=True) == found(index, text="hand slips") == [run]
    store.delete(run)
    assert found(index) == []


def outcome(verdict, paper):
    figures = {"peak_tip_force": 0.5, "peak_tip_force_to_closure": 0.4, "final_target_spin": 0.1}
    rest = {"min_manipulability": 0.1, "momentum_error": 0.0, "duration": 9.0, "closed_at": 5.0, "locked_at": 6.0}
    verdicts = {"outcome": verdict, "at_locked_arms": verdict, "at_first_closure": paper}
    return Outcome(**verdicts, caged=verdict[:5] == "caged", cage_margin=0.01, contacts=[], **figures, **rest)


def test_the_verdict_and_the_papers_are_two_filters(store, index):
    blow = kept(store, outcome=outcome("base_collision", "caged_force_reduced"))
    soft = kept(store, outcome=outcome("caged_force_reduced", "caged_force_reduced"))
    assert found(index, outcome=OutcomeClass.CAGED_FORCE_REDUCED) == [soft]
    assert found(index, outcome=OutcomeClass.BASE_COLLISION) == [blow]
    assert sorted(found(index, at_first_closure=OutcomeClass.CAGED_FORCE_REDUCED)) == sorted([blow, soft])
    assert index.tally() == {
        ("scripted", "finished", "base_collision"): 1,
        ("scripted", "finished", "caged_force_reduced"): 1,
    }


def test_runs_are_found_by_what_people_call_them_and_by_what_was_changed(store, index):
    plain = kept(store)
    config = revised(MissionConfig(), nested({"published.impedance.damping": 3.0}))
    damped = kept(store, configuration="published (edited)", config=config)
    store.remark(plain, Remarks(name="The Reference", tags=("paper", "Figure 7", "paper")))
    assert found(index, text="impedance.damping") == found(index, text="DAMPING 3.0 edited") == [damped]
    assert found(index, text="published reference") == found(index, text="figure") == [plain]
    assert found(index, tag="figure 7") == [plain]
    assert found(index, tag="figure") == []
    assert store.read(plain).remarks.tags == ("paper", "Figure 7")


@pytest.mark.parametrize(
    ("sort", "values"),
    [
        ("seed", {"simulation.seed": 3}),
        ("initial_spin", {"target.initial_spin": 2.0}),
        ("changes", {"published.impedance.damping": 3.0}),
    ],
)
def test_runs_are_ordered_by_what_was_chosen(store, index, sort, values):
    plain = kept(store)
    changed = kept(store, config=revised(MissionConfig(), nested(values)))
    assert found(index, sort=sort) == [changed, plain]
    if sort != "changes":
        assert found(index, sort=sort, ascending=True) == [plain, changed]


def test_a_page_of_five_hundred_runs_reads_no_other_run(store, index, monkeypatch):
    first = kept(store)
    record = (store.root / first / RECORD_NAME).read_text()
    for number in range(499):
        folder = store.root / f"20200101T{number:09}-000000"
        folder.mkdir()
        (folder / RECORD_NAME).write_text(record.replace(first, folder.name))
    assert index.find(RunQuery(), 50).total == 500
    monkeypatch.setattr(store, "read", lambda run_id: pytest.fail(f"{run_id} was read"))
    page = index.find(RunQuery(sort="seed", text="published"), 50)
    assert (len(page.ids), page.total) == (50, 500)


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


def test_what_another_version_could_not_read_is_looked_at_again(store, index):
    run = kept(store)
    assert found(index) == [run]
    with closing(sqlite3.connect(store.root / FILE_NAME)) as rows:
        rows.execute("UPDATE runs SET kind = NULL, unreadable = 'of another version'")
        rows.execute(f"PRAGMA user_version = {run_index.index_version() ^ 1}")
        rows.commit()
    assert found(index) == [run]
    assert index.unreadable() == {}


def test_damaged_it_is_rebuilt(store, index):
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


def test_a_damaged_record_is_told_until_it_is_repaired(store, index):
    run = kept(store)
    record = store.record(run)
    (store.root / run / "run.json").write_text("{")
    assert found(index) == []
    assert "damaged" in index.unreadable()[run]
    write_record(store.root / run, record)
    assert (found(index), index.unreadable()) == ([run], {})


def test_moments_are_compared_as_moments(store, index):
    early = kept(store, started="2026-11-25T12:30:00.000+02:00")
    late = kept(store, started="2026-11-25T11:00:00.000+00:00")
    between = datetime(2026, 11, 25, 11, 45, tzinfo=timezone(timedelta(hours=1)))
    assert found(index, started_from=between) == [late]
    assert found(index, started_to=between) == [early]
    assert found(index, started_from=datetime(2026, 11, 25), started_to=datetime(2026, 11, 25, 11)) == [late, early]


def test_an_index_that_another_process_holds_makes_no_search_wait(store, index, monkeypatch):
    run = kept(store)
    assert found(index) == [run]
    holder = sqlite3.connect(store.root / FILE_NAME, isolation_level=None)
    holder.execute("BEGIN EXCLUSIVE")
    monkeypatch.setattr(run_index, "PATIENCE", 0.01)
    opened = []
    connect = sqlite3.connect

    def noted(path, **options):
        opened.append(path)
        return connect(path, **options)

    monkeypatch.setattr(sqlite3, "connect", noted)
    later = kept(store)
    assert found(index) == [later, run]
    assert index.tally() == {("scripted", "finished", None): 2}
    assert index.unreadable() == {}
    assert opened == [store.root / FILE_NAME, ":memory:"]  # the file is left alone for a while
    holder.close()
    monkeypatch.setattr(index, "_file_from", 0.0)
    assert found(index) == [later, run]
    assert opened[2:] == [store.root / FILE_NAME]


def test_a_library_that_is_gone_is_no_empty_one(store, index):
    kept(store)
    shutil.rmtree(store.root)
    with pytest.raises(FileNotFoundError):
        found(index)
    assert not store.root.exists()


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere a name is text")
def test_a_folder_whose_name_is_no_text_is_listed_and_costs_no_other(store, index):
    run = kept(store)
    folder = os.fsencode(store.root) + b"/\xff\x1b[31m"
    os.mkdir(folder)
    os.utime(folder, (1e9, 1e9))
    for _ in range(2):
        assert found(index) == [run]
        assert {"name is no identifier" in why for why in index.unreadable().values()} == {True}
        assert list(index.unreadable()) == ["\\udcff\\x1b[31m"]
    os.rmdir(folder)
    assert index.unreadable() == {}
