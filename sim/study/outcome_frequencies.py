"""How often each outcome class occurred, with a confidence interval where the cells are a sample."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

import scipy
from pydantic import Field

from sim.snapshot import FrozenMessage
from sim.study.design import Study
from sim.study.run import Row

CONFIDENCE = 0.95


class OutcomeFrequency(FrozenMessage):
    """How often a study's cells ended in one class."""

    outcome: str
    cells: int
    share: float = Field(description="Of the cells that have an outcome")
    low: float | None = Field(description="Lower end of the 95 % confidence interval of the share; null on a grid")
    high: float | None = Field(description="Its upper end")


def is_sample(study: Study) -> bool:
    """Whether its cells are draws of one population, so that shares and means of them estimate something."""
    return study.samples is not None and not study.grid


def outcome_frequencies(study: Study, rows: Iterable[Row]) -> list[OutcomeFrequency]:
    """The classes that occurred, the most frequent first.

    The interval is Wilson's for independent draws (Wilson 1927); for a Latin hypercube or Sobol sample it is
    conservative. A grid is not a sample, so a study with one has no interval.
    """
    counts = Counter(row["outcome"] for row in rows if row["outcome"] is not None)
    sampled = is_sample(study)
    return [_frequency(outcome, cells, counts.total(), sampled=sampled) for outcome, cells in counts.most_common()]


def _frequency(outcome: str, cells: int, total: int, *, sampled: bool) -> OutcomeFrequency:
    low, high = share_interval(cells, total) if sampled else (None, None)
    return OutcomeFrequency(outcome=outcome, cells=cells, share=cells / total, low=low, high=high)


def share_interval(count: int, total: int) -> tuple[float, float]:
    """The confidence interval of a share that was seen so often in independent draws (Wilson 1927)."""
    interval = scipy.stats.binomtest(count, total).proportion_ci(CONFIDENCE, method="wilson")
    return float(interval.low), float(interval.high)
