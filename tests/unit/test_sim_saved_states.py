"""Saved states: what is flown on from one is what is flown from the start, to the last bit."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from sim.capture.mission import Mission
from sim.capture.replay import FlightHistory, Intervention, flown_to, intervene
from sim.capture.saved_states import CAPACITY, FIRST_SPACING, SavedStates
from sim.config import MissionConfig
from sim.configurations import named_configuration, revised
from sim.control.phases import Command
from sim.errors import PlantError

END = 1400
"""Ticks of 5 ms."""


class Flight(NamedTuple):
    """A mission that was flown, with edits, and where it was at each look."""

    history: FlightHistory
    mission: Mission
    states: SavedStates


def _reduced(name: str) -> MissionConfig:
    return revised(named_configuration(name), {"simulation": {"engine": "reduced"}})


def _flown(history: FlightHistory, end: int, together: int) -> Flight:
    """Fly it, looking after every so many ticks, as the mission thread does."""
    mission, states = history.begun(), SavedStates()
    left = list(history.interventions)
    while mission.next_tick < end:
        while left and left[0].tick <= mission.next_tick:
            intervene(mission, left.pop(0))
        until = min(end, mission.next_tick + together, *(each.tick for each in left))
        mission.advance(until - mission.next_tick)
        mission.take_events()
        states.keep(mission)
    return Flight(history, mission, states)


NOISY = {
    "testbed_becalm": {"co_moving_couple.touch.drift_time": 0.3},
    "testbed": {"published.impedance.damping": 2.5},
}
"""Configurations of both methods whose sensors are wrong, and what is edited on the way."""


@pytest.fixture(scope="module", params=NOISY)
def flight(request: pytest.FixtureRequest) -> Flight:
    """A capture with an edit, a hold and a second sequence."""
    done = (
        Intervention(tick=27, command=Command.CAPTURE),
        Intervention(tick=320, changes=NOISY[request.param]),
        Intervention(tick=740, command=Command.HOLD),
        Intervention(tick=780, command=Command.CAGE),
    )
    return _flown(FlightHistory(config=_reduced(request.param), interventions=done), END, 16)


def _assert_same(one: Mission, other: Mission, ticks: int = 200) -> None:
    assert one.next_tick == other.next_tick
    assert one.snapshot() == other.snapshot()
    for _ in range(2):  # the second time also what they do when asked
        flown = [each.advance(ticks) for each in (one, other)]
        assert flown[0].tobytes() == flown[1].tobytes()
        assert one.take_events() == other.take_events()
        for each in (one, other):
            each.request(Command.STOP)


@pytest.mark.parametrize("tick", [300, 520, 740, 790, 1301])
def test_a_fork_from_a_saved_state_is_the_fork_flown_from_the_start(flight: Flight, tick: int) -> None:
    history, start = flight.history.before(tick), flight.states.before(tick)
    assert start is not None
    assert tick - FIRST_SPACING - 16 < start.tick <= tick
    seen: list[int] = []
    near = flown_to(history, tick, lambda rows: seen.extend(rows["tick"]), start)
    assert seen == list(range(start.tick, tick))
    _assert_same(near, flown_to(history, tick))


def test_every_instant_can_be_saved(flight: Flight) -> None:
    """Also in the middle of a plan that is searched over many ticks, and of a touch."""
    last = flight.mission.snapshot()
    instants = [*range(30, 100, 7), *range(100, END, 97)]
    walking = flight.history.begun()
    reached = walking.save()
    for tick in instants:
        walking = flown_to(flight.history.before(tick), tick, start=reached)
        reached = walking.save()
    assert flown_to(flight.history, END, start=reached).snapshot() == last


def test_the_mission_that_was_saved_flies_on_undisturbed(flight: Flight) -> None:
    again = _flown(flight.history, END, 500)
    _assert_same(again.mission, flown_to(flight.history, END))


def test_so_many_are_kept_however_long_it_lasts() -> None:
    mission, states = Mission(_reduced("becalm")), SavedStates()
    for _ in range(3 * CAPACITY):
        mission.advance(FIRST_SPACING)
        states.keep(mission)
    found = {saved.tick for tick in range(0, mission.next_tick, 100) if (saved := states.before(tick)) is not None}
    assert CAPACITY // 2 <= len(found) <= CAPACITY
    assert max(np.diff(sorted(found))) <= 4 * FIRST_SPACING
    assert states.before(min(found) - 1) is None
    past = states.until(30 * FIRST_SPACING)
    assert past.before(mission.next_tick) == states.before(30 * FIRST_SPACING)


def test_what_cannot_be_copied_is_not_saved() -> None:
    mission, states = Mission(MissionConfig()), SavedStates()
    mission.advance(FIRST_SPACING)
    states.keep(mission)
    assert mission.save() is None
    assert states.before(FIRST_SPACING) is None
    saved = Mission(_reduced("becalm")).save()
    assert saved is not None
    with pytest.raises(PlantError, match="cannot return"):
        mission.restore(saved)
