"""`becalm study`: many captures on all cores, kept as they come, written as one table."""

from __future__ import annotations

import multiprocessing
import sys
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import click

from server.studies.cluster import cluster_workers
from sim.capture.mission import prepare
from sim.config import Engine
from sim.configurations import nested, revised
from sim.errors import CaptureError, ConfigError
from sim.reproduction.published import NAMED_STUDIES, Agreement, agreement, is_comparable
from sim.study.cores import cores
from sim.study.design import ENGINE, METHOD, Study, altered, read_study
from sim.study.executors import Workers, local_threads, local_workers
from sim.study.export import TableFormat, export
from sim.study.flight import MANY_CELLS, Progress, StudyFlight, flight_time, in_words
from sim.study.outcome_frequencies import OutcomeFrequency, outcome_frequencies
from sim.study.summaries import MeasureSummary, measure_summaries
from sim.study.table import StudyTable

MOST_THREADS = 4
"""More workers than that are processes: threads wait for one another in Python's part of a cell."""

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


class StudyReport(NamedTuple):
    """What a finished study reports besides its table."""

    study: Study
    output: Output
    workers: Workers
    resumed: int
    """Cells that were there from an earlier start."""
    progress: Progress
    """When the last cell had ended."""
    failures: list[str]
    """Why cells have no outcome."""
    frequencies: list[OutcomeFrequency]
    measures: list[MeasureSummary]
    """Of a study that is a sample."""
    agreements: list[Agreement] | None
    """With the published tables, where they can be compared with the study."""

    @property
    def flown(self) -> int:
        """Cells flown now."""
        return self.study.count - self.resumed


def output_file(path: Path, table_format: str | None) -> Output:
    """The file of that name, in that format or its suffix's.

    Raises:
        ConfigError: neither says which format, or the file cannot be written there.

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
        ConfigError: there is none, or it is invalid.

    """
    if name_or_file in NAMED_STUDIES:
        study = NAMED_STUDIES[name_or_file]()
    elif Path(name_or_file).exists():
        study = read_study(Path(name_or_file))
    else:
        known = ", ".join(NAMED_STUDIES)
        raise ConfigError(f"study = {name_or_file!r} is neither a named study ({known}) nor a file")
    return altered(study, changes, seed)


def engines_of(study: Study) -> set[Engine]:
    """The engines in which its cells fly."""
    return {Engine(str(value)) for value in study.levels.get(ENGINE, (study.base.simulation.engine,))}


def _prepare(study: Study) -> None:
    """Compile what its cells run, before there are workers who would wait for each other."""
    methods = study.levels.get(METHOD, (study.base.method,))
    for engine, method in product(engines_of(study), methods):
        with suppress(CaptureError):  # what cannot be flown as one cell may be as another: each says so in its row
            prepare(revised(study.base, nested({ENGINE: engine, METHOD: method})), recorded=False)


def chosen_workers(study: Study, count: int | None, scheduler: str | None) -> Workers:
    """Threads of this process or others on this machine, or the workers of a cluster.

    Few workers are threads, if all cells fly in the reduced engine: pymunk's library can end the process it is in.

    Raises:
        ConfigError: both are asked for, or the address is invalid.
        WorkersUnavailable: the cluster has no worker that could fly a cell.

    """
    if scheduler is None:
        count = count or cores()
        in_threads = count <= MOST_THREADS and engines_of(study) == {Engine.REDUCED}
        return local_threads(count) if in_threads else local_workers(count)
    if count is not None:
        raise ConfigError(f"--workers {count}: a cluster has its own workers; give --workers or --scheduler")
    return cluster_workers(scheduler)


def fly(study: Study, output: Output, workers: Workers, *, confirmed: bool, replace: bool) -> StudyReport:
    """Fly the cells that are missing, write the table, and report the results; progress goes to standard error.

    Args:
        study: what to fly.
        output: where its table goes.
        workers: what flies it.
        confirmed: more than `MANY_CELLS` cells are intended.
        replace: drop a table, or rows, that are there already.

    Raises:
        ConfigError: there is a table already.
        TableUnusable: the rows cannot be kept.
        WorkersUnavailable: there is no worker that could fly a cell.
        click.ClickException: the person was asked, and declined.

    """
    if output.path.exists() and not replace:
        raise ConfigError(f"--out {output.path} exists already", tip="give another name, or --force to start over")
    with StudyTable(output.unfinished, study, replace=replace) as table:
        click.echo("Preparing the simulation (the first time compiles for about half a minute)", err=True)
        _prepare(study)
        resumed = len(table)
        if resumed:
            click.echo(f"Resuming: {resumed} of {study.count} cells are there already", err=True)
        if study.count - resumed > MANY_CELLS and not confirmed:
            _ask(study, study.count - resumed, workers)
        progress = _fly_missing(table, workers)
        export(table, output.path, output.table_format)
        report = StudyReport(
            study=study,
            output=output,
            workers=workers,
            resumed=resumed,
            progress=progress,
            failures=[row["error"] for row in table.rows() if row["error"] is not None],
            frequencies=outcome_frequencies(study, table.rows()),
            measures=measure_summaries(study, table.rows()),
            agreements=agreement(table.rows()) if is_comparable(study) else None,
        )
    output.unfinished.unlink()
    return report


