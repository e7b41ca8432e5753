"""What a report says of one run: what was flown, what came of it, its figures, plots and events."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import FigureBase

from server.instants import day_and_time
from server.library.changes import changes_of, value_words
from server.library.decimated import decimated
from server.library.reader import RunReader
from server.library.record import LoggedEvent
from server.reports.blocks import Beside, Block, Column, Document, Drawing, Facts, Heading, Table, Words, number
from server.reports.drawing import draw_instant
from server.reports.run_plots import LEGEND, Level, RunCurves, RunPlots, instants, largest_rotation
from server.reports.style import MARKS
from sim.capture.events import verdict_in_words
from sim.errors import MissionRefused
from sim.method.method import method_of
from sim.snapshot import Outcome

ROWS = 4000
"""Of the log that the plots are drawn from, with every extreme in them."""
MOST_LISTED = 12
"""Touches, and events, that are listed."""
DRAWINGS = 5
"""Of robot and target, beside one another."""

_TOUCHES = ("touch", "touch_end")
"""Kinds of events that a table of their own has."""

_FIRST = ("verdict", "closed", "locked", "command", "config", "fault", "link", "phase", "import")
"""Kinds of events that are listed whatever else there is; the others as long as there is room."""


def run_document(reader: RunReader) -> Document:
    """The report of a run.

    Raises:
        MissionRefused: it has recorded nothing yet.
        StoredUnreadable: its log cannot be understood.

    """
    record, remarks = reader.record, reader.remarks
    if not reader.tick_count:
        raise MissionRefused(
            f"run {record.id} has recorded nothing: it is {record.status}", tip="ask when it has flown"
        )
    curves = RunCurves(decimated(reader, ROWS))
    versions = ", ".join(f"{name} {version}" for name, version in record.versions.items())
    return Document(
        title=remarks.name or f"Run {record.id}",
        subtitle=f"{f'Run {record.id}, begun' if remarks.name else 'Begun'} {day_and_time(record.started)}; {versions}",
        lead=_lead(reader),
        blocks=(
            Facts(_flown(reader)),
            Words(f"Method: {method_of(record.config).title}."),
            *_changes(reader),
            Heading("Results"),
            Facts(_results(record.outcome, curves)),
            _drawings(reader, curves),
            Drawing(7.27, 2.75, _plots(reader, curves).draw, "Tip forces, spin, rotation of the base, manipulability"),
            Words(LEGEND, quiet=True),
            Beside((Heading("Touches"), *_touches(record.outcome)), (Heading("Events"), *_events(reader))),
            *_remarks(reader),
        ),
    )


def _lead(reader: RunReader) -> str:
    """What came of it."""
    outcome = reader.record.outcome
    if outcome is None:
        why = f": {reader.record.note}" if reader.record.note else ""
        return f"No verdict: the run is {reader.record.status}{why}."
    return f"{verdict_in_words(outcome)}."


def _flown(reader: RunReader) -> list[tuple[str, str]]:
    record, remarks = reader.record, reader.remarks
    config = record.config
    last = reader.last_tick()
    return [
        ("Configuration", record.configuration + (", direct caging" if record.direct else "")),
        ("Engine, if it was simulated", config.simulation.engine.value),
        ("Seed", str(config.simulation.seed)),
        ("Spin at the start", f"{number(config.target.initial_spin)} rad/s"),
        ("Recorded", f"{reader.tick_count} ticks, {0.0 if last is None else float(last['time'][0]):.3f} s"),
        ("Kind, status", f"{record.kind}, {record.status}, log {record.integrity or 'open'}"),
        ("Tags", ", ".join(remarks.tags) or "none"),
        ("Changed parameters", str(len(changes_of(record))) if changes_of(record) else "none"),
        *([("Parent", record.parent)] if record.parent else []),
    ]


def _changes(reader: RunReader) -> tuple[Block, ...]:
    changes = changes_of(reader.record)
    if not changes:
        return ()
    rows = [
        (each.path, value_words(each.configured), value_words(each.value), "" if each.unit == "1" else each.unit)
        for each in changes
    ]
    columns = (Column("Changed parameter"), Column("Configured", True), Column("Flown", True), Column("Unit"))
    return (Table(columns, rows),)


def _results(outcome: Outcome | None, curves: RunCurves) -> list[tuple[str, str]]:
    rotation = ("Largest rotation of the base", f"{number(math.degrees(largest_rotation(curves)), 3)} deg")
    if outcome is None:
        force = max(float(np.nanmax(curves[f"{arm}.hand_force"])) for arm in ("left", "right"))
        return [("Peak tip force so far", f"{force:.3f} N"), rotation]
    margin = "none" if outcome.cage_margin is None else f"{1e3 * outcome.cage_margin:.2f} mm"
    return [
        ("Verdict, at locked arms", MARKS[outcome.at_locked_arms].words),
        ("Paper's verdict, at first closure", MARKS[outcome.at_first_closure].words),
        ("Cage margin", margin),
        rotation,
        ("Peak tip force", f"{outcome.peak_tip_force:.3f} N"),
        ("... up to the first closure", f"{outcome.peak_tip_force_to_closure:.3f} N"),
        ("First closed, locked", f"{_at(outcome.closed_at)}, {_at(outcome.locked_at)}"),
        ("From start to verdict", f"{outcome.duration:.3f} s"),
        ("Spin at the verdict", f"{number(outcome.final_target_spin, 3)} rad/s"),
        ("Least manipulability", f"{1e3 * outcome.min_manipulability:.2f}·10⁻³ m²"),
        ("Momentum error", f"{outcome.momentum_error:.1e} N s, N m s"),
        ("Touches", f"{len(outcome.contacts)}, {sum(not touch.planned for touch in outcome.contacts)} unplanned"),
    ]


def _at(time: float | None) -> str:
    return "never" if time is None else f"{time:.3f} s"


def _drawings(reader: RunReader, curves: RunCurves) -> Drawing:
    end = float(np.nanmax(curves.time))
    moments = instants(reader.record.outcome, end, curves.first_motion, DRAWINGS)
    ticks = [(_tick_at(reader, time), words, time) for time, words in moments]
    path = curves.target_path

    def draw(figure: FigureBase) -> None:
        grid = figure.subplots(1, DRAWINGS, squeeze=False)[0]
        for axes in grid[len(ticks) :]:
            axes.set_visible(False)
        for axes, (tick, words, time) in zip(grid, ticks, strict=False):
            draw_instant(axes, reader.record.config, tick, words, path[curves.time <= time])

    return Drawing(7.27, 1.5, draw, "Robot and target: " + ", ".join(f"{words} at {t:.2f} s" for t, words in moments))


def _tick_at(reader: RunReader, time: float) -> Any:
    """The tick at that time, or the last one before it; one element of `TICK`."""
    period = reader.record.config.control.period
    return next(ticks[0] for ticks in reader.chunks(max(0.0, time - period), None) if len(ticks))


def _plots(reader: RunReader, curves: RunCurves) -> RunPlots:
    config = reader.record.config
    spin = method_of(config).spin_threshold(config)
    bound = config.judging.force_bound
    return RunPlots(
        curves,
        reader.record.outcome,
        Level(bound, f"bound {bound:.2f} N"),
        None if spin is None else Level(spin, "caging below"),
    )


def _touches(outcome: Outcome | None) -> tuple[Block, ...]:
    if outcome is None or not outcome.contacts:
        return (Words("No touch is known.", quiet=True),)
    columns = (Column("Hand"), Column("From, s", True), Column("To, s", True), Column("Peak, N", True), Column(""))
    rows = [
        (
            touch.arm,
            f"{touch.start:.3f}",
            "" if touch.end is None else f"{touch.end:.3f}",
            f"{touch.peak:.3f}",
            "" if touch.planned else "unplanned",
        )
        for touch in outcome.contacts
    ]
    return (Table(columns, rows[:MOST_LISTED]), *_left_out(len(rows) - MOST_LISTED, "touches"))


def _left_out(count: int, what: str) -> tuple[Block, ...]:
    return (Words(f"and {count} further {what} in the log", quiet=True),) if count > 0 else ()


def _events(reader: RunReader) -> tuple[Block, ...]:
    every = map(LoggedEvent.model_validate, reader.events())
    events = [event for event in every if event.kind not in _TOUCHES]
    kept = _most_telling(events)
    rows = [(f"{event.time:.2f}", event.message) for event in kept]
    columns = (Column("Time, s", True), Column("What happened"))
    if not rows:
        return (Words("No events.", quiet=True),)
    return (Table(columns, rows), *_left_out(len(events) - len(kept), "events"))


def _most_telling(events: Sequence[LoggedEvent]) -> list[LoggedEvent]:
    """As many as are listed, in their order."""
    ranked = sorted(events, key=lambda event: (event.severity == "info") + (event.kind not in _FIRST))
    kept = {id(event) for event in ranked[:MOST_LISTED]}
    return [event for event in events if id(event) in kept]


def _remarks(reader: RunReader) -> tuple[Block, ...]:
    notes = reader.remarks.notes
    if not notes:
        return ()
    rows = [("" if note.time is None else f"{note.time:.2f}", note.text, note.who, note.at) for note in notes]
    return (Heading("Notes"), Table((Column("At, s", True), Column("Note"), Column("Who"), Column("When")), rows))
