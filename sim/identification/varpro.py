"""The least squares of a fit: parameters of all runs at once, the state of every stretch following them."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import chain
from typing import Any, NamedTuple, TypeVar

import numpy as np
from scipy.optimize import least_squares

from sim.compiled import FloatArray
from sim.errors import CaptureError
from sim.identification.flight import normal_equations
from sim.identification.parameters import CONTACT_ONLY, STAMP_ERROR, Parameter, hypothesis, scaled_bounds
from sim.identification.recording import Recording
from sim.identification.rollout import Model
from sim.identification.shooting import WELL, Shot, Solved, Weights, projected
from sim.identification.stretches import stretches_of

_MOST_EVALUATIONS = 25
"""Of one least-squares problem."""

_DIFFERENCE = 1e-3
"""Of a parameter, in spreads of its prior, for slopes."""

_CLOSE = 1e-3
"""A step by less than this, in spreads, or that lowers the misfit by a smaller part of it, ends a fit."""

_USUAL = 0.25
"""Quantile of the misfits of a kind of stretches that is taken for usual."""

_INSIDE = 0.1
"""Distance from its bounds, in spreads, at which a parameter begins: beside a bound steps are short ones."""

_OF_SOLIDS = "contact.solid_"
"""Laws of contact of everything but tips."""

_T = TypeVar("_T")
_R = TypeVar("_R")


class FitCancelled(CaptureError):
    """Nobody waits for the fit any longer."""


class Estimate(NamedTuple):
    """What a least-squares fit came to."""

    scaled: FloatArray
    """Each parameter's distance from its nominal value in spreads, shape (parameters,)."""
    solved: tuple[Solved, ...]
    """Of each shot."""
    slopes: tuple[FloatArray, ...]
    """Of each shot: how its residuals change with the parameters, states following, shape (rows 18, parameters)."""
    evaluations: int


