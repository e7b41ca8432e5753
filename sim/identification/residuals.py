"""What is left of the readings: weights from it, and series to plot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sim.capture.tick import ARMS
from sim.compiled import FloatArray
from sim.identification.flight import CHANNELS, TARGET
from sim.identification.recording import BoolArray
from sim.identification.result import ChannelResidual
from sim.identification.shooting import Shot, Solved, Weights
from sim.identification.varpro import Problem

_LEAST = Weights(2e-6, 1e-5, 2e-6, 1e-5, 2e-6, 1e-3, 1e-4)
"""No reading counts for surer than this: a model is a model."""

_OUTLIER = 8.0
"""A pose farther off than this is left out [standard deviations]."""

_POINTS = 600
"""Of each series that is plotted."""

_POSE = (("x", "m"), ("y", "m"), ("angle", "rad"))
_WRENCH = (("force_x", "N"), ("force_y", "N"), ("torque", "N m"))
NAMES = (
    *((f"{body}.{axis}", unit) for body in ("base", "target") for axis, unit in _POSE),
    *((f"{arm}.joint_{number}", "rad") for arm in ARMS for number in (1, 2, 3)),
    *((f"{arm}.{axis}", unit) for arm in ARMS for axis, unit in _WRENCH),
)
"""Of the channels, with their units."""

_GROUPS: tuple[tuple[int, ...], ...] = ((0, 1), (2,), (3, 4), (5,), tuple(range(6, 12)), (12, 13, 15, 16), (14, 17))
"""Channels that have one weight, in the order of `Weights`."""


def refined(problem: Problem, solved: Sequence[Solved], weights: Weights) -> Weights:
    """Weights as what is left says; poses that are far off are left out from here on."""
    counting = [place for place, counts in enumerate(problem.counted) if counts]
    residual = np.concatenate([solved[place].residual for place in counting])
    counted = np.concatenate([_counted(problem.shots[place]) for place in counting])
    found = []
    for place, channels in enumerate(_GROUPS):
        here = counted[:, channels]
        if here.sum() < 10:
            found.append(weights[place])
            continue
        left = residual[:, channels][here]
        usual = left[np.abs(left) < _OUTLIER]
        scale = float(np.sqrt(np.mean(usual**2))) if len(usual) else float(np.sqrt(np.mean(left**2)))
        found.append(max(_LEAST[place], scale * weights[place]))
    result = Weights(*found)
    relative = weights.of_channels / result.of_channels
    for shot, each in zip(problem.shots, solved, strict=True):
        far = np.abs(each.residual * relative) > _OUTLIER
        far[:, TARGET.stop :] = False
        shot.known &= ~far
    return result


def _counted(shot: Shot) -> BoolArray:
    """Where a residual is that of a reading, shape (rows, 18)."""
    counted: BoolArray = shot.known.copy()
    if shot.recorded.gated:
        rows = slice(shot.stretch.first, shot.stretch.last)
        for arm in range(2):
            counted[:, 12 + 3 * arm : 15 + 3 * arm] &= shot.recorded.touching[rows, arm][:, None]
    return counted


def channels_of(
    problem: Problem,
    usual: Mapping[str, float],
    solved: Sequence[Solved],
    fitted: Mapping[str, float],
    weights: Weights,
) -> list[ChannelResidual]:
    """Every reading of every run: what is left of it, and a series to plot.

    Args:
        problem: the fit's.
        usual: nominal values.
        solved: its shots, fitted.
        fitted: values.
        weights: of the fit.

    """
    before, sigma = problem.solve(usual, weights), weights.of_channels
    models = problem.models(fitted)
    found: list[ChannelResidual] = []
    for recorded, model in zip(problem.recordings, models, strict=True):
        mine = [place for place, shot in enumerate(problem.shots) if shot.recorded is recorded]
        shots = [problem.shots[place] for place in mine]
        if not shots:
            continue
        counted = np.concatenate([_counted(shot) for shot in shots])
        left, left_before = (np.concatenate([of[place].residual for place in mine]) for of in (solved, before))
        rows = [shot.predict(model, solved[place].node).readings for shot, place in zip(shots, mine, strict=True)]
        read, measured = np.concatenate(rows), np.concatenate([shot.measured for shot in shots])
        instants = np.concatenate([recorded.time[shot.stretch.first : shot.stretch.last] for shot in shots])
        for channel in range(CHANNELS):
            here = np.flatnonzero(counted[:, channel])
            if not len(here):
                continue
            shown = here[:: max(1, -(-len(here) // _POINTS))]
            found.append(
                ChannelResidual(
                    run=recorded.name,
                    name=NAMES[channel][0],
                    unit=NAMES[channel][1],
                    rms=_rms(left[here, channel]) * sigma[channel],
                    rms_nominal=_rms(left_before[here, channel]) * sigma[channel],
                    deviation=float(sigma[channel]),
                    time=instants[shown].round(4).tolist(),
                    measured=_short(measured[shown, channel]),
                    predicted=_short(read[shown, channel]),
                )
            )
    return found


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _short(values: FloatArray) -> list[float]:
    """With seven digits: more is noise, and takes room."""
    return [float(f"{value:.7g}") for value in np.nan_to_num(values).tolist()]
