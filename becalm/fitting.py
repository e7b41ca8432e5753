"""`becalm fit`: which numbers explain recorded runs, with errors, and what the runs do not tell."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import click

from server.fits.recorded import preset_of, recorded_plan
from server.fits.report import fit_document, sharp
from server.instants import wall_clock
from server.library.presets import NAME, PresetStore
from server.library.reader import RunReader
from server.reports.blocks import number
from server.reports.formats import written
from sim.errors import ConfigError
from sim.identification.fit import fit
from sim.identification.result import FitResult, FittedParameter, TouchPrediction

WRITERS: dict[str, Callable[[FitResult], bytes]] = {
    ".json": lambda result: result.model_dump_json(indent=1).encode(),
    ".html": lambda result: written(fit_document(result), "html"),
    ".pdf": lambda result: written(fit_document(result), "pdf"),
}
"""By the suffix of the file."""


def require_writable(out: Path | None) -> None:
    """Refuse a file that cannot be written, before anything is fitted.

    Raises:
        ConfigError: its suffix names no format.

    """
    if out is not None and out.suffix not in WRITERS:
        raise ConfigError(f"--out {out}: write a .json, .html or .pdf")


def require_name(keep_as: str | None) -> None:
    """Refuse a name that no preset can have.

    Raises:
        ConfigError: it cannot be one.

    """
    if keep_as is not None and not re.fullmatch(NAME, keep_as):
        raise ConfigError(
            f"--keep-as {keep_as!r}: up to 40 letters, digits, spaces and . + - _, beginning with a letter or digit"
        )


def fitted(
    runs: Sequence[RunReader], names: Sequence[str] | None, held_out: Sequence[RunReader], threads: int | None
) -> FitResult:
    """Fit, with progress on standard error.

    Raises:
        ConfigError: something chosen is out of bounds.
        MissionRefused: nothing can be learnt from a run.

    """
    plan = recorded_plan(runs, names, held_out)
    click.echo("Preparing the simulation (the first time compiles for about half a minute)", err=True)
    result = fit(plan, threads=threads, on_progress=_show_progress())
    if sys.stderr.isatty():
        click.echo("", err=True)
    notices = [notice for each in runs for notice in (*each.record.notices, *each.log_notices)]
    return result.model_copy(update={"notices": [*notices, *result.notices]})


def keep(data: Path, name: str, run: RunReader, result: FitResult) -> None:
    """Keep the run's configuration with the fitted values as a preset of the data folder.

    Raises:
        JobRefused: nothing was found that a preset can keep.

    """
    who = os.environ.get("USER") or "becalm fit"
    PresetStore(data).keep(preset_of(name, run.record, result.preset, who, wall_clock()))


def _show_progress() -> Callable[[float, str], None]:
    rewrites, shown = sys.stderr.isatty(), -1.0

    def show(part: float, words: str) -> None:
        nonlocal shown
        if rewrites:
            click.echo(f"\r{f'{part:4.0%}  {words}':<40}", err=True, nl=False)
        elif part >= shown + 0.1 or part < shown:
            shown = part
            click.echo(f"{part:4.0%}  {words}", err=True)

    return show


def as_text(result: FitResult) -> str:
    """What `becalm fit` prints."""
    lines = [
        f"{', '.join(result.runs)}: {result.rows} ticks in {result.stretches} stretches, {result.touches} of them with "
        f"a touch; {result.wall_time:.1f} s",
        *(f"  {notice}" for notice in result.notices),
        "",
        f"  {'':<34}{'nominal':>12}{'fitted':>12}{'error':>10}   95 % interval",
        *map(_value_line, result.parameters),
    ]
    if result.indistinct:
        lines += ["", *(f"  {each}" for each in result.indistinct)]
    if result.miss is not None:
        lines += ["", f"  Touch at {result.miss.time:.2f} s: {result.miss.words}"]
    if result.touch_predictions or result.held_out_predictions:
        lines += ["", f"  {'peak force [N]':<34}{'measured':>12}{'nominal':>12}{'fitted':>10}"]
        lines += [_touch_line(each, "") for each in result.touch_predictions]
        lines += [_touch_line(each, ", held out") for each in result.held_out_predictions]
    return "\n".join(lines)


def _value_line(each: FittedParameter) -> str:
    name = f"{each.name} [{each.unit}]"
    if not each.told:
        return f"  {name:<34}{number(each.nominal):>12}{'not told':>12}"
    error = each.standard_error
    interval = f"{sharp(each.low, error)} to {sharp(each.high, error)}"
    values = f"{number(each.nominal):>12}{sharp(each.value, error):>12}{number(error, 2):>10}"
    return f"  {name:<34}{values}   {interval}"


def _touch_line(each: TouchPrediction, held: str) -> str:
    what = f"{each.run[-6:]}, {each.time:.2f} s, {each.arm}{held}"
    return f"  {what:<34}{each.measured:>12.3g}{each.nominal:>12.3g}{each.fitted:>10.3g}"
