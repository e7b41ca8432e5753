"""The mission so far in few rows: what a browser that joins late draws its plots from.

Ticks are taken together in pieces. Of each piece two rows remain: the least and the largest value of every column, so
that no peak is lost however long the mission lasts.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from pydantic import Field
from pydantic_core import to_json

from server.library.folder import TickArray
from sim.capture.snapshot import Published
from sim.capture.tick import ARMS, COLUMNS, Column, column_values

CAPACITY = 750
"""Pieces at most; two neighbours become one when it is full. Their JSON, the first that a late reader is sent, stays
under the mebibyte that WebSocket clients take of a message unless they are told otherwise."""

AT_ONCE = 1000
"""Ticks that are taken in with one length of their pieces; far fewer than fill the room."""

FIRST_STRIDE = 16
"""Ticks in a piece at first: about what a screen shows in a second."""

DIGITS = 7
"""Of a number in JSON: more than any plot shows."""

Values = np.ndarray[Any, np.dtype[np.float64]]


class Plotted(NamedTuple):
    """A column of the history: one of the log, or what plots show that no single column of the log tells."""

    name: str
    unit: str
    of: Callable[[TickArray], Values]
    """Its values over an array of `TICK`, shape (ticks,)."""


_QUANTITIES = ("tick", "time", "phase", "base_pose", "base_twist", "target_pose", "target_twist")
_ARM_QUANTITIES = (
    "joint_rate",
    "commanded_joint_rate",
    "hand_pose",
    "desired_hand_pose",
    "hand_wrench",
    "manipulability",
)


def _recorded(column: Column) -> Plotted:
    return Plotted(column.name, column.unit, lambda ticks: column_values(ticks, column).astype(float))


def _derived(arm: int, name: str) -> tuple[Plotted, ...]:
    """Of one arm. The extremes of a force do not follow from those of its components."""

    def error(ticks: TickArray) -> Values:
        difference: Values = ticks["desired_hand_pose"][:, arm] - ticks["hand_pose"][:, arm]
        return difference

    return (
        Plotted(f"{name}.hand_force", "N", lambda ticks: np.hypot(*ticks["hand_wrench"][:, arm, :2].T)),
        Plotted(f"{name}.position_error", "m", lambda ticks: np.hypot(*error(ticks)[:, :2].T)),
        Plotted(f"{name}.angle_error", "rad", lambda ticks: error(ticks)[:, 2]),
    )


PLOTTED: tuple[Plotted, ...] = (
    *(_recorded(column) for column in COLUMNS if column.quantity in (*_QUANTITIES, *_ARM_QUANTITIES)),
    *(plotted for arm, name in enumerate(ARMS) for plotted in _derived(arm, name)),
)
TICK_PLACE, TIME_PLACE, PHASE_PLACE = (
    [column.name for column in PLOTTED].index(name) for name in ("mission.tick", "mission.time", "mission.phase")
)


def plotted_values(ticks: TickArray) -> Values:
    """Every column over an array of `TICK`, shape (ticks, columns)."""
    return np.column_stack([column.of(ticks) for column in PLOTTED])


def extremes(values: Values, starts: np.ndarray[Any, np.dtype[np.signedinteger[Any]]]) -> tuple[Values, Values]:
    """Least and largest values of the pieces that begin at these rows; shapes (pieces, columns)."""
    return np.fmin.reduceat(values, starts), np.fmax.reduceat(values, starts)


def rows_of(low: Values, high: Values) -> list[list[float | None]]:
    """Two rows a piece, one of a piece with a single tick; what is not finite is null.

    Where ticks are missing between two pieces stands a row of nulls, so that no curve is drawn over the gap.
    """
    gap = np.full_like(high, np.nan)
    gap[:, [TICK_PLACE, PHASE_PLACE]] = high[:, [TICK_PLACE, PHASE_PLACE]] + (0.5, 0.0)
    gap[:-1, TIME_PLACE] = 0.5 * (high[:-1, TIME_PLACE] + low[1:, TIME_PLACE])
    missing = np.append(low[1:, TICK_PLACE] - high[:-1, TICK_PLACE] > 1, np.zeros(min(1, len(low)), bool))
    wanted = np.column_stack([np.ones(len(low), bool), high[:, TICK_PLACE] > low[:, TICK_PLACE], missing])
    rows = np.stack([low, high, gap], axis=1)[wanted]
    numbers: list[list[float | None]] = rows.tolist()
    if not np.isfinite(rows).all():
        numbers = [[value if math.isfinite(value) else None for value in row] for row in rows.tolist()]
    return numbers


class HistoryColumn(Published):
    """One column of the history."""

    name: str
    unit: str


HISTORY_COLUMNS = [HistoryColumn(name=column.name, unit=column.unit) for column in PLOTTED]
_ENCODED_COLUMNS = json.dumps([{"name": column.name, "unit": column.unit} for column in PLOTTED])


class History(Published):
    """Ticks of a run in few rows, oldest first."""

    run_id: str = Field(description="Of the mission's run")
    columns: list[HistoryColumn]
    rows: list[list[float | None]] = Field(
        description="Two rows for each piece of time, the least and the largest value of every column"
    )


class _Block:
    """Room for the pieces of a run's history. Rows below `count` never change."""

    def __init__(self, run_id: str, low: Values, high: Values) -> None:
        self.run_id = run_id
        self.low, self.high = (np.empty((CAPACITY, len(PLOTTED))) for _ in range(2))
        self.count = len(low)
        self.low[: self.count], self.high[: self.count] = low, high

    def add(self, low: Values, high: Values) -> None:
        """One piece more."""
        self.low[self.count], self.high[self.count] = low, high
        self.count += 1

    def halved(self) -> _Block:
        """Of every two neighbours one piece."""
        even = self.count - self.count % 2
        low = np.fmin(self.low[0:even:2], self.low[1:even:2])
        return _Block(self.run_id, low, np.fmax(self.high[0:even:2], self.high[1:even:2]))


