"""Ticks as a log keeps them: `/becalm/tick`, in a schema of our own that stands in the file.

Today's logs have the bytes of `TICK` itself (CDR: each value at a multiple of its size). One of another version is laid
out by the schema that it brings along: its columns are found by name, also by a former one, those that it lacks are
filled, and those that today's version does not know stay as they are and can be exported.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from mcap.records import Schema

from server.errors import StoredUnreadable
from server.log.stream import Bytes, Contents
from sim.capture.tick import COLUMNS, QUANTITIES, TICK, TickColumn, column_values, columns_of
from sim.schema_history import TICK_CHANGES, former_names

TICK_CHANNEL = 1
"""Channel of the ticks in every log."""

CDR_TICK = np.dtype([("head", "V4"), ("tick", f"V{TICK.itemsize}")])
"""Payload of one of today's ticks: the encapsulation header of little-endian CDR, then the bytes of the tick."""
_CDR_HEAD = np.frombuffer(b"\x00\x01\x00\x00", "V4")[0]

_ROS_TYPES = {
    "i1": "int8", "i2": "int16", "i4": "int32", "i8": "int64", "u1": "uint8", "u2": "uint16", "u4": "uint32",
    "u8": "uint64", "f4": "float32", "f8": "float64", "b1": "bool",
}  # fmt: skip
_NUMPY_KINDS = {ros: kind for kind, ros in _ROS_TYPES.items()}
_LINE = re.compile(r"(?P<type>\S+)\s+(?P<name>[A-Za-z]\w*)\s*(#\s*(\[(?P<unit>.*)\])?.*)?")


class StoredColumn(NamedTuple):
    """A column as a log has it."""

    name: str
    """As ROS 2 spells it: `left_hand_wrench_x`."""
    kind: str
    """Numpy type, such as `f8`."""
    unit: str


def field_name(column: TickColumn) -> str:
    """A column's name as ROS 2 spells it: `left.hand_wrench.x` is `left_hand_wrench_x`."""
    return column.name.removeprefix("mission.").replace(".", "_")


def stored_columns(columns: tuple[TickColumn, ...] | list[TickColumn]) -> list[StoredColumn]:
    """Columns of today as a log has them."""
    return [StoredColumn(field_name(each), TICK[each.quantity].base.str[1:], each.unit) for each in columns]


def schema_of(columns: list[StoredColumn]) -> Schema:
    """The schema of ticks with these columns."""
    lines = ["# One control tick of Becalm; SI and radians, world axes."]
    lines += [f"{_ROS_TYPES[kind]} {name}  # [{unit}]" for name, kind, unit in columns]
    return Schema(id=0, name="becalm_msgs/msg/Tick", encoding="ros2msg", data="\n".join(lines).encode())


@cache
def tick_schema() -> Schema:
    """Every column of one of today's ticks with its unit."""
    return schema_of(stored_columns(COLUMNS))


def tick_payloads(ticks: Bytes) -> Bytes:
    """Rows of `TICK` as the payloads of their messages, of a void type."""
    kept = np.ascontiguousarray(ticks, TICK.newbyteorder("<"))
    payloads = np.empty(len(ticks), CDR_TICK)
    payloads["head"], payloads["tick"] = _CDR_HEAD, kept.view(CDR_TICK["tick"])
    return payloads.view(f"V{CDR_TICK.itemsize}")


