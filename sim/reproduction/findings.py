"""What a reproduction found, in numbers: one document, from which every number of its report is taken."""

from __future__ import annotations

import csv
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from importlib.resources import files
from typing import Any, NamedTuple

import numpy as np

from sim.capture.events import Ticks
from sim.compiled import FloatArray
from sim.config import MissionConfig
from sim.reproduction.experiments import (
    Ablation,
    Example,
    FlownCapture,
    examples,
    impedance_of,
    published_config,
    succeeded,
)
from sim.reproduction.first_touch import TouchState, effective_mass, lever_of
from sim.reproduction.first_touch_prediction import Prediction, prediction_score, predictions, touch_state
from sim.reproduction.published import DAMPING, MASS, STIFFNESS, agreement, cohens_kappa, published_classes
from sim.study.capture_metrics import ContactStage
from sim.study.run import Row

AUTHORS_AGREEMENT = {"agreeing": 481, "cells": 484}
"""Of the authors' own public simulator with all four published tables, class for class."""


class Captures(NamedTuple):
    """The captures that the report shows in full."""

    direct: FlownCapture
    representative: FlownCapture
    figures: FlownCapture
    """With the impedance that fits the paper's figures."""


class Reproduction(NamedTuple):
    """Everything that was flown, and what follows from it."""

    every: int
    captures: Captures
    published: Sequence[Row]
    as_printed: Sequence[Row]
    ablations: Sequence[tuple[Ablation, Sequence[Row]]]
    cells: Sequence[Prediction]
    touch: TouchState
    examples: Sequence[Example]

    @property
    def config(self) -> MissionConfig:
        """The authors' constants."""
        return self.captures.representative.config


def reproduction(
    every: int,
    captures: Captures,
    published: Sequence[Row],
    as_printed: Sequence[Row],
    ablations: Sequence[tuple[Ablation, Sequence[Row]]],
) -> Reproduction:
    """What follows from the flights: the first touch by itself, and the typical cells."""
    config = published_config()
    touch = touch_state(config, captures.representative.ticks)
    cells = predictions(config, touch, published)
    return Reproduction(every, captures, published, as_printed, ablations, cells, touch, examples(published, config))


