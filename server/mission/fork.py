"""A mission flown again to a moment of its past, from where it can go on on a way of its own.

To fly again is exact, and takes a second for a minute or so of mission time: it is done by the thread that asks,
so that the mission thread goes on flying, and stops when asked to.
"""

from __future__ import annotations

import threading
from dataclasses import dataclass, field

from server.errors import ServiceBusy
from server.library.record import LoggedEvent
from server.mission.history import HistoryRing
from sim.capture.mission import Mission
from sim.capture.replay import FlightHistory, flown_to
from sim.errors import MissionRefused

LONGEST_PAST = 3600.0
"""Mission time that is flown again at most [s]."""


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


def forked(parent: ForkParent, tick: int) -> Fork:
    """Fly a flight again up to that tick, from tick 0.

    Raises:
        MissionRefused: it has no such tick, or it is too long since its start.
        ServiceBusy: another one is being flown again.

    """
    if tick > parent.ticks:
        what = f"tick = {tick}: run {parent.run_id} has flown {parent.ticks} ticks"
        raise MissionRefused(what, tip="fork it at one of them")
    history = parent.history.before(tick)
    time = tick * history.config.control.period
    if time > LONGEST_PAST:
        what = f"tick = {tick} is {time:.0f} s after the start, which would have to be flown again"
        raise MissionRefused(what, tip=f"fork within the first {LONGEST_PAST:.0f} s; reset before a long capture")
    if not _flying_again.acquire(blocking=False):
        raise ServiceBusy("another fork is being flown to its tick", tip="try again when that has begun")
    try:
        past = HistoryRing()
        return Fork(parent, tick, history, flown_to(history, tick, past.keep), past)
    finally:
        _flying_again.release()
