"""The log of one run while it is written."""

from __future__ import annotations

import io
import json
from datetime import datetime

import numpy as np
from mcap.records import Schema
from pydantic import BaseModel

from server.log.ros import header, ros, ros_schema, serialized
from server.log.scene import MARKERS, scene
from server.log.stream import Bytes, ByteSink, McapStream
from server.log.ticks import tick_payloads, tick_schema
from server.log.topics import EVENT_TOPIC, LOG_TOPIC, SCENE_TOPIC, TICK_TOPIC, topics_of
from sim.capture.events import Event
from sim.config import MissionConfig

CHUNK_BYTES = 2**19
"""A chunk is closed at this size, before compression, or at `flush`."""

WAITING_TICKS = 512
"""Ticks that become messages at once: a few at a time cost a hundred times as much."""

RUN_METADATA, OUTCOME_METADATA = "becalm.run", "becalm.outcome"
_LEVELS = {"info": 20, "warning": 30, "error": 40}
_LOG, _TEXT = "rcl_interfaces/msg/Log", "std_msgs/msg/String"
_NANOSECONDS = 1_000_000_000


def nanoseconds(started: str) -> int:
    """A wall-clock time, ISO 8601, as nanoseconds since 1970."""
    return round(datetime.fromisoformat(started).timestamp() * 1000) * 1_000_000


def prepare_logs() -> None:
    """Build the message layouts, which takes the first log a tenth of a second: a mission must not wait for it."""
    LogWriter(io.BytesIO(), "1970-01-01T00:00:00+00:00", MissionConfig())


class LogWriter:
    """Ticks and events in, one MCAP file out; times are those of the mission, counted from the run's start."""

    def __init__(
        self,
        sink: ByteSink,
        started: str,
        config: MissionConfig,
        schema: Schema | None = None,
        topic_rate: float | None = None,
    ) -> None:
        """Of a run that started then.

        Args:
            sink: takes the file.
            started: wall-clock time, ISO 8601.
            config: of the run.
            schema: of its ticks, if not today's.
            topic_rate: the most messages a second of mission time of each topic beside the ticks; none: no bound.

        """
        self._stream = McapStream(sink)
        self._began = nanoseconds(started)
        self._topics = topics_of(config, topic_rate)
        self._tick_channel = self._stream.channel(TICK_TOPIC, "cdr", schema or tick_schema(), {})
        self._channels = [self._open(topic.name, topic.schema) for topic in self._topics]
        self._scene, self._log, self._event = (
            self._open(SCENE_TOPIC, MARKERS),
            self._open(LOG_TOPIC, _LOG),
            self._open(EVENT_TOPIC, _TEXT),
        )
        self._waiting: list[tuple[Bytes, Bytes | None]] = []
        self._waiting_ticks, self._sequence = 0, 0
        self._stream.add_one(self._scene, self._began, scene(config))

    def _open(self, topic: str, schema: str) -> int:
        return self._stream.channel(topic, "cdr", ros_schema(schema), {})

    def append(self, ticks: Bytes, payloads: Bytes | None = None) -> None:
        """Add rows of `TICK`, and their payloads if the schema is not today's; whole chunks are written."""
        self._waiting.append((ticks, payloads))
        self._waiting_ticks += len(ticks)
        if self._waiting_ticks >= WAITING_TICKS:
            self._put_waiting()
        if self._stream.pending >= CHUNK_BYTES:
            self._stream.close_chunk()

    def _put_waiting(self) -> None:
        """Make messages of the ticks that wait."""
        waiting, self._waiting, self._waiting_ticks = self._waiting, [], 0
        ticks = _joined([ticks for ticks, _ in waiting])
        if ticks is not None:
            payloads = _joined([each for _, each in waiting if each is not None])
            self._put(ticks, tick_payloads(ticks) if payloads is None else payloads)

    def _put(self, ticks: Bytes, payloads: Bytes) -> None:
        times = self._began + np.round(ticks["time"] * 1e9).astype(np.uint64)
        numbers = self._sequence + np.arange(len(ticks))
        self._sequence += len(ticks)
        self._stream.add(self._tick_channel, numbers, times, payloads)
        shown: dict[int, tuple[Bytes, Bytes, Bytes]] = {1: (ticks, times, numbers)}
        for topic, channel in zip(self._topics, self._channels, strict=True):
            if topic.stride not in shown:
                chosen = ticks["tick"] % topic.stride == 0
                shown[topic.stride] = ticks[chosen], times[chosen], numbers[chosen]
            rows, at, numbered = shown[topic.stride]
            blanks = self._stream.add(channel, numbered, at, topic.template.blank)
            topic.template.fill(blanks, at, topic.numbers(rows))

    def log(self, event: Event) -> None:
        """Add an event: in words for every tool, and whole for our own."""
        self._put_waiting()
        time = self._began + round(event.time * 1e9)
        stamp = header("", time // _NANOSECONDS, time % _NANOSECONDS).stamp
        line = ros(_LOG, stamp, _LEVELS[event.severity], event.kind, event.message, "", "", 0)
        self._stream.add_one(self._log, time, serialized(line, _LOG))
        text = ros(_TEXT, event.model_dump_json(exclude_none=True))
        self._stream.add_one(self._event, time, serialized(text, _TEXT))

    def flush(self) -> None:
        """Write what waits."""
        self._put_waiting()
        self._stream.close_chunk()

    def describe(self, record: BaseModel, config: MissionConfig) -> None:
        """State the run and its configuration as they are now; the last statement counts."""
        self.flush()
        stated = record.model_dump(mode="json", exclude={"config", "outcome"})
        self._stream.add_metadata(RUN_METADATA, {name: _text(value) for name, value in stated.items()})
        content = config.model_dump_json(indent=2).encode()
        self._stream.attach("config.json", "application/json", self._began, content)

    def conclude(self, outcome: BaseModel) -> None:
        """State how the run ended; the last statement counts."""
        self.flush()
        stated = outcome.model_dump(mode="json")
        self._stream.add_metadata(OUTCOME_METADATA, {name: _text(value) for name, value in stated.items()})

    def end(self) -> None:
        """Write what waits, and the summary."""
        self._put_waiting()
        self._stream.end()


def _joined(parts: list[Bytes]) -> Bytes | None:
    """Rows one after another; None of nothing."""
    if sum(map(len, parts)) == 0:
        return None
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _text(value: object) -> str:
    return value if isinstance(value, str) else json.dumps(value)
