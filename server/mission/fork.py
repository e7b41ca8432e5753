"""A mission flown again to a moment of its past, from where it can go on on a way of its own.

To fly again is exact: from a saved state of the same mission, where its plant can be copied, else from its start, which
takes a second for a minute or so of mission time. It is done by the thread that asks, so that the mission thread goes
on flying, and stops when asked to.
"""

from __future__ import annotations

import threading
from dataclasses import dataclass, field, replace

from server.errors import ServiceBusy
from server.library.record import LoggedEvent
from server.mission.history import HistoryRing
from sim.capture.events import Ticks
from sim.capture.mission import Mission
from sim.capture.replay import FlightHistory, flown_to
from sim.capture.saved_states import SavedStates
from sim.errors import MissionRefused

LONGEST_PAST = 3600.0
"""Mission time that is flown again at most [s]."""

MOST_ENDED = 4
"""Flights that have ended whose states are kept; up to 7 MB each."""

_flying_again = threading.Lock()
"""One at a time: each takes Python from the mission thread for some milliseconds, again and again."""


@dataclass(frozen=True)
class ForkParent:
    """What is known of a flight that a fork may come from."""

    run_id: str
    configuration: str
    """The named configuration that it began as."""
    history: FlightHistory
    ticks: int
    """Flown until now; they may be forked at."""
    states: SavedStates = field(default_factory=SavedStates)
    """Where it was, now and then; none of a flight whose plant cannot be copied."""
    shown: HistoryRing = field(default_factory=HistoryRing)
    """Its ticks, as those who watch know them."""


@dataclass(frozen=True)
class Fork:
    """A mission that stands at a tick of the parent's past."""

    parent: ForkParent
    tick: int
    """The first tick that is the fork's own."""
    history: FlightHistory
    """What the ticks before it follow from."""
    mission: Mission
    past: HistoryRing = field(default_factory=HistoryRing)
    """Those ticks, for who watches."""
    events: tuple[LoggedEvent, ...] = ()
    """What the parent's log says of them, but for what they follow from, which is in the history."""


class EndedFlights:
    """The last flights of this service that have ended and have saved states, so that they are forked as the live one.

    `remember` is the mission thread's, `find` anyone's.
    """

    def __init__(self) -> None:
        self._flights: tuple[ForkParent, ...] = ()

    def remember(self, flight: ForkParent) -> None:
        """Keep a flight that ends now, unless it only idled, with what was shown of it; the oldest is let go of."""
        if flight.states and flight.history.interventions:
            kept = replace(flight, shown=flight.shown.before(flight.run_id, flight.ticks))
            self._flights = (*self._flights, kept)[-MOST_ENDED:]  # replaced, never changed: others read it

    def find(self, run_id: str) -> ForkParent | None:
        """The flight of that run; None if it is not kept here."""
        return next((each for each in self._flights if each.run_id == run_id), None)


def forked(parent: ForkParent, tick: int) -> Fork:
    """Fly a flight again up to that tick, from the last saved state that leaves no gap in what was shown of it.

    Raises:
        MissionRefused: it has no such tick, or it is too long since its start.
        ServiceBusy: another one is being flown again.

    """
    if tick > parent.ticks:
        what = f"tick = {tick}: run {parent.run_id} has flown {parent.ticks} ticks"
        raise MissionRefused(what, tip="fork it at one of them")
    history, past = parent.history.before(tick), parent.shown.before(parent.run_id, tick)
    shown = past.end
    start = parent.states.before(shown + 1)
    time = (tick - (0 if start is None else start.tick)) * history.config.control.period
    if time > LONGEST_PAST:
        what = f"tick = {tick} is {time:.0f} s after the start, which would have to be flown again"
        raise MissionRefused(what, tip=f"fork within the first {LONGEST_PAST:.0f} s; reset before a long capture")
    if not _flying_again.acquire(blocking=False):
        raise ServiceBusy("another fork is being flown to its tick", tip="try again when that has begun")
    try:

        def keep(ticks: Ticks) -> None:
            past.keep(ticks[ticks["tick"] > shown])

        return Fork(parent, tick, history, flown_to(history, tick, keep, start), past)
    finally:
        _flying_again.release()
