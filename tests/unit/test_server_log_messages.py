"""The messages of a log: as earlier versions wrote them, however the ticks arrive, and thinned only where asked."""

from __future__ import annotations

import io
import tarfile
from collections import defaultdict
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from mcap.reader import make_reader

from server.library.reader import RunReader
from server.library.runs import RunStore
from server.log.scan import chunk_data, payloads, scan
from server.log.ticks import TICK_CHANNEL
from server.log.writer import WAITING_TICKS, LogWriter
from sim.capture.tick import TICK
from sim.config import MissionConfig

GOLDEN = Path(__file__).parent / "golden" / "data_folder_of_0_1_0.tar.xz"
STARTED = "2026-01-01T00:00:00+00:00"


class Written(NamedTuple):
    """One message."""

    data: bytes
    log_time: int
    sequence: int


def _messages(log: bytes) -> dict[str, list[Written]]:
    """Of every topic, in their order in the file, by the reference reader."""
    found = defaultdict(list)
    for _, channel, message in make_reader(io.BytesIO(log), validate_crcs=True).iter_messages(log_time_order=False):
        assert message.publish_time == message.log_time
        found[channel.topic].append(Written(message.data, message.log_time, message.sequence))
    return found


def _log(config: MissionConfig, parts: list[np.ndarray], started: str = STARTED, rate: float | None = None) -> bytes:
    sink = io.BytesIO()
    writer = LogWriter(sink, started, config, topic_rate=rate)
    for part in parts:
        writer.append(part)
    writer.end()
    return sink.getvalue()


def _ticks(count: int) -> np.ndarray:
    ticks = np.zeros(count, TICK)
    numbers = np.random.default_rng(1).normal(size=(count, TICK.itemsize // 8))
    ticks.view(np.float64).reshape(count, -1)[:] = numbers
    ticks["tick"] = np.arange(count)
    ticks["time"] = 1e-3 * ticks["tick"]
    return ticks


@pytest.fixture(scope="module")
def run_of_0_1_0(tmp_path_factory: pytest.TempPathFactory) -> RunReader:
    folder = tmp_path_factory.mktemp("data_of_0_1_0")
    with tarfile.open(GOLDEN) as archive:
        archive.extractall(folder, filter="data")
    return RunStore(folder / "runs").read("20261130T011309033-9055c9")


def test_what_other_tools_show_is_what_0_1_0_wrote_to_the_last_bit(run_of_0_1_0: RunReader) -> None:
    record, before = run_of_0_1_0.record, _messages(run_of_0_1_0.log_path.read_bytes())
    today = _messages(_log(record.config, list(run_of_0_1_0.chunks()), record.started))
    topics = {topic for topic in before if topic not in ("/becalm/tick", "/becalm/event", "/rosout", "/scene")}
    assert topics >= {"/tf", "/joint_states", "/left_hand/wrench", "/right_hand/pose"}
    for topic in topics:
        assert today[topic] == before[topic], topic


@pytest.mark.parametrize("size", [1, 7, WAITING_TICKS - 1, WAITING_TICKS, 5 * WAITING_TICKS])
def test_a_log_is_the_same_however_its_ticks_arrive(size: int) -> None:
    ticks, config = _ticks(2 * WAITING_TICKS + 5), MissionConfig()
    parts = [ticks[start : start + size] for start in range(0, len(ticks), size)]
    assert _messages(_log(config, parts)) == _messages(_log(config, [ticks]))


def test_ticks_are_read_back_from_messages_of_many_channels_by_turns() -> None:
    ticks, sink = _ticks(40), io.BytesIO()
    writer = LogWriter(sink, STARTED, MissionConfig())
    for start in range(0, len(ticks), 4):
        writer.append(ticks[start : start + 4])
        writer._put_waiting()  # as a version that did not wait wrote them
    writer.end()
    (chunk,) = scan(sink).contents.chunks
    found = payloads(chunk_data(sink, chunk), TICK_CHANNEL)
    assert [payload.tobytes()[4:] for payload in found] == [tick.tobytes() for tick in ticks]


@pytest.mark.parametrize(("rate", "stride"), [(1000.0, 1), (300.0, 4), (60.0, 17), (1.0, 1000)])
def test_a_rate_thins_all_topics_but_the_ticks(rate: float, stride: int) -> None:
    found = _messages(_log(MissionConfig(), [_ticks(2001)], rate=rate))
    assert len(found["/becalm/tick"]) == 2001
    for topic in ("/joint_states", "/left_hand/wrench"):
        assert [each.sequence for each in found[topic]] == list(range(0, 2001, stride))
    for topic in ("/tf", "/target/pose"):
        assert [each.sequence for each in found[topic]] == list(range(0, 2001, max(stride, 16)))
