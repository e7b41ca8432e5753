"""Killed at any moment, on a full disk: every finished run is whole, every other has all but its last moment."""

from __future__ import annotations

import itertools
import os
import resource
import signal
import struct
import time
from functools import partial

import numpy as np
import pytest
from mcap.reader import make_reader

from server.library.index import RunIndex
from server.library.recorder import Recorder
from server.library.runs import RunStore, new_record
from server.library.scripted import fly
from server.mission.live_run import LiveRun
from sim.capture.mission import Mission
from sim.capture.run import run_capture
from sim.configurations import named_configuration
from sim.control.phases import Command

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")

CONFIG = named_configuration("published")
KILLS = 60
LOST_AT_MOST = 1.0
LONGEST_TURN = 0.05
"""Between two reports of a live mission, unless the machine stands still [s]."""
MANY = 1000.0
"""More than any mission time [s]: tells the runs of one process apart in what it reports."""
_REPORT = struct.Struct("<dd")


@pytest.fixture(scope="module")
def reference():
    """Every tick of the mission, as it is flown whole."""
    rows = []
    run_capture(CONFIG, on_ticks=rows.append)
    return np.concatenate(rows)


def _child(work) -> tuple[int, int]:
    """A process that does this work with the writing end of a pipe; (its id, the reading end)."""
    reading, writing = os.pipe()
    process = os.fork()
    if process == 0:
        try:
            os.close(reading)
            work(writing)
        finally:
            os._exit(0)
    os.close(writing)
    return process, reading


def _killed(process: int, reading: int, after: float) -> list[tuple[float, float]]:
    """Kill it after that time [s] from its first report; all (mission time, wall time) that it reported."""
    content = os.read(reading, _REPORT.size)
    time.sleep(after)  # not for something to happen: the moment of the kill
    os.kill(process, signal.SIGKILL)
    os.waitpid(process, 0)
    while piece := os.read(reading, 65536):
        content += piece
    os.close(reading)
    return list(_REPORT.iter_unpack(content[: len(content) // _REPORT.size * _REPORT.size]))


def _report(writing: int, mission_time: float) -> None:
    os.write(writing, _REPORT.pack(mission_time, time.monotonic()))


def _reported(writing: int, before: float, flown: float) -> None:
    _report(writing, before + flown)


def _fly_on_and_on(store: RunStore):
    def work(writing: int) -> None:
        for number in itertools.count():
            record = new_record("scripted", "published", CONFIG)
            store.create(record)
            fly(store, record, partial(_reported, writing, number * MANY))

    return work


def _fly_live(store: RunStore):
    """As the service does: a recorder in its own thread, ticks a few at a time, at three times real time."""

    def work(writing: int) -> None:
        recorder = Recorder(store)
        recorder.start()
        run, mission = LiveRun(recorder, "published", CONFIG), Mission(CONFIG)
        run.open()
        mission.request(Command.CAPTURE)
        run.begin("published", CONFIG)
        while True:
            run.keep(mission.advance(15))
            _report(writing, mission.time - CONFIG.control.period)
            time.sleep(0.005)

    return work


def _check(reader, reference) -> None:
    """What it says of itself is true, and it holds what was flown, from the first tick on."""
    record = reader.record
    ticks = np.concatenate([reference[:0], *reader.chunks()])
    assert ticks.tobytes() == reference[: len(ticks)].tobytes()
    assert len(ticks) == record.ticks
    if record.status == "queued":  # killed between its making and its begin: the next service flies it
        assert record.ticks == 0
        return
    assert record.ended
    assert record.integrity in ("complete", "recovered")
    if record.integrity == "complete" and record.status == "finished":
        assert len(ticks) == len(reference)
    if reader.has_log and len(ticks):
        with reader.log_path.open("rb") as file:
            counts = make_reader(file, validate_crcs=True).get_summary().statistics.channel_message_counts
        assert counts[1] == len(ticks)


def _awake(moments: list[float]) -> float:
    """From the first to the last of these [s], without the time that the machine stood still between two of them."""
    return sum(min(later - earlier, LONGEST_TURN) for earlier, later in itertools.pairwise(moments))


def test_kill_9_at_any_moment(tmp_path, reference):
    random = np.random.default_rng(4)
    for number in range(KILLS):
        store = RunStore(tmp_path / str(number)).make_root()
        live = number % 3 == 0
        process, reading = _child((_fly_live if live else _fly_on_and_on)(store))
        reports = _killed(process, reading, float(random.uniform(0.0, 0.5 if live else 0.25)))
        stored = sorted(store.newest(), key=lambda reader: reader.record.id)
        if live and not stored:  # the recorder's thread had not come to writing yet
            assert _awake([at for _, at in reports]) < LOST_AT_MOST
            continue
        *finished, last = stored
        for reader in finished:
            assert (reader.record.status, reader.record.integrity) == ("finished", "complete")
        for reader in (*finished, last):
            _check(reader, reference)
        assert not RunIndex(store).unreadable()
        if live:
            kept = sum(flown <= last.record.duration for flown, _ in reports)
            assert _awake([at for _, at in reports[max(kept - 1, 0) :]]) < LOST_AT_MOST
        else:
            # What `fly` has reported is on disk: nothing of it may be missing.
            number_reported, flown = divmod(reports[-1][0], MANY)
            if number_reported == len(finished):
                assert last.record.duration >= flown - 1e-6


def test_full_disk_keeps_what_was_written(tmp_path, reference):
    """The system refuses to let a file grow further, as a full disk does."""
    store = RunStore(tmp_path / "runs").make_root()

    def work(writing: int) -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (2_000_000, 2_000_000))
        record = new_record("scripted", "published", CONFIG)
        store.create(record)
        try:
            fly(store, record, lambda flown: _report(writing, flown))
        except OSError:
            os.write(writing, _REPORT.pack(-1.0, 0.0))

    process, reading = _child(work)
    os.waitpid(process, 0)
    reports = list(_REPORT.iter_unpack(os.read(reading, 65536)))
    os.close(reading)
    assert reports[-1][0] == -1.0
    (reader,) = store.newest()
    _check(reader, reference)
    assert reader.record.integrity == "recovered"
    assert reader.record.duration == reports[-2][0]
    assert 0 < reader.record.ticks < len(reference)
