"""The outcome maps: one square a cell of the study, class by class beside the published tables, or a quantity."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from server.reports.style import GREY, INK, MARKS, PALE, figure
from sim.reproduction.experiments import impedance_of
from sim.reproduction.published import DAMPING, MASS, STIFFNESS, PublishedImpedance, published_classes
from sim.snapshot import OutcomeClass
from sim.study.capture_metrics import ContactStage
from sim.study.run import Row

_SIGNS = {ContactStage.TOUCH: "T", ContactStage.CLOSING: "C", ContactStage.AFTER_CLOSURE: "A"}
_DARK_ABOVE = 0.55  # of the colour map: signs on darker cells are white


def beside_published(rows: Sequence[Row]) -> Figure:
    """Ours above, the paper's below where Becalm has it; cells that differ are framed."""
    masses = _levels(rows, MASS)
    printed = published_classes()
    ours = {impedance_of(row): str(row["at_first_closure"]) for row in rows}
    drawn = figure(7.4, 4.5)
    grid = drawn.subplots(2, len(masses), sharex=True, sharey=True, squeeze=False)
    for column, mass in enumerate(masses):
        above, below = grid[0, column], grid[1, column]
        _lay_out(above, rows, f"m = {mass:g} kg", outer=column == 0, lowest=False)
        _classes(above, ours, mass)
        theirs = {place: printed[place] for place in ours if place.mass == mass and place in printed}
        _lay_out(below, rows, "", outer=column == 0, lowest=True)
        if not theirs:
            below.text(0.5, 0.5, "no published table", transform=below.transAxes, ha="center", color=GREY, fontsize=7.5)
        _classes(below, theirs, mass)
        for place, printed_class in theirs.items():
            if ours[place] != printed_class:
                for axes in (above, below):
                    _square(axes, rows, place, facecolor="none", edgecolor=INK, linewidth=1.6, zorder=5)
    grid[0, 0].annotate("Becalm", (0, 1.16), xycoords="axes fraction", fontsize=8.5, color=GREY)
    grid[1, 0].annotate("the paper", (0, 1.04), xycoords="axes fraction", fontsize=8.5, color=GREY)
    _class_legend(drawn, {*ours.values(), *printed.values()})
    return drawn


def classes_of(rows: Sequence[Row], judged: str) -> Figure:
    """One row of maps by that judgement (a column of the table)."""
    masses = _levels(rows, MASS)
    ours = {impedance_of(row): str(row[judged]) for row in rows}
    drawn = figure(7.4, 2.55)
    grid = drawn.subplots(1, len(masses), sharex=True, sharey=True, squeeze=False)
    for column, mass in enumerate(masses):
        _lay_out(grid[0, column], rows, f"m = {mass:g} kg", outer=column == 0, lowest=True)
        _classes(grid[0, column], ours, mass)
    _class_legend(drawn, set(ours.values()))
    return drawn


def peaks(rows: Sequence[Row], bound: float) -> Figure:
    """Largest force of the whole sequence, and the stage it fell into."""
    masses = _levels(rows, MASS)
    drawn = figure(7.4, 2.65)
    grid = drawn.subplots(1, len(masses), sharex=True, sharey=True, squeeze=False)
    forces = np.array([row["peak_tip_force"] for row in rows])
    top = float(np.quantile(forces, 0.98))
    mesh = None
    for column, mass in enumerate(masses):
        axes = grid[0, column]
        _lay_out(axes, rows, f"m = {mass:g} kg", outer=column == 0, lowest=True)
        own = {(row[DAMPING], row[STIFFNESS]): row for row in rows if row[MASS] == mass}
        dampings, stiffnesses = _levels(rows, DAMPING), _levels(rows, STIFFNESS)
        table = np.array([[own[d, k]["peak_tip_force"] for d in dampings] for k in stiffnesses])
        mesh = axes.imshow(table, origin="lower", cmap="cividis_r", vmin=0.0, vmax=top, aspect="auto", rasterized=False)
        for (d, k), row in own.items():
            sign = _SIGNS.get(row["peak_stage"], "")
            colour = "white" if row["peak_tip_force"] / top > _DARK_ABOVE else INK
            place = (dampings.index(d), stiffnesses.index(k))
            axes.text(*place, sign, ha="center", va="center", fontsize=4.6, color=colour)
    assert mesh is not None
    bar = drawn.colorbar(mesh, ax=grid[0, :], shrink=0.9, pad=0.01, extend="max")
    bar.set_label("largest hand force, N")
    bar.ax.axhline(bound, color=INK, linewidth=1.0)
    drawn.legend(
        handles=[Patch(facecolor="none", edgecolor="none", label=words) for words in (
            "T  in a touch", "C  while closing", "A  after the first closed instant")],
        loc="outside lower center", ncols=3, handlelength=0,
    )  # fmt: skip
    return drawn


