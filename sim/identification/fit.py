"""The fit: weights, least squares, what is known how surely, and what the values say of the hardest touch."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sim.compiled import FloatArray, compiling_alone
from sim.errors import ConfigError
from sim.identification.covariance import Spread, spread_of, told_apart
from sim.identification.flight import CHANNELS
from sim.identification.parameters import DEFAULT, STAMP_ERROR, Parameter, parameters_of
from sim.identification.prediction import foretold, miss_of, touches_of
from sim.identification.recording import Recording
from sim.identification.residuals import channels_of, refined
from sim.identification.result import Correlation, FitResult, FittedParameter
from sim.identification.shooting import Solved, Weights, projected
from sim.identification.varpro import Estimate, Problem, in_free_flight, shared_delay
from sim.study.cores import cores

MOST_RUNS = 8
"""That are fitted at once, or held out."""

MOST_TIME = 600.0
"""Of all runs together [s]."""

_COARSE = Weights(1e-3, 5e-3, 1e-3, 5e-3, 1e-3, 0.1, 5e-3)
"""To begin with: so wide that no reading pulls a parameter far from where it should go."""
_USUAL = Weights(3e-4, 1.5e-3, 3e-4, 1.5e-3, 2e-5, 0.02, 1e-3)
"""As of a laboratory's sensors."""

_ROUGHLY = 1e-2
_FINELY = 1e-3
_FAR_AT_FIRST, _FAR, _OFF = 50.0, 2.5, 1.5
"""A stretch whose misfit is so many times the usual one is left out."""
_EVALUATIONS = 22
"""Of a usual fit, for its progress."""
_CLOSELY = 0.9
"""Parameters whose errors are correlated beyond this are named."""


@dataclass(frozen=True)
class FitPlan:
    """A fit, checked. Travels as a pickle."""

    recordings: tuple[Recording, ...]
    held_out: tuple[Recording, ...]
    parameters: tuple[Parameter, ...]


def planned(
    recordings: Sequence[Recording], names: Sequence[str] = DEFAULT, held_out: Sequence[Recording] = ()
) -> FitPlan:
    """A fit of these parameters to these runs together.

    Raises:
        ConfigError: a name is unknown, or there are too many runs; the message says what would be right.

    """
    if not 1 <= len(recordings) <= MOST_RUNS or len(held_out) > MOST_RUNS:
        raise ConfigError(
            f"runs: {len(recordings)} to fit and {len(held_out)} held out; from 1 to {MOST_RUNS} are fitted, and at "
            f"most {MOST_RUNS} held out"
        )
    length = sum(len(each.time) * each.period for each in recordings)
    if length > MOST_TIME:
        raise ConfigError(f"runs: {length:.0f} s to fit; at most {MOST_TIME:g} s are fitted at once")
    parameters = parameters_of(recordings[0].config, names, shared_delay(recordings))
    for other in (*recordings[1:], *held_out):
        for name, mine, its in zip(
            names, parameters, parameters_of(other.config, names, shared_delay([other])), strict=True
        ):
            if mine.in_configuration and not math.isclose(mine.nominal, its.nominal):
                raise ConfigError(
                    f"runs: {name} is {mine.nominal:g} in run {recordings[0].name} and {its.nominal:g} in run "
                    f"{other.name}",
                    tip="fit runs of the same robot and target together",
                )
    return FitPlan(tuple(recordings), tuple(held_out), parameters)


class Progress:
    """How far a fit has come, for whoever waits; from any thread."""

    def __init__(self, tell: Callable[[float, str], None]) -> None:
        self._tell, self._done, self._words = tell, 0, ""

    def stage(self, words: str) -> None:
        """Something else begins."""
        self._words = words
        self._say()

    def step(self) -> None:
        """One more evaluation."""
        self._done += 1
        self._say()

    def _say(self) -> None:
        self._tell(0.95 * (1.0 - math.exp(-1.5 * self._done / _EVALUATIONS)), self._words)


def fit(
    plan: FitPlan,
    *,
    threads: int | None = None,
    on_progress: Callable[[float, str], None] = lambda _part, _words: None,
    cancelled: threading.Event | None = None,
) -> FitResult:
    """Find the values that explain the runs.

    Args:
        plan: what is fitted to what.
        threads: that fly rollouts; one a core by default.
        on_progress: called with the part that is done, 0 to 1, and what is being done.
        cancelled: set by whoever no longer waits.

    Raises:
        FitCancelled: it was set.

    """
    began, progress = time.perf_counter(), Progress(on_progress)
    progress.stage("preparing the simulation")
    problem = Problem(
        plan.recordings, plan.parameters, threads=threads or cores(), cancelled=cancelled, on_evaluation=progress.step
    )
    prepare_fit(plan)
    return _Fit(plan, problem, progress).result(began)


def prepare_fit(plan: FitPlan) -> None:
    """Compile what rollouts run: half a minute once, cached on disk afterwards."""
    with compiling_alone():
        problem = Problem(plan.recordings[:1], plan.parameters, threads=1)
        if problem.shots:
            shot, model = problem.shots[0], problem.models(problem.values(np.zeros(len(plan.parameters))))[0]
            shot.predict(model, shot.glance)
            projected(shot.solve(model, None, _USUAL.of_channels), np.zeros((CHANNELS * shot.stretch.rows, 1)))


