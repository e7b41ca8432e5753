"""The figures of a study's report: how often each class came, maps over its grid, scatter of its draws."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import FigureBase
from matplotlib.patches import Patch

from server.reports.blocks import Drawing
from server.reports.study_cells import CLASSES, NO_CLASS, Axis, Spread, StudyCells
from server.reports.style import GREY, INK, MARKS, PALE
from sim.snapshot import OutcomeClass
from sim.study.axes import Value, parameter_words
from sim.study.outcome_frequencies import OutcomeFrequency

ACROSS = 4
"""Panels beside one another, at most."""
WIDTH = 7.2
"""Of a figure [inch]."""
MOST_PANELS = 8
"""Further values of that axis are left out."""
MOST_TICKS = 8
"""Values that an axis names."""

_COLOURS = ListedColormap([MARKS[each].colour for each in CLASSES]).with_extremes(bad=PALE)
_NORM = BoundaryNorm(np.arange(-0.5, len(CLASSES) + 0.5), len(CLASSES))


class Shown(NamedTuple):
    """A measure as it is drawn."""

    name: str
    title: str
    unit: str
    factor: float = 1.0
    """From SI to the unit."""


SHOWN = (
    Shown("peak_tip_force", "Peak tip force", "N"),
    Shown("cage_margin", "Cage margin", "mm", 1e3),
    Shown("base_turn", "Rotation of the base", "deg", math.degrees(1.0)),
    Shown("min_manipulability", "Least manipulability", "10⁻³ m²", 1e3),
)
"""The measures that have a map or a scatter of their own."""


def axis_title(path: str) -> str:
    """A varied parameter by the end of its path, with its unit."""
    unit = parameter_words(path)[0]
    name = " ".join(path.split(".")[-2:]).replace("_", " ")
    return name if unit == "1" else f"{name}, {unit}"


def odds(frequencies: Sequence[OutcomeFrequency]) -> Drawing:
    """How often each class came, with its interval where the cells are a sample."""

    def draw(figure: FigureBase) -> None:
        axes = figure.subplots()
        for place, each in enumerate(frequencies):
            axes.barh(place, 100 * each.share, color=MARKS[OutcomeClass(each.outcome)].colour, height=0.7)
            if each.low is not None and each.high is not None:
                axes.plot([100 * each.low, 100 * each.high], [place, place], color=INK, lw=1.2, marker="|", ms=5)
        names = [f"{MARKS[OutcomeClass(each.outcome)].words} ({each.cells})" for each in frequencies]
        axes.set_yticks(range(len(frequencies)), names)
        axes.invert_yaxis()
        axes.set(xlim=(0.0, 100.0), xlabel="% of the cells that have an outcome")

    words = "; ".join(f"{each.outcome}: {100 * each.share:.1f} %" for each in frequencies)
    return Drawing(WIDTH, 0.55 + 0.2 * len(frequencies), draw, words)


def class_map(cells: StudyCells, spread: Spread, name: str, title: str) -> Drawing:
    """Outcome classes over the grid; of several draws at a place the most frequent one."""
    panels = cells.class_panels(name, spread)

    def fill(axes: Axes, values: np.ndarray) -> None:
        axes.imshow(np.ma.masked_equal(values, NO_CLASS), cmap=_COLOURS, norm=_NORM, origin="lower", aspect="auto")
        _letters(axes, values)

    present = cells.occurring(name)
    handles = [Patch(facecolor=MARKS[e].colour, label=f"{MARKS[e].sign}  {MARKS[e].words}") for e in present]

    def finish(figure: FigureBase, _: Sequence[Axes]) -> None:
        figure.legend(handles=handles, loc="outside lower center", ncols=min(3, max(1, len(handles))), handlelength=1.1)

    return _panels(spread, panels, fill, finish, title, extra=0.2 * math.ceil(len(handles) / 3))


def _letters(axes: Axes, values: np.ndarray) -> None:
    """The sign of each class, for who does not tell the colours apart, where there is room."""
    if max(values.shape) > 16:
        return
    for (row, column), place in np.ndenumerate(values):
        if place != NO_CLASS:
            sign = MARKS[CLASSES[int(place)]].sign
            axes.text(column, row, sign, ha="center", va="center", fontsize=4.6, color=INK)


def number_map(cells: StudyCells, spread: Spread, values: np.ndarray, shown: Shown) -> Drawing:
    """A measure over the grid; of several draws at a place their mean."""
    panels = shown.factor * cells.panels(values, spread)
    low, high = _span(panels)

    def fill(axes: Axes, of_panel: np.ndarray) -> None:
        axes.imshow(of_panel, cmap="cividis", vmin=low, vmax=high, origin="lower", aspect="auto")
        axes.set_facecolor(PALE)

    def finish(figure: FigureBase, grid: Sequence[Axes]) -> None:
        bar = figure.colorbar(grid[0].images[0], ax=list(grid), shrink=0.9, pad=0.01)
        bar.set_label(shown.unit)

    return _panels(spread, panels, fill, finish, shown.title)


def _span(values: np.ndarray) -> tuple[float, float]:
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
    return (low, high) if high > low else (low - 0.5, high + 0.5)


def _panels(
    spread: Spread,
    panels: np.ndarray,
    fill: Callable[[Axes, np.ndarray], None],
    finish: Callable[[FigureBase, Sequence[Axes]], None],
    title: str,
    extra: float = 0.0,
) -> Drawing:
    """A row of panels, or several; all alike."""
    shown = panels[:MOST_PANELS]
    across = min(ACROSS, len(shown))
    rows = math.ceil(len(shown) / across)

    def draw(figure: FigureBase) -> None:
        grid = figure.subplots(rows, across, squeeze=False, sharex=True, sharey=True)
        flat = [axes for line in grid for axes in line]
        for place, values in enumerate(shown):
            fill(flat[place], values)
            _lay_out(flat[place], spread, place, lowest=place + across >= len(shown), outer=place % across == 0)
        for axes in flat[len(shown) :]:
            axes.set_visible(False)
        flat[0].annotate(title, (0, 1.16), xycoords="axes fraction", fontsize=8.5, fontweight="bold")
        finish(figure, flat[: len(shown)])

    height = rows * (0.9 if spread.y is None else 1.75) + 0.3 + extra
    return Drawing(WIDTH if across > 1 else 0.6 * WIDTH, height, draw, f"{title} over {spread.x.path}")


def _lay_out(axes: Axes, spread: Spread, place: int, *, lowest: bool, outer: bool) -> None:
    axes.set_xticks(*_ticks(spread.x.values))
    axes.tick_params(length=0, labelsize=6.5, labelbottom=lowest)
    if lowest:
        axes.set_xlabel(axis_title(spread.x.path), fontsize=7)
    if spread.y is None:
        axes.set_yticks([])
    else:
        axes.set_yticks(*_ticks(spread.y.values))
        if outer:
            axes.set_ylabel(axis_title(spread.y.path), fontsize=7)
    if spread.panels is not None:
        value = spread.panels.values[place]
        name = spread.panels.path.split(".")[-1].replace("_", " ")
        axes.set_title(f"{name} {_words(value)}", fontsize=7.5, fontweight="normal")


def _ticks(values: Sequence[Value]) -> tuple[list[int], list[str]]:
    every = math.ceil(len(values) / MOST_TICKS)
    places = list(range(0, len(values), every))
    return places, [_words(values[place]) for place in places]


def _words(value: Value) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def lines(cells: StudyCells, axis: Axis, shown: Sequence[Shown]) -> Drawing:
    """Measures over the one axis of a grid, each cell in the colour of its class."""
    named = any(isinstance(value, str) for value in axis.values)
    places = np.arange(len(axis.values), dtype=float) if named else np.array(axis.values, dtype=float)
    across = np.repeat(places, cells.study.count // len(axis.values))

    def draw(figure: FigureBase) -> None:
        for axes, each in zip(figure.subplots(1, len(shown), squeeze=False)[0], shown, strict=True):
            _dots(axes, cells, across, each)
            if named:
                axes.set_xticks(*_ticks(axis.values))
            axes.set_xlabel(axis_title(axis.path))

    return Drawing(WIDTH, 2.0, draw, f"Measures over {axis.path}")


def scatter(cells: StudyCells, paths: Sequence[str], shown: Shown) -> Drawing:
    """A measure over each drawn parameter, each draw in the colour of its class."""

    def draw(figure: FigureBase) -> None:
        grid = figure.subplots(1, len(paths), squeeze=False, sharey=True)[0]
        for axes, path in zip(grid, paths, strict=True):
            _dots(axes, cells, cells.numbers(path), shown)
            axes.set_xlabel(axis_title(path))
            axes.set_title("")
        for axes in grid[1:]:
            axes.set_ylabel("")
        grid[0].set_title(shown.title)

    return Drawing(WIDTH, 1.9, draw, f"{shown.title} over {', '.join(paths)}")


def _dots(axes: Axes, cells: StudyCells, across: np.ndarray, shown: Shown) -> None:
    values, classes = shown.factor * cells.numbers(shown.name), cells.classes("outcome")
    for place, each in enumerate(CLASSES):
        of_it = classes == place
        if of_it.any():
            axes.plot(across[of_it], values[of_it], "o", ms=2.4, mew=0, alpha=0.8, color=MARKS[each].colour)
    axes.set(title=shown.title, ylabel=shown.unit)


def distribution(cells: StudyCells, shown: Sequence[Shown]) -> Drawing:
    """How each measure is spread over the cells."""

    def draw(figure: FigureBase) -> None:
        for axes, each in zip(figure.subplots(1, len(shown), squeeze=False)[0], shown, strict=True):
            values = each.factor * cells.numbers(each.name)
            axes.hist(values[np.isfinite(values)], bins=24, color=GREY)
            axes.set(title=each.title, xlabel=each.unit, yticks=[])

    return Drawing(WIDTH, 1.5, draw, "Distributions of " + ", ".join(each.title for each in shown))
