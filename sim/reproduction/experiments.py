"""What is flown to reproduce the paper: whole captures, cells of its study, ablations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from enum import StrEnum
from typing import Any, NamedTuple

import numpy as np

from sim.capture.events import Event, Ticks
from sim.capture.run import run_capture
from sim.config import MissionConfig
from sim.configurations import named_configuration
from sim.reproduction.published import (
    DAMPING,
    MASS,
    REPRODUCTION_ENGINE,
    STIFFNESS,
    PublishedImpedance,
    published_classes,
    published_study,
)
from sim.snapshot import Outcome, OutcomeClass
from sim.study.design import ENGINE, Study, configured, study_of
from sim.study.run import Row


class FlownCapture(NamedTuple):
    """One capture with every tick of it."""

    config: MissionConfig
    direct: bool
    ticks: Ticks
    outcome: Outcome
    events: list[Event]


def fly_whole(config: MissionConfig, *, direct: bool = False) -> FlownCapture:
    """Fly a capture to its verdict and keep every tick.

    Raises:
        PlantDiverged: the simulated state is not finite.

    """
    kept: list[Ticks] = []
    result = run_capture(config, direct=direct, on_ticks=kept.append)
    return FlownCapture(config, direct, np.concatenate(kept), result.outcome, result.events)


def fly_row(study: Study, row: Row) -> FlownCapture:
    """Fly the cell of a row again, and keep every tick."""
    return fly_whole(configured(study.base, study.cell(row["cell"])))


def tables_study(configuration: str, every: int) -> Study:
    """The paper's 484 cells with the constants of that configuration, or with every N-th damping and stiffness only."""
    grid = {path: list(axis.listed()) for path, axis in published_study().grid.items()}
    for path in (DAMPING, STIFFNESS):
        grid[path] = grid[path][::every]
    changes = {ENGINE: REPRODUCTION_ENGINE.value}
    return study_of({"name": configuration, "configuration": configuration, "changes": changes, "grid": grid})


class Origin(StrEnum):
    """Where an ablation's other value comes from."""

    PRINTED = "printed"
    """The paper prints it."""
    UNSTATED = "unstated"
    """The paper does not state the constant."""
    PLANT = "plant"
    """It is a choice of the simulation, the authors' or ours."""


class Ablation(NamedTuple):
    """One constant of `published` set to another value."""

    name: str
    words: str
    changes: Mapping[str, Any]
    origin: Origin


ABLATIONS = (
    Ablation("friction", "friction μ = 0.1", {"contact.friction": 0.1}, Origin.PRINTED),
    Ablation("position", "contact position α = 0.8", {"published.touch.contact_position": 0.8}, Origin.PRINTED),
    Ablation("hand_tilt", "hand tilt β = 0.175 rad", {"published.touch.hand_tilt": 0.175}, Origin.PRINTED),
    Ablation("target_tilt", "target tilt γ = 0.175 rad", {"published.touch.target_tilt": 0.175}, Origin.PRINTED),
    Ablation("link_2", "link 2 of 0.175 m", {"robot.arm.link_2.length": 0.175}, Origin.PRINTED),
    Ablation("link_1", "link 1 centre of mass at 0.229 m", {"robot.arm.link_1.centre_of_mass": 0.229}, Origin.PRINTED),
    Ablation("slow_spin", "caging at once below 0.4 rad/s", {"published.caging.slow_spin": 0.4}, Origin.UNSTATED),
    Ablation("absorb_time", "absorbing for 0.2 s", {"published.touch.absorb_time": 0.2}, Origin.UNSTATED),
    Ablation("corner", "radial contact at corners", {"contact.corner": "radial"}, Origin.PLANT),
    Ablation("mount", "hand rigid on link 3", {"robot.servo.hand_mount": "rigid"}, Origin.PLANT),
    Ablation("servo", "servo of 0.5 ms", {"robot.servo.time_constant": 5e-4}, Origin.PLANT),
    Ablation("creep", "friction that creeps below 10 mm/s", {"contact.friction_speed": 0.01}, Origin.PLANT),
    Ablation("time_step", "physics step of 0.5 ms", {"simulation.time_step": 5e-4}, Origin.PLANT),
)


def ablation_study(ablation: Ablation, every: int) -> Study:
    """The cells of the two tables at hand, with that one change of `published`."""
    whole = tables_study("published", every).definition()
    masses = sorted({impedance.mass for impedance in published_classes()})
    whole["grid"][MASS] = masses
    return study_of({**whole, "name": f"ablation_{ablation.name}", "changes": {**whole["changes"], **ablation.changes}})


def impedance_of(row: Row) -> PublishedImpedance:
    """The impedance of a row's cell."""
    return PublishedImpedance(row[MASS], row[DAMPING], row[STIFFNESS])


def succeeded(row: Row) -> bool:
    """Whether the paper would call the cell a success."""
    return str(row["at_first_closure"]).startswith("caged")


class Example(NamedTuple):
    """A typical cell of one kind of outcome."""

    kind: str
    """dead_touch, beside_it, rebound, ejection, unresolved or lost_after_closure."""
    row: Row
    alike: int
    """How many cells of the study are of its kind."""


def examples(rows: Sequence[Row], config: MissionConfig) -> list[Example]:
    """One cell of each kind of failure among the rows, and the success beside the first."""
    slow, threshold = config.published.caging.slow_spin, config.published.caging.spin_threshold
    kinds: dict[str, list[Row]] = {
        "dead_touch": [], "rebound": [], "ejection": [], "unresolved": [], "lost_after_closure": []
    }  # fmt: skip
    for row in rows:
        spin = row["spin_after_first_touch"]
        if succeeded(row):
            if not row["caged"]:
                kinds["lost_after_closure"].append(row)
        elif row["at_first_closure"] in (OutcomeClass.EJECTION, OutcomeClass.UNRESOLVED):
            kinds[row["at_first_closure"]].append(row)
        elif spin is not None and slow < abs(spin) < threshold and row["touches"] == 1:
            kinds["dead_touch"].append(row)
        elif spin is not None and abs(spin) <= slow:
            kinds["rebound"].append(row)
    chosen = []
    for kind, found in kinds.items():
        if not found:
            continue
        row = _typical(kind, found)
        chosen.append(Example(kind, row, len(found)))
        if kind == "dead_touch" and (beside := _beside(row, rows)) is not None:
            chosen.append(Example("beside_it", beside, sum(map(succeeded, rows))))
    return chosen


def _typical(kind: str, found: Sequence[Row]) -> Row:
    """Of dead touches the least dead one of the middle mass; of the others the one in the middle by drift."""
    if kind == "dead_touch":
        middle = [row for row in found if row[MASS] == 0.1] or found
        return min(middle, key=lambda row: abs(row["spin_after_first_touch"]))
    ordered = sorted(found, key=lambda row: (row["drift_after_first_touch"] or 0.0, row["cell"]))
    return ordered[len(ordered) // 2]


def _beside(row: Row, rows: Iterable[Row]) -> Row | None:
    """The success with the next smaller damping, all else the same."""
    less = [
        other
        for other in rows
        if succeeded(other)
        and other[DAMPING] < row[DAMPING]
        and (other[MASS], other[STIFFNESS]) == (row[MASS], row[STIFFNESS])
    ]
    return max(less, key=lambda other: other[DAMPING], default=None)


def published_config() -> MissionConfig:
    """The authors' constants."""
    return named_configuration("published")