class _Fit:
    """One fit under way."""

    def __init__(self, plan: FitPlan, problem: Problem, progress: Progress) -> None:
        self._plan, self._problem, self._progress = plan, problem, progress
        self._weights = _USUAL

    def result(self, began: float) -> FitResult:
        """From far to near: first what free flight tells, then touches roughly, then everything as sharply as it is."""
        problem, count = self._problem, len(self._plan.parameters)
        everything = list(range(count))
        scaled = self._of_free_flight(self._start())
        self._progress.stage("touches, coarsely")
        estimate = problem.estimate(scaled, self._of_touches() or everything, _COARSE, _ROUGHLY)
        for words, times in (("all of it", _FAR_AT_FIRST), ("sharper", _FAR), ("as sharply as it is", _OFF)):
            self._progress.stage(words)
            solved = self._all_solved(estimate.scaled)
            problem.find_solid(problem.values(estimate.scaled), solved)
            problem.leave_out(solved, times)
            self._weights = refined(problem, solved, self._weights)
            estimate = problem.estimate(estimate.scaled, everything, self._weights, _FINELY)
        estimate, told, reasons = self._told(estimate)
        spread = spread_of(problem.shots, estimate, len(told))
        self._progress.stage("peak forces")
        return self._worded(estimate, told, reasons, spread, began)

    def _start(self) -> FloatArray:
        """Nominal values, and servos as the joints show them at a glance: from far away a fit could lose its way."""
        scaled = np.zeros(len(self._plan.parameters))
        guess = float(np.median([each.servo_guess for each in self._plan.recordings]))
        for place, each in enumerate(self._plan.parameters):
            if each.name == "robot.servo.time_constant" and guess > 0.0:
                scaled[place] = (guess - each.nominal) / each.spread
        return scaled

    def _of_touches(self) -> list[int]:
        """The parameters that only touches tell; what free flight tells stays as it said while weights are wide."""
        if not any(not shot.stretch.touches for shot in self._problem.shots):
            return []
        return [place for place, each in enumerate(self._plan.parameters) if not in_free_flight(each)]

    def _of_free_flight(self, scaled: FloatArray) -> FloatArray:
        """What stretches without a touch say; those in which something unfelt happened count no longer."""
        problem = self._problem
        problem.counted = [not shot.stretch.touches for shot in problem.shots]
        free = [place for place, each in enumerate(self._plan.parameters) if in_free_flight(each)]
        if not free or not any(problem.counted):
            problem.counted = [True] * len(problem.shots)
            return scaled
        self._progress.stage("free flight")
        for times in (_FAR_AT_FIRST, _FAR):
            estimate = problem.estimate(scaled, free, self._weights, _ROUGHLY)
            problem.leave_out(estimate.solved, times, touches=False)
            scaled = estimate.scaled
        scaled = problem.estimate(scaled, free, self._weights, _FINELY).scaled
        problem.counted = [c or shot.stretch.touches for c, shot in zip(problem.counted, problem.shots, strict=True)]
        return scaled

    def _all_solved(self, scaled: FloatArray) -> list[Solved]:
        """Every stretch, also those that are left out, from the best state."""
        counted, self._problem.counted = self._problem.counted, [True] * len(self._problem.shots)
        solved = self._problem.solve(self._problem.values(scaled), self._weights)
        self._problem.counted = counted
        return solved

    def _told(self, estimate: Estimate) -> tuple[Estimate, list[int], dict[int, str]]:
        """The fit again without what the runs do not tell, which stays nominal."""
        told, reasons = told_apart(self._plan.parameters, self._problem.shots, estimate)
        if not reasons:
            return estimate, told, reasons
        start = estimate.scaled.copy()
        start[list(reasons)] = 0.0
        self._progress.stage("fit of what the runs tell")
        estimate = self._problem.estimate(start, told, self._weights, _FINELY)
        self._weights = refined(self._problem, estimate.solved, self._weights)
        return self._problem.estimate(estimate.scaled, told, self._weights, _FINELY), told, reasons

    def _worded(
        self,
        estimate: Estimate,
        told: list[int],
        reasons: Mapping[int, str],
        spread: Spread,
        began: float,
    ) -> FitResult:
        plan, problem, weights = self._plan, self._problem, self._weights
        usual, fitted = problem.values(np.zeros(len(plan.parameters))), problem.values(estimate.scaled)
        names = [plan.parameters[place].name for place in told]
        usual_told, fitted_told = ({n: each[n] for n in names} for each in (usual, fitted))
        touches = [each for recorded in plan.recordings for each in touches_of(recorded)]
        held = [each for recorded in plan.held_out for each in touches_of(recorded)]
        hardest = max(touches, key=lambda each: each.measured, default=None)
        parameters = _parameters(plan.parameters, estimate.scaled, told, reasons, spread)
        miss = None
        if hardest is not None and names:
            miss = miss_of(hardest, usual_told, fitted_told, weights, problem.each)
        return FitResult(
            runs=[each.name for each in plan.recordings],
            held_out=[each.name for each in plan.held_out],
            rows=sum(shot.stretch.rows for shot in problem.shots),
            stretches=len(problem.shots),
            touches=sum(shot.stretch.touches for shot in problem.shots),
            parameters=parameters,
            correlations=_correlations(names, spread.correlation),
            indistinct=[*reasons.values(), *_together(names, spread.correlation)],
            channels=channels_of(problem, usual, estimate.solved, fitted, weights),
            touch_predictions=foretold(touches, usual, fitted, weights, problem.each),
            held_out_predictions=foretold(held, usual, fitted, weights, problem.each),
            miss=miss,
            preset={each.name: each.value for each in parameters if each.told and each.in_configuration},
            uncertainty=_uncertainty(parameters),
            notices=[*_notices(plan), *_left_out(problem)],
            evaluations=estimate.evaluations,
            wall_time=time.perf_counter() - began,
        )


