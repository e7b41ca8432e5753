"""Shares of outcomes, with intervals where they are a sample."""

from __future__ import annotations

import pytest

from sim.study.design import study_of
from sim.study.outcome_frequencies import outcome_frequencies

SAMPLES = {"count": 10, "over": {"target.mass": {"from": 1.0, "to": 2.0}}}
ROWS = [{"outcome": "ejection"}] * 3 + [{"outcome": "base_collision"}] * 7 + [{"outcome": None}]


def test_the_most_frequent_first_of_the_cells_that_have_one():
    shares = outcome_frequencies(study_of({"samples": SAMPLES}), ROWS)
    assert [(share.outcome, share.cells, share.share) for share in shares] == [
        ("base_collision", 7, 0.7),
        ("ejection", 3, 0.3),
    ]


def test_intervals_of_a_sample_are_wilsons():
    share = outcome_frequencies(study_of({"samples": SAMPLES}), ROWS)[0]
    assert (share.low, share.high) == pytest.approx((0.3968, 0.8922), abs=1e-4)


def test_a_grid_is_no_sample():
    for study in ({"grid": {"contact.friction": [0.1]}}, {"grid": {"contact.friction": [0.1]}, "samples": SAMPLES}):
        assert outcome_frequencies(study_of(study), ROWS)[0].low is None


def test_of_nothing_there_are_none():
    assert outcome_frequencies(study_of({"samples": SAMPLES}), []) == []
