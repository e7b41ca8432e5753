"""A run's outcome, for a person to read and for a script to parse."""

from __future__ import annotations

from typing import Any

from server.library.record import RunRecord
from sim.snapshot import Outcome

_HEADLINES = {
    "caged_force_reduced": "Caged, with less force than direct caging",
    "caged_force_not_reduced": "Caged, but with no less force than direct caging",
    "caged_unplanned_contact": "Caged, after a contact that was not planned",
    "ejection": "Failed: the target left the robot's reach",
    "base_collision": "Failed: the target struck the base",
    "unresolved": "Unresolved: not caged, or never closed around a slow target",
}


def as_document(record: RunRecord, outcome: Outcome) -> dict[str, Any]:
    """What `becalm run --json` prints."""
    return {
        **outcome.model_dump(mode="json"),
        "real_time_factor": record.real_time_factor,
        "seed": record.config.simulation.seed,
        "engine": record.config.simulation.engine.value,
        "run_id": record.id,
        "configuration": record.configuration,
        "direct": record.direct,
        "versions": record.versions,
        "config": record.config.model_dump(mode="json"),
    }


def as_text(record: RunRecord, outcome: Outcome) -> str:
    """What `becalm run` prints."""
    facts = [
        ("outcome", f"{outcome.outcome.value} (at first closure {outcome.at_first_closure.value}, "
         f"with locked arms {outcome.at_locked_arms.value})"),
        ("cage", _cage(outcome)),
        ("peak tip force", f"{outcome.peak_tip_force:.3f} N, {outcome.peak_tip_force_to_closure:.3f} N until closed"),
        ("closed, locked", f"{_at(outcome.closed_at)}, {_at(outcome.locked_at)}"),
        ("final target spin", f"{outcome.final_target_spin:.3f} rad/s"),
        ("least manipulability", f"{outcome.min_manipulability:.4f} m2"),
        ("momentum error", f"{outcome.momentum_error:.1e} N s, N m s"),
        ("duration", f"{outcome.duration:.3f} s, {record.real_time_factor or 0:.0f} x real time"),
        ("configuration", f"{record.configuration}, seed {record.config.simulation.seed}"),
        ("engine", record.config.simulation.engine.value),
        ("run", record.id),
    ]  # fmt: skip
    lines = [
        f"With locked arms:    {_HEADLINES[outcome.at_locked_arms.value]}",
        f"By the paper's rule: {_HEADLINES[outcome.at_first_closure.value]}",
        "",
    ]
    lines += [f"  {name:<22}{value}" for name, value in facts]
    return "\n".join([*lines, "", *_contacts(outcome)])


def _cage(outcome: Outcome) -> str:
    if not outcome.caged or outcome.cage_margin is None:
        return "none: some motion leads the target out of the hands"
    return f"holds, with a margin of {1e3 * outcome.cage_margin:.1f} mm"


def _at(time: float | None) -> str:
    return "never" if time is None else f"{time:.3f} s"


def _contacts(outcome: Outcome) -> list[str]:
    if not outcome.contacts:
        return ["  no contact"]
    lines = [f"  {'contact':<10}{'from s':>9}{'to s':>9}{'peak N':>9}"]
    for touch in outcome.contacts:
        end = "" if touch.end is None else f"{touch.end:.3f}"
        note = "" if touch.planned else "  unplanned"
        lines.append(f"  {touch.arm:<10}{touch.start:>9.3f}{end:>9}{touch.peak:>9.3f}{note}")
    return lines
