"""A run that an earlier version recorded, read by this one: its own folder, as that version left it."""

from __future__ import annotations

import json
import tarfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader

from server.errors import StoredUnreadable
from server.library.folder import LOG_NAME
from server.library.index import RunIndex, RunQuery
from server.library.runs import RunStore
from sim.configurations import named_configuration
from sim.file_lock import ProcessLock

GOLDEN = Path(__file__).parent / "golden" / "run_of_format_1.tar.xz"
"""120 ticks of a capture that was stopped, written by the last version of format 1."""


@pytest.fixture
def store(tmp_path):
    with tarfile.open(GOLDEN) as archive:
        archive.extractall(tmp_path / "runs", filter="data")
    return RunStore(tmp_path / "runs").make_root()


@pytest.fixture
def folder(store) -> Path:
    (folder,) = store.root.iterdir()
    return folder


def _revised(folder: Path, **changes) -> None:
    path = folder / "run.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), **changes}))


def _ticks_of_format_1(folder: Path) -> np.ndarray[Any, np.dtype[Any]]:
    """The ticks by the layout in the run itself; x86-64 and ARM64 have the file's byte order."""
    layout = json.loads((folder / "run.json").read_text())["layout"]
    formats = [(field["kind"], tuple(field["shape"])) for field in layout["fields"]]
    names, offsets = ([field[key] for field in layout["fields"]] for key in ("name", "offset"))
    kind = np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": layout["size"]})
    return np.frombuffer((folder / "ticks.bin").read_bytes(), kind)


def test_it_is_read_bit_for_bit_and_becomes_a_run_like_any_other(store, folder):
    stored = _ticks_of_format_1(folder)
    reader = store.read(folder.name)
    read = np.concatenate(list(reader.chunks()))
    assert len(read) == len(stored) == 120
    assert stored.dtype.names is not None
    for name in stored.dtype.names:
        assert read[name].tobytes() == stored[name].tobytes(), name
    record = reader.record
    assert (record.status, record.integrity, record.ticks, record.note) == ("cancelled", "complete", 120, "stopped")
    assert record.config == named_configuration("published")
    assert record.versions["numba"] == "0.68.1"  # those that it was flown with
    assert [event["command"] for event in reader.events()] == ["capture"]
    assert sorted(path.name for path in folder.iterdir()) == [".writing", "events.jsonl", LOG_NAME, "run.json"]
    with reader.log_path.open("rb") as file:
        channels = {channel.topic for _, channel, _ in make_reader(file, validate_crcs=True).iter_messages()}
    assert {"/becalm/tick", "/becalm/event", "/tf"} <= channels
    assert json.loads((folder / "run.json").read_text())["format"] == 2


def test_the_library_finds_it_and_the_next_look_changes_nothing(store, folder):
    index = RunIndex(store)
    assert index.find(RunQuery(), 10).ids == [folder.name]
    assert index.unreadable() == {}
    before = (folder / "run.json").stat().st_mtime_ns
    store.recover()
    assert (folder / "run.json").stat().st_mtime_ns == before


def test_an_upgrade_that_was_cut_off_clock_restarted(store, folder):
    (folder / LOG_NAME).write_bytes(b"half of it")
    (folder / ".upgrade").mkdir()
    (folder / ".upgrade" / LOG_NAME).write_bytes(b"half")
    assert store.read(folder.name).tick_count == 120
    assert not (folder / ".upgrade").exists()


def test_a_run_that_a_crash_cut_off_keeps_its_whole_ticks_and_says_so(store, folder):
    with (folder / "ticks.bin").open("ab") as file:
        file.write(b"half a tick")
    _revised(folder, status="running")
    record = store.read(folder.name).record
    assert (record.status, record.integrity, record.ticks) == ("failed", "recovered", 120)
    assert "recovered" in record.note


def test_a_run_that_still_waits_waits_on(store, folder):
    (folder / "ticks.bin").unlink()
    _revised(folder, status="queued")
    assert store.read(folder.name).record.status == "queued"


def _contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file() and path.name[0] != "."}


def test_one_that_the_earlier_version_still_writes_is_left_alone(store, folder):
    before = _contents(folder)
    lock = ProcessLock(folder / ".writing")
    with pytest.raises(StoredUnreadable, match="layout"):
        store.read(folder.name)
    lock.release()
    assert _contents(folder) == before
    assert store.read(folder.name).tick_count == 120


@pytest.mark.parametrize("changes", [{"layout": {"size": 8}}, {"layout": None}, {"config": {"robot": {"arms": 3}}}])
def test_one_that_cannot_be_understood_is_left_as_it_is_and_reported(store, folder, changes):
    _revised(folder, **changes)
    before = _contents(folder)
    assert list(RunIndex(store).unreadable()) == [folder.name]
    assert _contents(folder) == before
