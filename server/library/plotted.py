"""What plots show of a run: its columns, and pieces of time of which the least and the largest value remain."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from pydantic import Field

from server.library.record import TickArray
from sim.capture.tick import ARMS, COLUMNS, TickColumn, column_values
from sim.snapshot import FrozenMessage

Values = np.ndarray[Any, np.dtype[np.float64]]


class Plotted(NamedTuple):
    """A column of the history: one of the log, or what plots show that no single column of the log has."""

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
    "wanted_force",
)


def recorded(column: TickColumn) -> Plotted:
    """A column of the log as it is."""
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
    *(recorded(column) for column in COLUMNS if column.quantity in (*_QUANTITIES, *_ARM_QUANTITIES)),
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


class HistoryColumn(FrozenMessage):
    """One column of the history."""

    name: str
    unit: str


HISTORY_COLUMNS = [HistoryColumn(name=column.name, unit=column.unit) for column in PLOTTED]
ENCODED_COLUMNS = json.dumps([{"name": column.name, "unit": column.unit} for column in PLOTTED])


class History(FrozenMessage):
    """Ticks of a run in few rows, oldest first."""

    run_id: str = Field(description="Of the mission's run")
    columns: list[HistoryColumn]
    rows: list[list[float | None]] = Field(
        description="Two rows for each piece of time, the least and the largest value of every column"
    )