def _parameters(
    parameters: Sequence[Parameter], scaled: FloatArray, told: Sequence[int], reasons: Mapping[int, str], spread: Spread
) -> list[FittedParameter]:
    found = []
    errors = dict(zip(told, spread.deviation.tolist(), strict=True))
    for place, each in enumerate(parameters):
        value = each.nominal + each.spread * float(scaled[place])
        error = each.spread * errors[place] if place in errors else None
        found.append(
            FittedParameter(
                name=each.name,
                unit=each.unit,
                description=each.description,
                nominal=each.nominal,
                spread=each.spread,
                value=value,
                standard_error=error,
                low=None if error is None else value - spread.quantile * error,
                high=None if error is None else value + spread.quantile * error,
                told=place in errors,
                why_not=reasons.get(place),
                in_configuration=each.in_configuration,
            )
        )
    return found


def _correlations(names: Sequence[str], correlation: FloatArray) -> list[Correlation]:
    return [
        Correlation(first=a, second=names[j], correlation=float(np.clip(correlation[i, j], -1.0, 1.0)))
        for i, a in enumerate(names)
        for j in range(i)
    ]


def _together(names: Sequence[str], correlation: FloatArray) -> list[str]:
    return [
        f"{names[j]} and {names[i]} are known together better than each by itself "
        f"(correlation {correlation[i, j]:+.2f})"
        for i in range(len(names))
        for j in range(i)
        if abs(correlation[i, j]) > _CLOSELY
    ]


_UNCERTAIN = {
    "target.mass": "target_mass",
    "target.inertia": "target_inertia",
    "contact.stiffness": "contact_stiffness",
    "robot.servo.time_constant": "servo_time_constant",
}
"""Relative spreads of the uncertainty model, by what a fit calls the parameter."""


def _uncertainty(parameters: Sequence[FittedParameter]) -> dict[str, float]:
    """Fields of the rehearsals' uncertainty model (`sim.rehearsal.uncertainty`) that the fit knows."""
    found = {}
    for each in parameters:
        if not each.told or each.standard_error is None:
            continue
        if each.name in _UNCERTAIN and each.value > 0.0:
            found[_UNCERTAIN[each.name]] = min(1.0, each.standard_error / each.value)
        elif each.name == "contact.friction":  # half the range of an even distribution of that deviation
            found["friction"] = min(3.0, math.sqrt(3.0) * each.standard_error)
        elif each.name == STAMP_ERROR:
            found["delay"] = min(0.1, each.standard_error)
    return found


def _left_out(problem: Problem) -> list[str]:
    """What was left out, with mission times."""
    return [
        words
        for recorded in problem.recordings
        for solid, why in (
            (True, "more of the robot than its tips touched from {} s on; of such contact the model knows little"),
            (False, "no values explain what happened from {} s on"),
        )
        if (words := _left_out_words(problem, recorded, why, solid=solid))
    ]


def _left_out_words(problem: Problem, recorded: Recording, why: str, *, solid: bool) -> str:
    """Which stretches of a run were left out for that reason; empty if none was."""
    times = [
        f"{recorded.time[shot.stretch.first]:.2f}"
        for shot, counts, is_solid in zip(problem.shots, problem.counted, problem.solid, strict=True)
        if shot.recorded is recorded and not counts and is_solid is solid
    ]
    if not times:
        return ""
    return f"run {recorded.name}: {why.format(', '.join(times))}, and those {len(times)} stretches are left out"


def _notices(plan: FitPlan) -> list[str]:
    found = []
    for each in (*plan.recordings, *plan.held_out):
        gaps = int(each.segment[-1])
        if gaps:
            found.append(f"run {each.name}: {gaps} gaps between its ticks; nothing is flown across them")
        if each.smoothing > 0.0:
            found.append(
                f"run {each.name}: its poses are those of the model-based estimator, which believes a mass and an "
                "inertia of its own: errors may be greater than said"
            )
        if each.command_delay > 0.0:
            found.append(f"run {each.name}: commands take {1e3 * each.command_delay:g} ms to the joints")
    return found
