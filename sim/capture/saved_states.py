"""Where a mission was, now and then, so that any tick of its past is a short flight away."""

from __future__ import annotations

from sim.capture.mission import Mission, SavedMission

CAPACITY = 128
"""States that are kept at most; some 40 kB each."""

FIRST_SPACING = 500
"""Ticks between two of them at first; twice as many whenever there is no room."""


class SavedStates:
    """The states of one mission. `keep` is for the thread that flies it, `before` for any."""

    def __init__(self) -> None:
        self._states: tuple[SavedMission, ...] = ()
        self._spacing = FIRST_SPACING
        self._due = 0

    def __bool__(self) -> bool:
        """Whether there is any."""
        return bool(self._states)

    def keep(self, mission: Mission) -> None:
        """Keep where the mission is, if that is far enough from the last state, and nothing was granted since its tick.

        Of a mission that cannot be copied nothing is kept.
        """
        if mission.next_tick < self._due:
            return
        self._due = mission.next_tick + self._spacing
        if (saved := mission.save()) is None:
            return
        if len(self._states) == CAPACITY:
            self._states = self._states[::2]
            self._spacing *= 2
        self._states = (*self._states, saved)  # replaced, never changed: others read it

    def before(self, tick: int) -> SavedMission | None:
        """The last one that stands at that tick or before it; None if none does."""
        return next((each for each in reversed(self._states) if each.tick <= tick), None)

    def until(self, tick: int) -> SavedStates:
        """Those until that tick, for another mission that goes on from there."""
        past = SavedStates()
        past._states = tuple(each for each in self._states if each.tick <= tick)
        past._spacing, past._due = self._spacing, tick
        return past
