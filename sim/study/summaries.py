"""What a sample says about every measure: mean, median and a high quantile, with their confidence intervals."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import scipy
from pydantic import Field

from sim.snapshot import FrozenMessage
from sim.study.design import Study
from sim.study.outcome_frequencies import CONFIDENCE, is_sample, share_interval
from sim.study.run import MEASURES, Row

HIGH = 0.95
"""The quantile that is given besides the median: one case in twenty exceeds it."""

SUMMARIZED = tuple(column for column in MEASURES if column.kind is not str)


class Estimate(FrozenMessage):
    """A number of the population, estimated from the sample."""

    value: float
    low: float | None = Field(description="Lower end of the 95 % confidence interval; null if there are too few cells")
    high: float | None = Field(description="Its upper end")


class MeasureSummary(FrozenMessage):
    """One measure over the cells that have it."""

    measure: str
    unit: str
    cells: int = Field(description="That have the measure")
    mean: Estimate = Field(description="For true and false: the share of true")
    median: Estimate | None = Field(description="Null for true and false")
    quantile_95: Estimate | None = Field(description="One cell in twenty lies above; null for true and false")


def measure_summaries(study: Study, rows: Iterable[Row]) -> list[MeasureSummary]:
    """Every measure of a study that is a sample; nothing for one with a grid, which is not.

    Means have Student's interval, quantiles the one of the order statistics, which assumes nothing about the
    distribution (Conover 1999, 3.2), shares of true Wilson's. All are those of independent draws: for a Latin
    hypercube or Sobol sample they are conservative.
    """
    if not is_sample(study):
        return []
    kept = list(rows)
    return [
        _summary(column.name, column.unit, values)
        for column in SUMMARIZED
        if (values := [row[column.name] for row in kept if row[column.name] is not None])
    ]


def _summary(measure: str, unit: str, values: Sequence[float | bool]) -> MeasureSummary:
    if isinstance(values[0], bool):
        true = sum(map(bool, values))
        low, high = share_interval(true, len(values))
        mean = Estimate(value=true / len(values), low=low, high=high)
        return MeasureSummary(measure=measure, unit=unit, cells=len(values), mean=mean, median=None, quantile_95=None)
    drawn = np.asarray(values, dtype=float)
    return MeasureSummary(
        measure=measure,
        unit=unit,
        cells=len(values),
        mean=_mean(drawn),
        median=_quantile(drawn, 0.5),
        quantile_95=_quantile(drawn, HIGH),
    )


def _mean(drawn: np.ndarray) -> Estimate:
    mean = float(np.mean(drawn))
    if len(drawn) < 2 or np.ptp(drawn) == 0.0:
        return Estimate(value=mean, low=None, high=None)
    low, high = scipy.stats.t.interval(CONFIDENCE, len(drawn) - 1, loc=mean, scale=scipy.stats.sem(drawn))
    return Estimate(value=mean, low=float(low), high=float(high))


def _quantile(drawn: np.ndarray, share: float) -> Estimate:
    value = float(np.quantile(drawn, share))
    interval: Any = scipy.stats.quantile_test(drawn, q=value, p=share).confidence_interval(
        CONFIDENCE
    )  # its stubs say float
    return Estimate(value=value, low=_known(interval.low), high=_known(interval.high))


def _known(end: float) -> float | None:
    return float(end) if np.isfinite(end) else None
