"""Rehearsals foretell: their bands hold what then happens as often as they say, and their odds beat the base rate."""

from __future__ import annotations

import math

import pytest

from benchmarks.calibration import calibrated, summary

SITUATIONS, FUTURES = 60, 60


def _at_least(share: float) -> float:
    """What so many situations show of a true share, but for three standard deviations of chance."""
    return share - 3.0 * math.sqrt(share * (1.0 - share) / SITUATIONS)


@pytest.mark.slow  # flies thousands of futures
@pytest.mark.parametrize("configuration", ["becalm", "published"])
def test_bands_hold_and_odds_are_better_than_the_base_rate(configuration: str) -> None:
    found = summary(calibrated(configuration, SITUATIONS, FUTURES, seed=1))
    assert found["peak force within its 90 % band"] >= _at_least(0.85)
    assert found["time to cage within its 90 % band"] >= _at_least(0.85)
    if 0.1 < found["caged"] < 0.9:
        assert found["Brier score"] < found["... of guessing the base rate"]
