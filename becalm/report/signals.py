"""Time histories: the paper's figures of forces, spins, attitude and manipulability, redrawn from our runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Literal, Protocol, TypeVar

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from server.reports.style import AUTHORS, BASE, GREY, INK, LEFT, RIGHT, TARGET, annotate_level, figure
from sim.capture.events import Ticks
from sim.capture.tick import ARMS
from sim.compiled import FloatArray
from sim.control.phases import Phase
from sim.method.published.memory import Activity
from sim.reproduction.experiments import FlownCapture
from sim.reproduction.findings import hand_forces


class HasTicks(Protocol):
    """A flight whose ticks are drawn."""

    @property
    def ticks(self) -> Ticks:
        """All of them."""
        ...


Shown = TypeVar("Shown", bound=HasTicks)

_BINS = 900  # points of a drawn curve; of each bin the extreme is kept, so that no peak is lost
_SHADES = {Phase.DETUMBLING: "#EAF2F8", Phase.CAGING: "#FBF1E3", Phase.HOLDING: "#EAF5EF"}


def extremes(time: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A curve of few points that keeps the value of largest size in each of them."""
    if len(time) <= _BINS:
        return time, values
    edges = np.linspace(0, len(time), _BINS + 1).astype(np.int64)
    places = [low + int(np.argmax(np.abs(values[low:high]))) for low, high in pairwise(edges)]
    return time[places], values[places]


def forces(runs: Mapping[str, FlownCapture], bound: float) -> Figure:
    """Resultant force of each hand's tips."""

    def panel(axes: Axes, flown: FlownCapture) -> None:
        for arm, colour in enumerate((LEFT, RIGHT)):
            axes.plot(
                *extremes(flown.ticks["time"], hand_forces(flown.ticks)[arm]), color=colour, label=f"{ARMS[arm]} hand"
            )
        for touch in flown.outcome.contacts:
            colour = LEFT if touch.arm == "left" else RIGHT
            axes.plot(touch.start, -0.045, marker="^", color=colour, markersize=3.5, clip_on=False)
        annotate_level(axes, bound, f"bound {bound:.2f} N" if flown.direct else "")
        if flown.outcome.closed_at is not None:
            axes.axvline(flown.outcome.closed_at, color=INK, linewidth=0.7, linestyle=":")
            axes.text(flown.outcome.closed_at, axes.get_ylim()[1], " first closed", va="top", fontsize=6.5)

    top = max(flown.outcome.peak_tip_force for flown in runs.values())
    return panels(runs, "hand force, N", panel, (0.0, 1.1 * top), legend="upper left")


def spins(runs: Mapping[str, FlownCapture], authors: Mapping[str, FloatArray]) -> Figure:
    """Angular velocities of target and base; the authors' own direct run beside ours."""

    def panel(axes: Axes, flown: FlownCapture) -> None:
        time = flown.ticks["time"]
        axes.plot(time[::20], flown.ticks["target_twist"][::20, 2], color=TARGET, label="target")
        axes.plot(time[::20], flown.ticks["base_twist"][::20, 2], color=BASE, label="base")
        if flown.direct:
            axes.plot(authors["t"], authors["targ_w"], color=AUTHORS, linestyle="--", label="target, authors")
            axes.legend(loc="upper right")
        annotate_level(axes, flown.config.published.caging.spin_threshold, "caging below" if flown.direct else "")
        axes.axhline(0.0, color=GREY, linewidth=0.4)

    return panels(runs, "angular velocity, rad/s", panel, None, legend="upper right")


def attitude(runs: Mapping[str, FlownCapture]) -> Figure:
    """Base attitude above, manipulability of both arms below."""
    drawn = figure(7.4, 3.5)
    grid = drawn.subplots(2, len(runs), sharex="col", sharey="row", squeeze=False)
    for place, (name, flown) in enumerate(runs.items()):
        above, below = grid[0, place], grid[1, place]
        time = flown.ticks["time"]
        shade(above, flown)
        shade(below, flown)
        above.plot(time[::20], np.degrees(flown.ticks["base_pose"][::20, 2]), color=BASE)
        above.axhline(0.0, color=GREY, linewidth=0.4)
        above.set_title(name)
        for arm, colour in enumerate((LEFT, RIGHT)):
            values = flown.ticks["manipulability"][::20, arm]
            below.plot(time[::20], 1e3 * values, color=colour, label=f"{ARMS[arm]} arm")
        below.set(xlabel="time, s", xlim=(0.0, time[-1]), ylim=(0.0, None))
    grid[0, 0].set_ylabel("base attitude, deg")
    grid[1, 0].set_ylabel("manipulability, 10⁻³ m²")
    grid[1, 0].legend(loc="lower left")
    return drawn


