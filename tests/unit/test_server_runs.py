"""The run store: whole records, whole ticks, and identifiers that lead nowhere else."""

from __future__ import annotations

import threading
from contextlib import suppress

import numpy as np
import pytest
from mcap.reader import make_reader

from server.errors import StoredUnreadable
from server.files import replace_file
from server.library.folder import LOCK_NAME, read_record
from server.library.index import RunIndex
from server.library.record import LoggedEvent
from server.library.runs import RunStore, new_record, new_run_id
from sim.capture.tick import TICK
from sim.configurations import named_configuration
from sim.errors import MissionRefused, RunNotFound
from sim.file_lock import ProcessLock, is_locked


@pytest.fixture
def store(tmp_path):
    return RunStore(tmp_path / "runs").make_root()


def _record(kind="scripted"):
    return new_record(kind, "published", named_configuration("published"))


def _random_ticks(count: int) -> np.ndarray:
    """Any bits at all, but for the time: the store does not look at them."""
    content = np.random.default_rng(1).bytes(count * TICK.itemsize)
    ticks = np.frombuffer(content, TICK).copy()
    ticks["tick"] = np.arange(count)
    ticks["time"] = 1e-3 * ticks["tick"]
    return ticks


def _event(tick: int) -> LoggedEvent:
    return LoggedEvent(time=tick * 1e-3, tick=tick, kind="touch", severity="info", message="it", at="now")


@pytest.mark.parametrize("robot", [False, True])
def test_a_run_knows_whether_a_robot_was_flown(store, robot):
    """Of a robot's a replay takes what was perceived from the ticks; one from before robots were noted has none."""
    record = new_record("live", "testbed_becalm", named_configuration("testbed_becalm"), robot=robot)
    store.write(record).close(status="finished")
    assert store.read(record.id).history().robot == robot


def test_identifiers_sort_by_time():
    identifiers = [new_run_id() for _ in range(50)]
    assert [each[:18] for each in identifiers] == sorted(each[:18] for each in identifiers)
    assert len(set(identifiers)) == 50


def test_a_folder_of_runs_that_has_gone_is_not_made_again(store):
    store.root.rmdir()
    for write in (store.create, store.write):
        with pytest.raises(FileNotFoundError):
            write(_record())
    assert not store.root.exists()


def test_ticks_and_events_read_back(store):
    record, ticks = _record(), _random_ticks(1000)
    writer = store.write(record)
    for part in np.array_split(ticks, 7):
        writer.append(part)
        writer.flush()
    writer.log(_event(1))
    writer.log(_event(2))
    writer.close(status="finished")
    reader = store.read(record.id)
    read = list(reader.chunks())
    assert np.concatenate(read).tobytes() == ticks.tobytes()
    assert [event["tick"] for event in reader.events()] == [1, 2]
    assert reader.record.status == "finished"


def test_what_was_flushed_is_readable_while_it_is_written(store):
    record = _record()
    writer = store.write(record)
    writer.append(_random_ticks(10))
    writer.flush()
    writer.append(_random_ticks(1))
    reader = store.read(record.id)
    assert reader.tick_count == 10
    assert sum(map(len, reader.chunks())) == 10
    writer.close()


def test_half_a_chunk_and_half_an_event_are_left_out(store):
    record, ticks = _record(), _random_ticks(30)
    writer = store.write(record.model_copy(update={"status": "running"}))
    for part in np.array_split(ticks, 3):
        writer.append(part)
        writer.log(_event(1))
        writer.flush()
    writer.abandon()
    folder = store.root / record.id
    with (folder / "log.mcap").open("r+b") as file:
        file.truncate(file.seek(0, 2) - 7)
    with (folder / "events.jsonl").open("ab") as file:
        file.write(b'{"tick": 2')
    reader = store.read(record.id)
    assert reader.record.integrity == "recovered"
    assert reader.record.lost_at_most <= 1.0
    assert "recovered" in reader.record.note
    assert reader.record.ticks == reader.tick_count == 20
    assert np.concatenate(list(reader.chunks())).tobytes() == ticks[:20].tobytes()
    assert len(list(reader.events())) == 3
    assert reader.scanned().closed


