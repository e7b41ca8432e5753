"""The report as one HTML page that needs nothing else: its figures, its prose, its numbers from one document."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
from matplotlib.figure import Figure

from becalm.report import maps, mechanism, signals
from server.reports.drawing import DrawnInstant, sequence
from server.reports.style import MARKS, Picture, look, picture
from server.versions import becalm_version
from sim.configurations import named_configuration
from sim.method.published.memory import Activity
from sim.reproduction.experiments import Example, FlownCapture, Origin, impedance_of
from sim.reproduction.findings import Reproduction, authors_run
from sim.snapshot import OutcomeClass

_APART = 0.12  # two instants of a sequence closer than this are one [s]
_FRAMES = 8


class ShownExample(NamedTuple):
    """A cell that was flown again to be looked at."""

    example: Example
    flown: FlownCapture


def figures(found: Reproduction, shown: list[ShownExample]) -> dict[str, Picture]:
    """Every figure of the report by name, in its order."""
    with look():
        return {name: picture(drawn) for name, drawn in _drawn(found, shown).items()}


def _drawn(found: Reproduction, shown: list[ShownExample]) -> dict[str, Figure]:
    captures, config = found.captures, found.config
    runs = {
        "Direct caging": captures.direct,
        "Representative cell": captures.representative,
        "Impedance of the figures": captures.figures,
    }
    authors = authors_run()
    numbers = mechanism.numbers_of(found.cells, found.touch, config)
    drawn = {
        "sequence_figures": _sequence(captures.figures, _FRAMES, 4),
        "sequence_representative": _sequence(captures.representative, _FRAMES, 4),
        "sequence_direct": _sequence(captures.direct, 4, 4),
        "forces": signals.forces(runs, config.judging.force_bound),
        "spins": signals.spins(runs, authors),
        "attitude": signals.attitude(runs),
        "authors_direct": signals.beside_the_authors(captures.direct, authors),
        "maps_published": maps.beside_published(found.published),
        "maps_truth": maps.classes_of(found.published, "at_locked_arms"),
        "maps_peak": maps.peaks(found.published, config.judging.force_bound),
        "residual_spin": mechanism.residual_spin(config, found.cells),
        "restitution": mechanism.rebound(found.cells, numbers),
        "spin_and_drift": mechanism.spin_and_drift(config, found.cells, numbers.drift_bound),
    }
    by_kind = {one.example.kind: one for one in shown}
    if {"dead_touch", "beside_it"} <= by_kind.keys():
        pair = [by_kind["dead_touch"], by_kind["beside_it"]]
        names = [f"d = {impedance_of(one.example.row).damping:g} N s/m" for one in pair]
        drawn["dead_touch"] = signals.dead_touch(pair[0].flown, pair[1].flown, names)
    for one in shown:
        drawn[f"example_{one.example.kind}"] = _sequence(one.flown, 5, 5)
    drawn["maps_as_printed"] = maps.beside_published(found.as_printed)
    return drawn


def ablation_figure(found: list[Mapping[str, Any]], reference: float) -> Picture:
    """Kappa of the ablations as bars."""
    with look():
        return picture(
            mechanism.ablations(
                [one["words"] for one in found],
                [one["success_kappa"] for one in found],
                [Origin(one["origin"]) for one in found],
                reference,
            )
        )


def _sequence(flown: FlownCapture, count: int, columns: int) -> Figure:
    return sequence(flown.config, flown.ticks, _instants(flown, count), columns)


def _instants(flown: FlownCapture, count: int) -> list[DrawnInstant]:
    """The start, touches, the closing, the largest force and the end; the most telling ones if they are many."""
    ticks, outcome = flown.ticks, flown.outcome
    end = float(ticks["time"][-1])
    force = np.hypot(ticks["hand_wrench"][:, :, 0], ticks["hand_wrench"][:, :, 1]).max(axis=1)
    closing = np.flatnonzero(ticks["activity"] == Activity.CLOSING)
    moments = [(end, _ending(outcome.at_locked_arms))]
    if force.max() > 0.0:
        moments.append((float(ticks["time"][int(np.argmax(force))]), f"largest force, {force.max():.2f} N"))
    if outcome.contacts:
        moments.append((outcome.contacts[0].start, f"{outcome.contacts[0].arm} hand touches"))
    if outcome.closed_at is not None:
        moments.append((outcome.closed_at, "first closed instant"))
    if len(closing) and not flown.direct:
        moments.append((float(ticks["time"][closing[0]]), "the closing is planned"))
    moments.append((0.0, "start"))
    moments += [(touch.end, "the touch ends") for touch in outcome.contacts[:1] if touch.end is not None]
    moments += [(touch.start, f"{touch.arm} hand touches") for touch in outcome.contacts[1:]]
    kept: list[DrawnInstant] = []
    for time, caption in moments:
        if len(kept) < count and all(abs(time - frame.time) > _APART for frame in kept):
            kept.append(DrawnInstant(time, caption))
    return sorted(kept)


def _ending(outcome: OutcomeClass) -> str:
    return MARKS[outcome].words


def environment() -> Environment:
    """Of the report's pages."""
    made = Environment(
        loader=PackageLoader("becalm.report"),
        autoescape=select_autoescape(default=True),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters["words"] = _words
    made.filters["places"] = _places
    return made


def html(found: Reproduction, document: Mapping[str, Any], pictures: Mapping[str, Picture], day: str) -> str:
    """The whole report."""
    template = environment().get_template("report.html.j2")
    impedance = found.captures.figures.config.published.impedance
    captures = {**document["captures"], "figures_impedance": impedance}
    return template.render(
        **{**document, "captures": captures},
        images={name: data_uri(one) for name, one in pictures.items()},
        config=found.config,
        as_printed_config=named_configuration("as_printed"),
        version=becalm_version(),
        day=day,
    )


def data_uri(one: Picture) -> str:
    """A picture as a page holds it."""
    return "data:image/svg+xml;base64," + base64.b64encode(one.svg).decode("ascii")


def _words(outcome: str) -> str:
    return MARKS[OutcomeClass(outcome)].words


def _places(value: float, digits: int = 2) -> str:
    """A number with that many decimal places and a true minus sign."""
    return f"{value:.{digits}f}".replace("-", "\N{MINUS SIGN}")