def beside_the_authors(flown: FlownCapture, authors: Mapping[str, FloatArray]) -> Figure:
    """Direct caging by us and by the authors' simulator around the touch: forces of both hands, spin of the target."""
    drawn = figure(7.4, 2.3)
    left, right, spin = drawn.subplots(1, 3)
    ticks = flown.ticks
    first = flown.outcome.contacts[0].start if flown.outcome.contacts else 2.0
    window = (first - 0.15, min(first + 0.9, float(authors["t"][-1])))
    for arm, axes in enumerate((left, right)):
        axes.plot(authors["t"], authors[f"Fhand_{'LR'[arm]}"], color=AUTHORS, label="authors, each 5 ms")
        axes.plot(ticks["time"], hand_forces(ticks)[arm], color=(LEFT, RIGHT)[arm], linewidth=0.9, label="Becalm")
        axes.set(title=f"{ARMS[arm]} hand", ylabel="force, N", xlabel="time, s", xlim=window, ylim=(0.0, None))
        axes.legend(loc="upper right")
    spin.plot(authors["t"], authors["targ_w"], color=AUTHORS, label="authors")
    spin.plot(ticks["time"][::5], ticks["target_twist"][::5, 2], color=TARGET, linewidth=0.9, label="Becalm")
    spin.set(title="target", ylabel="spin, rad/s", xlabel="time, s", xlim=window)
    spin.legend(loc="upper right")
    return drawn


def dead_touch(failure: FlownCapture, success: FlownCapture, names: Sequence[str]) -> Figure:
    """A dead touch and the success beside it: spin, drift of the base's attitude, distance from base to target."""
    drawn = figure(7.4, 2.3)
    spin, turn, gap = drawn.subplots(1, 3)
    for flown, name, colour in ((failure, names[0], RIGHT), (success, names[1], BASE)):
        ticks = flown.ticks
        time = ticks["time"][::10]
        spin.plot(time, ticks["target_twist"][::10, 2], color=colour, label=name)
        turn.plot(time, np.degrees(ticks["base_pose"][::10, 2]), color=colour)
        apart = ticks["target_pose"][::10, :2] - ticks["base_pose"][::10, :2]
        gap.plot(time, np.hypot(*apart.T), color=colour)
        for axes, values in ((turn, np.degrees(ticks["base_pose"][-1, 2])), (gap, np.hypot(*apart[-1]))):
            axes.plot(ticks["time"][-1], values, "o", color=colour, markersize=3.5)
    closing = failure.ticks["activity"] == Activity.CLOSING
    if closing.any():
        for axes in (spin, turn, gap):
            axes.axvline(failure.ticks["time"][int(np.argmax(closing))], color=GREY, linewidth=0.6, linestyle=":")
    annotate_level(spin, failure.config.published.caging.slow_spin, "planner's slow spin")
    spin.set(ylabel="target's spin, rad/s", xlabel="time, s", xlim=(3.0, None))
    turn.set(ylabel="base attitude, deg", xlabel="time, s", xlim=(3.0, None))
    gap.set(ylabel="base to target, m", xlabel="time, s", xlim=(3.0, None))
    spin.legend(loc="upper right")
    return drawn


def panels(
    runs: Mapping[str, Shown],
    label: str,
    panel: Callable[[Axes, Shown], None],
    limits: tuple[float, float] | None,
    legend: Literal["upper left", "upper right"],
) -> Figure:
    """One panel a flight, on the same vertical axis, phases shaded."""
    drawn = figure(7.4, 2.25)
    row = drawn.subplots(1, len(runs), sharey=True, squeeze=False)[0]
    for axes, (name, flown) in zip(row, runs.items(), strict=True):
        if limits:
            axes.set_ylim(*limits)
        shade(axes, flown)
        panel(axes, flown)
        axes.set(title=name, xlabel="time, s", xlim=(0.0, float(flown.ticks["time"][-1])))
    row[0].set_ylabel(label)
    row[-1].legend(loc=legend)
    return drawn


def shade(axes: Axes, flown: HasTicks) -> None:
    """The phases as pale bands."""
    phases = flown.ticks["phase"]
    time = flown.ticks["time"]
    starts = [0, *(np.flatnonzero(phases[1:] != phases[:-1]) + 1), len(phases) - 1]
    for start, end in pairwise(starts):
        colour = _SHADES.get(Phase(int(phases[start])))
        if colour:
            axes.axvspan(time[start], time[end], color=colour, linewidth=0, zorder=0)
