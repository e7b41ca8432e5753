"""The mission so far in few rows: what a browser that joins late draws its plots from."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import NamedTuple

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

    run_id: str = Field(description="Of the mission's run")
    columns: list[HistoryColumn]
    rows: list[list[float | None]] = Field(description="One row a kept tick, in the order of the columns")


class HistoryRing:
    """Rows are encoded when they are kept, so that a browser that joins costs no more than joining strings.

    Written by the mission thread; read from any thread: rows are only appended, or replaced together with their run.
    """

    def __init__(self) -> None:
        self._content = _Content("", FIRST_STRIDE, [])

    def begin(self, run_id: str, past: HistoryRing | None = None) -> None:
        """Hold nothing but that past: another mission begins, with that run."""
        stride, rows = (FIRST_STRIDE, []) if past is None else (past._content.stride, list(past._content.rows))
        self._content = _Content(run_id, stride, rows)

    def keep(self, ticks: TickArray) -> None:
        """Keep every stride-th of these rows of `TICK`."""
        kept = ticks[ticks["tick"] % self._content.stride == 0]
        if not len(kept):
            return
        columns = [column_values(kept, column).tolist() for column in PLOTTED]
        rows = self._content.rows
        for tick, row in zip(kept["tick"].tolist(), zip(*columns, strict=True), strict=True):
            rows.append((tick, _encoded(row)))
        while len(self._content.rows) >= CAPACITY:
            self._thin()

    def encoded(self, since: int = -1) -> str:
        """The members of `History` as JSON, of the ticks after `since`; for any thread."""
        content = self._content  # one look: a run and its rows are replaced together
        rows = ",".join(text for tick, text in list(content.rows) if tick > since)
        return f'"run_id":{json.dumps(content.run_id)},"columns":{_ENCODED_COLUMNS},"rows":[{rows}]'

    def _thin(self) -> None:
        run_id, stride, rows = self._content
        self._content = _Content(run_id, 2 * stride, [row for row in rows if row[0] % (2 * stride) == 0])


class _Content(NamedTuple):
    """Rows by their ticks, of one run."""

    run_id: str
    stride: int
    rows: list[tuple[int, str]]


_ENCODED_COLUMNS = json.dumps([{"name": column.name, "unit": column.unit} for column in PLOTTED])


def _encoded(row: Sequence[float]) -> str:
    return "[" + ",".join(map(_encoded_number, row)) + "]"


def _encoded_number(value: float) -> str:
    """Seven digits are more than any plot shows; JSON has no word for what is not finite."""
    if isinstance(value, int):
        return str(value)
    return format(value, ".7g") if math.isfinite(value) else "null"
