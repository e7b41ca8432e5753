"""`becalm rehearse`: what a command or an edit would do from a recorded state, with odds, before anything moves."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import click

from server.library.reader import RunReader
from server.rehearsals.recorded import recorded_situation
from sim.configurations import read_config_file
from sim.control.phases import Command
from sim.errors import MissionRefused
from sim.rehearsal.rehearsal import Rehearsal, RehearsalResult, planned, prepare_futures, rehearse
from sim.rehearsal.situation import REQUESTS, Situation
from sim.rehearsal.summary import Band, CaseResult, Odds
from sim.rehearsal.uncertainty import UncertaintyModel, uncertainty_of

GO_ON = "continue"
"""In place of a request: the sequence that is under way goes on."""

CHOICES = (*(each.value for each in REQUESTS), GO_ON)

SHOWN_DECIDERS = 5

PROGRESS_STEP = 0.5
"""Between two lines of progress where the terminal cannot rewrite one [s]."""


def request_of(situation: Situation, chosen: str | None) -> Command | None:
    """The request of that name; without one, what is under way goes on, and a capture begins where nothing is."""
    if chosen is not None:
        return None if chosen == GO_ON else Command(chosen)
    try:
        situation.require_can_begin(situation.config, None)
    except MissionRefused:
        return Command.CAPTURE
    return None


def uncertainty_in(path: Path | None) -> UncertaintyModel:
    """The uncertainty model in a TOML or JSON file; the default one without a file.

    Raises:
        ConfigError: the file cannot be read, or a value in it is invalid.

    """
    return uncertainty_of({} if path is None else read_config_file(path, "uncertainty file"))


def rehearsed(
    reader: RunReader,
    at: float | None,
    changes: Mapping[str, Any],
    *,
    request: str | None,
    futures: int,
    seed: int,
    horizon: float,
    uncertainty: UncertaintyModel,
    threads: int | None,
) -> RehearsalResult:
    """Rehearse from a recorded state, with progress on standard error.

    Raises:
        ConfigError: something chosen is out of bounds.
        MissionRefused: the run has no such state, or the request cannot begin there.

    """
    situation = recorded_situation(reader, at)
    rehearsal = planned(
        situation,
        changes,
        request=request_of(situation, request),
        uncertainty=uncertainty,
        futures=futures,
        seed=seed,
        horizon=horizon,
    )
    click.echo("Preparing the simulation (the first time compiles for about a minute)", err=True)
    prepare_futures(rehearsal)
    result = rehearse(rehearsal, threads=threads, on_progress=_show_progress(rehearsal))
    if sys.stderr.isatty():
        click.echo("", err=True)
    notices = [*reader.record.notices, *reader.log_notices, *result.notices]
    return result.model_copy(update={"notices": notices})


def _show_progress(rehearsal: Rehearsal) -> Callable[[int], None]:
    rewrites, shown = sys.stderr.isatty(), 0.0

    def show(done: int) -> None:
        nonlocal shown
        now = time.perf_counter()
        if done < rehearsal.total and now < shown + (0.1 if rewrites else PROGRESS_STEP):
            return
        shown = now
        line = f"Futures: {done} of {rehearsal.total}"
        click.echo(f"\r{line:<40}" if rewrites else line, err=True, nl=not rewrites)

    return show


def as_text(result: RehearsalResult) -> str:
    """What `becalm rehearse` prints."""
    what = "what is under way goes on" if result.request is None else result.request
    lines = [
        f"From {result.time:.3f} s (phase {result.phase}): {what}, method {result.method}, "
        f"{result.as_it_is.futures} futures{' each' if result.as_changed else ''}, seed {result.seed}",
        *(f"  {notice}" for notice in result.notices),
        *(f"  {path} = {value}" for path, value in result.changes.items()),
        "",
        _row("", "as it is", "as changed" if result.as_changed else ""),
    ]
    cases = [result.as_it_is, *([result.as_changed] if result.as_changed else [])]
    lines += _odds_lines(cases)
    lines += [
        "",
        _row("5 %, median, 95 %", *([""] * len(cases))),
        *_band_lines(cases),
        *_decider_lines(result.as_it_is),
    ]
    if result.compared:
        lines += ["", *(f"  {change.verdict:<7}{change.words}" for change in result.compared)]
    return "\n".join(lines)


def _row(title: str, *columns: str) -> str:
    return f"  {title:<36}" + "".join(f"{column:>30}" for column in columns)


def _odds_lines(cases: list[CaseResult]) -> list[str]:
    outcomes = dict.fromkeys(each.outcome for case in cases for each in (case.caged, *case.odds))
    found = [{each.outcome: each for each in (case.caged, *case.odds)} for case in cases]
    return [_row(outcome, *(_odds_words(case.get(outcome)) for case in found)) for outcome in outcomes]


def _odds_words(odds: Odds | None) -> str:
    return "-" if odds is None else f"{odds.share:.1%} ({odds.low:.1%} to {odds.high:.1%})"


def _band_lines(cases: list[CaseResult]) -> list[str]:
    found = [{band.measure: band for band in case.bands} for case in cases]
    units = {band.measure: band.unit for case in cases for band in case.bands}
    return [_row(f"{name} [{unit}]", *(_band_words(case.get(name)) for case in found)) for name, unit in units.items()]


def _band_words(band: Band | None) -> str:
    return "-" if band is None else f"{band.low:.3g}, {band.median:.3g}, {band.high:.3g}"


def _decider_lines(case: CaseResult) -> list[str]:
    if not case.deciding:
        return []
    lines = ["", _row("what decides (rank correlation)", "with peak force", "with caged")]
    for each in case.deciding[:SHOWN_DECIDERS]:
        numbers = ("-" if value is None else f"{value:+.2f}" for value in (each.with_peak_force, each.with_caged))
        lines.append(_row(each.name, *numbers))
    return lines