def _levels(rows: Sequence[Row], path: str) -> list[float]:
    return sorted({row[path] for row in rows})


def _lay_out(axes: Axes, rows: Sequence[Row], title: str, *, outer: bool, lowest: bool) -> None:
    """Axes whose unit squares are cells: damping to the right, stiffness upwards."""
    dampings, stiffnesses = _levels(rows, DAMPING), _levels(rows, STIFFNESS)
    axes.set(xlim=(-0.5, len(dampings) - 0.5), ylim=(-0.5, len(stiffnesses) - 0.5), title=title)
    every = 2 if len(dampings) > 6 else 1
    axes.set_xticks(range(0, len(dampings), every), [f"{value:g}" for value in dampings[::every]])
    axes.set_yticks(range(0, len(stiffnesses), every), [f"{value:g}" for value in stiffnesses[::every]])
    axes.tick_params(length=0, labelsize=6.8)
    for spine in axes.spines.values():
        spine.set(visible=True, color=PALE)
    if lowest:
        axes.set_xlabel("d, N s/m", fontsize=7.5)
    if outer:
        axes.set_ylabel("k, N/m", fontsize=7.5)


def _classes(axes: Axes, classes: Mapping[PublishedImpedance, str], mass: float) -> None:
    places = [place for place in classes if place.mass == mass]
    dampings = sorted({place.damping for place in places})
    stiffnesses = sorted({place.stiffness for place in places})
    squares: dict[str, list[Rectangle]] = {}
    for place in places:
        x, y = dampings.index(place.damping), stiffnesses.index(place.stiffness)
        squares.setdefault(classes[place], []).append(Rectangle((x - 0.5, y - 0.5), 1, 1))
    for outcome, of_it in squares.items():
        mark = MARKS[OutcomeClass(outcome)]
        axes.add_collection(
            PatchCollection(of_it, facecolor=mark.colour, edgecolor="white", linewidth=0.5, hatch=mark.hatch or None)
        )
        corners = np.array([square.get_xy() for square in of_it]) + 0.5
        axes.plot(*corners.T, linestyle="", marker=f"$\\mathrm{{{mark.sign}}}$", markersize=3.4, color=INK, mew=0.0)


def _square(axes: Axes, rows: Sequence[Row], place: PublishedImpedance, **look: object) -> None:
    x = _levels(rows, DAMPING).index(place.damping)
    y = _levels(rows, STIFFNESS).index(place.stiffness)
    axes.add_patch(Rectangle((x - 0.5, y - 0.5), 1, 1, **look))  # type: ignore[arg-type]


def _class_legend(drawn: Figure, present: set[str]) -> None:
    handles = [
        Patch(facecolor=mark.colour, edgecolor="white", hatch=mark.hatch or None, label=f"{mark.sign}  {mark.words}")
        for outcome, mark in MARKS.items()
        if outcome.value in present
    ]
    drawn.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), 5), handlelength=1.1)
