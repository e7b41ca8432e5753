"""What a report says of one study: what varied, how often each class came, maps, measures, agreement with the paper."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from server.instants import day_and_time
from server.library.changes import value_words
from server.reports.blocks import Block, Column, Document, Drawing, Facts, Heading, Table, Words, number
from server.reports.study_cells import NUMBERS, Spread, StudyCells, summarised, usual_spread
from server.reports.study_plots import (
    MOST_PANELS,
    SHOWN,
    Shown,
    class_map,
    distribution,
    lines,
    number_map,
    odds,
    scatter,
)
from server.reports.style import MARKS
from server.studies.store import StudyRecord
from sim.reproduction.published import DAMPING, MASS, STIFFNESS, agreement, is_comparable
from sim.snapshot import OutcomeClass
from sim.study.axes import Distribution, parameter_words
from sim.study.design import ENGINE, Study
from sim.study.outcome_frequencies import OutcomeFrequency, outcome_frequencies
from sim.study.summaries import SUMMARIZED, measure_summaries
from sim.study.table import StudyRows

MOST_LISTED = 40
"""Cells of a study that are listed one by one."""
MOST_DRAWN = 4
"""Drawn parameters that have a scatter."""

LISTED = ("outcome", "peak_tip_force", "cage_margin", "duration")
"""Measures of a cell that is listed."""


def study_document(record: StudyRecord, table: StudyRows) -> Document:
    """The report of a study, with the cells that have ended."""
    study = record.study
    cells = StudyCells(study, table)
    frequencies = outcome_frequencies(study, table.rows("outcome"))
    versions = ", ".join(f"{name} {version}" for name, version in record.versions.items())
    return Document(
        title=record.name,
        subtitle=f"Study {record.id}, begun {day_and_time(record.created)}; {versions}",
        lead=_lead(record, cells, frequencies),
        blocks=(
            *([Words(study.description)] if study.description else []),
            Facts(_facts(record, study, cells)),
            *_varied(study),
            *_changes(study),
            *(_results(study, cells, table, frequencies) if frequencies else [Words("No cell has an outcome yet.")]),
        ),
    )


def _lead(record: StudyRecord, cells: StudyCells, frequencies: Sequence[OutcomeFrequency]) -> str:
    if not frequencies:
        return f"The study is {record.status}: {cells.done} of {record.cells} cells."
    best = frequencies[0]
    interval = "" if best.low is None or best.high is None else f" ({100 * best.low:.1f} to {100 * best.high:.1f} %)"
    caged = np.nanmean(cells.caged)
    words = MARKS[OutcomeClass(best.outcome)].words
    most = f"{words}, {100 * best.share:.1f} %{interval}"
    return f"{100 * caged:.1f} % of {cells.done} cells are caged; most often: {most}."


def _facts(record: StudyRecord, study: Study, cells: StudyCells) -> list[tuple[str, str]]:
    note = f": {record.note}" if record.note else ""
    return [
        ("Configuration", study.configuration + (", direct caging" if study.direct else "")),
        ("Method", study.base.method.value.replace("_", " ")),
        ("Engine", "varied" if ENGINE in study.varied else study.base.simulation.engine.value),
        ("Seed", str(study.seed)),
        ("Cells", f"{cells.done} of {study.count}, {cells.failed} failed"),
        ("Status", f"{record.status}{note}"),
        ("Judged", study.base.judging.rule.value.replace("_", " ")),
        ("Wall time", f"{record.wall_time:.1f} s"),
    ]


def _varied(study: Study) -> Iterator[Block]:
    rows = [(path, _values_words(study, path), parameter_words(path)[1]) for path in study.varied]
    yield Heading("What varies")
    yield Table((Column("Parameter"), Column("Values"), Column("What it is")), rows)


def _values_words(study: Study, path: str) -> str:
    unit = _unit_words(path)
    if path in study.levels:
        values = [value_words(value) for value in study.levels[path]]
        listed = (
            ", ".join(values) if len(values) <= 8 else f"{', '.join(values[:3])}, ..., {values[-1]} ({len(values)})"
        )
        return f"{listed} {unit}"
    assert study.samples is not None, "what varies is on the grid or drawn"
    drawn = f"{study.samples.count} draws, {study.samples.method.value.replace('_', ' ')}"
    return f"{_distribution_words(study.samples.over[path], unit)}; {drawn}"


def _distribution_words(drawn: Distribution, unit: str) -> str:
    if drawn.mean is None:
        return f"{drawn.start:g} to {drawn.stop:g} {unit}, {drawn.spacing.value}"
    return f"normal, {drawn.mean:g} ± {drawn.deviation:g} {unit}"


def _unit_words(path: str) -> str:
    """Nothing of a pure number or a choice."""
    unit = parameter_words(path)[0]
    return "" if unit == "1" else unit


def _changes(study: Study) -> tuple[Block, ...]:
    if not study.changes:
        return ()
    rows = [(path, value_words(value), _unit_words(path)) for path, value in study.changes.items()]
    return (
        Heading("What all cells share, changed"),
        Table((Column("Parameter"), Column("Value"), Column("Unit")), rows),
    )


def _results(
    study: Study, cells: StudyCells, table: StudyRows, frequencies: Sequence[OutcomeFrequency]
) -> Iterator[Block]:
    yield Heading("How often")
    yield odds(frequencies)
    if frequencies[0].low is not None:
        yield Words("Bars: shares; lines: Wilson's 95 % intervals, which hold for independent draws.", quiet=True)
    yield from _agreement(study, table)
    spread = usual_spread(study)
    yield Heading("Maps" if spread is not None and spread.y is not None else "Measures over what varies")
    yield from _drawn(study, cells) if spread is None else _mapped(study, cells, spread)
    yield from _measures(study, cells, table)
    yield from _listed(study, table)


def _agreement(study: Study, table: StudyRows) -> Iterator[Block]:
    if not is_comparable(study):
        return
    found = agreement(table.rows("cell", MASS, DAMPING, STIFFNESS, "at_first_closure"))
    rows = [
        (f"{each.mass:g} kg", str(each.cells), f"{100 * each.share:.1f} %", f"{each.kappa:.3f}",
         f"{100 * each.success_share:.1f} %", f"{each.success_kappa:.3f}")
        for each in found
    ]  # fmt: skip
    titles = ("Cells", "Same class", "Cohen's κ", "Success as printed", "κ of success")
    yield Heading("Agreement with the paper's tables, at the first closure")
    yield Table((Column("Virtual mass"), *(Column(title, True) for title in titles)), rows)


def _mapped(study: Study, cells: StudyCells, spread: Spread) -> Iterator[Block]:
    if spread.y is None:
        yield lines(cells, spread.x, SHOWN[:3])
        return
    yield class_map(cells, spread, "outcome", "Outcome")
    if is_comparable(study):
        yield class_map(cells, spread, "at_locked_arms", "Verdict at locked arms")
    if study.samples is not None:
        yield number_map(cells, spread, cells.caged, Shown("caged", "Share that is caged", "%", 100.0))
    for shown in SHOWN[:3]:
        if np.isfinite(cells.numbers(shown.name)).any():
            yield number_map(cells, spread, cells.numbers(shown.name), shown)
    yield from _left_out(spread)


def _left_out(spread: Spread) -> Iterator[Block]:
    """What the maps do not show."""
    held = [f"{axis.path} = {value_words(axis.values[place])}" for axis, place in spread.held]
    if spread.panels is not None and len(spread.panels.values) > MOST_PANELS:
        held.append(f"the first {MOST_PANELS} of {len(spread.panels.values)} values of {spread.panels.path}")
    if held:
        yield Words(f"The maps show {'; '.join(held)}.", quiet=True)


def _drawn(study: Study, cells: StudyCells) -> Iterator[Drawing]:
    paths = study.varied[:MOST_DRAWN]
    for shown in SHOWN[:2]:
        if np.isfinite(cells.numbers(shown.name)).any():
            yield scatter(cells, paths, shown)
    known = [shown for shown in SHOWN if np.isfinite(cells.numbers(shown.name)).any()]
    yield distribution(cells, known)


def _measures(study: Study, cells: StudyCells, table: StudyRows) -> Iterator[Block]:
    yield Heading("Measures")
    rows = []
    for column in NUMBERS:
        values = cells.numbers(column.name)
        count = int(np.isfinite(values).sum())
        if count:
            statistics = [number(value, 3) for value in summarised(values)]
            rows.append((_measure_words(column.name, column.unit), str(count), *statistics))
    titles = ("Cells", "Least", "Mean", "Median", "95 %", "Largest")
    yield Table((Column("Measure"), *(Column(title, True) for title in titles)), rows)
    yield from _estimates(study, table)


def _estimates(study: Study, table: StudyRows) -> Iterator[Block]:
    """Means with their intervals, of a study that is a sample."""
    found = measure_summaries(study, table.rows(*(column.name for column in SUMMARIZED)))
    if found:
        rows = [
            (_measure_words(each.measure, each.unit), number(each.mean.value), number(each.mean.low, 3),
             number(each.mean.high, 3))
            for each in found
        ]  # fmt: skip
        yield Heading("Means of the population, with 95 % intervals")
        yield Table((Column("Measure"), Column("Mean", True), Column("From", True), Column("To", True)), rows)


def _measure_words(name: str, unit: str) -> str:
    return name.replace("_", " ") + ("" if unit == "1" else f", {unit}")


def _listed(study: Study, table: StudyRows) -> Iterator[Block]:
    yield Heading("Cells")
    if study.count > MOST_LISTED:
        yield Words(f"The table of all {study.count} cells leaves as CSV, Parquet or JSON.", quiet=True)
        return
    names = (*study.varied, *LISTED)
    rows = [(str(row["cell"]), *(_cell_words(row[name]) for name in names)) for row in table.rows("cell", *names)]
    short = [name.split(".")[-1].replace("_", " ") for name in names]
    yield Table((Column("Cell", True), *(Column(name, name != "outcome") for name in short)), rows)


def _cell_words(value: object) -> str:
    if value is None or isinstance(value, float):
        return number(value)
    return str(value).replace("_", " ")
