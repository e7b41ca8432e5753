"""The report of a fit: one page, or PDF, that needs nothing else; figures of both are drawn by matplotlib."""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure

from server.versions import becalm_version
from sim.identification.result import ChannelResidual, FitResult, FittedParameter

_INK, _GREY, _FITTED, _NOMINAL, _MEASURED = "#1b1f24", "#6b7280", "#0072B2", "#D55E00", "#1b1f24"
_LOOK: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 8.0,
    "axes.titlesize": 8.5,
    "axes.titlelocation": "left",
    "axes.edgecolor": _GREY,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "lines.linewidth": 0.9,
    "legend.frameon": False,
    "svg.hashsalt": "becalm",
    "svg.fonttype": "none",
    "figure.constrained_layout.use": True,
}
_PAGE = (8.27, 11.69)
"""Of the PDF: A4 [inch]."""
_WIDTH = 7.2
_COLUMNS = 3
"""Of residual plots."""


def html(result: FitResult) -> bytes:
    """The page: values, what is not told, the miss, peak forces, residuals; figures are in it."""
    environment = Environment(
        loader=PackageLoader("server.fits"), undefined=StrictUndefined, autoescape=select_autoescape(["j2"])
    )
    environment.filters["number"], environment.filters["sharp"] = number, sharp
    drawn = {name: _svg(figure) for name, figure in figures(result).items()}
    page = environment.get_template("report.html.j2")
    return page.render(result=result, figures=drawn, version=becalm_version()).encode()


def pdf(result: FitResult) -> bytes:
    """The same as PDF, A4."""
    buffer = io.BytesIO()
    with mpl.rc_context(_LOOK), PdfPages(buffer, metadata={"Title": _title(result)}) as pages:
        for page in (*_text_pages(result), *figures(result).values()):
            pages.savefig(page)
    return buffer.getvalue()


def figures(result: FitResult) -> dict[str, Figure]:
    """Every figure by name, in order; those that there is nothing for are left out."""
    with mpl.rc_context(_LOOK):
        drawn = {"miss": _miss(result), "peaks": _peaks(result), "correlations": _correlations(result)}
        found = {name: figure for name, figure in drawn.items() if figure is not None}
        for run in result.runs:
            channels = [each for each in result.channels if each.run == run]
            if channels:
                found[f"residuals_{run}"] = _residuals(run, channels)
        return found


def number(value: float | None, digits: int = 4) -> str:
    """A value as it is read; a dash for none."""
    return "–" if value is None else f"{value:.{digits}g}"


def sharp(value: float | None, error: float | None) -> str:
    """A value with as many digits as its error leaves sense in, three at least."""
    if value is None or not error or not value:
        return number(value)
    return number(value, min(9, max(3, 2 + math.floor(math.log10(abs(value))) - math.floor(math.log10(error)))))


def _title(result: FitResult) -> str:
    return f"Fit of {', '.join(result.runs)}"


def _svg(figure: Figure) -> str:
    text = io.StringIO()
    with mpl.rc_context(_LOOK):
        figure.savefig(text, format="svg", metadata={"Date": None})
    content = text.getvalue()
    return content[content.index("<svg") :]


def _miss(result: FitResult) -> Figure | None:
    """The miss as a waterfall from what the nominal model foretells to what was measured."""
    miss = result.miss
    if miss is None:
        return None
    names = ["nominal", *(each.name for each in miss.parts), "unexplained", "measured"]
    figure = Figure((_WIDTH, 0.6 + 0.24 * len(names)))
    axes = figure.subplots()
    level = miss.nominal
    axes.barh(0, miss.nominal, color=_GREY)
    for place, part in enumerate([*(each.part for each in miss.parts), miss.unexplained], 1):
        axes.barh(place, part, left=level, color=_FITTED if part >= 0.0 else _NOMINAL)
        axes.text(max(level, level + part), place, f" {part:+.3g}", va="center", fontsize=7)
        level += part
    axes.barh(len(names) - 1, miss.measured, color=_MEASURED)
    axes.set_yticks(range(len(names)), names)
    axes.invert_yaxis()
    axes.set_xlabel("peak force [N]")
    axes.set_title(f"Touch at {miss.time:.2f} s of run {miss.run}, {miss.arm} hand")
    return figure


def _peaks(result: FitResult) -> Figure | None:
    """Foretold over measured."""
    kinds = ((result.touch_predictions, "fitted runs", "o"), (result.held_out_predictions, "held out", "s"))
    if not any(touches for touches, _, _ in kinds):
        return None
    figure = Figure((_WIDTH / 2, _WIDTH / 2))
    axes = figure.subplots()
    most = 0.0
    for touches, words, marker in kinds:
        for values, colour, name in (
            ([each.nominal for each in touches], _NOMINAL, "nominal"),
            ([each.fitted for each in touches], _FITTED, "fitted"),
        ):
            if touches:
                measured = [each.measured for each in touches]
                axes.plot(measured, values, marker, color=colour, ms=4, label=f"{name}, {words}", alpha=0.8)
                most = max(most, *measured, *values)
    axes.plot([0.0, most], [0.0, most], color=_GREY, lw=0.7)
    axes.set_xlabel("measured [N]")
    axes.set_ylabel("foretold [N]")
    axes.set_title("Peak force of each touch")
    axes.legend()
    return figure


