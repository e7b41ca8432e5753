"""How every figure of the report looks: type, colours, signs, and how it is written to disk, always the same bytes."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sim.snapshot import OutcomeClass

INK, GREY, PALE = "#1b1f24", "#6b7280", "#d5d9df"
LEFT, RIGHT, TARGET, BASE = "#0072B2", "#D55E00", "#1b1f24", "#009E73"
AUTHORS = "#CC79A7"

_LOOK: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 8.0,
    "axes.titlesize": 8.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 8.0,
    "axes.edgecolor": GREY,
    "axes.linewidth": 0.7,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "text.color": INK,
    "xtick.color": GREY,
    "ytick.color": GREY,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "lines.linewidth": 1.1,
    "legend.frameon": False,
    "legend.fontsize": 7.5,
    "hatch.linewidth": 0.5,
    "figure.constrained_layout.use": True,
    "svg.hashsalt": "becalm",
    "svg.fonttype": "path",
    "path.simplify_threshold": 0.3,
}


class OutcomeMark(NamedTuple):
    """How an outcome class is shown: a colour, and a sign for who does not see the colour."""

    colour: str
    sign: str
    words: str
    hatch: str = ""


MARKS = {
    OutcomeClass.CAGED_FORCE_REDUCED: OutcomeMark("#009E73", "R", "caged, force reduced"),
    OutcomeClass.CAGED_FORCE_NOT_REDUCED: OutcomeMark("#56B4E9", "N", "caged, force not reduced"),
    OutcomeClass.CAGED_UNPLANNED_CONTACT: OutcomeMark("#F0E442", "U", "caged, unplanned contact"),
    OutcomeClass.EJECTION: OutcomeMark("#CC79A7", "E", "ejection", "////"),
    OutcomeClass.BASE_COLLISION: OutcomeMark("#D55E00", "B", "base collision", "////"),
    OutcomeClass.UNRESOLVED: OutcomeMark("#B8BDC6", "?", "unresolved", "...."),
}


class Picture(NamedTuple):
    """A figure as files."""

    svg: bytes
    png: bytes


@contextmanager
def look() -> Iterator[None]:
    """Everything drawn within looks like the report."""
    with mpl.rc_context(_LOOK):
        yield


def figure(width: float, height: float) -> Figure:
    """An empty figure of that size [inch], which no window knows."""
    return Figure(figsize=(width, height))


def picture(drawn: Figure) -> Picture:
    """The figure as SVG and PNG, without a date and with the same identifiers each time."""
    svg, png = io.BytesIO(), io.BytesIO()
    drawn.savefig(svg, format="svg", metadata={"Date": None, "Creator": "Becalm"})
    drawn.savefig(png, format="png", dpi=160, metadata={"Software": "Becalm"})
    return Picture(svg.getvalue(), png.getvalue())


def annotate_level(axes: Axes, value: float, words: str, colour: str = GREY) -> None:
    """A thin level across the axes with its name at the left end."""
    axes.axhline(value, color=colour, linewidth=0.7, linestyle=(0, (4, 3)), zorder=1)
    axes.annotate(
        words, (0.02, value), xycoords=("axes fraction", "data"), ha="left", va="bottom", fontsize=6.8, color=colour
    )
