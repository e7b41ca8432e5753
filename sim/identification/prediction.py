"""Peak forces foretold: the state before a touch from free flight alone, and then only the commands."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import combinations
from typing import NamedTuple, Protocol, TypeVar

import numpy as np

from sim.capture.tick import ARMS
from sim.identification.parameters import hypothesis
from sim.identification.recording import Recording
from sim.identification.result import Miss, MissPart, TouchPrediction
from sim.identification.rollout import Model
from sim.identification.shooting import Shot, Weights
from sim.identification.stretches import Stretch, stretches_of

_AHEAD = 0.6
"""So much of a touch is foretold [s]; what follows a rebound is another touch."""

_T = TypeVar("_T")
_R = TypeVar("_R")

_EXACT = 6
"""Up to so many parameters Shapley values are exact; beyond, from orders drawn at random."""
_ORDERS = 12
"""Each of which is gone through forwards and backwards."""

_EARLY = 4
"""Rows before the first that was felt, in which the foretold touch may begin."""

Values = Mapping[str, float]


class Each(Protocol):
    """The function of each item, by as many threads as there are."""

    def __call__(self, function: Callable[[_T], _R], items: Sequence[_T], /) -> list[_R]: ...  # noqa: D102


class _Step(NamedTuple):
    """A parameter that is put right after others."""

    name: str
    right: frozenset[str]
    """Those that are right already."""
    weight: float
    """Part of all orders in which it comes so."""


class Touch:
    """A touch whose beginning free flight tells."""

    def __init__(self, recorded: Recording, stretch: Stretch, lead: Shot) -> None:
        self.recorded, self.stretch, self.lead = recorded, stretch, lead
        self.end = min(stretch.last, stretch.onset + round(_AHEAD / recorded.period))
        felt = recorded.felt_force[stretch.onset : self.end]
        self.arm = int(np.argmax(np.nan_to_num(felt).max(axis=0)))
        self.measured = float(np.nanmax(felt))

    @property
    def time(self) -> float:
        """When it was felt first [s]."""
        return float(self.recorded.time[self.stretch.onset])

    def peak(self, values: Values, weights: Weights) -> float:
        """The largest force that a wrist would have read [N], under a hypothesis."""
        recorded = self.recorded
        model = Model(recorded, hypothesis(recorded.config, values, recorded.command_delay))
        node = self.lead.solve(model, None, weights.of_channels).node
        touchable = np.ones(self.end - self.stretch.first, dtype=bool)
        wrench = model.predict(self.stretch.first, touchable, node).wrench
        read = wrench[max(0, self.stretch.onset - self.stretch.first - _EARLY) :]
        return float(np.nanmax(np.hypot(read[..., 0], read[..., 1]), initial=0.0))


def touches_of(recorded: Recording) -> list[Touch]:
    """The touches of a run that can be foretold, in order."""
    found = [(each, Shot(recorded, each).lead()) for each in stretches_of(recorded) if each.touches]
    return [Touch(recorded, each, lead) for each, lead in found if lead is not None]


def foretold(
    touches: Sequence[Touch], nominal: Values, fitted: Values, weights: Weights, each: Each
) -> list[TouchPrediction]:
    """What nominal and fitted values say of each touch."""

    def of_touch(touch: Touch) -> TouchPrediction:
        return TouchPrediction(
            run=touch.recorded.name,
            time=touch.time,
            arm=ARMS[touch.arm],
            measured=touch.measured,
            nominal=touch.peak(nominal, weights),
            fitted=touch.peak(fitted, weights),
        )

    return each(of_touch, touches)


def miss_of(touch: Touch, nominal: Values, fitted: Values, weights: Weights, each: Each) -> Miss:
    """The miss at one touch, taken apart by parameter.

    What a parameter adds depends on which others are right already: Shapley's value is the mean over all orders
    (Shapley 1953), and the only division that sums up and treats parameters alike.

    Args:
        touch: the touch.
        nominal: values without the fit.
        fitted: values of the same names.
        weights: by which free flight is weighed.
        each: gives a function of each item, by threads.

    """
    names = list(nominal)
    steps = _all_steps(names) if len(names) <= _EXACT else _drawn_steps(names)
    wanted = {frozenset[str](), frozenset(names)} | {right for _, right, _ in steps}
    wanted |= {right | {name} for name, right, _ in steps}

    def peak(right: frozenset[str]) -> float:
        return touch.peak({n: fitted[n] if n in right else nominal[n] for n in names}, weights)

    sets = list(wanted)
    peaks = dict(zip(sets, each(peak, sets), strict=True))
    parts = dict.fromkeys(names, 0.0)
    for name, right, weight in steps:
        parts[name] += weight * (peaks[right | {name}] - peaks[right])
    before, after = peaks[frozenset()], peaks[frozenset(names)]
    ordered = [MissPart(name=n, part=parts[n]) for n in sorted(names, key=lambda n: -abs(parts[n]))]
    return Miss(
        run=touch.recorded.name,
        time=touch.time,
        arm=ARMS[touch.arm],
        nominal=before,
        fitted=after,
        measured=touch.measured,
        parts=ordered,
        unexplained=touch.measured - after,
        words=_words(before, touch.measured, ordered, touch.measured - after),
    )


def _all_steps(names: Sequence[str]) -> list[_Step]:
    """Each way in which each parameter can be put right after others, by its part of all orders."""
    count, steps = len(names), []
    for name in names:
        others = [each for each in names if each != name]
        for size in range(count):
            weight = math.factorial(size) * math.factorial(count - size - 1) / math.factorial(count)
            steps += [_Step(name, frozenset(chosen), weight) for chosen in combinations(others, size)]
    return steps


def _drawn_steps(names: Sequence[str]) -> list[_Step]:
    """The same of some orders, drawn at random."""
    steps, drawn = [], np.random.default_rng(0)
    for _ in range(_ORDERS):
        order = [names[place] for place in drawn.permutation(len(names))]
        for way in (order, order[::-1]):
            steps += [_Step(name, frozenset(way[:place]), 0.5 / _ORDERS) for place, name in enumerate(way)]
    return steps


def _words(nominal: float, measured: float, parts: Sequence[MissPart], unexplained: float) -> str:
    told = [f"{each.part:+.2g} N from {each.name}" for each in parts if abs(each.part) >= 0.02 * abs(measured)]
    told.append(f"{unexplained:+.2g} N unexplained")
    return f"of {measured - nominal:+.2g} N ({measured:.2f} measured, {nominal:.2f} foretold): {', '.join(told)}"