def _correlations(result: FitResult) -> Figure | None:
    told = [each.name for each in result.parameters if each.told]
    if len(told) < 2:
        return None
    known = {(each.first, each.second): each.correlation for each in result.correlations}
    table = [[1.0 if a == b else known.get((a, b), known.get((b, a), 0.0)) for b in told] for a in told]
    side = 1.8 + 0.36 * len(told)
    figure = Figure((min(_WIDTH, side + 1.2), min(_WIDTH, side)))
    axes = figure.subplots()
    axes.imshow(table, cmap="RdBu", vmin=-1.0, vmax=1.0)
    for row, values in enumerate(table):
        for column, value in enumerate(values):
            colour = "white" if abs(value) > 0.6 else _INK
            axes.text(column, row, f"{value:+.2f}", ha="center", va="center", fontsize=6, color=colour)
    axes.set_xticks(range(len(told)), told, rotation=45, ha="right", fontsize=6.5)
    axes.set_yticks(range(len(told)), told, fontsize=6.5)
    axes.set_title("Correlations of the errors")
    return figure


def _residuals(run: str, channels: Sequence[ChannelResidual]) -> Figure:
    """Measured less fitted, a plot for each reading, with two standard deviations either way."""
    rows = -(-len(channels) // _COLUMNS)
    figure = Figure((_WIDTH, 0.3 + 1.25 * rows))
    grid = figure.subplots(rows, _COLUMNS, squeeze=False)
    figure.suptitle(f"What is left: measured less fitted, run {run}", x=0.01, ha="left", fontsize=9)
    for axes, each in zip(grid.flat, channels, strict=False):
        left = [m - p for m, p in zip(each.measured, each.predicted, strict=True)]
        axes.plot(each.time, left, ".", ms=1.5, color=_FITTED)
        axes.axhspan(-2.0 * each.deviation, 2.0 * each.deviation, color=_GREY, alpha=0.15, lw=0)
        axes.set_title(f"{each.name} [{each.unit}]")
        axes.ticklabel_format(axis="y", scilimits=(-2, 3))
    for axes in list(grid.flat)[len(channels) :]:
        axes.set_axis_off()
    return figure


def _text_pages(result: FitResult) -> list[Figure]:
    """Title, values, what is not told, peaks, notices, as pages of lines."""
    lines = [
        (_title(result), 13.0),
        (f"Becalm {becalm_version()}; {result.rows} ticks in {result.stretches} stretches, {result.touches} of them "
         f"with a touch; {result.wall_time:.1f} s", 8.0),
        ("", 8.0),
        ("Values, with 95 % intervals", 10.0),
        *((_value_words(each), 7.5) for each in result.parameters),
        *(((("", 8.0)), ("What the runs do not tell, or only together", 10.0)) if result.indistinct else ()),
        *((each, 7.5) for each in result.indistinct),
        *((("", 8.0), ("The miss", 10.0), (result.miss.words, 7.5)) if result.miss else ()),
        ("", 8.0),
        ("Peak forces, measured / nominal / fitted [N]", 10.0),
        *((f"{each.run}, {each.time:.2f} s, {each.arm}{held}: {each.measured:.3g} / {each.nominal:.3g} / "
           f"{each.fitted:.3g}", 7.5)
          for touches, held in ((result.touch_predictions, ""), (result.held_out_predictions, ", held out"))
          for each in touches),
        *((("", 8.0), ("Notices", 10.0)) if result.notices else ()),
        *((each, 7.5) for each in result.notices),
    ]  # fmt: skip
    wrapped = [(part, size) for text, size in lines for part in _wrapped(text)]
    per_page = 62
    return [_text_page(wrapped[start : start + per_page]) for start in range(0, len(wrapped), per_page)]


def _wrapped(text: str, width: int = 118) -> list[str]:
    found, line = [], ""
    for word in text.split(" "):
        if line and len(line) + 1 + len(word) > width:
            found.append(line)
            line = "    " + word
        else:
            line = f"{line} {word}" if line else word
    return [*found, line]


def _text_page(lines: Sequence[tuple[str, float]]) -> Figure:
    figure = Figure(_PAGE)
    for place, (text, size) in enumerate(lines):
        weight = "bold" if size > 9.0 else "normal"
        figure.text(0.07, 0.95 - 0.0148 * place, text, fontsize=size, fontweight=weight, parse_math=False)
    return figure


def _value_words(each: FittedParameter) -> str:
    unit = "" if each.unit == "1" else f" {each.unit}"
    if each.low is None or each.high is None:
        return f"{each.name}: {number(each.value)}{unit}, nominal: not told"
    return (
        f"{each.name}: {sharp(each.value, each.standard_error)}{unit} ({sharp(each.low, each.standard_error)} to "
        f"{sharp(each.high, each.standard_error)}), nominal {number(each.nominal)}"
    )
