"""Signals of a foreign log, CSV or MCAP: times and values of each that is asked for."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.csv
from mcap.exceptions import McapError
from mcap.reader import make_reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from sim.compiled import FloatArray
from sim.errors import ConfigError

_SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
MOST_SAMPLES = 5_000_000
"""Of one signal: seven hours at 200 Hz."""
_STEP = re.compile(r"\[([^\]]+)\]|([^.\[\]]+)")
SHOWN = 12
"""Names that an error lists."""


class Signal(NamedTuple):
    """One number over time, as it was logged."""

    time: FloatArray
    """[s], not necessarily in order."""
    value: FloatArray


def signals(path: Path, names: Sequence[str], time: str | None, unit: str) -> dict[str, Signal]:
    """The signals of these names.

    Args:
        path: a file, .csv or .mcap.
        names: columns, or `TOPIC:PATH`.
        time: column of the time; of MCAP the path of a stamp in each message, or None for the log's own times.
        unit: of that time.

    Raises:
        ConfigError: the file is of another kind or damaged, or has no such signal; the message names it.

    """
    readers: dict[str, Callable[..., dict[str, Signal]]] = {".csv": _csv, ".mcap": _mcap}
    if path.suffix.lower() not in readers:
        raise ConfigError(f"{path.name}: import a .csv or .mcap file")
    return readers[path.suffix.lower()](path, names, time, _SECONDS[unit])


def _csv(path: Path, names: Sequence[str], time: str | None, unit: float) -> dict[str, Signal]:
    if time is None:
        raise ConfigError("map: time.source is missing: a CSV needs the name of its column of times")
    wanted = [time, *dict.fromkeys(names)]
    try:
        table = pyarrow.csv.read_csv(path, convert_options=pyarrow.csv.ConvertOptions(strings_can_be_null=True))
    except pa.ArrowInvalid as error:
        raise ConfigError(f"{path.name} is no CSV that can be read: {error}") from None
    _require_known(path, [each for each in wanted if each not in table.column_names], table.column_names, "column")
    values = {name: _numbers(path, name, table.column(name)) for name in dict.fromkeys(wanted)}
    return {name: Signal(unit * values[time], values[name]) for name in names}


def _numbers(path: Path, name: str, column: Any) -> FloatArray:
    """A column as numbers; empty fields are not a number."""
    try:
        found = column.cast(pa.float64())
    except pa.ArrowInvalid as error:
        raise ConfigError(f"{path.name}: column {name} holds what is no number: {error}") from None
    result: FloatArray = found.to_numpy(zero_copy_only=False).astype(np.float64)
    return result


def _require_known(path: Path, missing: Sequence[str], known: Iterable[str], what: str) -> None:
    if missing:
        there = sorted(known)
        more = f" and {len(there) - SHOWN} more" if len(there) > SHOWN else ""
        raise ConfigError(
            f"{path.name} has no {what} {', '.join(missing)}; there is {', '.join(there[:SHOWN])}{more}",
            tip="correct the map",
        )


def _mcap(path: Path, names: Sequence[str], time: str | None, unit: float) -> dict[str, Signal]:
    paths: dict[str, list[str]] = {}
    for name in dict.fromkeys(names):
        topic, colon, _ = name.partition(":")
        if not colon:
            raise ConfigError(f"map: {name!r}: of an MCAP name TOPIC:PATH, such as /joints:position[left_1]")
        paths.setdefault(topic, []).append(name)
    found: dict[str, tuple[list[float], list[float]]] = {name: ([], []) for name in names}
    origin: int | None = None
    try:
        with path.open("rb") as file:
            reader = make_reader(file)
            summary = reader.get_summary()
            topics = [] if summary is None else [each.topic for each in summary.channels.values()]
            _require_known(path, [each for each in paths if topics and each not in topics], topics, "topic")
            decoders = _Decoders(path)
            for schema, channel, message in reader.iter_messages(topics=list(paths)):
                content = decoders.decoded(schema, channel.message_encoding, message.data)
                origin = message.log_time if origin is None else origin
                at = 1e-9 * (message.log_time - origin)  # since 1970 would leave a tenth of a microsecond of precision
                if time is not None:
                    at = _stamp(path, content, time, unit, origin // 1_000_000_000)
                for name in paths[channel.topic]:
                    times, values = found[name]
                    times.append(at)
                    values.append(_at(path, content, name))
    except (McapError, EOFError) as error:
        raise ConfigError(f"{path.name} is no MCAP that can be read: {error}") from None
    _require_known(path, [name for name, (times, _) in found.items() if not times], topics, "message for")
    return {name: Signal(np.array(times), np.array(values)) for name, (times, values) in found.items()}


class _Decoders:
    """What makes values of messages: ROS 2 (CDR) by the schemas of the file, or JSON."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._store = get_typestore(Stores.ROS2_HUMBLE)
        self._known: set[str] = set()

    def decoded(self, schema: Any, encoding: str, data: bytes) -> Any:
        """The message.

        Raises:
            ConfigError: its encoding is another, or it is damaged.

        """
        try:
            if encoding == "json":
                return json.loads(data)
            if encoding == "cdr" and schema is not None and schema.encoding == "ros2msg":
                if schema.name not in self._known:
                    types = get_types_from_msg(schema.data.decode(), schema.name)
                    self._store.register({k: v for k, v in types.items() if k not in self._store.types})
                    self._known.add(schema.name)
                return self._store.deserialize_cdr(data, schema.name)
        except (ValueError, KeyError, AssertionError, IndexError) as error:
            raise ConfigError(f"{self._path.name}: a message of {schema.name} cannot be read: {error}") from None
        raise ConfigError(f"{self._path.name}: messages are {encoding}; those of ROS 2 (cdr) and json can be read")


def _at(path: Path, content: Any, name: str) -> float:
    """The number at `TOPIC:PATH` of a message; not a number where it is null."""
    steps = name.partition(":")[2]
    found = content
    for index, field in _STEP.findall(steps):
        found = _item(path, content, found, index, name) if index else _field(path, found, field, name)
    try:
        return float("nan") if found is None else float(found)
    except (TypeError, ValueError):
        raise ConfigError(f"{path.name}: {name} is {type(found).__name__}, no number") from None


def _field(path: Path, found: Any, field: str, name: str) -> Any:
    if isinstance(found, Mapping) and field in found:
        return found[field]
    if hasattr(found, field):
        return getattr(found, field)
    raise ConfigError(f"{path.name}: {name}: there is no {field} in its messages", tip="correct the map")


def _item(path: Path, content: Any, found: Any, index: str, name: str) -> Any:
    """An item by its number, or by its place among the message's `name`s, as joints have."""
    names = content.get("name") if isinstance(content, Mapping) else getattr(content, "name", None)
    if index.isdigit():
        place = int(index)
    elif names is not None and index in list(names):
        place = list(names).index(index)
    else:
        raise ConfigError(f"{path.name}: {name}: no joint of its messages is called {index}", tip="correct the map")
    if place >= len(found):
        raise ConfigError(f"{path.name}: {name}: its messages have {len(found)} of them", tip="count from 0")
    return found[place]


def _stamp(path: Path, content: Any, time: str, unit: float, origin: int) -> float:
    """The time in a message: a number, or a stamp of ROS 2 after that second."""
    found = content
    for field in time.split("."):
        found = _field(path, found, field, time)
    if hasattr(found, "nanosec"):
        return float(found.sec - origin) + 1e-9 * float(found.nanosec)
    if isinstance(found, Mapping) and "nanosec" in found:
        return float(found["sec"] - origin) + 1e-9 * float(found["nanosec"])
    return unit * float(found)
