"""The page of the experiment that was flown again: the paper's four figures of it, and what came of the singularity."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from becalm.report.document import data_uri, environment
from becalm.report.signals import extremes, panels, shade
from server.reports.drawing import DrawnInstant, sequence
from server.reports.style import (
    BASE,
    GREY,
    INK,
    LEFT,
    PALE,
    RIGHT,
    TARGET,
    Picture,
    annotate_level,
    figure,
    look,
    picture,
)
from server.versions import becalm_version
from sim.capture.tick import ARMS
from sim.compiled import FloatArray
from sim.reproduction.findings import hand_forces
from sim.reproduction.testbed import PAPER, SINGULAR, FlownTrial, Trial, low_point, nearest, shown

_FRAMES = 5
_EVERY = 4  # of the ticks are drawn
_LOW = {"published": "Detumbling and caging", "becalm": "Our own method"}
"""Trials whose arms are drawn where they come nearest to a singularity."""


def figures(flown: Sequence[Trial], flights: Sequence[FlownTrial]) -> dict[str, Picture]:
    """Every figure of the page by name, in its order."""
    by_trial = {trial.name: [each for each in flights if each.trial == trial.name] for trial in flown}
    typical = {trial.title: shown(by_trial[trial.name]) for trial in flown}
    drawn = {f"snapshots_{each.trial}": _snapshots(each) for each in typical.values()}
    with look():
        drawn |= {"forces": _forces(typical), "velocities": _velocities(typical), "stability": _stability(typical)}
        drawn["manipulability"] = _all_manipulability({trial.title: by_trial[trial.name] for trial in flown})
        drawn |= {f"nearest_{name}": _nearest(by_trial[name]) for name in _LOW}
        return {name: picture(one) for name, one in drawn.items()}


def _snapshots(flight: FlownTrial) -> Figure:
    """Fig. 10 of the paper: the start, the touches, the closing, the end."""
    with look():
        return sequence(flight.config, flight.ticks, _instants(flight), _FRAMES)


def _instants(flight: FlownTrial) -> list[DrawnInstant]:
    ticks, outcome = flight.ticks, flight.outcome
    force = hand_forces(flight.ticks).max(axis=0)
    moments = [(float(ticks["time"][-1]), "the end"), (0.0, "start")]
    if outcome is not None:
        moments += [(each.start, f"{each.arm} hand touches") for each in outcome.contacts[:1]]
        if outcome.closed_at is not None:
            moments.append((outcome.closed_at, "first closed instant"))
    moments.append((float(ticks["time"][int(np.argmax(force))]), f"largest force, {force.max():.2f} N"))
    return sorted(DrawnInstant(time, caption) for time, caption in moments)


def _forces(runs: Mapping[str, FlownTrial]) -> Figure:
    """Fig. 11: what the wrists feel."""

    def panel(axes: Axes, flight: FlownTrial) -> None:
        felt = hand_forces(flight.ticks)
        for arm, colour in enumerate((LEFT, RIGHT)):
            axes.plot(*extremes(flight.ticks["time"], felt[arm]), color=colour, label=f"{ARMS[arm]} wrist")
        paper = PAPER.get(flight.trial, {}).get("peak_force")
        if paper is not None:
            annotate_level(axes, paper, f"paper's peak, {paper:.2g} N")

    top = max(float(hand_forces(flight.ticks).max()) for flight in runs.values())
    return panels(runs, "force at the wrists, N", panel, (0.0, 1.1 * max(top, 4.4)), legend="upper right")


def _velocities(runs: Mapping[str, FlownTrial]) -> Figure:
    """Fig. 12: angular velocities of base and target."""

    def panel(axes: Axes, flight: FlownTrial) -> None:
        ticks = flight.ticks[::_EVERY]
        axes.plot(ticks["time"], ticks["target_twist"][:, 2], color=TARGET, label="target")
        axes.plot(ticks["time"], ticks["base_twist"][:, 2], color=BASE, label="base")
        axes.axhline(0.0, color=GREY, linewidth=0.4)

    return panels(runs, "angular velocity, rad/s", panel, None, legend="upper right")


def _stability(runs: Mapping[str, FlownTrial]) -> Figure:
    """Fig. 13: base attitude above, manipulability of both arms below."""
    drawn = figure(7.4, 3.5)
    grid = drawn.subplots(2, len(runs), sharex="col", sharey="row", squeeze=False)
    for (title, flight), (above, below) in zip(runs.items(), grid.T, strict=True):
        ticks = flight.ticks[::_EVERY]
        shade(above, flight)
        shade(below, flight)
        above.plot(ticks["time"], np.degrees(ticks["base_pose"][:, 2]), color=BASE)
        above.axhline(0.0, color=GREY, linewidth=0.4)
        above.set_title(title)
        for arm, colour in enumerate((LEFT, RIGHT)):
            below.plot(ticks["time"], 1e3 * ticks["manipulability"][:, arm], color=colour, label=f"{ARMS[arm]} arm")
        annotate_level(below, 1e3 * SINGULAR, "floor")
        below.set(xlabel="time, s", xlim=(0.0, float(ticks["time"][-1])), ylim=(0.0, None))
    grid[0, 0].set_ylabel("base attitude, deg")
    grid[1, 0].set_ylabel("manipulability, 10⁻³ m²")
    grid[1, 0].legend(loc="center right")
    return drawn


def _all_manipulability(runs: Mapping[str, Sequence[FlownTrial]]) -> Figure:
    """The lesser of both arms in every flight, and the one that came nearest to a singularity."""
    drawn = figure(7.4, 2.4)
    row = drawn.subplots(1, len(runs), sharey=True, squeeze=False)[0]
    for axes, (title, flights) in zip(row, runs.items(), strict=True):
        for flight in flights:
            axes.plot(*_lesser(flight), color=PALE, linewidth=0.7)
        worst = nearest(flights)
        low = low_point(worst)
        axes.plot(*_lesser(worst), color=INK, linewidth=1.1, label=f"seed {worst.seed}")
        axes.plot(low.time, 1e3 * low.manipulability, "o", color=RIGHT, markersize=4)
        annotate_level(axes, 1e3 * SINGULAR, "floor")
        axes.set(title=title, xlabel="time, s", xlim=(0.0, None), ylim=(0.0, None))
        axes.legend(loc="upper right")
    row[0].set_ylabel("manipulability, 10⁻³ m²")
    return drawn


def _lesser(flight: FlownTrial) -> tuple[FloatArray, FloatArray]:
    ticks = flight.ticks[::_EVERY]
    return ticks["time"], 1e3 * ticks["manipulability"].min(axis=1)


def _nearest(flights: Sequence[FlownTrial]) -> Figure:
    """Robot and target where an arm is nearest to a singularity, half a second before and after."""
    flight = nearest(flights)
    low, end = low_point(flight), float(flight.ticks["time"][-1])
    times = (max(0.0, low.time - 0.5), low.time, min(end, low.time + 0.5))
    words = ("before", f"{low.arm} arm: {1e3 * low.manipulability:.1f} 10⁻³ m²", "after")
    return sequence(flight.config, flight.ticks, [DrawnInstant(*each) for each in zip(times, words, strict=True)], 3)


def html(flown: Sequence[Trial], document: Mapping[str, Any], pictures: Mapping[str, Picture], day: str) -> str:
    """The whole page."""
    return (
        environment()
        .get_template("experiment.html.j2")
        .render(
            **document,
            titles={trial.name: trial.title for trial in flown},
            paper=PAPER,
            floor=SINGULAR,
            images={name: data_uri(one) for name, one in pictures.items()},
            version=becalm_version(),
            day=day,
        )
    )
