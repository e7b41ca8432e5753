"""The plots of a run's report: forces, spin, attitude of the base and manipulability, over mission time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import FigureBase

from server.library.plotted import History
from server.reports.style import BASE, GREY, INK, LEFT, RIGHT, TARGET
from sim.capture.tick import ARMS
from sim.compiled import FloatArray
from sim.control.phases import Phase
from sim.snapshot import Outcome

_SHADES = {Phase.DETUMBLING: "#EAF2F8", Phase.CAGING: "#FBF1E3", Phase.HOLDING: "#EAF5EF"}
_HANDS = (LEFT, RIGHT)


class RunCurves:
    """The plotted columns of a run, few rows with every extreme in them."""

    def __init__(self, history: History) -> None:
        values = np.array(history.rows, dtype=float)  # null becomes nan
        self._columns = {column.name: values[:, place] for place, column in enumerate(history.columns)}
        self.time = self._columns["mission.time"]

    def __getitem__(self, name: str) -> FloatArray:
        return self._columns[name]

    @property
    def attitude(self) -> FloatArray:
        """The base's angle, from where it was at first [rad]."""
        angle = self["base.pose.angle"]
        turned: FloatArray = angle - angle[0]
        return turned

    @property
    def first_motion(self) -> float:
        """When the mission first left idle, or was first recorded where that was on the way [s]."""
        (phase, start, end), *_ = self.phases()
        return end if phase is Phase.IDLE else start

    @property
    def target_path(self) -> FloatArray:
        """The target's centre, shape (rows, 2) [m]."""
        return np.column_stack([self["target.pose.x"], self["target.pose.y"]])

    def phases(self) -> list[tuple[Phase, float, float]]:
        """Each phase with its beginning and its end [s]."""
        known = np.isfinite(self.time) & np.isfinite(self["mission.phase"])
        time, phase = self.time[known], self["mission.phase"][known].astype(int)
        starts = np.flatnonzero(np.diff(phase, prepend=-1))
        ends = [*time[starts[1:]], time[-1]]
        return [
            (Phase(int(phase[start])), float(time[start]), float(end)) for start, end in zip(starts, ends, strict=True)
        ]


class Level(NamedTuple):
    """A value that a plot is read against."""

    value: float
    words: str


