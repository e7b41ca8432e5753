"""`becalm study`: many captures on all cores, kept as they come, written as one table."""

from __future__ import annotations

import multiprocessing
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import click
import numpy as np

from sim.capture.mission import prepare
from sim.errors import ConfigError
from sim.study.design import Study, flattened, read_study, study_of
from sim.study.executors import LocalProcesses, fly_cells
from sim.study.export import TableFormat, export
from sim.study.published import NAMED_STUDIES, Agreement, agreement, is_comparable
from sim.study.run import CellTask, Row, fly_cell
from sim.study.shares import OutcomeShare, outcome_shares
from sim.study.table import StudyTable

MANY_CELLS = 10_000
"""A study with more is asked for."""

TRIAL_CELLS = 6
"""Flown to estimate how long a study takes."""

PROGRESS_STEP = 5.0
"""Between two lines of progress where the terminal cannot rewrite one [s]."""

INTERRUPTED = 130
"""Exit code after Ctrl-C, as shells have it."""


class Output(NamedTuple):
    """Where the table goes."""

    path: Path
    table_format: TableFormat

    @property
    def unfinished(self) -> Path:
        """Where the rows are kept until the study has all of them."""
        return self.path.with_name(self.path.name + ".unfinished")


class Report(NamedTuple):
    """What a study that is whole has to tell besides its table."""

    study: Study
    output: Output
    workers: int
    resumed: int
    """Cells that were there from an earlier start."""
    wall_time: float
    """From the first cell flown to the last [s]."""
    simulated_time: float
    """Of the cells flown in that time [s]."""
    failures: list[str]
    """Why cells have no outcome."""
    shares: list[OutcomeShare]
    agreements: list[Agreement] | None
    """With the published tables, where they can be laid beside the study."""

    @property
    def flown(self) -> int:
        """Cells flown now."""
        return self.study.count - self.resumed


def output_file(path: Path, table_format: str | None) -> Output:
    """The file of that name, in that format or its suffix's.

    Raises:
        ConfigError: neither says which format, or the file cannot be there.

    """
    table_format = table_format or path.suffix.removeprefix(".")
    if table_format not in list(TableFormat):
        known = ", ".join(TableFormat)
        raise ConfigError(f"--out {path}: the format {table_format!r} is unknown; give --format, one of {known}")
    if not path.parent.is_dir():
        raise ConfigError(f"--out {path}: the folder {path.parent} does not exist")
    if path.is_dir():
        raise ConfigError(f"--out {path} is a folder; give the name of a file")
    return Output(path, TableFormat(table_format))


def chosen_study(name_or_file: str, changes: Mapping[str, Any], seed: int | None) -> Study:
    """The study of that name or in that file, with nested changes and perhaps another seed.

    Raises:
        ConfigError: there is none, or it cannot be.

    """
    study = NAMED_STUDIES.get(name_or_file)
    if study is None and not Path(name_or_file).exists():
        known = ", ".join(NAMED_STUDIES)
        raise ConfigError(f"study = {name_or_file!r} is neither a named study ({known}) nor a file")
    if study is None:
        study = read_study(Path(name_or_file))
    definition = study.definition()
    definition["changes"] |= flattened(changes)
    if seed is not None:
        definition["seed"] = seed
    return study_of(definition)


def fly(study: Study, output: Output, workers: int, *, confirmed: bool) -> Report:
    """Fly the cells that are missing, write the table, and tell what came out; progress goes to standard error.

    Raises:
        TableUnusable: the rows cannot be kept.
        WorkersUnavailable: no worker process can be started.
        click.ClickException: the person was asked, and declined.

    """
    with StudyTable(output.unfinished, study) as table:
        click.echo("Preparing the simulation (the first time compiles for about half a minute)", err=True)
        prepare()
        resumed = len(table)
        if resumed:
            click.echo(f"Going on: {resumed} of {study.count} cells are there already", err=True)
        if study.count - resumed > MANY_CELLS and not confirmed:
            _ask(study, study.count - resumed, workers)
        before = time.perf_counter()
        simulated_time = _fly_missing(study, table, workers)
        wall_time = time.perf_counter() - before
        export(table, output.path, output.table_format)
        report = Report(
            study=study,
            output=output,
            workers=workers,
            resumed=resumed,
            wall_time=wall_time,
            simulated_time=simulated_time,
            failures=[row["error"] for row in table.rows() if row["error"] is not None],
            shares=outcome_shares(study, table.rows()),
            agreements=agreement(table.rows()) if is_comparable(study) else None,
        )
    output.unfinished.unlink()
    return report


