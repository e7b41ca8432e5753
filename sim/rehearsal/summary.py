"""What many futures say: odds, bands of each measure, what decides, and a few of them as paths to draw."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import scipy
from pydantic import Field

from sim.compiled import FloatArray
from sim.rehearsal.futures import TRACE, Flown, Trace
from sim.rehearsal.uncertainty import DRAWN, Draw
from sim.snapshot import FrozenMessage
from sim.study.outcome_frequencies import share_interval
from sim.study.run import MEASURES

LEVELS = (0.05, 0.5, 0.95)
"""Of a band: 90 % of the futures are between its ends."""

FEWEST = 8
"""Futures that a rank correlation takes."""

MOST_PATHS = 20
"""Futures whose whole way is in a result."""


class Odds(FrozenMessage):
    """How often something happened."""

    outcome: str = Field(description="An outcome, or `caged` for all that end in a cage")
    futures: int = Field(description="That ended so")
    share: float
    low: float = Field(description="Lower end of Wilson's 95 % interval of the share")
    high: float = Field(description="Its upper end")


class Band(FrozenMessage):
    """What 90 % of the futures that have a measure are between."""

    measure: str
    unit: str
    description: str
    futures: int = Field(description="That have the measure")
    low: float = Field(description="5 % are below")
    median: float
    high: float = Field(description="5 % are above")


class Decider(FrozenMessage):
    """How much hangs on one number that is not known for sure: Spearman's rank correlations."""

    name: str = Field(description="What is drawn, as in a future's draw")
    unit: str
    description: str
    with_peak_force: float | None = Field(description="With the peak force to locked arms; null where all are equal")
    with_caged: float | None = Field(description="With being caged; null where all or none are")


class FutureSummary(FrozenMessage):
    """One future: what it drew, and how it ended."""

    draw: Draw
    outcome: str
    caged: bool
    measures: dict[str, float | None] = Field(description="As in `bands`; null where it has none")
    error: str | None = Field(description="Why it could not be flown to its end")


class Path(FrozenMessage):
    """The way of one future, thinned."""

    future: int
    times: list[float] = Field(description="Mission time [s]")
    base: list[list[float]] = Field(description="Pose (x, y, angle) at each time [m, m, rad]")
    target: list[list[float]]
    left: list[list[float]] = Field(description="Of the hand")
    right: list[list[float]]


class Fan(FrozenMessage):
    """The band of one quantity over time."""

    quantity: str = Field(description="As a column of a log: target.twist.angle; or left.force, right.force")
    unit: str
    times: list[float] = Field(description="Mission time [s]; until the first tenth of the futures has ended")
    low: list[float] = Field(description="5 % are below")
    median: list[float]
    high: list[float] = Field(description="5 % are above")


class CaseResult(FrozenMessage):
    """What the futures of one configuration say."""

    futures: int
    caged: Odds
    odds: list[Odds] = Field(description="Of each outcome that occurred, the most frequent first")
    bands: list[Band]
    deciding: list[Decider] = Field(description="What hangs most on, first")
    fans: list[Fan]
    paths: list[Path] = Field(description="Of the most likely future, the worst, and others")
    most_likely: int = Field(description="The future nearest to the median of those with the most frequent outcome")
    worst: int = Field(description="The future that ended worst: not caged, or with the largest force")
    each: list[FutureSummary]

    def in_outline(self) -> CaseResult:
        """Without the single futures: what is compared with what then happens."""
        return self.model_copy(update={"paths": [], "each": []})


BANDED = (
    "peak_tip_force", "peak_tip_force_to_closure", "time_to_cage", "base_turn", "min_manipulability", "cage_margin",
    "locked_at", "final_target_spin",
)  # fmt: skip
"""The measures that have a band."""

MEASURE_WORDS = {column.name: (column.unit, column.description) for column in MEASURES} | {
    "time_to_cage": ("s", "From the state to the first closed instant, of those that are caged"),
    "base_turn": ("rad", "Size of the base's angle where it is largest"),
}
"""Unit and description of each measure."""


def case_result(flown: Sequence[Flown]) -> CaseResult:
    """What futures of one configuration say; at least one, in the order of their numbers."""
    total = len(flown)
    outcomes = Counter(each.outcome.outcome.value for each in flown)
    typical = _most_likely(flown, outcomes.most_common(1)[0][0])
    worst = min(flown, key=lambda each: (each.outcome.caged, -each.outcome.peak_tip_force))
    return CaseResult(
        futures=total,
        caged=odds("caged", sum(each.outcome.caged for each in flown), total),
        odds=[odds(outcome, count, total) for outcome, count in outcomes.most_common()],
        bands=list(_bands(flown)),
        deciding=_deciders(flown),
        fans=_fans(flown),
        paths=[_path(each) for each in _shown(flown, typical, worst)],
        most_likely=typical.drawn.future,
        worst=worst.drawn.future,
        each=[_summary(each) for each in flown],
    )


def odds(outcome: str, count: int, total: int) -> Odds:
    """Of something that happened so often."""
    low, high = share_interval(count, total)
    return Odds(outcome=outcome, futures=count, share=count / total, low=low, high=high)


def measured(flown: Flown, name: str) -> float | None:
    """A measure of `BANDED`."""
    value = flown.measures[name]
    if value is None or not np.isfinite(value):
        return None
    return abs(float(value)) if name == "base_turn" else float(value)