class Problem:
    """Recordings, and the parameters that explain all of them together."""

    def __init__(
        self,
        recordings: Sequence[Recording],
        parameters: Sequence[Parameter],
        *,
        threads: int,
        cancelled: threading.Event | None = None,
        on_evaluation: Callable[[], None] = lambda: None,
    ) -> None:
        self.recordings, self.parameters = tuple(recordings), tuple(parameters)
        self.shots = tuple(Shot(each, stretch) for each in recordings for stretch in stretches_of(each))
        self._threads, self._cancelled, self._on_evaluation = threads, cancelled, on_evaluation
        self.counted = [True] * len(self.shots)
        """Whether a shot counts; of the others no state is looked for."""
        self.solid = [False] * len(self.shots)
        """Whether another part of the robot than a tip touches in it, of which the model knows little."""
        self._weights: Weights | None = None
        self._solved: list[Solved | None] = [None] * len(self.shots)
        """The best until now, with these weights."""
        self._leads = [None if shot.stretch.follows else shot.lead() for shot in self.shots]
        starts = [place for place, shot in enumerate(self.shots) if not shot.stretch.follows]
        self._chains = [range(a, b) for a, b in zip(starts, [*starts[1:], len(self.shots)], strict=True)]

    def values(self, scaled: FloatArray) -> dict[str, float]:
        """Parameters by name, from their distances in spreads."""
        return {
            each.name: each.nominal + each.spread * z for each, z in zip(self.parameters, scaled.tolist(), strict=True)
        }

    def models(self, values: Mapping[str, float]) -> list[Model]:
        """The hypothesis for each recording."""
        return [Model(each, hypothesis(each.config, values, each.command_delay)) for each in self.recordings]

    def solve(self, values: Mapping[str, float], weights: Weights) -> list[Solved]:
        """Every shot under one hypothesis, from the best state; one that does not count, from that found last."""
        sigma = weights.of_channels
        models = dict(zip((id(each) for each in self.recordings), self.models(values), strict=True))
        self._reweigh(weights)

        def solved(places: Sequence[int]) -> list[Solved]:
            found: list[Solved] = []
            for place in places:
                shot, known, lead = self.shots[place], self._solved[place], self._leads[place]
                model = models[id(shot.recorded)]
                if not self.counted[place]:
                    found.append(known or shot.glanced(model, sigma))
                    continue
                best = shot.solve(model, known, sigma)
                if found:
                    before = self.shots[place - 1]
                    best = shot.better(model, best, before.predict(model, found[-1].node).end, sigma)
                elif lead is not None and shot.misfit(best) > WELL:
                    best = shot.better(model, best, lead.solve(model, None, sigma).node, sigma)
                found.append(best)
            return found

        return list(chain.from_iterable(self.each(solved, self._chains)))

    def _reweigh(self, weights: Weights) -> None:
        """Go on from the states that were best with other weights."""
        if self._weights is not None and self._weights != weights:
            ratio = self._weights.of_channels / weights.of_channels
            self._solved = [
                None if each is None else shot.reweighed(each, ratio)
                for shot, each in zip(self.shots, self._solved, strict=True)
            ]
        self._weights = weights

    def estimate(self, start: FloatArray, free: Sequence[int], weights: Weights, close: float = _CLOSE) -> Estimate:
        """Fit those parameters whose numbers are given; the others stay at the start.

        Raises:
            FitCancelled: nobody waits any longer.

        """
        run = _Run(self, start, list(free), weights)
        if len(free):
            low, high = scaled_bounds(self.parameters)
            found = least_squares(
                run.residuals,
                np.clip(start[run.free], low[run.free] + _INSIDE, high[run.free] - _INSIDE),
                jac=run.jacobian,
                bounds=(low[run.free], high[run.free]),
                xtol=close,
                ftol=close,
                gtol=1e-8,
                max_nfev=_MOST_EVALUATIONS,
            )
        at = run.at(found.x if len(free) else start[run.free])
        return Estimate(at.scaled, tuple(at.solved), tuple(at.slopes), run.evaluations)

    def slopes(
        self, scaled: FloatArray, solved: Sequence[Solved], free: Sequence[int], weights: Weights
    ) -> list[FloatArray]:
        """How each shot's residuals change with those parameters, states following, shape (rows 18, parameters)."""
        sigma = weights.of_channels
        varied = []
        for place in free:
            changed = scaled.copy()
            changed[place] += _DIFFERENCE
            varied.append(self.models(self.values(changed)))
        number = {id(each): place for place, each in enumerate(self.recordings)}

        def slope(place: int) -> FloatArray:
            shot, at = self.shots[place], solved[place]
            slopes = np.zeros((at.residual.size, len(free)))
            if not self.counted[place]:
                return slopes
            of = number[id(shot.recorded)]
            for column, parameter in enumerate(free):
                if shot.stretch.touches or not self.parameters[parameter].name.startswith(CONTACT_ONLY):
                    then, _ = shot.residual(varied[column][of], at.node, sigma)
                    slopes[:, column] = (then - at.residual).ravel() / _DIFFERENCE
            return projected(at, slopes)

        return self.each(slope, range(len(self.shots)))

    def leave_out(self, solved: Sequence[Solved], times: float, *, touches: bool = True) -> None:
        """Count no shot whose misfit is so many times the usual one of its kind, and no touch unless they are to count.

        One that is `solid` does not count either.

        A touch that nobody felt, or a reading gone wrong, is explained by no values, and would spoil all of them. Free
        flight is always explained better than a touch, so each is compared with its like. What is usual is what the
        best of them show: where the model fails, as while the target is held, it fails in most.
        """
        misfits = np.array([shot.misfit(each) for shot, each in zip(self.shots, solved, strict=True)])
        touching = np.array([shot.stretch.touches for shot in self.shots]) & ~np.array(self.solid)
        free = np.array([not shot.stretch.touches for shot in self.shots])
        counted = np.zeros(len(self.shots), dtype=bool)
        for kind in (touching, free) if touches else (free,):
            usual = float(np.quantile(misfits[kind], _USUAL)) if kind.any() else 1.0
            counted |= kind & (misfits <= times * max(1.0, usual))
        self.counted = counted.tolist()

    def find_solid(self, values: Mapping[str, float], solved: Sequence[Solved]) -> None:
        """Find in which touches more than tips touch; none where a law of the other parts' contact is fitted."""
        if any(each.name.startswith(_OF_SOLIDS) for each in self.parameters):
            return
        models = dict(zip((id(each) for each in self.recordings), self.models(values), strict=True))

        def solid(place: int) -> bool:
            shot = self.shots[place]
            return shot.stretch.touches and shot.predict(models[id(shot.recorded)], solved[place].node).solid

        self.solid = self.each(solid, range(len(self.shots)))

    def remember(self, solved: Sequence[Solved]) -> None:
        """Begin from the states of those that count next time."""
        self._solved = [
            new if counts else old for new, old, counts in zip(solved, self._solved, self.counted, strict=True)
        ]

    def each(self, function: Callable[[_T], _R], items: Sequence[_T]) -> list[_R]:
        """The function of each, by all threads.

        Raises:
            FitCancelled: nobody waits any longer.

        """

        def guarded(item: _T) -> _R:
            if self._cancelled is not None and self._cancelled.is_set():
                raise FitCancelled("the fit was cancelled")
            return function(item)

        with ThreadPoolExecutor(self._threads, "becalm-fit") as pool:
            return list(pool.map(guarded, items))

    def evaluated(self) -> None:
        """Tell whoever waits that one more evaluation is done."""
        self._on_evaluation()


