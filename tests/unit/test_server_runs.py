"""The run store: whole records, whole ticks, and identifiers that lead nowhere else."""

from __future__ import annotations

import numpy as np
import pytest

from server.claim import Claim, is_claimed
from server.run_folder import LoggedEvent, read_record
from server.runs import RunStore, new_record, new_run_id
from sim.capture.tick import TICK
from sim.configurations import named_configuration
from sim.errors import MissionRefused, RunNotFound


@pytest.fixture
def store(tmp_path):
    return RunStore(tmp_path / "runs")


def _record(kind="scripted"):
    return new_record(kind, "published", named_configuration("published"))


def _random_ticks(count: int) -> np.ndarray:
    """Any bits at all: the store does not look at them."""
    content = np.random.default_rng(1).bytes(count * TICK.itemsize)
    return np.frombuffer(content, TICK)


def _event(tick: int) -> LoggedEvent:
    return LoggedEvent(time=tick * 1e-3, tick=tick, kind="touch", severity="info", message="it", at="now")


def test_identifiers_sort_by_time():
    identifiers = [new_run_id() for _ in range(50)]
    assert [each[:18] for each in identifiers] == sorted(each[:18] for each in identifiers)
    assert len(set(identifiers)) == 50


def test_ticks_and_events_read_back(store):
    record, ticks = _record(), _random_ticks(1000)
    writer = store.write(record)
    for part in np.array_split(ticks, 7):
        writer.append(part)
    writer.log(_event(1))
    writer.log(_event(2))
    writer.close(status="finished")
    reader = store.read(record.id)
    read = list(reader.chunks(64))
    assert all(len(chunk) <= 64 for chunk in read)
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


def test_half_a_tick_and_half_an_event_are_left_out(store):
    record = _record()
    writer = store.write(record)
    writer.append(_random_ticks(3))
    writer.log(_event(1))
    writer.close(status="finished")
    folder = store.root / record.id
    with (folder / "ticks.bin").open("ab") as file:
        file.write(b"half")
    with (folder / "events.jsonl").open("ab") as file:
        file.write(b'{"tick": 2')
    reader = store.read(record.id)
    assert sum(map(len, reader.chunks(2))) == 3
    assert len(list(reader.events())) == 1


def test_record_is_replaced_whole(store):
    record = _record()
    writer = store.write(record)
    writer.revise(note="first")
    assert read_record(store.root / record.id).note == "first"
    assert {path.name for path in (store.root / record.id).iterdir()} >= {"run.json", "ticks.bin", "events.jsonl"}
    writer.close()


def test_layout_in_the_record_is_that_of_the_ticks():
    dtype = _record().layout.dtype()
    assert dtype.itemsize == TICK.itemsize
    assert {name: dtype.fields[name][1] for name in dtype.names} == {name: TICK.fields[name][1] for name in TICK.names}


def test_a_claim_is_alone_and_ends(tmp_path):
    claim = Claim(tmp_path)
    assert is_claimed(tmp_path)
    with pytest.raises(BlockingIOError):
        Claim(tmp_path)
    claim.release()
    assert not is_claimed(tmp_path)


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


def test_a_run_that_was_never_written_can_be_discarded(store):
    """A full disk: the folder could not be made, and the reset that the operator is advised to must go through."""
    record = _record()
    store.discard(record.id)
    with pytest.raises(RunNotFound):
        store.record(record.id)
