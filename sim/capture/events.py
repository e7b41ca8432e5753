"""What happened, in words: events read from the recorded ticks, so that a replay has the same ones."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Literal, NamedTuple

import numpy as np
from pydantic import Field

from sim.capture.tick import TICK
from sim.compiled import compiled_inline
from sim.config import MissionConfig
from sim.control.phases import Phase
from sim.errors import Cause, LinkLost, PlantError
from sim.method.method import Words, method_of
from sim.record import Record
from sim.snapshot import FrozenMessage, Outcome, OutcomeClass, Touch

Severity = Literal["info", "warning", "error"]
Ticks = np.ndarray[Any, np.dtype[Any]]


class Event(FrozenMessage):
    """Something that happened at one tick."""

    time: float = Field(description="Mission time [s]")
    tick: int
    kind: str = Field(
        description="phase, plan, touch, touch_end, spin_threshold, closed, locked, verdict, solid_contact, "
        "base_overlap, rate_limit, trouble, manipulability, command, config, fault, link or import"
    )
    severity: Severity
    message: str
    cause: Cause | None = Field(None, description="Of a fault, of a lost link and of a verdict without a cage")


class _Flag(NamedTuple):
    """A field of the tick that becomes true with an event."""

    field: str
    kind: str
    severity: Severity
    message: str


_FLAGS = (
    _Flag("solid_contact", "solid_contact", "warning", "The target strikes a link or the back of a hand"),
    _Flag("base_overlap", "base_overlap", "error", "The target strikes the base"),
    _Flag("rate_limited", "rate_limit", "warning", "Joint rates are at their limit: an arm is near a singularity"),
)


def _noted_bytes() -> tuple[int, int]:
    """Where in a tick all fields begin and end whose changes are events."""
    assert TICK.fields is not None
    places = [TICK.fields[name] for name in ("phase", "plan", "trouble", *(flag.field for flag in _FLAGS))]
    return min(place[1] for place in places), max(place[1] + place[0].itemsize for place in places)


_NOTED = slice(*_noted_bytes())


def _noted(ticks: Ticks) -> Ticks:
    """Those bytes of ticks, shape (ticks, bytes)."""
    noted: Ticks = np.ascontiguousarray(ticks).view(np.uint8).reshape(len(ticks), TICK.itemsize)[:, _NOTED]
    return noted


_PHASE_MESSAGES = {
    Phase.IDLE: "Idle",
    Phase.HOLDING: "Joint rates are zero: the arms hold",
    Phase.STOPPED: "Stopped: joint rates are zero",
    Phase.FAULTED: "Fault: the plant can no longer be trusted",
}


def events_of(ticks: Ticks, before: Ticks, config: MissionConfig) -> list[Event]:
    """The events within consecutive ticks; the one tick before them only shows what they change from."""
    span = _Span(ticks, before)
    method = method_of(config)
    threshold = method.spin_threshold(config)
    events: list[Event] = []
    if not span.is_uneventful():
        events = [*_phase_events(span, method.words), *_plan_events(span, method.words), *_flag_events(span)]
        events += _trouble_events(span, method.words)
    if threshold is not None:
        events += _spin_events(span, threshold)
    return sorted(events, key=lambda event: event.tick)


@compiled_inline
def has_event(before: Record, row: Record, spin_threshold: float) -> bool:
    """Whether `events_of` may find an event in this tick: the same quantities, looked at in compiled code."""
    return bool(
        row.phase != before.phase
        or row.plan != before.plan
        or row.trouble != before.trouble
        or row.solid_contact != before.solid_contact
        or row.base_overlap != before.base_overlap
        or row.rate_limited != before.rate_limited
        or (abs(row.target_perceived_twist[2]) < spin_threshold)
        != (abs(before.target_perceived_twist[2]) < spin_threshold)
    )


class _Span(NamedTuple):
    """Consecutive ticks and the one before."""

    ticks: Ticks
    before: Ticks

    def values(self, field: str) -> Ticks:
        """A field of the tick before and of all ticks."""
        return np.concatenate([self.before[field], self.ticks[field]])

    def is_uneventful(self) -> bool:
        """Whether no field that makes an event changes: one look at the few bytes that have them all."""
        return bool((_noted(self.ticks) == _noted(self.before)).all())

    def event(self, place: int, kind: str, severity: Severity, message: str) -> Event:
        """An event at one of the ticks."""
        row = self.ticks[place]
        return Event(time=float(row["time"]), tick=int(row["tick"]), kind=kind, severity=severity, message=message)


def _changes(values: Ticks) -> list[int]:
    """Places among the ticks where a value, given from the tick before on, differs from the one before."""
    return [int(place) for place in np.flatnonzero(values[1:] != values[:-1])]


def _phase_events(span: _Span, words: Words) -> Iterator[Event]:
    for place in _changes(span.values("phase")):
        phase = Phase(int(span.ticks["phase"][place]))
        bad = phase in (Phase.STOPPED, Phase.FAULTED)
        yield span.event(place, "phase", "warning" if bad else "info", {**_PHASE_MESSAGES, **words.phase}[phase])


def _plan_events(span: _Span, words: Words) -> Iterator[Event]:
    for place in _changes(span.values("plan")):
        what = words.plan.get(int(span.ticks["activity"][place]))
        if what:
            yield span.event(place, "plan", "info", what)


def _trouble_events(span: _Span, words: Words) -> Iterator[Event]:
    for place in _changes(span.values("trouble")):
        what = words.trouble.get(int(span.ticks["trouble"][place]))
        if what:
            yield span.event(place, "trouble", "warning", f"{what[:1].upper()}{what[1:]}")


def _flag_events(span: _Span) -> Iterator[Event]:
    for flag in _FLAGS:
        for place in _changes(span.values(flag.field)):
            if span.ticks[flag.field][place]:
                yield span.event(place, flag.kind, flag.severity, flag.message)


def _spin_events(span: _Span, threshold: float) -> Iterator[Event]:
    spins = span.values("target_perceived_twist")[:, 2]
    for place in _changes(np.abs(spins) < threshold):
        spin = float(spins[place + 1])
        slow = abs(spin) < threshold
        message = f"Spin {spin:.3f} rad/s is {'under' if slow else 'over'} its threshold of {threshold:g} rad/s"
        yield span.event(place, "spin_threshold", "info" if slow else "warning", message)


def touch_event(touch: Touch, period: float) -> Event:
    """The event of a touch that begins (it has no end yet) or has ended; `period` is that of control [s]."""
    name = touch.arm.capitalize()
    if touch.end is None:
        planned = "" if touch.planned else ", unplanned: a plan was still running"
        return _event_at(
            touch.start, period, "touch", "info" if touch.planned else "warning", f"{name} hand touches{planned}"
        )
    message = f"{name} hand leaves after {touch.end - touch.start:.2f} s; peak {touch.peak:.2f} N"
    return _event_at(touch.end, period, "touch_end", "info", message)


def closed_event(time: float, period: float) -> Event:
    """The event of the first closed instant [s]."""
    return _event_at(time, period, "closed", "info", "The tips close around the slow target: first closed instant")


def locked_event(time: float, period: float) -> Event:
    """The event of locked arms [s]."""
    return _event_at(time, period, "locked", "info", "The closing is done: the arms are locked, the cage is verified")


def fault_event(fault: PlantError, time: float, period: float) -> Event:
    """The event of a plant that can no longer be trusted, or of a lost link."""
    kind = "link" if isinstance(fault, LinkLost) else "fault"
    return _event_at(time, period, kind, "error", str(fault), fault.cause)


def verdict_event(outcome: Outcome, time: float, period: float) -> Event:
    """The event of a verdict."""
    failed = outcome.at_locked_arms in (OutcomeClass.EJECTION, OutcomeClass.BASE_COLLISION, OutcomeClass.UNRESOLVED)
    severity: Severity = "info" if outcome.caged else "error" if failed else "warning"
    cause = None if outcome.caged else _VERDICT_CAUSES.get(outcome.at_locked_arms, Cause.TIME_UP)
    return _event_at(time, period, "verdict", severity, verdict_in_words(outcome), cause)


_VERDICT_CAUSES = {
    OutcomeClass.EJECTION: Cause.TARGET_EJECTED,
    OutcomeClass.BASE_COLLISION: Cause.BASE_STRUCK,
}


def _event_at(
    time: float, period: float, kind: str, severity: Severity, message: str, cause: Cause | None = None
) -> Event:
    tick = round(time / period)
    return Event(time=time, tick=tick, kind=kind, severity=severity, message=message, cause=cause)


def verdict_in_words(outcome: Outcome) -> str:
    """How it ended, in one sentence."""
    peak = f"peak force {outcome.peak_tip_force:.2f} N"
    if outcome.caged and outcome.cage_margin is not None:
        count = len(outcome.contacts)
        return f"Caged with a margin of {1e3 * outcome.cage_margin:.1f} mm; {count} touches, {peak}"
    return {
        OutcomeClass.EJECTION: f"Failed: the target left the robot's reach; {peak}",
        OutcomeClass.BASE_COLLISION: f"Failed: the target struck the base; {peak}",
    }.get(outcome.at_locked_arms, f"Failed: not caged when the time was up; {peak}")