class _Point(NamedTuple):
    """What was found of one point."""

    scaled: FloatArray
    """All parameters."""
    solved: list[Solved]
    """Every shot from its best state."""
    slopes: list[FloatArray]
    """How its residuals change with the free parameters, states following."""
    residuals: FloatArray
    """A few numbers that have the sum of squares, the gradient and the curvature of all residuals and the prior."""
    jacobian: FloatArray
    """Of these."""


class _Run:
    """One least-squares problem: what was found of the point that was looked at last.

    A hundred thousand residuals are handed on as a few: with g the gradient, R^T R the curvature (Cholesky), R^-T g and
    a number that makes up the sum of squares have the same of each, and the same steps follow from them.
    """

    def __init__(self, problem: Problem, start: FloatArray, free: list[int], weights: Weights) -> None:
        self._problem, self._start, self._weights = problem, start, weights
        self.free, self.evaluations = free, 0
        self._last: _Point | None = None
        self._best = np.inf

    def at(self, x: FloatArray) -> _Point:
        """What is so at these values of the free parameters."""
        if self._last is None or not np.array_equal(self._last.scaled[self.free], x):
            scaled = self._start.copy()
            scaled[self.free] = x
            self._last = self._looked_at(scaled)
            self.evaluations += 1
            self._problem.evaluated()
        return self._last

    def residuals(self, x: FloatArray) -> FloatArray:
        """Of all shots, and of the prior, as a few."""
        return self.at(x).residuals

    def jacobian(self, x: FloatArray) -> Any:
        """Of `residuals`."""
        return self.at(x).jacobian

    def _looked_at(self, scaled: FloatArray) -> _Point:
        problem, free = self._problem, self.free
        solved = problem.solve(problem.values(scaled), self._weights)
        slopes = problem.slopes(scaled, solved, free, self._weights)
        curvature, gradient = np.eye(len(free)), scaled[free].copy()
        squares = float(gradient @ gradient)
        for each, slope, counts in zip(solved, slopes, problem.counted, strict=True):
            if counts:
                squares += 2.0 * each.cost
                normal_equations(slope, each.residual.ravel(), curvature, gradient)
        if squares < self._best:  # the next point is near to the best one
            self._best = squares
            problem.remember(solved)
        triangle = np.linalg.cholesky(curvature)
        few = np.linalg.solve(triangle, gradient)
        rest = np.sqrt(max(0.0, squares - float(few @ few)))
        return _Point(scaled, solved, slopes, np.append(few, rest), np.vstack([triangle.T, np.zeros(len(free))]))


def shared_delay(recordings: Sequence[Recording]) -> float:
    """The delay of commands that is nominal for runs that are fitted together [s]."""
    return float(np.median([each.command_delay for each in recordings]))


def in_free_flight(parameter: Parameter) -> bool:
    """Whether free flight tells something about a parameter; a lag of pictures shows where hands meet the target."""
    return not parameter.name.startswith((*CONTACT_ONLY, STAMP_ERROR))
