"""Peak forces foretold: the state before a touch from free flight alone, and then only the commands."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import combinations

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

_EXACT = 6
"""Up to so many parameters Shapley values are exact; beyond, from orders drawn at random."""
_ORDERS = 12
"""Each of which is gone through forwards and backwards."""

Values = Mapping[str, float]


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
        read = model.predict(self.stretch.first, self.end, node).wrench[self.stretch.onset - self.stretch.first - 4 :]
        return float(np.nanmax(np.hypot(read[..., 0], read[..., 1]), initial=0.0))


def touches_of(recorded: Recording) -> list[Touch]:
    """The touches of a run that can be foretold, in order."""
    found = [(each, Shot(recorded, each).lead()) for each in stretches_of(recorded) if each.touches]
    return [Touch(recorded, each, lead) for each, lead in found if lead is not None]


def foretold(touches: Sequence[Touch], nominal: Values, fitted: Values, weights: Weights) -> list[TouchPrediction]:
    """What nominal and fitted values say of each touch."""
    return [
        TouchPrediction(
            run=each.recorded.name,
            time=each.time,
            arm=ARMS[each.arm],
            measured=each.measured,
            nominal=each.peak(nominal, weights),
            fitted=each.peak(fitted, weights),
        )
        for each in touches
    ]


def miss_of(touch: Touch, nominal: Values, fitted: Values, weights: Weights, check: Callable[[], None]) -> Miss:
    """The miss at one touch, taken apart by parameter.

    What a parameter adds depends on which others are right already: Shapley's value is the mean over all orders
    (Shapley 1953), and the only division that sums up and treats parameters alike.

    Args:
        touch: the touch.
        nominal: values without the fit.
        fitted: values of the same names.
        weights: by which free flight is weighed.
        check: called before each rollout; raises if nobody waits any longer.

    """
    names = list(nominal)
    known: dict[frozenset[str], float] = {}

    def peak(right: frozenset[str]) -> float:
        if right not in known:
            check()
            known[right] = touch.peak({n: fitted[n] if n in right else nominal[n] for n in names}, weights)
        return known[right]

    parts = _shapley(names, peak) if len(names) <= _EXACT else _sampled(names, peak)
    before, after = peak(frozenset()), peak(frozenset(names))
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


def _shapley(names: Sequence[str], peak: Callable[[frozenset[str]], float]) -> dict[str, float]:
    count = len(names)
    parts = dict.fromkeys(names, 0.0)
    for name in names:
        others = [each for each in names if each != name]
        for size in range(count):
            weight = math.factorial(size) * math.factorial(count - size - 1) / math.factorial(count)
            for chosen in combinations(others, size):
                right = frozenset(chosen)
                parts[name] += weight * (peak(right | {name}) - peak(right))
    return parts


def _sampled(names: Sequence[str], peak: Callable[[frozenset[str]], float]) -> dict[str, float]:
    parts, drawn = dict.fromkeys(names, 0.0), np.random.default_rng(0)
    for _ in range(_ORDERS):
        order = [names[place] for place in drawn.permutation(len(names))]
        for way in (order, order[::-1]):
            right: frozenset[str] = frozenset()
            for name in way:
                parts[name] += (peak(right | {name}) - peak(right)) / (2 * _ORDERS)
                right |= {name}
    return parts


def _words(nominal: float, measured: float, parts: Sequence[MissPart], unexplained: float) -> str:
    told = [f"{each.part:+.2g} N from {each.name}" for each in parts if abs(each.part) >= 0.02 * abs(measured)]
    told.append(f"{unexplained:+.2g} N unexplained")
    return f"of {measured - nominal:+.2g} N ({measured:.2f} measured, {nominal:.2f} foretold): {', '.join(told)}"
