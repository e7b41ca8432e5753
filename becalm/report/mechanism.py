"""Why the band has the bounds it has: figures of the first touch as a collision, and of the ablations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from server.reports.style import GREY, INK, LEFT, MARKS, PALE, RIGHT, figure
from sim.config import MissionConfig
from sim.reproduction.experiments import Origin
from sim.reproduction.first_touch import TouchState, effective_mass, lever_of, restitution
from sim.reproduction.first_touch_prediction import Prediction, prediction_score
from sim.reproduction.published import DAMPING, MASS, STIFFNESS
from sim.snapshot import OutcomeClass

_ORIGINS = {Origin.PRINTED: LEFT, Origin.UNSTATED: RIGHT, Origin.PLANT: GREY}
_LINES: tuple[Literal[":", "-.", "--", "-"], ...] = (":", "-.", "--", "-")
_SHAPES = {0.01: "o", 0.05: "s", 0.1: "^", 0.5: "D"}


def _colour(cell: Prediction) -> str:
    return MARKS[OutcomeClass(cell.row["at_first_closure"])].colour


def _outcomes(cells: Sequence[Prediction]) -> list[Line2D]:
    """Legend entries of the classes among the cells."""
    present = {cell.row["at_first_closure"] for cell in cells}
    return [
        Line2D([], [], linestyle="", marker="o", markersize=4, color=mark.colour, label=mark.words)
        for outcome, mark in MARKS.items()
        if outcome.value in present
    ]


def residual_spin(config: MissionConfig, cells: Sequence[Prediction]) -> Figure:
    """Spin after the first touch over damping, for some stiffnesses: flights as points, the planar model as lines."""
    masses = sorted({cell.row[MASS] for cell in cells})
    stiffnesses = sorted({cell.row[STIFFNESS] for cell in cells})
    last = len(stiffnesses) - 1
    chosen = [stiffnesses[place] for place in sorted({0, min(1, last), last // 2, last})]
    drawn = figure(7.4, 2.6)
    grid = drawn.subplots(1, len(masses), sharey=True, squeeze=False)
    caging = config.published.caging
    for axes, mass in zip(grid[0], masses, strict=True):
        axes.axhspan(caging.slow_spin, caging.spin_threshold, color="#FBE9E0", linewidth=0, zorder=0)
        for stiffness, line in zip(chosen, _LINES[-len(chosen) :], strict=True):
            own = [cell for cell in cells if (cell.row[MASS], cell.row[STIFFNESS]) == (mass, stiffness)]
            damping = [cell.row[DAMPING] for cell in own]
            axes.plot(damping, [cell.planar.spin for cell in own], color=GREY, linestyle=line, linewidth=0.9, zorder=2)
            flown = [cell.measured.spin for cell in own]
            axes.scatter(damping, flown, c=list(map(_colour, own)), s=15, edgecolors="white", linewidths=0.3, zorder=3)
        axes.set(title=f"m = {mass:g} kg", xlabel="d, N s/m", xlim=(-0.6, None))
    grid[0, 0].set_ylabel("spin after first touch, rad/s")
    lines = [
        Line2D([], [], color=GREY, linestyle=line, label=f"model, k = {stiffness:g} N/m")
        for stiffness, line in zip(chosen, _LINES[-len(chosen) :], strict=True)
    ]
    drawn.legend(handles=[*_outcomes(cells), *lines], loc="outside lower center", ncols=4)
    return drawn


def spin_and_drift(config: MissionConfig, cells: Sequence[Prediction], bound: float) -> Figure:
    """Every cell by what its first touch left: in flight to the left, by the planar model to the right."""
    drawn = figure(7.4, 3.2)
    row = drawn.subplots(1, 2, sharex=True, sharey=True)
    caging = config.published.caging
    for axes, name in zip(row, ("measured", "planar"), strict=True):
        axes.axhspan(caging.slow_spin, caging.spin_threshold, color="#FBE9E0", linewidth=0, zorder=0)
        axes.axvspan(1e3 * bound, 60.0, color="#FBE9E0", linewidth=0, zorder=0)
        for mass, shape in _SHAPES.items():
            own = [cell for cell in cells if cell.row[MASS] == mass]
            left = [getattr(cell, name) for cell in own]
            axes.scatter(
                [1e3 * one.drift for one in left],
                [one.spin for one in left],
                c=list(map(_colour, own)),
                marker=shape,
                s=13,
                edgecolors="white",
                linewidths=0.3,
            )
        axes.set_xlabel("drift after first touch, mm/s")
    row[0].set(title="in flight", ylabel="spin after first touch, rad/s", xlim=(0.0, 60.0))
    row[1].set_title("by the collision alone")
    shapes = [
        Line2D([], [], linestyle="", marker=shape, color=GREY, markersize=4, label=f"{mass:g} kg")
        for mass, shape in _SHAPES.items()
    ]
    drawn.legend(handles=[*_outcomes(cells), *shapes], loc="outside lower center", ncols=5)
    return drawn


class Numbers(NamedTuple):
    """Of the first touch, the same in all cells."""

    effective_mass: float
    """[kg]"""
    approach_speed: float
    """Of the touched point along the face's normal [m/s]."""
    target_mass: float
    """[kg]"""
    drift_bound: float
    """[m/s]"""


