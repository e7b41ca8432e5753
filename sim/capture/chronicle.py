"""What has happened in a mission so far: its events, touches and phases, and the outcome of its last sequence.

All of it is read from the recorded ticks and from the monitor's notes, so that a replay has the same.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from sim.capture.caging import cage
from sim.capture.events import (
    Event,
    Ticks,
    closed_event,
    events_of,
    locked_event,
    touch_event,
    verdict_event,
)
from sim.capture.monitor import outcome_of, touches_of
from sim.capture.stages import Visit, visits_after
from sim.config import MissionConfig
from sim.control.phases import Verdict
from sim.record import Record
from sim.snapshot import Outcome, Touch

_INSTANTS: dict[str, Callable[[float, float], Event]] = {"closed_at": closed_event, "locked_at": locked_event}
"""Of the monitor, that are events once each, with what makes the event from the instant and the control period [s]."""


class Happened(NamedTuple):
    """What had happened in a mission until a tick, but for events; never changed."""

    last: Ticks
    """That tick, an array of one `TICK`; before the first one, the start."""
    visits: tuple[Visit, ...]
    outcome: Outcome | None = None
    """How the last sequence ended; None before its verdict."""
    touches: tuple[Touch, ...] = ()
    """Of the last sequence, as far as they have been announced."""
    announced: frozenset[str] = frozenset()
    """Instants of the monitor that have been events."""

    @classmethod
    def until(cls, last: Ticks, monitor: Record, config: MissionConfig) -> Happened:
        """All that is known where only the last tick and the monitor's notes are: no phase before that tick's."""
        announced = frozenset(name for name in _INSTANTS if not math.isnan(monitor[name]))
        return cls(last, tuple(visits_after([], last, config)), None, tuple(touches_of(monitor)), announced)


class Chronicle:
    """Kept by a mission, tick by tick."""

    def __init__(self, start: Ticks, config: MissionConfig) -> None:
        """Before the first tick, at a start that is an array of one `TICK`."""
        self.happened = Happened(start, tuple(visits_after([], start, config)))
        self._events: list[Event] = []

    def begin_sequence(self) -> None:
        """Forget the last sequence: another one begins."""
        self.happened = Happened(self.happened.last, self.happened.visits[-1:])

    def go_back(self, happened: Happened) -> None:
        """Stand where it stood then; events that were not taken are dropped."""
        self.happened, self._events = happened, []

    def add(self, event: Event) -> None:
        """One event more."""
        self._events.append(event)

    def take_events(self) -> list[Event]:
        """The events since the last call, in the order in which they happened."""
        events, self._events = self._events, []
        return sorted(events, key=lambda event: event.time)

    def note(self, rows: Ticks, monitor: Record, config: MissionConfig) -> None:
        """Events of the ticks just flown, rows of `TICK`, and the outcome if they reached a verdict."""
        before = self.happened
        self._events += events_of(rows, before.last, config)
        visits = tuple(visits_after(before.visits, rows, config))
        self.happened = before._replace(last=rows[-1:].copy(), visits=visits)
        if math.isnan(monitor["begun_at"]):
            return
        self._note_touches(monitor, config.control.period)
        self._note_instants(monitor, config.control.period)
        if self.happened.outcome is None and monitor["verdict"] != Verdict.NONE:
            self._note_verdict(monitor, config)

    def _note_touches(self, monitor: Record, period: float) -> None:
        """Events of the touches that have begun or ended since the last call."""
        if not monitor["touch_count"]:
            return
        known, touches = self.happened.touches, tuple(touches_of(monitor))
        for place, touch in enumerate(touches):
            if place >= len(known):
                self.add(touch_event(touch.model_copy(update={"end": None}), period))
            if touch.end is not None and (place >= len(known) or known[place].end is None):
                self.add(touch_event(touch, period))
        self.happened = self.happened._replace(touches=touches)

    def _note_instants(self, monitor: Record, period: float) -> None:
        """Events of the monitor's instants, the first time that they are there."""
        for name, event in _INSTANTS.items():
            instant = float(monitor[name])
            if not math.isnan(instant) and name not in self.happened.announced:
                self.happened = self.happened._replace(announced=self.happened.announced | {name})
                self.add(event(instant, period))

    def _note_verdict(self, monitor: Record, config: MissionConfig) -> None:
        row = self.happened.last[-1]
        found = cage(config, row["hand_pose"], row["target_pose"])
        outcome = outcome_of(monitor, config, float(row["target_twist"][2]), found)
        self.happened = self.happened._replace(outcome=outcome)
        self.add(verdict_event(outcome, float(monitor["verdict_at"]), config.control.period))
