"""The mission so far in few rows: what a browser that joins late draws its plots from."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence

from pydantic import Field

from server.run_folder import TickArray
from sim.capture.snapshot import Published
from sim.capture.tick import COLUMNS, Column, column_values

CAPACITY = 3000
"""Rows at most; the history is thinned to half when it is full."""

FIRST_STRIDE = 16
"""Ticks between two rows at first: about what a screen shows in a second."""

_PLOTTED_QUANTITIES = ("tick", "time", "phase", "base_pose", "base_twist", "target_pose", "target_twist")
_PLOTTED_ARM_QUANTITIES = (
    "joint_rate",
    "commanded_joint_rate",
    "hand_pose",
    "desired_hand_pose",
    "hand_wrench",
    "manipulability",
)
PLOTTED: tuple[Column, ...] = tuple(
    column for column in COLUMNS if column.quantity in (*_PLOTTED_QUANTITIES, *_PLOTTED_ARM_QUANTITIES)
)


class HistoryColumn(Published):
    """One column of the history."""

    name: str
    unit: str


class History(Published):
    """Decimated ticks of the live mission, oldest first."""

    columns: list[HistoryColumn]
    rows: list[list[float | None]] = Field(description="One row a kept tick, in the order of the columns")


class HistoryRing:
    """Rows are encoded when they are kept, so that a browser that joins costs no more than joining strings.

    Written by the mission thread; read from any thread: the list is only appended to or replaced.
    """

    def __init__(self) -> None:
        self._stride = FIRST_STRIDE
        self._rows: list[tuple[int, str]] = []

    def begin(self, past: HistoryRing | None = None) -> None:
        """Hold nothing but that past: a new mission begins."""
        self._stride = FIRST_STRIDE if past is None else past._stride
        self._rows = [] if past is None else list(past._rows)

    def keep(self, ticks: TickArray) -> None:
        """Keep every stride-th of these rows of `TICK`."""
        kept = ticks[ticks["tick"] % self._stride == 0]
        if not len(kept):
            return
        columns = [column_values(kept, column).tolist() for column in PLOTTED]
        for tick, row in zip(kept["tick"].tolist(), zip(*columns, strict=True), strict=True):
            self._rows.append((tick, _encoded(row)))
        if len(self._rows) >= CAPACITY:
            self._thin()

    def encoded(self, since: int = -1) -> str:
        """The members `columns` and `rows` of `History` as JSON, of the ticks after `since`."""
        rows = ",".join(text for tick, text in list(self._rows) if tick > since)
        return f'"columns":{_ENCODED_COLUMNS},"rows":[{rows}]'

    def _thin(self) -> None:
        while len(self._rows) >= CAPACITY:
            self._stride *= 2
            self._rows = [row for row in self._rows if row[0] % self._stride == 0]


_ENCODED_COLUMNS = json.dumps([{"name": column.name, "unit": column.unit} for column in PLOTTED])


def _encoded(row: Sequence[float]) -> str:
    return "[" + ",".join(map(_encoded_number, row)) + "]"


def _encoded_number(value: float) -> str:
    """Seven digits are more than any plot shows; JSON has no word for what is not finite."""
    if isinstance(value, int):
        return str(value)
    return format(value, ".7g") if math.isfinite(value) else "null"
