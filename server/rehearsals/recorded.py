"""A state of a run of the library, for futures to begin in."""

from __future__ import annotations

from server.library.reader import RunReader
from sim.errors import MissionRefused
from sim.rehearsal.situation import Situation


def recorded_situation(reader: RunReader, at: float | None) -> Situation:
    """That a run was in at that mission time [s]; at its last tick without one.

    The current controller is driven through its ticks until then, so that it remembers what it would.

    Raises:
        MissionRefused: the run has no ticks, or none at that time.
        StoredUnreadable: its log or an event is damaged.

    """
    last = reader.last_tick()
    if last is None:
        raise MissionRefused(f"run {reader.record.id} holds no ticks", tip="take one that was flown")
    end = float(last[0]["time"])
    if at is not None and not 0.0 <= at <= end:
        raise MissionRefused(f"at = {at:g} s: run {reader.record.id} was recorded from 0 to {end:g} s")
    at = end if at is None else at
    return Situation.recorded(reader.history(), reader.chunks(until=at + reader.record.config.control.period), at)
