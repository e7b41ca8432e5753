"""One cell of a study: a capture flown to its verdict, and what is kept of it as one flat row."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from sim.capture.mission import prepare
from sim.capture.run import run_capture
from sim.config import PARAMETERS, MissionConfig, OutcomeRule
from sim.errors import CaptureError
from sim.record import Record
from sim.snapshot import Outcome, Touch
from sim.study.axes import parameter_words
from sim.study.capture_metrics import capture_metrics
from sim.study.design import Cell, Study, configured

Row = Mapping[str, Any]
"""Column name to value; None where there is none."""


class Column(NamedTuple):
    """One column of a study's table."""

    name: str
    kind: type[float] | type[int] | type[bool] | type[str]
    unit: str
    description: str


MEASURES = (
    Column("outcome", str, "1", "The verdict that judging.rule names: the paper's, unless the study says otherwise"),
    Column("at_first_closure", str, "1", "The paper's verdict: judged at the first closed instant, as its tables"),
    Column("at_locked_arms", str, "1", "Judged when the arms have locked, by the caging test"),
    Column("caged", bool, "1", "No motion leads the target out of the locked hands"),
    Column("cage_margin", float, "m", "How far the tips would have to give way to let it out; none if not caged"),
    Column("peak_tip_force", float, "N", "Largest hand resultant of the whole sequence, to locked arms"),
    Column("peak_tip_force_to_closure", float, "N", "The same up to the first closed instant"),
    Column("closed_at", float, "s", "First closed instant; none if never"),
    Column("locked_at", float, "s", "Arms locked; none if never"),
    Column("duration", float, "s", "From the sequence's start to the verdict"),
    Column("touches", int, "1", "How many touches, planned or not"),
    Column("hardest_touch_arm", str, "1", "Arm of the touch with the largest force"),
    Column("hardest_touch_start", float, "s", "When that touch began"),
    Column("hardest_touch_peak", float, "N", "Largest hand resultant of that touch"),
    Column("peak_at", float, "s", "When the largest hand resultant of all came; none if no tip touched"),
    Column("peak_stage", str, "1", "What it fell into: a touch, the closing up to the first closed instant, or after"),
    Column("first_touch_end", float, "s", "Last contact of the first touch"),
    Column("first_touch_peak", float, "N", "Largest hand resultant of the first touch"),
    Column("spin_after_first_touch", float, "rad/s", "Target's angular velocity when the first touch ends"),
    Column("drift_after_first_touch", float, "m/s", "Speed of the target's centre when the first touch ends"),
    Column("base_turn", float, "rad", "The base's angle where it is largest, with its sign"),
    Column("final_target_spin", float, "rad/s", "Target's angular velocity at the verdict"),
    Column("min_manipulability", float, "m2", "Smallest of both arms over the sequence"),
    Column("momentum_error", float, "N s, N m s", "Largest change of total momentum: linear plus angular"),
    Column("engine", str, "1", "What simulated the capture (simulation.engine)"),
)
"""The measures of a cell that was flown."""


def columns(study: Study) -> tuple[Column, ...]:
    """The columns of a study's table: the cell, what was varied under its full path, its measures, its error."""
    return (
        Column("cell", int, "1", "Place in the study, from 0"),
        *map(_varied_column, study.varied),
        Column("seed", int, "1", "Of the capture's random numbers"),
        *MEASURES,
        Column("error", str, "1", "Why the cell has no measures"),
    )


def _varied_column(path: str) -> Column:
    kind = PARAMETERS[path].annotation if path in PARAMETERS else float
    return Column(path, kind if kind in (float, int) else str, *parameter_words(path))


@dataclass(frozen=True)
class CellTask:
    """All that a worker needs to fly one cell; small, and travels as a pickle."""

    base: MissionConfig
    direct: bool
    cell: Cell


def fly_cell(task: CellTask) -> Row:
    """Fly a cell to its verdict; a row with `error` if it cannot be flown."""
    try:
        config = configured(task.base, task.cell)
        prepare(config, recorded=False)
        flown = run_capture(config, direct=task.direct)
        measured = measures_of(flown.outcome, flown.monitor, config)
    except CaptureError as error:
        return failed_row(task.cell, str(error))
    except Exception as error:  # one cell that fails, however it does, must not take the others along
        return failed_row(task.cell, f"{type(error).__name__}: {error}")
    return {**_identity(task.cell), **measured, "error": None}


def measures_of(outcome: Outcome, monitor: Record, config: MissionConfig) -> dict[str, Any]:
    """The values of `MEASURES` of a capture, in their order.

    Args:
        outcome: how it ended.
        monitor: what was noted of it, one element of `MONITOR`.
        config: with which it was flown.

    """
    measured = _measures(outcome, config.judging.rule) | capture_metrics(monitor, outcome, config)
    measured["engine"] = config.simulation.engine.value
    return {column.name: measured[column.name] for column in MEASURES}


def failed_row(cell: Cell, error: str) -> Row:
    """The row of a cell that has no measures, and why."""
    return {**_identity(cell), **dict.fromkeys(column.name for column in MEASURES), "error": error}


def _identity(cell: Cell) -> dict[str, Any]:
    return {"cell": cell.index, **cell.values, "seed": cell.seed}


def _measures(outcome: Outcome, rule: OutcomeRule) -> dict[str, Any]:
    judged = outcome.at_first_closure if rule is OutcomeRule.FIRST_CLOSURE else outcome.at_locked_arms
    hardest: Touch | None = max(outcome.contacts, key=lambda touch: touch.peak, default=None)
    return {
        "outcome": judged.value,
        "at_first_closure": outcome.at_first_closure.value,
        "at_locked_arms": outcome.at_locked_arms.value,
        "caged": outcome.caged,
        "cage_margin": outcome.cage_margin,
        "peak_tip_force": outcome.peak_tip_force,
        "peak_tip_force_to_closure": outcome.peak_tip_force_to_closure,
        "closed_at": outcome.closed_at,
        "locked_at": outcome.locked_at,
        "duration": outcome.duration,
        "touches": len(outcome.contacts),
        "hardest_touch_arm": hardest.arm if hardest else None,
        "hardest_touch_start": hardest.start if hardest else None,
        "hardest_touch_peak": hardest.peak if hardest else None,
        "final_target_spin": outcome.final_target_spin,
        "min_manipulability": outcome.min_manipulability,
        "momentum_error": outcome.momentum_error,
    }
