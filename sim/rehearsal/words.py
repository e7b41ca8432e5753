"""What changes between two sets of futures, in words."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from sim.rehearsal.summary import Band, CaseResult, FutureSummary
from sim.snapshot import FrozenMessage

Verdict = Literal["better", "worse", "same"]


class Change(FrozenMessage):
    """How one thing differs by the changes."""

    measure: str = Field(description="caged, or a measure that has a band")
    verdict: Verdict = Field(description="same: the futures do not tell it from chance")
    words: str


_LESS_IS_BETTER = {
    "peak_tip_force": "peak force to locked arms",
    "peak_tip_force_to_closure": "peak force to closure",
    "time_to_cage": "time to cage",
    "base_turn": "rotation of the base",
}
_MORE_IS_BETTER = {"min_manipulability": "least manipulability", "cage_margin": "margin of the cage"}
_SIGNIFICANT = 0.75
"""Of the futures that are flown in both ways: that many change the same way before it counts as a change."""
_NOTABLE = 0.02
"""A median that moves by less than that part is the same for an operator."""


def changes_between(before: CaseResult, after: CaseResult) -> list[Change]:
    """What the changes make better and worse; each future is compared with itself, as it is flown otherwise."""
    found = [_of_odds(before, after)]
    for measure, words in {**_LESS_IS_BETTER, **_MORE_IS_BETTER}.items():
        old, new = _band(before, measure), _band(after, measure)
        if old is not None and new is not None:
            found.append(_of_band(measure, words, old, new, _pairs(before, after, measure)))
    return found


def _of_odds(before: CaseResult, after: CaseResult) -> Change:
    gained = sum(new.caged and not old.caged for old, new in zip(before.each, after.each, strict=True))
    lost = sum(old.caged and not new.caged for old, new in zip(before.each, after.each, strict=True))
    words = f"caged {before.caged.futures} of {before.futures} as it is, {after.caged.futures} as changed"
    # The sign test on futures that changed sides (McNemar): beyond two of its standard deviations.
    if (gained - lost) ** 2 <= 4.0 * (gained + lost):
        return Change(measure="caged", verdict="same", words=words)
    return Change(measure="caged", verdict="better" if gained > lost else "worse", words=words)


def _of_band(measure: str, words: str, old: Band, new: Band, pairs: list[tuple[float, float]]) -> Change:
    stated = f"{words} {_number(old)} as it is, {_number(new)} as changed"
    up = sum(after > before for before, after in pairs)
    down = sum(after < before for before, after in pairs)
    small = abs(new.median - old.median) <= _NOTABLE * max(abs(old.median), abs(new.median))
    if small or max(up, down) < _SIGNIFICANT * max(1, len(pairs)):
        return Change(measure=measure, verdict="same", words=stated)
    better = (down > up) == (measure in _LESS_IS_BETTER)
    return Change(measure=measure, verdict="better" if better else "worse", words=stated)


def _pairs(before: CaseResult, after: CaseResult, measure: str) -> list[tuple[float, float]]:
    def both(old: FutureSummary, new: FutureSummary) -> tuple[float, float] | None:
        a, b = old.measures[measure], new.measures[measure]
        return None if a is None or b is None else (a, b)

    pairs = (both(old, new) for old, new in zip(before.each, after.each, strict=True))
    return [pair for pair in pairs if pair is not None]


def _band(case: CaseResult, measure: str) -> Band | None:
    return next((band for band in case.bands if band.measure == measure), None)


def _number(band: Band) -> str:
    unit = "" if band.unit == "1" else f" {band.unit}"
    return f"{band.median:.3g} ({band.low:.3g} to {band.high:.3g}){unit}"