def numbers_of(cells: Sequence[Prediction], touch: TouchState, config: MissionConfig) -> Numbers:
    """What the figures need of the first touch."""
    lever, target = lever_of(touch, config), config.target
    return Numbers(
        effective_mass(target.mass, target.inertia, lever),
        lever * abs(float(touch.target_twist[2])),
        target.mass,
        prediction_score(config, cells).drift_bound,
    )


def rebound(cells: Sequence[Prediction], numbers: Numbers) -> Figure:
    """Coefficient of restitution over damping ratio: the linear dashpot's curve, flights as points."""
    drawn = figure(4.6, 2.9)
    axes = drawn.subplots()
    blow = numbers.effective_mass * numbers.approach_speed
    ratios = np.geomspace(0.03, 4.0, 200)
    axes.plot(ratios, [restitution(ratio) for ratio in ratios], color=INK, linewidth=1.2)
    for mass, shape in _SHAPES.items():
        own = [cell for cell in cells if cell.row[MASS] == mass and 0.0 < cell.ratio < 4.0]
        measured = [numbers.target_mass * cell.measured.drift / blow - 1.0 for cell in own]
        axes.scatter(
            [cell.ratio for cell in own],
            measured,
            c=list(map(_colour, own)),
            marker=shape,
            s=12,
            edgecolors="white",
            linewidths=0.3,
        )
    axes.axhline(0.0, color=PALE, linewidth=0.8, zorder=0)
    axes.set(xscale="log", xlabel="damping ratio d / (2 √(k (m_eff + m)))", ylabel="restitution")
    axes.set_xticks([0.05, 0.1, 0.2, 0.5, 1, 2, 4], ["0.05", "0.1", "0.2", "0.5", "1", "2", "4"])
    axes.minorticks_off()
    shapes = [
        Line2D([], [], linestyle="", marker=shape, color=GREY, markersize=4, label=f"{mass:g} kg")
        for mass, shape in _SHAPES.items()
    ]
    axes.legend(handles=[Line2D([], [], color=INK, label="linear dashpot, one lever"), *shapes], loc="upper right")
    return drawn


def ablations(names: Sequence[str], kappas: Sequence[float], origins: Sequence[Origin], reference: float) -> Figure:
    """Kappa with the published tables, one change at a time."""
    drawn = figure(6.0, 0.45 + 0.24 * len(names))
    axes = drawn.subplots()
    places = np.arange(len(names))[::-1]
    colours = [_ORIGINS[origin] for origin in origins]
    axes.barh(places, kappas, color=colours, height=0.62)
    axes.set_yticks(places, names)
    for place, kappa in zip(places, kappas, strict=True):
        axes.text(max(kappa, 0.0) - 0.012, place, f"{kappa:.2f}", va="center", ha="right", color="white", fontsize=7)
    axes.axvline(reference, color=INK, linewidth=0.8, linestyle=":")
    axes.set(
        xlim=(min(0.0, *kappas), 1.05), xlabel="kappa over success and failure, m = 0.01 and 0.1 kg (dotted: published)"
    )
    axes.tick_params(axis="y", length=0)
    _plain(axes)
    return drawn


def _plain(axes: Axes) -> None:
    axes.spines["left"].set_visible(False)
