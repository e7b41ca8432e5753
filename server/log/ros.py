"""ROS 2 messages whose length never changes: one is serialized once, and numpy fills in the numbers of a thousand.

Where a number stands in the bytes is found by planting a distinct one there, so that no layout is written down twice.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from mcap.records import Schema
from rosbags.typesys import Stores, get_typestore

from server.log.stream import Bytes

_PLANTED = 1.7e200
_PLANTED_SECONDS, _PLANTED_NANOSECONDS = 0x5EC0_1234, 0x0BAD_5EED
_NANOSECONDS = 1_000_000_000


@cache
def store() -> Any:
    """The message types of ROS 2."""
    return get_typestore(Stores.ROS2_HUMBLE)


@cache
def ros_schema(name: str) -> Schema:
    """The MCAP schema of a ROS 2 message type."""
    text, _ = store().generate_msgdef(name, ros_version=2)
    return Schema(id=0, name=name, encoding="ros2msg", data=text.encode())


def serialized(message: Any, name: str) -> bytes:
    """One message as CDR."""
    return bytes(store().serialize_cdr(message, name))


def ros(name: str, *values: Any) -> Any:
    """A message of that type with these fields, in the order of its definition."""
    return store().types[name](*values)


def header(frame: str, seconds: int = _PLANTED_SECONDS, nanoseconds: int = _PLANTED_NANOSECONDS) -> Any:
    """A header in that frame; with the planted time if it is of a template."""
    return ros("std_msgs/msg/Header", ros("builtin_interfaces/msg/Time", seconds, nanoseconds), frame)


class Template:
    """Messages that differ in their time and in a row of numbers only."""

    def __init__(self, name: str, numbers: int, made: Callable[[Sequence[float]], Any]) -> None:
        """A template of `made`, which builds the message of that many numbers."""
        planted = [_PLANTED * (1.0 + i / 4096) for i in range(numbers)]
        content = serialized(made(planted), name)
        stamp = struct.pack("<iI", _PLANTED_SECONDS, _PLANTED_NANOSECONDS)
        stamps = [place for place in range(len(content)) if content.startswith(stamp, place)]
        self._runs = _runs([content.index(struct.pack("<d", number)) for number in planted])
        self._stamps = [f"stamp_{i}" for i in range(len(stamps))]
        self.blank: Bytes = np.array(content, f"V{len(content)}")
        """The payload that is to be filled, shape ()."""
        self._dtype = np.dtype(
            {
                "names": [*(run.name for run in self._runs), *self._stamps],
                "formats": [*(f"({run.length},)<f8" for run in self._runs), *["<u8"] * len(stamps)],
                "offsets": [*(run.place for run in self._runs), *stamps],
                "itemsize": len(content),
            }
        )

    def fill(self, payloads: Bytes, log_times: Bytes, numbers: Bytes) -> None:
        """Fill blanks, shape (messages,), with their times [ns] and rows of numbers, shape (messages, numbers)."""
        rows = payloads.view(self._dtype)
        for run in self._runs:
            rows[run.name] = numbers[:, run.first : run.first + run.length]
        stamps = log_times // _NANOSECONDS | log_times % _NANOSECONDS << np.uint64(32)
        for name in self._stamps:
            rows[name] = stamps


class _Run(NamedTuple):
    """Numbers of a template that follow one another in the bytes."""

    first: int
    """Which number it begins with."""
    length: int
    place: int
    """Of its first byte."""

    @property
    def name(self) -> str:
        return f"numbers_{self.first}"


def _runs(places: Sequence[int]) -> list[_Run]:
    """The runs of numbers at these places; each number has eight bytes."""
    runs: list[_Run] = []
    for number, place in enumerate(places):
        last = runs[-1] if runs else None
        if last is not None and place == last.place + 8 * last.length:
            runs[-1] = last._replace(length=last.length + 1)
        else:
            runs.append(_Run(number, 1, place))
    return runs