def _fly_missing(study: Study, table: StudyTable, workers: int) -> float:
    """Fly the cells without a row; how much time was simulated [s]."""
    simulated_time = 0.0
    progress = _progress(study.count)

    def keep(row: Row) -> None:
        nonlocal simulated_time
        table.add(row)
        simulated_time += row["duration"] or 0.0
        progress(len(table))

    tasks = (CellTask(study.base, study.direct, study.cell(index)) for index in table.missing())
    try:
        fly_cells(tasks, keep, lambda: LocalProcesses(workers), at_once=2 * workers)
    except KeyboardInterrupt:
        for worker in multiprocessing.active_children():
            worker.terminate()
        click.echo(
            f"\nStopped. {len(table)} of {study.count} cells are kept in {table.path}; "
            "the same command goes on from there",
            err=True,
        )
        sys.exit(INTERRUPTED)
    if sys.stderr.isatty():
        click.echo("", err=True)
    return simulated_time


def _ask(study: Study, cells: int, workers: int) -> None:
    """Say how long so many cells take, and go on only if that is wanted."""
    duration = _clock(cell_time(study) * cells / workers)
    question = f"{cells} cells take about {duration} on {workers} workers (--yes does not ask). Start?"
    if not click.confirm(question, err=True):
        raise click.ClickException("nothing was started")


def cell_time(study: Study) -> float:
    """How long a cell takes [s]: the mean of some, spread over the study, which are flown here and forgotten."""
    places = np.unique(np.linspace(0, study.count - 1, TRIAL_CELLS).astype(np.int64))
    before = time.perf_counter()
    for place in places:
        fly_cell(CellTask(study.base, study.direct, study.cell(int(place))))
    return (time.perf_counter() - before) / len(places)


def _progress(total: int) -> Callable[[int], None]:
    """What shows how many cells there are, and the time that is left by the pace since the first of now."""
    rewrites = sys.stderr.isatty()
    step = 0.2 if rewrites else PROGRESS_STEP
    began = shown = 0.0
    done_then = 0

    def show(done: int) -> None:
        nonlocal began, shown, done_then
        now = time.perf_counter()
        line = f"Cells: {done} of {total} ({done / total:.0%})"
        if not done_then:
            began, done_then = now, done
        elif done < total and now < shown + step:
            return
        else:
            line += f", {_clock((now - began) / (done - done_then) * (total - done))} left"
        shown = now
        click.echo(f"\r{line:<60}" if rewrites else line, err=True, nl=not rewrites)

    return show


def _clock(duration: float) -> str:
    """A duration [s] as a person says it."""
    minutes, seconds = divmod(round(duration), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes:02d} min"
    return f"{minutes} min {seconds:02d} s" if minutes else f"{seconds} s"


def as_document(report: Report) -> dict[str, Any]:
    """What `becalm study --json` prints."""
    return {
        "study": report.study.definition(),
        "cells": report.study.count,
        "resumed": report.resumed,
        "failed": len(report.failures),
        "outcomes": [share.model_dump() for share in report.shares],
        "agreement": None if report.agreements is None else [table.model_dump() for table in report.agreements],
        "workers": report.workers,
        "wall_time": report.wall_time,
        "cells_per_second": report.flown / report.wall_time,
        "simulated_seconds_per_second": report.simulated_time / report.wall_time,
        "out": str(report.output.path),
        "format": report.output.table_format.value,
    }


def as_text(report: Report) -> str:
    """What `becalm study` prints."""
    rate = report.flown / report.wall_time
    lines = [
        f"Study {report.study.name}: {report.study.count} cells, {report.flown} flown in {_clock(report.wall_time)} "
        f"by {report.workers} workers ({rate:.1f} a second)",
        "",
        *map(_share_line, report.shares),
        *_failure_lines(report.failures),
    ]
    if report.agreements:
        lines += ["", "Agreement with the published tables, at the first closure:", ""]
        lines += map(_agreement_line, report.agreements)
    return "\n".join([*lines, "", f"Wrote {report.output.path}"])


def _share_line(share: OutcomeShare) -> str:
    interval = "" if share.low is None else f"   95 %: {share.low:.1%} to {share.high:.1%}"
    return f"  {share.outcome:<26}{share.cells:>7}{share.share:>8.1%}{interval}"


def _failure_lines(failures: list[str]) -> list[str]:
    if not failures:
        return []
    return [f"  {'failed':<26}{len(failures):>7}   the first: {failures[0]}"]


def _agreement_line(table: Agreement) -> str:
    return (
        f"  m = {table.mass:g} kg: {table.agreeing} of {table.cells} cells in the same class ({table.share:.1%}, "
        f"kappa {table.kappa:.2f}); {table.success_agreeing} by success or failure ({table.success_share:.1%}, "
        f"kappa {table.success_kappa:.2f})"
    )
