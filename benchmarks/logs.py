"""How fast a capture is recorded and exported, and what each topic of its log costs: `python -m benchmarks.logs`.

Figures are multiples of real time: simulated seconds a second of one core. Processor time is counted, not the clock on
the wall, and the best of several rounds, so that other programs on the machine do little harm; what the disk makes a
process wait for is not in it. A scripted run is flown and written by two threads at once: that is by the clock, and
wants two cores of its own.
"""

from __future__ import annotations

import argparse
import io
import json
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import zstandard

from benchmarks.service import Figures
from server.library.export import MEDIA_TYPES, LogFormat, exported
from server.library.reader import RunReader
from server.library.record import LoggedEvent, RunRecord
from server.library.runs import RunStore, new_record
from server.library.scripted import fly
from server.log.scan import chunk_data, scan
from server.log.stream import COMPRESSION_LEVEL, McapStream
from server.log.ticks import tick_payloads
from server.log.topics import Topic, topics_of
from server.log.writer import LogWriter
from server.process.realtime import shorten_switch_interval
from sim.capture.events import Event, Ticks
from sim.capture.mission import prepare
from sim.capture.run import run_capture
from sim.config import Engine, MissionConfig
from sim.configurations import named_configuration, revised

ROUNDS = 9

FIGURES = {"flown and written at once": 100.0, "exported as csv": 60.0, "exported as parquet": 200.0}
"""To reach, in multiples of real time."""


class Flight(NamedTuple):
    """A capture as it came, part by part."""

    config: MissionConfig
    parts: list[Ticks]
    events: list[Event]

    @property
    def duration(self) -> float:
        """In simulated time [s]."""
        return sum(map(len, self.parts)) * self.config.control.period


def flight(engine: Engine) -> Flight:
    """A capture in that engine."""
    config = revised(named_configuration("published"), {"simulation": {"engine": engine.value}})
    prepare(config)
    found = Flight(config, [], [])
    run_capture(config, on_ticks=found.parts.append, on_event=found.events.append)
    return found


def best_time(part: Callable[[], object], clock: Callable[[], float] = time.process_time) -> float:
    """Of the quickest of several rounds [s], by default in processor time."""
    times = []
    for _ in range(ROUNDS):
        before = clock()
        part()
        times.append(clock() - before)
    return min(times)


def _queued(store: RunStore, config: MissionConfig) -> RunRecord:
    record = new_record("scripted", "published", config)
    store.create(record)
    return record


def _write(store: RunStore, flown: Flight) -> None:
    """What a run writes, without flying it."""
    writer = store.write(_queued(store, flown.config))
    for event in flown.events:
        writer.log(LoggedEvent(**event.model_dump(), at=writer.record.started))
    for part in flown.parts:
        writer.append(part)
        writer.flush()
    writer.close(status="finished")


def _export(reader: RunReader, log_format: LogFormat) -> None:
    for _ in exported(reader, log_format):
        pass


def speeds(store: RunStore, engine: Engine) -> Figures:
    """Of the whole way of a capture in that engine, in multiples of real time."""
    flown = flight(engine)
    records = iter([_queued(store, flown.config) for _ in range(2 * ROUNDS)])
    times = {
        "flown": best_time(partial(run_capture, flown.config)),
        "written": best_time(partial(_write, store, flown)),
        "flown and written, both on one core": best_time(lambda: fly(store, next(records))),
        "flown and written at once": best_time(lambda: fly(store, next(records)), time.perf_counter),
    }
    reader = store.latest()
    for log_format in MEDIA_TYPES:
        times[f"exported as {log_format}"] = best_time(partial(_export, reader, log_format))
    figures = {name: flown.duration / taken for name, taken in times.items()}
    return {**figures, "MB on the disk, for a simulated second": 1e-6 * reader.log_path.stat().st_size / flown.duration}


def shares(flown: Flight) -> Figures:
    """What the parts of writing cost, as shares of the whole without the disk."""
    whole = best_time(partial(_log, flown))
    drafts = _chunks(flown)
    compressor = zstandard.ZstdCompressor(level=COMPRESSION_LEVEL)
    times = {"compression": best_time(lambda: [compressor.compress(draft) for draft in drafts])}
    times["/becalm/tick"] = best_time(partial(_put, flown, None))
    for topic in topics_of(flown.config):
        times[topic.name] = best_time(partial(_put, flown, topic))
    times["the rest: checksums, indexes, opening and closing"] = whole - sum(times.values())
    return {name: taken / whole for name, taken in times.items()}


def _log(flown: Flight) -> bytes:
    sink = io.BytesIO()
    writer = LogWriter(sink, "1970-01-01T00:00:00+00:00", flown.config)
    for part in flown.parts:
        writer.append(part)
        writer.flush()
    writer.end()
    return sink.getvalue()


def _chunks(flown: Flight) -> list[bytes]:
    """Chunks of the log as they are before they are compressed."""
    sink = io.BytesIO(_log(flown))
    return [chunk_data(sink, index) for index in scan(sink).contents.chunks]


def _put(flown: Flight, topic: Topic | None) -> None:
    """Messages of one topic, or of the ticks, without compression."""
    stream = McapStream(io.BytesIO())
    for ticks in flown.parts:
        rows = ticks if topic is None or topic.stride == 1 else ticks[ticks["tick"] % topic.stride == 0]
        times = numbers = rows["tick"].astype(np.uint64)
        blanks = stream.add(1, numbers, times, tick_payloads(rows) if topic is None else topic.template.blank)
        if topic is not None:
            topic.template.fill(blanks, times, topic.numbers(rows))
        stream.pending = 0  # the next part may take its place


def main() -> int:
    """Measure and print; exit code 1 if a figure is missed with the engine of studies."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--json", action="store_true", help="print one JSON document")
    as_json = parser.parse_args().json
    shorten_switch_interval()  # as where runs are flown
    tables: dict[str, Figures] = {}
    with tempfile.TemporaryDirectory() as name:
        for engine in Engine:
            store = RunStore(Path(name, engine.value)).make_root()
            tables[f"A capture with {engine.value}, times real time"] = found = speeds(store, engine)
    tables["Shares of writing it"] = shares(flight(Engine.REDUCED))
    if as_json:
        print(json.dumps(tables, indent=2))
        return 0
    for title, figures in tables.items():
        print(f"\n{title}")
        for label, value in figures.items():
            reach = f"   (to reach: {FIGURES[label]:g})" if label in FIGURES and "capture" in title else ""
            print(f"  {value:10.3g}  {label}{reach}")
    return 0 if all(found[label] >= figure for label, figure in FIGURES.items()) else 1


if __name__ == "__main__":
    sys.exit(main())
