"""One bad file costs one thing: every kind of damage, before every reader of the library."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

import pytest

from server import files
from server.errors import StoredUnreadable
from server.library.index import RunIndex, RunQuery
from server.library.record import Note, Remarks
from server.library.retention import remove_expired
from server.library.runs import RunStore, new_record
from server.studies.store import StudyStore
from sim.config import MissionConfig
from sim.errors import RunNotFound
from sim.study.design import study_of

STUDY = study_of({"name": "two", "grid": {"published.impedance.mass": [0.05, 0.1]}})
SPOILED = "20261120T000000000-bad0ad"
OLD = "2026-01-01T00:00:00.000+00:00"


def instead(make):
    """Something else in the place of a file."""

    def spoil(path: Path) -> None:
        path.unlink()
        make(path)

    return spoil


def changed(**fields):
    def spoil(path: Path) -> None:
        path.write_text(json.dumps({**json.loads(path.read_text()), **fields}))

    return spoil


def without(field):
    def spoil(path: Path) -> None:
        path.write_text(json.dumps({k: v for k, v in json.loads(path.read_text()).items() if k != field}))

    return spoil


FILE_DAMAGES = {
    "empty": lambda path: path.write_bytes(b""),
    "torn": lambda path: path.write_bytes(path.read_bytes()[:-20]),
    "no UTF-8": lambda path: path.write_bytes(b'{"id": "\xff\xfe"}'),
    "lone surrogate": lambda path: path.write_bytes(b'{"id": "\\ud800"}'),
    "deep": lambda path: path.write_bytes(b'{"id": ' + b"[" * 50_000 + b"]" * 50_000 + b"}"),
    "a list": lambda path: path.write_bytes(b"[]"),
    "huge": lambda path: os.truncate(path, files.LARGEST_DOCUMENT + 1),
    "a folder": instead(Path.mkdir),
    "a pipe": instead(os.mkfifo),
    "a dangling link": instead(lambda path: path.symlink_to("nowhere")),
    "a looping link": instead(lambda path: path.symlink_to(path.name)),
    "a device": instead(lambda path: path.symlink_to("/dev/zero")),
    "not permitted": lambda _path: None,
}
RECORD_DAMAGES = {
    **FILE_DAMAGES,
    "wrong type": changed(status=7),
    "unknown status": changed(status="flown"),
    "of tomorrow": changed(format=3),
    "another run's": changed(id="20261120T000000000-00d00d"),
    "no date": without("started"),
    "no such date": changed(started="yesterday"),
    "a date without a zone": changed(started="2026-11-20T00:00:00"),
    "a date before the clocks": changed(started="0001-01-01T00:00:00+00:00"),
    "a date that is null": changed(started=None),
    "a figure that is none": changed(duration=float("nan")),
    "a figure without end": changed(real_time_factor=float("inf")),
}
REMARKS_DAMAGES = {**FILE_DAMAGES, "wrong type": changed(starred="very"), "a time that is none": changed(
    notes=[{"text": "x", "time": float("nan")}])}  # fmt: skip


@pytest.fixture
def forbid(monkeypatch):
    """Has the system refuse a file, which it does not do to root."""
    forbidden = set()
    really = os.open

    def refusing(path, *arguments, **options):
        if path in forbidden:
            raise PermissionError(13, "Permission denied", str(path))
        return really(path, *arguments, **options)

    monkeypatch.setattr("server.files.os.open", refusing)
    return forbidden.add


@pytest.fixture
def store(tmp_path):
    """A library of three runs: one that is good, one to be spoiled, and one that is starred."""
    store = RunStore(tmp_path / "runs").make_root()
    for run_id in ("20261119T000000000-00d00d", SPOILED, "20261121T000000000-57a44d"):
        record = new_record("scripted", "published", MissionConfig())
        fields = {"id": run_id, "started": OLD, "status": "finished", "integrity": "complete"}
        store.create(record.model_copy(update=fields))
        store.remark(run_id, Remarks(starred=run_id != "20261119T000000000-00d00d"))
    return store


OTHERS = ["20261121T000000000-57a44d", "20261119T000000000-00d00d"]


@pytest.mark.parametrize("damage", RECORD_DAMAGES)
def test_a_bad_record_costs_its_run_only(store, forbid, damage):
    path = store.root / SPOILED / "run.json"
    RECORD_DAMAGES[damage](path)
    if damage == "not permitted":
        forbid(path)
    store.recover()
    assert [reader.record.id for reader in store.newest()] == OTHERS
    index = RunIndex(store)
    for _ in range(2):  # as it is found, and as it is remembered
        assert index.find(RunQuery(), 10).ids == OTHERS
        ((name, why),) = index.unreadable().items()
        assert (name, why.partition(" ")[0]) == (SPOILED, "run.json")
        assert sum(index.tally().values()) == 2
    with pytest.raises(StoredUnreadable):
        store.read(SPOILED)
    remove_expired(store, 1.0, None, lambda _: None)
    assert {path.name for path in store.root.iterdir() if path.is_dir()} == {SPOILED, OTHERS[0]}
    store.delete(SPOILED)
    assert index.unreadable() == {}


@pytest.mark.parametrize("damage", REMARKS_DAMAGES)
def test_bad_remarks_cost_the_star_and_notes_of_one_run(store, forbid, damage):
    path = store.root / SPOILED / "remarks.json"
    REMARKS_DAMAGES[damage](path)
    if damage == "not permitted":
        forbid(path)
    index = RunIndex(store)
    assert index.find(RunQuery(), 10).ids == [OTHERS[0], SPOILED, OTHERS[1]]
    assert index.find(RunQuery(starred=True), 10).ids == [OTHERS[0]]
    ((name, why),) = index.unreadable().items()
    assert name == SPOILED
    assert "star and notes cannot be read: remarks.json" in why
    assert store.read(SPOILED).remarks == Remarks()
    with pytest.raises(StoredUnreadable):  # what may be repaired is not written over
        store.remark(SPOILED, Remarks(notes=(Note(text="mine"),)))
    remove_expired(store, 1.0, None, lambda _: None)
    assert {path.name for path in store.root.iterdir() if path.is_dir()} == {SPOILED, OTHERS[0]}


def _as_old_folder(path: Path) -> None:
    path.mkdir()
    os.utime(path, (0, 0))


ENTRIES = {
    "a file": (lambda path: path.write_text("x"), "no folder"),
    "a dangling link": (lambda path: path.symlink_to("nowhere"), "leads nowhere"),
    "a looping link": (lambda path: path.symlink_to(path.name), ""),
    "an old folder without a record": (_as_old_folder, "holds no run.json"),
    "a folder just made": (Path.mkdir, None),
}


@pytest.mark.parametrize("entry", ENTRIES)
@pytest.mark.parametrize("name", [SPOILED, "20261120T000000000-copied"])
def test_what_stands_in_a_folders_place_is_reported(store, entry, name):
    shutil.rmtree(store.root / SPOILED)
    make, says = ENTRIES[entry]
    make(store.root / name)
    store.recover()
    index = RunIndex(store)
    assert index.find(RunQuery(), 10).ids == OTHERS
    is_run = name == SPOILED
    if says is None or not (is_run or (store.root / name).is_dir()):
        assert index.unreadable() == {}
    else:
        assert (says if is_run else "no identifier of a run") in index.unreadable()[name]
    with pytest.raises(RunNotFound):
        store.read(name)


def test_a_link_to_a_run_is_a_run_and_removing_it_leaves_what_it_leads_to(store, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    (store.root / SPOILED).rename(elsewhere)
    (store.root / SPOILED).symlink_to(elsewhere)
    assert store.read(SPOILED).remarks.starred
    store.delete(SPOILED)
    assert not (store.root / SPOILED).is_symlink()
    assert (elsewhere / "run.json").exists()


def test_a_bad_log_or_event_costs_what_it_would_have_told(store, caplog):
    folder = store.root / SPOILED
    good = {"time": 0.1, "tick": 1, "kind": "command", "severity": "info", "message": "capture granted", "at": OLD}
    lines = [json.dumps(good), "{", json.dumps({**good, "time": float("nan")}), '{"kind": "\\ud800"}', "[" * 5000]
    (folder / "events.jsonl").write_text("\n".join([*lines, json.dumps(good), '{"cut off']))
    (folder / "log.mcap").mkdir()
    reader = store.read(SPOILED)
    assert [event["message"] for event in reader.events()] == ["capture granted"] * 2
    assert "4 damaged lines are left out" in caplog.text
    assert reader.damaged_events == 4
    with pytest.raises(StoredUnreadable, match=r"line 2 of events\.jsonl"):  # a run is not flown again without them
        reader.history()
    store.recover()
    assert RunIndex(store).find(RunQuery(), 10).ids[1] == SPOILED
    RECORD_DAMAGES["wrong type"](folder / "run.json")


def test_a_run_cut_off_whose_log_cannot_be_read_is_reported(store):
    changed(status="running", integrity=None)(store.root / SPOILED / "run.json")
    (store.root / SPOILED / "log.mcap").mkdir()
    store.recover()
    assert RunIndex(store).unreadable() == {SPOILED: "log.mcap cannot be read: Is a directory"}


@pytest.mark.parametrize("damage", [*FILE_DAMAGES, "wrong type", "another study's", "no such date"])
def test_a_bad_study_costs_itself_only(tmp_path, forbid, damage):
    store = StudyStore(tmp_path / "studies").make_root()
    good, bad = store.create(STUDY), store.create(STUDY)
    path = store.root / bad.id / "study.json"
    damages = {**FILE_DAMAGES, "wrong type": changed(status=7), "another study's": changed(id=good.id),
               "no such date": changed(created="yesterday")}  # fmt: skip
    damages[damage](path)
    if damage == "not permitted":
        forbid(path)
    assert [record.id for record in store.newest()] == [good.id]
    ((name, why),) = store.unreadable().items()
    assert (name, why.partition(" ")[0]) == (bad.id, "study.json")
    with pytest.raises(StoredUnreadable):
        store.record(bad.id)
    store.delete(bad.id)
    assert store.unreadable() == {}
