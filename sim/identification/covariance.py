"""How surely parameters are known, and which of them the runs do not tell apart."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.stats import t as student

from sim.compiled import FloatArray
from sim.identification.flight import CHANNELS, normal_equations
from sim.identification.parameters import CONTACT_ONLY, Parameter
from sim.identification.shooting import Shot
from sim.identification.varpro import Estimate

MEMORY = 0.1
"""Residuals that far apart are taken to be independent [s] (Bartlett's weights: Newey and West 1987)."""

_LEAST_TOLD = 4.0
"""A direction is told if the runs say this many times as much about it as the prior does."""

_PART = 0.35
"""Parameters with less of a direction are not named with it."""


class Spread(NamedTuple):
    """Standard errors and correlations of the parameters that are told."""

    deviation: FloatArray
    """In spreads of the prior, shape (told,)."""
    correlation: FloatArray
    """Shape (told, told)."""
    quantile: float
    """Standard errors either way of a 95 % interval: Student's, by the number of stretches."""


def spread_of(shots: Sequence[Shot], estimate: Estimate, count: int) -> Spread:
    """Errors by the curvature of the misfit, made wider where residuals go on for longer than a row, or for a stretch.

    The largest of three counts: curvature alone; residuals that remember `MEMORY`; and by how much the values change
    when one stretch after the other is left out (the jackknife), which alone sees a touch that tells most of a value.
    """
    if not count:
        return Spread(np.zeros(0), np.zeros((0, 0)), math.inf)
    information = sum((_square(slope) for slope in estimate.slopes), np.eye(count))
    plain = np.linalg.inv(information)
    scores, without = np.zeros((count, count)), []
    for shot, solved, slope in zip(shots, estimate.solved, estimate.slopes, strict=True):
        of_rows = (slope * solved.residual.reshape(-1, 1)).reshape(-1, CHANNELS, count).sum(axis=1)
        if of_rows.any():
            scores += _long_run(of_rows, round(MEMORY / shot.recorded.period))
            without.append(np.linalg.solve(information - _square(slope), of_rows.sum(axis=0)))
    groups = max(2, len(without))
    changes = np.array(without).reshape(-1, count)
    jackknife = (groups - 1.0) / groups * (changes**2).sum(axis=0)
    wider = np.ones(count)
    for variance in (np.diag(plain @ scores @ plain), jackknife):
        wider = np.maximum(wider, np.sqrt(variance / np.diag(plain)))
    deviation = np.sqrt(np.diag(plain))
    correlation = plain / np.outer(deviation, deviation)
    return Spread(deviation * wider, correlation, float(student.ppf(0.975, groups - 1)))


def _square(slope: FloatArray) -> FloatArray:
    """Of slopes, shape (parameters, parameters)."""
    count = slope.shape[1]
    square, nothing = np.zeros((count, count)), np.zeros(count)
    normal_equations(slope, np.zeros(len(slope)), square, nothing)
    return square


def _long_run(scores: FloatArray, memory: int) -> FloatArray:
    """Covariance of the sum of the rows, shape (rows, parameters), that remember so many of them."""
    total: FloatArray = scores.T @ scores
    for lag in range(1, min(memory, len(scores) - 1) + 1):
        both = scores[lag:].T @ scores[:-lag]
        total = total + (1.0 - lag / (memory + 1.0)) * (both + both.T)
    return total


def told_apart(
    parameters: Sequence[Parameter], shots: Sequence[Shot], estimate: Estimate
) -> tuple[list[int], dict[int, str]]:
    """Which parameters the runs tell, and of the others why they do not.

    Directions about which the runs say no more than the prior does are those of small eigenvalues of J^T J, in spreads
    of the prior. Of each, the parameter that has most of it is left nominal, until no such direction is left.

    Args:
        parameters: all of the fit, all of them free in the estimate.
        shots: of the fit.
        estimate: of them.

    """
    count = len(parameters)
    information = sum((_square(slope) for slope in estimate.slopes), np.zeros((count, count)))
    touches = any(shot.stretch.touches for shot in shots)
    told, reasons = list(range(count)), {}
    while told:
        values, vectors = np.linalg.eigh(information[np.ix_(told, told)])
        if values[0] >= _LEAST_TOLD:
            break
        direction = np.abs(vectors[:, 0])
        worst = int(np.argmax(direction))
        others = [parameters[told[i]].name for i in np.flatnonzero(direction >= _PART) if i != worst]
        place = told.pop(worst)
        reasons[place] = _reason(parameters[place], others, touches)
    return told, reasons


def _reason(parameter: Parameter, others: Sequence[str], touches: bool) -> str:
    stays = f"it stays at {parameter.nominal:g}{'' if parameter.unit == '1' else ' ' + parameter.unit}"
    if others:
        return f"{parameter.name} cannot be told apart from {' and '.join(others)}: {stays}"
    if not touches and parameter.name.startswith(CONTACT_ONLY):
        return f"{parameter.name}: no hand touches the target, and without a touch nothing depends on it: {stays}"
    return f"{parameter.name}: the runs say no more about it than was known before: {stays}"