@pytest.mark.parametrize("seed", range(20))
def test_no_damage_is_too_much(store, seed):
    """Cut and overwritten anywhere: what the run gives was recorded, or it says why it gives nothing."""
    random = np.random.default_rng(seed)
    record, ticks = _record(), _random_ticks(50)
    writer = store.write(record.model_copy(update={"status": "running"}))
    for part in np.array_split(ticks, 5):
        writer.append(part)
        writer.flush()
    writer.abandon()
    path = store.root / record.id / "log.mcap"
    content = bytearray(path.read_bytes())
    content = content[: random.integers(len(content) // 3, len(content))]
    for place in random.integers(0, len(content), 3):
        content[place] = random.integers(256)
    path.write_bytes(content)
    try:
        reader = store.read(record.id)
        read = [tick.tobytes() for chunk in reader.chunks() for tick in chunk]
    except StoredUnreadable as error:  # without its schema no tick of a log means anything
        why = str(error)
    else:
        why = ""
        assert reader.record.integrity == "recovered"
        assert set(read) <= {tick.tobytes() for tick in ticks}
    assert not why or "the schema of its ticks cannot be understood" in why
    if not why:
        with path.open("rb") as file:
            make_reader(file).get_summary()


def test_span_of_time(store):
    record, ticks = _record(), _random_ticks(1000)
    writer = store.write(record)
    for part in np.array_split(ticks, 9):
        writer.append(part)
        writer.flush()
    writer.close(status="finished")
    read = np.concatenate(list(store.read(record.id).chunks(0.1, 0.35)))
    assert read["tick"].tolist() == list(range(100, 351))


def test_record_is_replaced_whole(store):
    record = _record()
    writer = store.write(record)
    writer.revise(note="first")
    assert read_record(store.root / record.id).note == "first"
    assert {path.name for path in (store.root / record.id).iterdir()} >= {"run.json", "events.jsonl"}
    writer.close()


def test_a_lock_is_exclusive_and_ends(tmp_path):
    lock = ProcessLock(tmp_path / "lock")
    assert is_locked(tmp_path / "lock")
    with pytest.raises(BlockingIOError):
        ProcessLock(tmp_path / "lock")
    lock.release()
    assert not is_locked(tmp_path / "lock")


@pytest.mark.parametrize("run_id", ["", ".", "..", "../runs", "20200101T000000000-abcdef", "x/y"])
def test_unknown_identifier(store, run_id):
    store.create(_record())
    with pytest.raises(RunNotFound):
        store.read(run_id)


def test_only_what_has_ended_is_removed(store):
    record = _record()
    store.create(record)
    with pytest.raises(MissionRefused):
        store.delete(record.id)
    store.write(record).close(status="cancelled")
    store.delete(record.id)
    assert list(store.newest()) == []


def test_run_of_another_version_does_not_hide_the_rest(store):
    good, strange = _record(), _record()
    for record in (good, strange):
        store.create(record)
    path = store.root / strange.id / "run.json"
    path.write_text(path.read_text().replace('"direct"', '"indirect"'))
    assert [reader.record.id for reader in store.newest()] == [good.id]
    ((name, reason),) = RunIndex(store).unreadable().items()
    assert name == strange.id
    assert "indirect" in reason


def test_a_run_that_was_never_written_can_be_discarded(store):
    """A full disk: the folder could not be made, and the reset that the operator is advised to must go through."""
    record = _record()
    store.discard(record.id)
    with pytest.raises(RunNotFound):
        store.record(record.id)


def test_a_run_is_read_while_its_files_come_and_go(store):
    """Drafts of what is replaced, and the lock of who writes it, vanish between two looks at the folder."""
    record = _record()
    store.write(record).close(status="finished")
    folder = store.root / record.id
    done = threading.Event()

    def churn():
        while not done.is_set():
            replace_file(folder / "remarks.json", b"{}")
            with suppress(BlockingIOError):  # whoever tests a lock holds it for that moment
                ProcessLock(folder / LOCK_NAME).release(remove=True)

    churning = threading.Thread(target=churn)
    churning.start()
    try:
        for _ in range(1500):
            assert store.read(record.id).size > 0
            is_locked(folder / LOCK_NAME)
    finally:
        done.set()
        churning.join()


def test_a_run_that_goes_while_it_is_read_is_not_found(store):
    record = _record()
    store.write(record).close(status="finished")
    reader = store.read(record.id)
    store.discard(record.id)
    assert reader.size == 0
    with pytest.raises(RunNotFound):
        store.record(record.id)


def test_files_that_are_gone_while_they_are_written_are_missed(store):
    record = _record()
    writer = store.write(record.model_copy(update={"status": "running"}))
    writer.append(_random_ticks(10))
    (store.root / record.id).rename(store.root.parent / "away")
    with pytest.raises(FileNotFoundError, match="gone while it is recorded"):
        writer.close(status="finished")
    writer.abandon()