class TickLayout:
    """How one log keeps its ticks, and what of them today's version knows."""

    def __init__(self, schema: Schema) -> None:
        """By the schema in the log.

        Raises:
            StoredUnreadable: it is no list of numbers, or lacks the number or the time of a tick.

        """
        self.schema = schema
        self._is_todays = schema.data == tick_schema().data
        self._stored = _columns_in(schema)
        known = _todays_columns()
        self.known = tuple((each, known[each.name]) for each in self._stored if each.name in known)
        """Columns of the log, and those of today that they are."""
        found = {column.name for _, column in self.known}
        self.absent = tuple(column for column in COLUMNS if column.name not in found)
        """Columns of today that the log lacks: not a number where they are floating, else 0."""
        self.further = tuple(each for each in self._stored if each.name not in known)
        """Columns of the log that today's version does not know."""
        if missing := [column.name for column in self.absent if column.quantity in ("tick", "time")]:
            raise StoredUnreadable(f"the ticks of its log have no {' and no '.join(missing)}")

    def ticks(self, payloads: Bytes) -> Bytes:
        """The payloads of messages as rows of `TICK`.

        Raises:
            StoredUnreadable: they are shorter than the schema says.

        """
        if not len(payloads):
            return np.zeros(0, TICK)
        if self._is_todays and payloads.dtype.itemsize == CDR_TICK.itemsize:
            kept = np.ascontiguousarray(payloads.view(CDR_TICK)["tick"])
            return kept.view(TICK.newbyteorder("<")).astype(TICK, copy=False)
        rows, ticks = self._rows(payloads), np.zeros(len(payloads), TICK)
        for stored, column in self.known:
            column_values(ticks, column)[:] = rows[stored.name]
        for column in self.absent:
            if TICK[column.quantity].base.kind == "f":
                column_values(ticks, column)[:] = np.nan
        return ticks

    def values(self, payloads: Bytes, column: StoredColumn) -> Bytes:
        """The values of one of the log's own columns, shape (messages,)."""
        values: Bytes = self._rows(payloads)[column.name].copy()
        return values

    def packed(self, values: Mapping[str, Bytes], count: int) -> Bytes:
        """Payloads of so many messages, from the values of every column by its name."""
        payloads = np.zeros(count, self._dtype(self._dtype(0).itemsize))
        payloads["head"] = _CDR_HEAD
        for each in self._stored:
            payloads[each.name] = values[each.name]
        return payloads.view(f"V{payloads.dtype.itemsize}")

    def _rows(self, payloads: Bytes) -> Bytes:
        dtype = self._dtype(payloads.dtype.itemsize)
        if dtype.itemsize > payloads.dtype.itemsize:
            raise StoredUnreadable(
                f"ticks of its log have {payloads.dtype.itemsize} bytes, by their schema they have {dtype.itemsize}"
            )
        return payloads.view(dtype)

    def _dtype(self, size: int) -> np.dtype[Any]:
        """Of a payload of so many bytes, or of as many as the columns take: each at a multiple of its size."""
        offsets, end = [], 0
        for each in self._stored:
            width = np.dtype(each.kind).itemsize
            offsets.append(-(-end // width) * width)
            end = offsets[-1] + width
        head = _CDR_HEAD.dtype.itemsize
        return np.dtype(
            {
                "names": ["head", *(each.name for each in self._stored)],
                "formats": ["V4", *(f"<{each.kind}" for each in self._stored)],
                "offsets": [0, *(head + offset for offset in offsets)],
                "itemsize": max(size, head + end),
            }
        )


def layout_in(contents: Contents) -> TickLayout:
    """How the ticks of a log are laid out; as today's in one that has none.

    Raises:
        StoredUnreadable: it cannot be understood; the message says why.

    """
    channel = contents.channels.get(TICK_CHANNEL)
    schema = None if channel is None else contents.schemas.get(channel.schema_id)
    return _layout_of((schema or tick_schema()).data)


@cache
def _layout_of(schema: bytes) -> TickLayout:
    return TickLayout(Schema(id=0, name="becalm_msgs/msg/Tick", encoding="ros2msg", data=schema))


def _columns_in(schema: Schema) -> list[StoredColumn]:
    """The columns that a schema lists: one a line, its unit in the comment."""
    columns: list[StoredColumn] = []
    for line in schema.data.decode(errors="replace").splitlines():
        if not line.split("#")[0].strip():
            continue
        found = _LINE.fullmatch(line.strip())
        if found is None or found["type"] not in _NUMPY_KINDS or found["name"] in [each.name for each in columns]:
            raise StoredUnreadable(f"the schema of its ticks cannot be understood at {line!r}")
        columns.append(StoredColumn(found["name"], _NUMPY_KINDS[found["type"]], found["unit"] or "1"))
    return columns


@cache
def _todays_columns() -> dict[str, TickColumn]:
    """Columns of today by every name under which a log may have them."""
    known: dict[str, TickColumn] = {}
    for quantity in QUANTITIES:
        for name in (quantity.name, *former_names(quantity.name, TICK_CHANGES)):
            stored = map(field_name, columns_of(quantity._replace(name=name)))
            known |= zip(stored, columns_of(quantity), strict=True)
    return known