def _bands(flown: Sequence[Flown]) -> Iterable[Band]:
    for name in BANDED:
        values = [value for each in flown if (value := measured(each, name)) is not None]
        if values:
            low, median, high = _quantiles(np.array(values)).tolist()
            unit, words = MEASURE_WORDS[name]
            yield Band(
                measure=name, unit=unit, description=words, futures=len(values), low=low, median=median, high=high
            )


def _quantiles(values: FloatArray) -> FloatArray:
    """Those of `LEVELS` over the first axis, so that the next draw, the real one, is below as often as they say.

    Of n values the k-th is above a share k / (n + 1) of all that could be drawn (Weibull 1939); by numpy's own choice a
    90 % band of 100 futures would hold 88 % of what then happens.
    """
    found: FloatArray = np.quantile(values, LEVELS, axis=0, method="weibull")
    return found


def _summary(flown: Flown) -> FutureSummary:
    return FutureSummary(
        draw=flown.drawn,
        outcome=flown.outcome.outcome.value,
        caged=flown.outcome.caged,
        measures={name: measured(flown, name) for name in BANDED},
        error=flown.error,
    )


def _deciders(flown: Sequence[Flown]) -> list[Decider]:
    """Of what differs from future to future; nothing of too few."""
    if len(flown) < FEWEST:
        return []
    peak = np.array([each.outcome.peak_tip_force for each in flown])
    caged = np.array([float(each.outcome.caged) for each in flown])
    found = []
    for quantity in DRAWN:
        drawn = np.array([each.drawn.values[quantity.name] for each in flown])
        with_peak, with_caged = _correlation(drawn, peak), _correlation(drawn, caged)
        if with_peak is not None or with_caged is not None:
            found.append(Decider(**quantity._asdict(), with_peak_force=with_peak, with_caged=with_caged))
    return sorted(found, key=lambda each: -max(abs(each.with_peak_force or 0.0), abs(each.with_caged or 0.0)))


def _correlation(drawn: FloatArray, with_: FloatArray) -> float | None:
    if np.ptp(drawn) == 0.0 or np.ptp(with_) == 0.0:
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of nearly equal values
        found: Any = scipy.stats.spearmanr(drawn, with_)
    return float(found.statistic) if np.isfinite(found.statistic) else None


def _most_likely(flown: Sequence[Flown], outcome: str) -> Flown:
    """Of those with that outcome, the one whose peak force and duration are nearest to their medians."""
    same = [each for each in flown if each.outcome.outcome.value == outcome]
    values = np.array([[each.outcome.peak_tip_force, each.outcome.duration] for each in same])
    spread = np.ptp(values, axis=0)
    apart = (np.abs(values - np.median(values, axis=0)) / np.where(spread > 0.0, spread, 1.0)).sum(axis=1)
    return same[int(np.argmin(apart))]


def _shown(flown: Sequence[Flown], typical: Flown, worst: Flown) -> list[Flown]:
    chosen = {each.drawn.future: each for each in (typical, worst, *flown[:MOST_PATHS])}
    return list(chosen.values())[:MOST_PATHS]


def _path(flown: Flown) -> Path:
    trace = flown.trace

    def poses(values: FloatArray) -> list[list[float]]:
        rounded: list[list[float]] = np.round(values, 5).tolist()
        return rounded

    return Path(
        future=flown.drawn.future,
        times=np.round(trace["time"], 6).tolist(),
        base=poses(trace["base_pose"]),
        target=poses(trace["target_pose"]),
        left=poses(trace["hand_pose"][:, 0]),
        right=poses(trace["hand_pose"][:, 1]),
    )


_FANNED = {
    "target.twist.angle": "rad/s",
    "base.pose.angle": "rad",
    "left.force": "N",
    "right.force": "N",
    "left.manipulability": "m2",
    "right.manipulability": "m2",
}


def _fans(flown: Sequence[Flown]) -> list[Fan]:
    """Bands over the time in which nine tenths of the futures still fly."""
    lengths = sorted(len(each.trace) for each in flown)
    length = lengths[len(lengths) // 10]
    kept = [each.trace[:length] for each in flown if len(each.trace) >= length]
    if not length:
        return []
    together = np.empty((len(kept), length), TRACE)
    for place, trace in enumerate(kept):
        together[place] = trace
    times = np.round(together["time"][0], 6).tolist()
    return [
        Fan(quantity=name, unit=unit, times=times, **_band_over_time(_values(together, name)))
        for name, unit in _FANNED.items()
    ]


def _band_over_time(values: FloatArray) -> dict[str, list[float]]:
    low, median, high = np.round(_quantiles(values), 6).tolist()
    return {"low": low, "median": median, "high": high}


def _values(trace: Trace, name: str) -> FloatArray:
    """Of one quantity, shape (futures, times)."""
    body, _, quantity = name.partition(".")
    if body in ("left", "right"):
        arm = 0 if body == "left" else 1
        if quantity == "force":
            wrench = trace["hand_wrench"][..., arm, :]
            force: FloatArray = np.hypot(wrench[..., 0], wrench[..., 1])
            return force
        values: FloatArray = trace["manipulability"][..., arm]
        return values
    field: FloatArray = trace["target_twist" if body == "target" else "base_pose"]
    return field[..., 2]
