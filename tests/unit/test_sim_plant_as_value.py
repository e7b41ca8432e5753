"""A plant is a value: a mission flies any that has the protocol, and configuration names the simulated ones."""

from __future__ import annotations

import numpy as np
import pytest

from sim.capture.mission import Mission
from sim.capture.tick import TICK
from sim.capture.tick_loop import recall
from sim.config import Engine, MissionConfig
from sim.configurations import revised
from sim.control.phases import Command, Phase
from sim.errors import ConfigError, PlantError
from sim.plant.engine import ENGINES, simulated_plant
from sim.plant.plant import PLANT_STATE
from sim.plant.scripted_plant import ScriptedPlant

TICKS = 50


@pytest.fixture(scope="module")
def flown() -> np.ndarray:
    """The first ticks of a capture."""
    mission = Mission(MissionConfig())
    mission.request(Command.CAPTURE)
    return mission.advance(TICKS)


def script_of(ticks: np.ndarray) -> np.ndarray:
    """The plant's states in recorded ticks."""
    states = np.zeros(len(ticks), PLANT_STATE)
    rows = np.empty(len(ticks), TICK)
    rows[:] = ticks
    for place in range(len(ticks)):
        recall(rows[place], states[place])
    return states


class TestEngine:
    def test_every_name_makes_a_plant_as_configured(self):
        assert set(ENGINES) == set(Engine)
        for engine in Engine:
            plant = simulated_plant(revised(MissionConfig(), {"simulation": {"engine": engine.value}}))
            assert plant.state["target_twist"].tolist() == [0.0, 0.0, 1.0]
            assert plant.next_tick == 0

    def test_one_that_does_not_exist_is_refused_with_those_that_do(self):
        with pytest.raises(ConfigError, match=r"simulation\.engine = 'bullet'") as refused:
            revised(MissionConfig(), {"simulation": {"engine": "bullet"}})
        for engine in Engine:
            assert f"'{engine.value}'" in str(refused.value)


class TestScriptedPlant:
    def test_a_mission_commands_what_it_commanded_in_the_same_states_of_another_plant(self, flown):
        plant = ScriptedPlant(script_of(flown))
        mission = Mission(MissionConfig(), plant)
        mission.request(Command.CAPTURE)
        rows = mission.advance(TICKS)
        assert np.array_equal(rows, flown)
        assert np.array_equal(plant.commanded_joint_rates, flown["commanded_joint_rate"])
        assert np.abs(flown["commanded_joint_rate"]).max() > 0.05

    def test_its_end_is_a_fault_of_the_plant(self, flown):
        mission = Mission(MissionConfig(), ScriptedPlant(script_of(flown)[:3]))
        assert len(mission.advance(TICKS)) == 3
        assert mission.phase is Phase.FAULTED
        with pytest.raises(PlantError, match="ended after 3 states"):
            mission.advance(1)

    def test_a_command_holds_from_the_tick_that_is_observed_next(self, flown):
        mission = Mission(MissionConfig(), ScriptedPlant(script_of(flown)))
        mission.advance(10)
        assert mission.next_tick == 10
        mission.request(Command.CAPTURE)
        assert mission.advance(1)["phase"].tolist() == [Phase.DETUMBLING]

    def test_no_states_are_refused(self):
        with pytest.raises(ValueError, match="0 of them"):
            ScriptedPlant(np.zeros(0, PLANT_STATE))
