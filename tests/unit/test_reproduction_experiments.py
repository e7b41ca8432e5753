"""What is flown to reproduce the paper, which cells are typical, and how the first touch foretells."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.capture.tick import TICK
from sim.config import PARAMETERS, MissionConfig
from sim.configurations import named_configuration
from sim.reproduction.experiments import ABLATIONS, ablation_study, examples, succeeded, tables_study
from sim.reproduction.findings import authors_run, hand_forces, overall
from sim.reproduction.first_touch import Residual
from sim.reproduction.first_touch_prediction import Prediction, prediction_score, predicts_success, touch_state
from sim.reproduction.published import DAMPING, MASS, STIFFNESS, published_classes, published_study


def row(cell: int = 0, *, mass=0.1, damping=1.5, stiffness=10.0, outcome="caged_force_reduced", **more):
    """A row of a study with what the analysis reads."""
    return {
        "cell": cell, MASS: mass, DAMPING: damping, STIFFNESS: stiffness, "at_first_closure": outcome,
        "caged": outcome.startswith("caged"), "touches": 1, "spin_after_first_touch": 0.1,
        "drift_after_first_touch": 0.04, **more,
    }  # fmt: skip


def prediction(spin: float, drift: float, *, success: bool) -> Prediction:
    left = Residual(spin, drift, math.nan)
    return Prediction(row(outcome="caged_force_reduced" if success else "base_collision"), left, left, left, 0.5)


def test_the_study_is_the_published_one_with_other_constants():
    study = tables_study("as_printed", 1)
    assert study.count == published_study().count == 484
    assert [cell.values for cell in study.cells()] == [cell.values for cell in published_study().cells()]
    assert study.base.contact.friction == named_configuration("as_printed").contact.friction


@pytest.mark.parametrize(("every", "cells"), [(2, 4 * 6 * 6), (5, 4 * 3 * 3), (10, 4 * 2 * 2)])
def test_a_coarse_study_keeps_both_ends(every, cells):
    study = tables_study("published", every)
    assert study.count == cells
    assert {cell.values[DAMPING] for cell in study.cells()} >= {0.0, 15.0}


@pytest.mark.parametrize("ablation", ABLATIONS, ids=lambda ablation: ablation.name)
def test_an_ablation_changes_one_constant_of_the_published_ones(ablation):
    study = ablation_study(ablation, 1)
    assert study.count == len(published_classes()) == 242
    assert len(ablation.changes) == 1
    assert set(ablation.changes) <= set(PARAMETERS)
    assert study.base != MissionConfig()


def test_overall_counts_published_cells_only():
    printed = published_classes()
    rows = [row(i, mass=m, damping=d, stiffness=k, outcome=c) for i, ((m, d, k), c) in enumerate(printed.items())]
    elsewhere = row(999, mass=0.5)
    assert overall([*rows, elsewhere])["agreeing"] == overall(rows)["cells"] == 242
    assert overall(rows)["kappa"] == 1.0


def test_examples_are_of_their_kinds():
    rows = [
        row(0, damping=6.0),
        row(1, damping=7.5, outcome="base_collision", spin_after_first_touch=0.31),
        row(2, damping=9.0, outcome="base_collision", spin_after_first_touch=0.35),
        row(3, damping=0.0, outcome="base_collision", spin_after_first_touch=-0.1),
        row(4, damping=0.0, outcome="ejection"),
        row(5, damping=3.0, caged=False),
    ]
    found = {example.kind: (example.row["cell"], example.alike) for example in examples(rows, MissionConfig())}
    assert found == {
        "dead_touch": (1, 2), "beside_it": (0, 2), "rebound": (3, 1), "ejection": (4, 1), "lost_after_closure": (5, 1),
    }  # fmt: skip


def test_success_is_what_the_paper_calls_so():
    assert succeeded(row(outcome="caged_unplanned_contact"))
    assert not succeeded(row(outcome="unresolved"))


@pytest.mark.parametrize(
    ("spin", "drift", "success"),
    [(0.29, 0.04, True), (0.31, 0.04, False), (-0.31, 0.04, False), (0.51, 0.02, True), (0.1, 0.06, False)],
)
def test_rule_by_spin_and_drift(spin, drift, success):
    assert predicts_success(MissionConfig(), Residual(spin, drift, math.nan), 0.05) is success


def test_quality_finds_the_drift_that_divides():
    cells = [prediction(0.3 - 5.0 * drift, drift, success=drift < 0.045) for drift in (0.030, 0.040, 0.050, 0.060)]
    found = prediction_score(MissionConfig(), cells)
    assert 0.040 < found.drift_bound < 0.050
    assert found.kappa_measured == found.kappa_planar == found.share_planar == 1.0
    assert found.spin_error == 0.0


def test_touch_state_is_that_of_the_first_contact():
    ticks = np.zeros(4, TICK)
    ticks["tip_contact"][2:, 1, 0] = 1
    ticks["hand_pose"][2, 1] = [0.1, 0.2, 0.3]
    ticks["target_twist"][2] = [0.0, 0.0, 1.0]
    state = touch_state(MissionConfig(), ticks)
    assert state.hand_pose.tolist() == [0.1, 0.2, 0.3]
    assert state.target_twist[2] == 1.0
    with pytest.raises(ValueError, match="no tip touches"):
        touch_state(MissionConfig(), ticks[:2])


def test_the_authors_run_is_in_the_package():
    theirs = authors_run()
    assert theirs["targ_w"][0] == 1.0
    assert theirs["Fhand_R"].max() == pytest.approx(1.12737)


def test_hand_forces_are_resultants():
    ticks = np.zeros(1, TICK)
    ticks["hand_wrench"][0, 1, :2] = [3.0, 4.0]
    assert hand_forces(ticks).tolist() == [[0.0], [5.0]]