def authors_run() -> Mapping[str, FloatArray]:
    """The authors' own run of direct caging, by column: SI, one value each 5 ms.

    From their public simulator (Space-Robotics-Laboratory, MATLAB_space_debri_capturing_sim, MIT licence).
    """
    text = files("sim.reproduction").joinpath("data", "authors_direct_caging.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def hand_forces(ticks: Ticks) -> FloatArray:
    """Resultant of the tip forces of both hands [N], shape (2, ticks)."""
    return np.asarray(np.hypot(ticks["hand_wrench"][:, :, 0], ticks["hand_wrench"][:, :, 1]).T)


def findings(found: Reproduction) -> dict[str, Any]:
    """All numbers, as one JSON document; the same flights give the same document."""
    return {
        "every": found.every,
        "cells": len(found.published),
        "agreement": {
            "published": [table.model_dump() for table in agreement(found.published)],
            "as_printed": [table.model_dump() for table in agreement(found.as_printed)],
            "authors": AUTHORS_AGREEMENT,
        },
        "overall": {
            "published": overall(found.published),
            "as_printed": overall(found.as_printed),
        },
        "outcomes": {
            "published": _outcomes(found.published),
            "as_printed": _outcomes(found.as_printed),
        },
        "differing": _differing(found.published),
        "captures": {name: _capture(flown) for name, flown in found.captures._asdict().items()},
        "authors_direct": _beside_the_authors(found.captures.direct),
        "after_closure": _after_closure(found.published, found.config),
        "first_touch": _first_touch(found),
        "examples": [_example(example) for example in found.examples],
        "ablations": [_ablation(*one) for one in found.ablations],
    }


def overall(rows: Sequence[Row]) -> dict[str, Any]:
    """Agreement with all published cells at hand together."""
    printed = published_classes()
    pairs = [(str(row["at_first_closure"]), printed[impedance_of(row)]) for row in rows if impedance_of(row) in printed]
    successes = [(str(ours.startswith("caged")), str(theirs.startswith("caged"))) for ours, theirs in pairs]
    return {
        "cells": len(pairs),
        "agreeing": sum(ours == theirs for ours, theirs in pairs),
        "kappa": cohens_kappa(pairs),
        "success_agreeing": sum(ours == theirs for ours, theirs in successes),
        "success_kappa": cohens_kappa(successes),
    }


def _outcomes(rows: Sequence[Row]) -> dict[str, Any]:
    return {
        "at_first_closure": dict(Counter(str(row["at_first_closure"]) for row in rows).most_common()),
        "at_locked_arms": dict(Counter(str(row["at_locked_arms"]) for row in rows).most_common()),
        "success": sum(map(succeeded, rows)),
        "caged": sum(bool(row["caged"]) for row in rows),
    }


def _differing(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """The cells whose class is not the published one."""
    printed = published_classes()
    return [
        {
            "mass": row[MASS],
            "damping": row[DAMPING],
            "stiffness": row[STIFFNESS],
            "ours": row["at_first_closure"],
            "published": printed[impedance_of(row)],
        }
        for row in rows
        if impedance_of(row) in printed and printed[impedance_of(row)] != row["at_first_closure"]
    ]


def _capture(flown: FlownCapture) -> dict[str, Any]:
    outcome = flown.outcome
    first = outcome.contacts[0] if outcome.contacts else None
    degrees = np.degrees(flown.ticks["base_pose"][:, 2])
    return {
        "outcome": outcome.model_dump(mode="json"),
        "first_touch": first.start if first else None,
        "first_arm": first.arm if first else None,
        "largest_base_angle_deg": float(degrees[np.argmax(np.abs(degrees))]),
        "spin_after_first_touch": _spin_at(flown.ticks, first.end) if first and first.end else None,
        "peaks": hand_forces(flown.ticks).max(axis=1).tolist(),
    }


def _spin_at(ticks: Ticks, time: float) -> float:
    place = min(int(np.searchsorted(ticks["time"], time)), len(ticks) - 1)
    return float(ticks["target_twist"][place, 2])


def _beside_the_authors(direct: FlownCapture) -> dict[str, Any]:
    """Our direct run beside theirs, at their instants, up to half a second after the first touch."""
    theirs, ticks = authors_run(), direct.ticks
    touching = (theirs["Fhand_L"] > 0.0) | (theirs["Fhand_R"] > 0.0)
    first = float(theirs["t"][int(np.argmax(touching))])
    window = theirs["t"] <= first + 0.5
    ours = np.interp(theirs["t"][window], ticks["time"], ticks["target_twist"][:, 2])
    return {
        "first_touch": first,
        "peaks": [float(theirs["Fhand_L"].max()), float(theirs["Fhand_R"].max())],
        "largest_spin_difference": float(np.abs(ours - theirs["targ_w"][window]).max()),
        "compared_until": first + 0.5,
    }


def _after_closure(rows: Sequence[Row], config: MissionConfig) -> dict[str, Any]:
    """What a judgement at the first closed instant leaves out."""
    captured = [row for row in rows if succeeded(row)]
    reduced = [row for row in rows if row["at_first_closure"] == "caged_force_reduced"]
    blows = np.array([row["peak_tip_force"] for row in reduced]) if reduced else np.zeros(1)
    before = np.array([row["peak_tip_force_to_closure"] for row in reduced]) if reduced else np.zeros(1)
    bound = config.judging.force_bound
    return {
        "captured": len(captured),
        "reduced": len(reduced),
        "reduced_over_bound_in_the_end": int((blows >= bound).sum()) if reduced else 0,
        "median_before": float(np.median(before)),
        "median_blow": float(np.median(blows)),
        "smallest_blow": float(blows.min()),
        "largest_blow": float(blows.max()),
        "force_bound": bound,
        "hardest": {stage.value: sum(row["peak_stage"] == stage for row in captured) for stage in ContactStage},
        "hardest_of_all": {stage.value: sum(row["peak_stage"] == stage for row in rows) for stage in ContactStage},
        "captured_not_caged": sum(not row["caged"] for row in captured),
    }


def _first_touch(found: Reproduction) -> dict[str, Any]:
    config, touch = found.config, found.touch
    lever, spin = lever_of(touch, config), float(touch.target_twist[2])
    target, caging = config.target, config.published.caging
    effective = effective_mass(target.mass, target.inertia, lever)
    begun = found.captures.representative.outcome.contacts[0].start
    dead = [cell for cell in found.cells if not cell.success and _is_dead(cell, config)]
    return {
        "time": begun,
        "lever": lever,
        "effective_mass": effective,
        "approach_speed": lever * abs(spin),
        "spin_if_dead": abs(spin) * (1.0 - effective * lever**2 / target.inertia),
        "slow_spin": caging.slow_spin,
        "spin_threshold": caging.spin_threshold,
        "failures": sum(not cell.success for cell in found.cells),
        "dead_failures": len(dead),
        "fast_failures": sum(not cell.success and abs(cell.measured.spin) <= caging.slow_spin for cell in found.cells),
        "in_the_gap": sum(_is_dead(cell, config) for cell in found.cells),
        "dead_base_turn_deg": _spread([np.degrees(abs(cell.row["base_turn"])) for cell in dead]),
        "dead_duration": _spread([cell.row["duration"] for cell in dead]),
        "longest_wait": math.pi / 2.0 / caging.slow_spin + caging.minimum_approach_time,
        "touch_duration": _spread([cell.row["first_touch_end"] - begun for cell in found.cells]),
        "dead_single_touch": sum(cell.row["touches"] == 1 for cell in dead),
        **prediction_score(config, found.cells).model_dump(),
    }


def _is_dead(cell: Prediction, config: MissionConfig) -> bool:
    caging = config.published.caging
    return caging.slow_spin < abs(cell.measured.spin) < caging.spin_threshold


def _spread(values: Sequence[float]) -> list[float] | None:
    """5th, 50th and 95th percentile; none of nothing."""
    return [float(value) for value in np.quantile(values, (0.05, 0.5, 0.95))] if values else None


def _example(example: Example) -> dict[str, Any]:
    return {"kind": example.kind, "alike": example.alike, "row": dict(example.row)}


def _ablation(ablation: Ablation, rows: Sequence[Row]) -> dict[str, Any]:
    return {"name": ablation.name, "words": ablation.words, "origin": ablation.origin.value, **overall(rows)}