def _fly_missing(table: StudyTable, workers: Workers) -> Progress:
    """Fly the cells without a row."""
    flight = StudyFlight(table)
    show = show_progress()
    try:
        flight.fly(workers, on_row=lambda _: show(flight.progress))
    except KeyboardInterrupt:
        for worker in multiprocessing.active_children():
            worker.terminate()
        click.echo(
            f"\nStopped. {len(table)} of {table.study.count} cells are kept in {table.path}; "
            "the same command resumes it",
            err=True,
        )
        sys.exit(INTERRUPTED)
    if sys.stderr.isatty():
        click.echo("", err=True)
    return flight.progress


def _ask(study: Study, cells: int, workers: Workers) -> None:
    """Say how long that many cells take, and continue only if the person agrees."""
    duration = in_words(flight_time(study, cells, workers))
    question = f"{cells} cells take about {duration} on {workers.words} (--yes does not ask). Start?"
    if not click.confirm(question, err=True):
        raise click.ClickException("nothing was started")


def show_progress() -> Callable[[Progress], None]:
    """What shows how many cells there are, and the time that is left."""
    rewrites = sys.stderr.isatty()
    step = 0.2 if rewrites else PROGRESS_STEP
    shown = 0.0

    def show(progress: Progress) -> None:
        nonlocal shown
        now = time.perf_counter()
        done, total = progress.done, progress.total
        if shown and done < total and now < shown + step:
            return
        line = f"Cells: {done} of {total} ({done / total:.0%})"
        if shown and progress.time_left is not None:
            line += f", {in_words(progress.time_left)} left"
        shown = now
        click.echo(f"\r{line:<60}" if rewrites else line, err=True, nl=not rewrites)

    return show


def as_document(report: StudyReport) -> dict[str, Any]:
    """What `becalm study --json` prints."""
    return {
        "study": report.study.definition(),
        "cells": report.study.count,
        "resumed": report.resumed,
        "failed": len(report.failures),
        "outcomes": [frequency.model_dump() for frequency in report.frequencies],
        "measures": [measure.model_dump() for measure in report.measures],
        "agreement": None if report.agreements is None else [table.model_dump() for table in report.agreements],
        "workers": report.workers.count,
        "wall_time": report.progress.wall_time,
        "cells_per_second": report.progress.cells_per_second,
        "simulated_seconds_per_second": report.progress.simulated_seconds_per_second,
        "out": str(report.output.path),
        "format": report.output.table_format.value,
    }


def as_text(report: StudyReport) -> str:
    """What `becalm study` prints."""
    progress = report.progress
    lines = [
        f"Study {report.study.name}: {report.study.count} cells, {report.flown} flown in "
        f"{in_words(progress.wall_time)} by {report.workers.words} ({progress.cells_per_second or 0.0:.1f} a second)",
        "",
        *map(_frequency_line, report.frequencies),
        *_failure_lines(report.failures),
    ]
    if report.measures:
        lines += ["", f"  {'':<32}{'mean':>10}{'95 % interval':>22}{'95 % quantile':>16}"]
        lines += map(_measure_line, report.measures)
    if report.agreements:
        lines += ["", "Agreement with the published tables, at the first closure:", ""]
        lines += map(_agreement_line, report.agreements)
    return "\n".join([*lines, "", f"Wrote {report.output.path}"])


def _frequency_line(frequency: OutcomeFrequency) -> str:
    interval = "" if frequency.low is None else f"   95 %: {frequency.low:.1%} to {frequency.high:.1%}"
    return f"  {frequency.outcome:<26}{frequency.cells:>7}{frequency.share:>8.1%}{interval}"


def _measure_line(summary: MeasureSummary) -> str:
    mean, high = summary.mean, summary.quantile_95
    interval = "" if mean.low is None else f"{mean.low:.4g} to {mean.high:.4g}"
    name = summary.measure if summary.unit == "1" else f"{summary.measure} [{summary.unit}]"
    return f"  {name:<32}{mean.value:>10.4g}{interval:>22}" + ("" if high is None else f"{high.value:>16.4g}")


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