class RunPlots:
    """Draws the four plots of one run."""

    def __init__(
        self, curves: RunCurves, outcome: Outcome | None, bound: Level | None, threshold: Level | None
    ) -> None:
        """Of these curves.

        Args:
            curves: what was recorded.
            outcome: how it ended, if it has.
            bound: of the tip force [N].
            threshold: of the target's spin [rad/s].

        """
        self._curves, self._outcome, self._bound, self._threshold = curves, outcome, bound, threshold

    def draw(self, figure: FigureBase) -> None:
        """All of them, two beside one another."""
        (force, spin), (attitude, manipulability) = figure.subplots(2, 2, sharex=True)
        self._forces(force)
        self._spins(spin)
        self._attitude(attitude)
        self._manipulability(manipulability)
        for axes in (force, spin, attitude, manipulability):
            self._mark_phases(axes)
            self._mark_instants(axes)
        for axes in (attitude, manipulability):
            axes.set_xlabel("mission time, s")

    def _forces(self, axes: Axes) -> None:
        for arm, colour in zip(ARMS, _HANDS, strict=True):
            axes.plot(self._curves.time, self._curves[f"{arm}.hand_force"], color=colour, label=arm, lw=0.9)
        for touch in self._outcome.contacts if self._outcome else ():
            axes.plot(touch.start, 0.0, "^", color=_HANDS[ARMS.index(touch.arm)], ms=3.5, clip_on=False, zorder=5)
        axes.set(title="Tip force of each hand", ylabel="N", ylim=(0.0, None))
        _finish(axes, self._bound)

    def _spins(self, axes: Axes) -> None:
        axes.plot(self._curves.time, self._curves["target.twist.angle"], color=TARGET, label="target", lw=0.9)
        axes.plot(self._curves.time, self._curves["base.twist.angle"], color=BASE, label="base", lw=0.9)
        axes.axhline(0.0, color=GREY, lw=0.4)
        axes.set(title="Spin", ylabel="rad/s")
        _finish(axes, self._threshold)

    def _attitude(self, axes: Axes) -> None:
        axes.plot(self._curves.time, np.degrees(self._curves.attitude), color=BASE, lw=0.9)
        axes.axhline(0.0, color=GREY, lw=0.4)
        axes.set(title="Rotation of the base", ylabel="deg")

    def _manipulability(self, axes: Axes) -> None:
        for arm, colour in zip(ARMS, _HANDS, strict=True):
            axes.plot(self._curves.time, 1e3 * self._curves[f"{arm}.manipulability"], color=colour, label=arm, lw=0.9)
        axes.set(title="Manipulability of each arm", ylabel="10⁻³ m²", ylim=(0.0, None))
        _finish(axes, None)

    def _mark_phases(self, axes: Axes) -> None:
        for phase, start, end in self._curves.phases():
            axes.axvspan(start, end, color=_SHADES.get(phase, "none"), lw=0, zorder=0)
        axes.set_xlim(0.0, max(float(np.nanmax(self._curves.time)), 1e-3))

    def _mark_instants(self, axes: Axes) -> None:
        if self._outcome is None:
            return
        for time, style in ((self._outcome.closed_at, ":"), (self._outcome.locked_at, "--")):
            if time is not None:
                axes.axvline(time, color=INK, lw=0.7, ls=style)


def _finish(axes: Axes, level: Level | None) -> None:
    """The names of the curves beside the title, and the level if it is in view."""
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.0, handlelength=1.2)
    low, high = axes.get_ylim()
    if level is None or not low < level.value < high:
        return
    axes.axhline(level.value, color=GREY, lw=0.7, ls=(0, (4, 3)))
    axes.annotate(
        level.words,
        (0.99, level.value),
        xycoords=("axes fraction", "data"),
        ha="right",
        va="bottom",
        fontsize=6.5,
        color=GREY,
    )


LEGEND = "Shaded: detumbling, caging, holding; dotted: first closed instant; dashed: arms locked; triangles: touches."
"""What the marks of the plots mean."""


def largest_rotation(curves: RunCurves) -> float:
    """The base's angle where it is largest, with its sign [rad]."""
    attitude = curves.attitude[np.isfinite(curves.attitude)]
    return float(attitude[np.argmax(np.abs(attitude))])


def instants(outcome: Outcome | None, end: float, start: float, most: int) -> Sequence[tuple[float, str]]:
    """Moments worth a drawing, in their order [s], each with what happens then; the most telling ones."""
    found = [(end, "end")] if outcome is None else [(end, "end"), *_moments(outcome)]
    kept: list[tuple[float, str]] = []
    for time, words in [(start, "start"), *found]:
        if len(kept) < most and all(abs(time - other) > APART for other, _ in kept):
            kept.append((time, words))
    return sorted(kept)


APART = 0.12
"""Two drawings closer than this are one [s]."""


def _moments(outcome: Outcome) -> list[tuple[float, str]]:
    hardest = max(outcome.contacts, key=lambda touch: touch.peak, default=None)
    first = outcome.contacts[0] if outcome.contacts else None
    return [
        *([(first.start, f"{first.arm} hand touches")] if first else []),
        *([(outcome.closed_at, "first closed instant")] if outcome.closed_at is not None else []),
        *([(hardest.start, f"hardest touch, {hardest.peak:.2f} N")] if hardest else []),
        *([(outcome.locked_at, "arms locked")] if outcome.locked_at is not None else []),
        *((touch.start, f"{touch.arm} hand touches") for touch in outcome.contacts[1:]),
    ]
