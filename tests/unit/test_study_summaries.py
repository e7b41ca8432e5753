"""Means and quantiles of a sample, with intervals that hold what they promise."""

from __future__ import annotations

import numpy as np
import pytest

from sim.study.design import study_of
from sim.study.run import MEASURES
from sim.study.summaries import measure_summaries

SAMPLE = study_of({"samples": {"count": 10, "over": {"target.mass": {"from": 1.0, "to": 2.0}}}})
EMPTY = dict.fromkeys(column.name for column in MEASURES)


def rows(peaks, **more):
    return [{**EMPTY, "peak_tip_force": peak, **more} for peak in peaks]


def summary_of(measure, found):
    return next(each for each in found if each.measure == measure)


def test_students_interval_by_hand():
    mean = summary_of("peak_tip_force", measure_summaries(SAMPLE, rows([1.0, 2.0, 3.0, 4.0]))).mean
    half = 3.182446 * np.sqrt(5 / 3) / 2  # t of 3 degrees of freedom, standard deviation, root of four
    assert (mean.value, mean.low, mean.high) == pytest.approx((2.5, 2.5 - half, 2.5 + half), rel=1e-6)


def test_intervals_hold_the_true_value_as_often_as_they_say():
    draws = np.random.default_rng(7)
    held = {"mean": 0, "median": 0, "quantile_95": 0}
    truth = {"mean": 1.0, "median": np.log(2), "quantile_95": np.log(20)}
    for _ in range(200):
        summary = summary_of("peak_tip_force", measure_summaries(SAMPLE, rows(draws.exponential(size=120))))
        for name, value in truth.items():
            estimate = getattr(summary, name)
            held[name] += estimate.low <= value <= estimate.high
    # Of 200 intervals of 95 %, 190 should hold; fewer than 178 do once in ten thousand times.
    assert min(held.values()) >= 178


def test_the_share_of_true_has_wilsons_interval():
    found = measure_summaries(SAMPLE, [{**EMPTY, "caged": each < 7} for each in range(10)])
    caged = summary_of("caged", found)
    assert (caged.mean.value, caged.mean.low, caged.mean.high) == pytest.approx((0.7, 0.3968, 0.8922), abs=1e-4)
    assert caged.median is None


def test_too_few_cells_tell_no_interval():
    only = summary_of("peak_tip_force", measure_summaries(SAMPLE, rows([1.5])))
    assert (only.mean.low, only.quantile_95.high) == (None, None)
    few = summary_of("peak_tip_force", measure_summaries(SAMPLE, rows([1.0, 2.0, 3.0])))
    assert few.quantile_95.high is None


def test_cells_without_the_measure_do_not_count():
    found = measure_summaries(SAMPLE, rows([1.0, 2.0, None]))
    assert summary_of("peak_tip_force", found).cells == 2
    assert [each.measure for each in found] == ["peak_tip_force"]


def test_a_grid_is_no_sample():
    assert measure_summaries(study_of({"grid": {"contact.friction": [0.1]}}), rows([1.0, 2.0])) == []
