"""Replay: a history gives the same ticks again, and recorded states the same commands, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

from sim.capture.mission import Mission
from sim.capture.replay import (
    FlightHistory,
    Intervention,
    controlled,
    first_difference,
    flown_to,
    intervene,
    rerun,
)
from sim.config import MissionConfig
from sim.configurations import nested, revised
from sim.control.phases import Command, Phase
from sim.errors import MissionRefused

HISTORY = FlightHistory(
    config=MissionConfig(),
    interventions=(
        Intervention(tick=137, command=Command.CAPTURE),
        Intervention(tick=3470, changes={"published.impedance.damping": 3.0, "published.impedance.mass": 0.05}),
        Intervention(tick=3600, command=Command.HOLD),
        Intervention(tick=3600, changes={"published.impedance.damping": 0.7}),
        Intervention(tick=3611, command=Command.CAGE),
        Intervention(tick=3900, command=Command.STOP),
    ),
)
END = 4000


@pytest.fixture(scope="module")
def flown():
    """The ticks of that history, flown as an operator would: one call a tick around each intervention."""
    mission, rows = Mission(HISTORY.config), []
    left = list(HISTORY.interventions)
    while mission.next_tick < END:
        while left and left[0].tick == mission.next_tick:
            intervene(mission, left.pop(0))
        until = left[0].tick if left else END
        rows.append(mission.advance(min(17, until - mission.next_tick)))
    return np.concatenate(rows)


def test_rerun_is_the_same_to_the_last_bit(flown):
    again = np.concatenate(list(rerun(HISTORY, END)))
    assert first_difference(flown, again) is None
    assert again.tobytes() == flown.tobytes()


def test_history_survives_json(flown):
    read = FlightHistory.model_validate_json(HISTORY.model_dump_json())
    assert read == HISTORY
    assert np.concatenate(list(rerun(read, 3500))).tobytes() == flown[:3500].tobytes()


@pytest.mark.parametrize("tick", [0, 1, 3470, 3600, 3950])
def test_flown_to_any_tick_goes_on_as_it_did(flown, tick):
    mission = flown_to(HISTORY, tick)
    assert mission.next_tick == tick
    for intervention in HISTORY.interventions:
        if intervention.tick == tick:
            intervene(mission, intervention)
    assert mission.advance(11).tobytes() == flown[tick : tick + 11].tobytes()


def test_what_is_granted_at_the_tick_is_left_undone():
    assert flown_to(HISTORY, 137).phase is Phase.IDLE
    assert flown_to(HISTORY, 138).phase is Phase.DETUMBLING
    assert flown_to(HISTORY, 3470).config.published.impedance.damping == 1.5
    assert flown_to(HISTORY, 3471).config.published.impedance.damping == 3.0


@pytest.mark.parametrize("size", [1000, 333])
def test_recorded_states_give_the_same_commands(flown, size):
    pieces = [flown[first : first + size] for first in range(0, END, size)]
    again = np.concatenate(list(controlled(HISTORY, pieces)))
    assert first_difference(flown, again) is None


def test_ticks_at_rest_may_be_missing(flown):
    kept = np.concatenate([flown[:1], flown[137:]])
    again = np.concatenate(list(controlled(HISTORY, [kept])))
    assert first_difference(kept, again) is None


def test_another_controller_is_found_at_its_first_command(flown):
    other = HISTORY.model_copy(
        update={"config": revised(HISTORY.config, nested({"published.touch.contact_position": 0.7}))}
    )
    difference = first_difference(flown, np.concatenate(list(controlled(other, [flown]))))
    assert difference.tick >= 137
    assert difference.time == pytest.approx(difference.tick * 1e-3)
    assert difference.recorded != difference.now


def test_difference_is_the_first_and_of_a_single_bit(flown):
    changed = flown.copy()
    changed["commanded_joint_rate"][200, 1, 2] = np.nextafter(changed["commanded_joint_rate"][200, 1, 2], 9)
    changed["base_pose"][300, 0] += 1.0
    difference = first_difference(flown, changed)
    assert (difference.tick, difference.quantity) == (200, "right.commanded_joint_rate.3")


def test_minus_zero_differs_and_nan_equals_itself(flown):
    rows = flown[:3].copy()
    rows["momentum"][:, 0] = [np.nan, 0.0, 0.0]
    other = rows.copy()
    assert first_difference(rows, other) is None
    other["momentum"][2, 0] = -0.0
    assert first_difference(rows, other).tick == 2


def test_what_no_mission_grants_is_refused():
    impossible = FlightHistory(config=MissionConfig(), interventions=(Intervention(tick=3, command=Command.RELEASE),))
    with pytest.raises(MissionRefused, match="release"):
        flown_to(impossible, 10)
