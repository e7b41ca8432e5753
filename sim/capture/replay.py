"""A mission flown again: what was done to it at which tick, and from that the same ticks, bit for bit.

`flown_to` brings a mission to any tick of its past; `rerun` flies all its ticks again; `controlled` drives
recorded states through the current controller; `first_difference` finds where two flights diverge.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np
from pydantic import ConfigDict, Field

from sim.capture.beginning import Beginning
from sim.capture.events import Ticks
from sim.capture.mission import Mission, SavedMission
from sim.capture.tick import COLUMNS, TICK, column_values
from sim.config import MissionConfig
from sim.configurations import nested, revised
from sim.control.phases import Command, Phase
from sim.errors import MissionRefused
from sim.snapshot import FrozenMessage

_CHUNK = 500  # ticks at a time, as in a headless run


class Intervention(FrozenMessage):
    """What somebody did to a mission: a command that was granted, or parameters that changed."""

    tick: int = Field(ge=0, description="The first tick flown under it")
    command: Command | None = None
    changes: dict[str, Any] = Field(default_factory=dict, description="Full path of each parameter to its new value")


class FlightHistory(FrozenMessage):
    """All that a simulated mission depends on: the same history gives the same ticks. A robot's depend on more."""

    model_config = ConfigDict(arbitrary_types_allowed=True)

    config: MissionConfig = Field(description="At tick 0")
    interventions: tuple[Intervention, ...] = Field((), description="In the order in which they were done")
    beginning: Beginning | None = Field(None, description="Where it began; null: as the configuration lays it out")
    robot: bool = Field(False, description="Whether a robot was flown: its ticks say what its sensors made of it")

    def begun(self) -> Mission:
        """The mission before its first tick.

        Raises:
            ConfigError: the target overlaps the robot at the start.

        """
        return Mission(self.config) if self.beginning is None else self.beginning.mission(self.config)

    def before(self, tick: int) -> FlightHistory:
        """What the ticks before that one follow from."""
        kept = tuple(each for each in self.interventions if each.tick < tick)
        return self.model_copy(update={"interventions": kept})


class Difference(NamedTuple):
    """The first number in which two flights differ."""

    tick: int
    time: float
    """[s]"""
    quantity: str
    """Name of the column, such as `left.commanded_joint_rate.2`."""
    recorded: float
    now: float


def flown_to(
    history: FlightHistory,
    tick: int,
    on_ticks: Callable[[Ticks], None] = lambda _: None,
    start: SavedMission | None = None,
) -> Mission:
    """The mission with that tick next, as it was before anything was granted or changed at it.

    Args:
        history: what its ticks follow from.
        tick: the one that is to be flown next.
        on_ticks: called with the ticks before it, arrays of `TICK`, as they are flown.
        start: where it was at an earlier tick, to fly from there; without it, it is flown from its beginning.

    Raises:
        ConfigError: the target overlaps the robot at the start.
        MissionRefused: a robot was flown, or the history holds an intervention that is never granted.
        PlantDiverged: the plant failed before that tick.

    """
    flight = _Rerun(history, start)
    for rows in flight.ticks_before(tick):
        flight.mission.take_events()
        on_ticks(rows)
    return flight.mission


def rerun(history: FlightHistory, end: int) -> Iterator[Ticks]:
    """The ticks 0 to `end` (without it), flown again; ends early with a plant that fails.

    Raises:
        ConfigError: the target overlaps the robot at the start.
        MissionRefused: a robot was flown, or the history holds an intervention that is never granted.

    """
    flight = _Rerun(history)
    for rows in flight.ticks_before(end):
        flight.mission.take_events()
        yield rows
        if flight.mission.phase is Phase.FAULTED:
            return


def controlled(history: FlightHistory, recorded: Iterable[Ticks]) -> Iterator[Ticks]:
    """The joint rates that the current controller commands in recorded states, arrays of `TICK`, in the same pieces.

    Ticks may be missing where nothing moved: a resting controller forgets nothing.

    Raises:
        MissionRefused: the current phases do not allow a command that was granted then.

    """
    follower = Follower(history)
    for chunk in recorded:
        yield follower.follow(chunk)
        follower.mission.take_events()