_NOTHING = np.empty((0, len(PLOTTED)))


class HistoryRing:
    """Written by the mission thread, which only takes extremes; read, and encoded, by any thread."""

    def __init__(self) -> None:
        self._stride = FIRST_STRIDE
        self._block = _Block("", _NOTHING, _NOTHING)
        self._waiting: list[TickArray] = []

    def begin(self, run_id: str, past: HistoryRing | None = None) -> None:
        """Hold nothing but that past: another mission begins, with that run."""
        self._stride = FIRST_STRIDE if past is None else past._stride
        low, high = (_NOTHING, _NOTHING) if past is None else past._extremes()
        self._block = _Block(run_id, low, high)
        self._waiting = [] if past is None else list(past._waiting)

    def keep(self, ticks: TickArray) -> None:
        """Take in rows of `TICK` that follow those before; they show when their piece is whole."""
        for start in range(0, len(ticks), AT_ONCE):
            self._keep_few(ticks[start : start + AT_ONCE])

    def _keep_few(self, ticks: TickArray) -> None:
        """Take in rows that all become pieces of one length."""
        self._waiting.append(ticks)
        first, last = (int(tick) // self._stride for tick in (self._waiting[0]["tick"][0], ticks["tick"][-1]))
        if first == last:
            return
        waiting = np.concatenate(self._waiting)
        numbers = waiting["tick"] // self._stride
        starts = np.flatnonzero(np.diff(numbers, prepend=numbers[0] - 1))
        self._waiting = [waiting[starts[-1] :]]
        for low, high in zip(*extremes(plotted_values(waiting[: starts[-1]]), starts[:-1]), strict=True):
            if self._block.count == CAPACITY:
                self._stride *= 2
                self._block = self._block.halved()
            self._block.add(low, high)

    def encoded(self, since: int = -1) -> str:
        """The members of `History` as JSON, of the pieces with ticks after `since`; for any thread."""
        block = self._block  # one look: a run and its rows are replaced together
        low, high = block.low[: block.count], block.high[: block.count]
        wanted = high[:, TICK_PLACE] > since
        rows = to_json(rows_of(_rounded(low[wanted]), _rounded(high[wanted])))
        return f'"run_id":{json.dumps(block.run_id)},"columns":{_ENCODED_COLUMNS},"rows":{rows.decode()}'

    def _extremes(self) -> tuple[Values, Values]:
        return self._block.low[: self._block.count], self._block.high[: self._block.count]


def _rounded(values: Values) -> Values:
    """To so many digits, the tick's number left whole; what is not finite stays."""
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = 10.0 ** (DIGITS - 1 - np.floor(np.log10(np.abs(values))))
        rounded = np.where((values == 0) | ~np.isfinite(scale), values, np.round(values * scale) / scale)
    rounded[:, TICK_PLACE] = values[:, TICK_PLACE]
    return rounded
