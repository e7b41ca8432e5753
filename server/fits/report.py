"""What a report says of a fit: values with intervals, the miss taken apart, peak forces, what is left of readings."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import partial

from matplotlib.figure import FigureBase

from server.reports.blocks import Block, Column, Document, Drawing, Heading, Table, Words, number
from server.reports.style import GREY, INK, LEFT, RIGHT
from server.versions import becalm_version
from sim.identification.result import ChannelResidual, FitResult, FittedParameter, Miss, TouchPrediction

_FITTED, _NOMINAL, _MEASURED = LEFT, RIGHT, INK
_WIDTH = 7.2
_COLUMNS = 3
"""Of residual plots."""


def fit_document(result: FitResult) -> Document:
    """The report of a fit."""
    held = f"; held out: {', '.join(result.held_out)}" if result.held_out else ""
    return Document(
        title=f"Fit of {', '.join(result.runs)}",
        subtitle=f"Becalm {becalm_version()}; {result.rows} ticks in {result.stretches} stretches, {result.touches} of "
        f"them with a touch; {result.wall_time:.1f} s{held}",
        blocks=(
            Heading("Values"),
            _values(result.parameters),
            *_indistinct(result),
            *_miss(result.miss),
            *_touches(result),
            *_correlated(result),
            *_left(result),
            *([Heading("Notices"), *map(Words, result.notices)] if result.notices else ()),
        ),
    )


def sharp(value: float | None, error: float | None) -> str:
    """A value with as many digits as its error leaves sense in, three at least."""
    if value is None or not error or not value:
        return number(value)
    return number(value, min(9, max(3, 2 + math.floor(math.log10(abs(value))) - math.floor(math.log10(error)))))


def _values(parameters: Sequence[FittedParameter]) -> Table:
    titles = ("Nominal", "Fitted", "Standard error", "95 % interval")
    columns = (Column("Parameter"), *(Column(title, True) for title in titles), Column("Unit"), Column("What it is"))
    return Table(columns, [_value_row(each) for each in parameters])


def _value_row(each: FittedParameter) -> tuple[str, ...]:
    if each.told:
        error = each.standard_error
        fitted = (sharp(each.value, error), number(error, 2), f"{sharp(each.low, error)} to {sharp(each.high, error)}")
    else:
        fitted = ("not told", number(None), number(None))
    return (each.name, number(each.nominal), *fitted, each.unit, each.description)


def _indistinct(result: FitResult) -> Iterator[Block]:
    if result.indistinct:
        yield Heading("What the runs do not tell, or only together")
        yield from map(Words, result.indistinct)


def _miss(miss: Miss | None) -> Iterator[Block]:
    if miss is None:
        return
    yield Heading("The miss, taken apart")
    yield Words(f"{miss.words[:1].upper()}{miss.words[1:]}.")
    height = 0.6 + 0.24 * (len(miss.parts) + 3)
    yield Drawing(_WIDTH, height, partial(_draw_miss, miss), miss.words)
    yield Words(
        "Each part is the parameter's Shapley value: its mean share over all orders of putting parameters right.",
        quiet=True,
    )


def _draw_miss(miss: Miss, figure: FigureBase) -> None:
    """The miss as a waterfall from what the nominal model foretells to what was measured."""
    names = ["nominal", *(each.name for each in miss.parts), "unexplained", "measured"]
    axes = figure.subplots()
    level = miss.nominal
    axes.barh(0, miss.nominal, color=GREY)
    for place, part in enumerate([*(each.part for each in miss.parts), miss.unexplained], 1):
        axes.barh(place, part, left=level, color=_FITTED if part >= 0.0 else _NOMINAL)
        axes.text(max(level, level + part), place, f" {part:+.3g}", va="center", fontsize=7)
        level += part
    axes.barh(len(names) - 1, miss.measured, color=_MEASURED)
    axes.set_yticks(range(len(names)), names)
    axes.invert_yaxis()
    axes.set_xlabel("peak force [N]")
    axes.set_title(f"Touch at {miss.time:.2f} s of run {miss.run}, {miss.arm} hand")


def _touches(result: FitResult) -> Iterator[Block]:
    told, held = result.touch_predictions, result.held_out_predictions
    if not told and not held:
        return
    yield Heading("Peak forces")
    titles = ("Measured, N", "Nominal, N", "Fitted, N")
    columns = (Column("Run"), Column("Touch, s", True), Column("Hand"), *(Column(title, True) for title in titles))
    yield Table(
        columns, [*(_touch_row(each, "") for each in told), *(_touch_row(each, " (held out)") for each in held)]
    )
    yield Words("Foretold from the free flight before the touch and the commands alone.", quiet=True)
    yield Drawing(_WIDTH / 2, _WIDTH / 2, partial(_draw_peaks, result), "Foretold over measured peak forces")


def _touch_row(each: TouchPrediction, which: str) -> tuple[str, ...]:
    forces = (number(force, 3) for force in (each.measured, each.nominal, each.fitted))
    return (f"{each.run}{which}", f"{each.time:.2f}", each.arm, *forces)


def _draw_peaks(result: FitResult, figure: FigureBase) -> None:
    """Foretold over measured."""
    axes = figure.subplots()
    most = 0.0
    kinds = ((result.touch_predictions, "fitted runs", "o"), (result.held_out_predictions, "held out", "s"))
    for touches, words, marker in kinds:
        for values, colour, name in (
            ([each.nominal for each in touches], _NOMINAL, "nominal"),
            ([each.fitted for each in touches], _FITTED, "fitted"),
        ):
            if touches:
                measured = [each.measured for each in touches]
                axes.plot(measured, values, marker, color=colour, ms=4, label=f"{name}, {words}", alpha=0.8)
                most = max(most, *measured, *values)
    axes.plot([0.0, most], [0.0, most], color=GREY, lw=0.7)
    axes.set(xlabel="measured [N]", ylabel="foretold [N]", title="Peak force of each touch")
    axes.legend()


def _correlated(result: FitResult) -> Iterator[Block]:
    told = [each.name for each in result.parameters if each.told]
    if len(told) < 2:
        return
    side = 1.8 + 0.36 * len(told)
    yield Heading("Correlations of the errors")
    yield Drawing(
        min(_WIDTH, side + 1.2), min(_WIDTH, side), partial(_draw_correlations, result, told), "Correlations of errors"
    )


def _draw_correlations(result: FitResult, told: Sequence[str], figure: FigureBase) -> None:
    known = {(each.first, each.second): each.correlation for each in result.correlations}
    table = [[1.0 if a == b else known.get((a, b), known.get((b, a), 0.0)) for b in told] for a in told]
    axes = figure.subplots()
    axes.imshow(table, cmap="RdBu", vmin=-1.0, vmax=1.0)
    for row, values in enumerate(table):
        for column, value in enumerate(values):
            colour = "white" if abs(value) > 0.6 else INK
            axes.text(column, row, f"{value:+.2f}", ha="center", va="center", fontsize=6, color=colour)
    axes.set_xticks(range(len(told)), told, rotation=45, ha="right", fontsize=6.5)
    axes.set_yticks(range(len(told)), told, fontsize=6.5)


def _left(result: FitResult) -> Iterator[Block]:
    """What is left of each reading."""
    titles = ("Nominal, rms", "Fitted, rms", "Its deviation")
    yield Heading("What is left of the readings")
    yield Table(
        (Column("Run"), Column("Reading"), *(Column(title, True) for title in titles), Column("Unit")),
        [
            (
                each.run,
                each.name,
                number(each.rms_nominal, 3),
                number(each.rms, 3),
                number(each.deviation, 3),
                each.unit,
            )
            for each in result.channels
        ],
    )
    for run in result.runs:
        channels = [each for each in result.channels if each.run == run]
        if channels:
            height = 0.3 + 1.25 * -(-len(channels) // _COLUMNS)
            yield Drawing(_WIDTH, height, partial(_draw_residuals, run, channels), f"Residuals of run {run}")


def _draw_residuals(run: str, channels: Sequence[ChannelResidual], figure: FigureBase) -> None:
    """Measured less fitted, a plot for each reading, with two standard deviations either way."""
    grid = figure.subplots(-(-len(channels) // _COLUMNS), _COLUMNS, squeeze=False)
    figure.suptitle(f"What is left: measured less fitted, run {run}", x=0.01, ha="left", fontsize=9)
    for axes, each in zip(grid.flat, channels, strict=False):
        left = [m - p for m, p in zip(each.measured, each.predicted, strict=True)]
        axes.plot(each.time, left, ".", ms=1.5, color=_FITTED)
        axes.axhspan(-2.0 * each.deviation, 2.0 * each.deviation, color=GREY, alpha=0.15, lw=0)
        axes.set_title(f"{each.name} [{each.unit}]")
        axes.ticklabel_format(axis="y", scilimits=(-2, 3))
    for axes in list(grid.flat)[len(channels) :]:
        axes.set_axis_off()