def intervene(mission: Mission, intervention: Intervention) -> None:
    """Apply an intervention again.

    Raises:
        ConfigError: a parameter that does not exist any more, or a value that is out of bounds now.
        MissionRefused: the phase does not allow it.

    """
    if intervention.changes:
        mission.configure(revised(mission.config, nested(intervention.changes)))
    if intervention.command is not None:
        mission.request(intervention.command)


def first_difference(recorded: Ticks, now: Ticks) -> Difference | None:
    """Where two arrays of the same ticks first differ, by a single bit; None if they do not."""
    found: tuple[int, int] | None = None
    for number, column in enumerate(COLUMNS):
        if column.quantity not in (recorded.dtype.names or ()):
            continue  # a log of an earlier version
        places = np.flatnonzero(_bits(column_values(recorded, column)) != _bits(column_values(now, column)))
        if len(places) and (found is None or places[0] < found[0]):
            found = int(places[0]), number
    if found is None:
        return None
    place, column = found[0], COLUMNS[found[1]]
    return Difference(
        tick=int(recorded["tick"][place]),
        time=float(recorded["time"][place]),
        quantity=column.name,
        recorded=float(column_values(recorded, column)[place]),
        now=float(column_values(now, column)[place]),
    )


def _bits(values: np.ndarray[Any, np.dtype[Any]]) -> np.ndarray[Any, np.dtype[Any]]:
    """Numbers as integers of the same bits: NaN equals itself, and minus zero is not zero."""
    return np.ascontiguousarray(values).view(f"u{values.dtype.itemsize}")


class Follower:
    """A mission that is given recorded ticks in place of a plant, and the interventions that it had then."""

    def __init__(self, history: FlightHistory) -> None:
        self.mission = history.begun()
        if history.robot:
            self.mission.perceive_as_recorded()
        self.done = 0
        """How many of the interventions have been applied."""
        self._interventions = history.interventions

    def follow(self, recorded: Ticks) -> Ticks:
        """What the current code judges and commands in these states, an array of `TICK` that follows those before.

        Raises:
            MissionRefused: the current phases do not allow a command that was granted then.

        """
        rows = np.empty(
            len(recorded), TICK
        )  # what a file gives is read-only, for which everything would be compiled again
        rows[:] = recorded
        pieces, place = [rows[:0]], 0
        while place < len(rows):
            self.mission.recall(rows[place])
            while (tick := self._next_intervention) is not None and tick <= rows["tick"][place]:
                intervene(self.mission, self._interventions[self.done])
                self.done += 1
            until = len(rows) if tick is None else int(np.searchsorted(rows["tick"], tick))
            pieces.append(self.mission.follow(rows[place:until]))
            place = until
        return np.concatenate(pieces)

    @property
    def _next_intervention(self) -> int | None:
        """The first tick flown under it; None if there is none left."""
        return self._interventions[self.done].tick if self.done < len(self._interventions) else None


class _Rerun:
    """A mission being flown again through its history."""

    def __init__(self, history: FlightHistory, start: SavedMission | None = None) -> None:
        if history.robot:
            raise MissionRefused(
                "a robot was flown: what moved it is not known, so that it cannot be flown again",
                tip="the current controller can be driven through its recorded ticks, and futures begin in any of them",
            )
        self.mission = history.begun()
        self._left = list(history.interventions)
        if start is not None:
            self.mission.restore(start)
            self._left = [each for each in self._left if each.tick >= start.tick]

    def ticks_before(self, end: int) -> Iterator[Ticks]:
        """Fly up to `end`; interventions at `end` are not applied."""
        mission = self.mission
        while mission.next_tick < end:
            while self._left and self._left[0].tick <= mission.next_tick:
                intervene(mission, self._left.pop(0))
            following = self._left[0].tick if self._left else end
            yield mission.advance(min(end, following, mission.next_tick + _CHUNK) - mission.next_tick)
