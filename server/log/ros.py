"""ROS 2 messages whose length never changes: one is serialized once, and numpy fills in the numbers of a thousand.

Where a number stands in the bytes is found by planting a distinct one there, so that no layout is written down twice.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

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
        places = [content.index(struct.pack("<d", number)) for number in planted]
        stamp = struct.pack("<iI", _PLANTED_SECONDS, _PLANTED_NANOSECONDS)
        stamps = [place for place in range(len(content)) if content.startswith(stamp, place)]
        names = [f"number_{i}" for i in range(numbers)], [f"stamp_{i}" for i in range(len(stamps))]
        self._names = names
        self._content = np.frombuffer(content, np.uint8)
        self._dtype = np.dtype(
            {
                "names": [*names[0], *names[1]],
                "formats": ["<f8"] * numbers + ["<u8"] * len(stamps),
                "offsets": [*places, *stamps],
                "itemsize": len(content),
            }
        )

    def filled(self, log_times: Bytes, numbers: Bytes) -> Bytes:
        """A payload for each row of numbers, shape (messages, numbers), at these times [ns]."""
        raw = np.tile(self._content, (len(numbers), 1))
        rows = raw.view(self._dtype)[:, 0] if len(raw) else np.empty(0, self._dtype)
        for i, name in enumerate(self._names[0]):
            rows[name] = numbers[:, i]
        stamps = log_times // _NANOSECONDS | log_times % _NANOSECONDS << np.uint64(32)
        for name in self._names[1]:
            rows[name] = stamps
        return raw.view(f"V{len(self._content)}")[:, 0]
