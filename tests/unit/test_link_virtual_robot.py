"""Our own method on the emulated testbed in virtual time: caged by what the robot's sensors say, and replayed so."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from server.link.imperfections import Imperfections
from server.link.virtual_robot import VirtualRobot
from sim.capture.caging import cage
from sim.capture.events import Ticks
from sim.capture.mission import Mission
from sim.capture.replay import FlightHistory, Intervention, controlled, first_difference, rerun
from sim.capture.tick import TICK
from sim.configurations import named_configuration, revised
from sim.control.phases import Command
from sim.errors import MissionRefused
from sim.plant.plant import PLANT_STATE
from sim.rehearsal.situation import Situation
from sim.snapshot import Outcome

CONFIG = named_configuration("testbed_becalm")


class Flown(NamedTuple):
    robot: VirtualRobot
    mission: Mission
    outcome: Outcome
    ticks: Ticks
    truth: np.ndarray
    """True states, an array of `PLANT_STATE`, one a tick."""
    touching: Situation
    """Of the mission while both hands pressed."""


@pytest.fixture(scope="module")
def flown() -> Flown:
    robot = VirtualRobot(CONFIG, Imperfections(), 0)
    mission, touching = Mission(CONFIG, robot), None
    mission.request(Command.CAPTURE)
    rows, truth = [], np.zeros(4000, PLANT_STATE)
    while mission.outcome is None and len(rows) < len(truth):
        rows.append(mission.advance(1))
        truth[len(rows) - 1] = robot.testbed.state
        if touching is None and rows[-1][0]["perceived_contact"].all():
            touching = Situation.of(mission)
    assert mission.outcome is not None
    assert touching is not None
    return Flown(robot, mission, mission.outcome, np.concatenate(rows), truth[: len(rows)], touching)


def history(flown: Flown) -> FlightHistory:
    first = int(flown.ticks["tick"][0])
    return FlightHistory(config=CONFIG, interventions=(Intervention(tick=first, command=Command.CAPTURE),), robot=True)


def test_it_cages_softly(flown: Flown) -> None:
    testbed = flown.robot.testbed
    assert flown.outcome.caged
    assert cage(CONFIG, testbed.hand_pose(), testbed.state["target_pose"]).margin > 0.005
    assert testbed.peak_force < 0.6


def test_what_is_perceived_is_what_is(flown: Flown) -> None:
    """Frames, signs and delay of every reading: each would be wrong by a multiple of these bounds."""
    ticks, truth = flown.ticks, flown.truth
    for body in ("base", "target"):
        apart = ticks[f"{body}_perceived_pose"] - truth[f"{body}_pose"]
        apart[:, 2] = np.remainder(apart[:, 2] + np.pi, 2.0 * np.pi) - np.pi
        assert np.abs(apart[:, :2]).max() < 6e-4
        assert np.abs(apart[:, 2]).max() < 6e-3
        twist = ticks[f"{body}_perceived_twist"] - truth[f"{body}_twist"]
        assert np.abs(twist[:, :2]).max() < 6e-3
        assert np.quantile(np.abs(twist[:, 2]), 0.95) < 0.03
    pressed = np.hypot(*truth["hand_wrench"][:, :, :2].transpose(2, 0, 1)) > 0.1
    force = ticks["perceived_hand_wrench"] - truth["hand_wrench"]
    assert pressed.sum() > 50
    assert np.quantile(np.hypot(force[..., 0], force[..., 1])[pressed], 0.9) < 0.08
    assert np.quantile(np.hypot(force[..., 0], force[..., 1])[pressed], 0.9) < 0.06
    inertia = float(ticks["target_perceived_inertia"][-1])
    assert inertia == pytest.approx(CONFIG.target.inertia, rel=0.1)


def test_a_replay_knows_what_the_robot_knew(flown: Flown) -> None:
    """The controller is driven through the recorded ticks, and commands the same, to the last bit."""
    now = np.concatenate(list(controlled(history(flown), np.array_split(flown.ticks, 5))))
    assert now.dtype == TICK
    assert first_difference(flown.ticks, now) is None


def test_a_robots_flight_is_not_flown_again_in_the_simulation(flown: Flown) -> None:
    with pytest.raises(MissionRefused, match="a robot was flown"):
        next(rerun(history(flown), 10))


def test_a_future_begins_with_what_the_link_has_learnt(flown: Flown) -> None:
    situation = flown.touching
    estimate = situation.estimate
    assert estimate is not None
    assert situation.touching
    behind = situation.time - 1e-9 * float(estimate["target"]["stamp"])
    assert 0.0 < behind < 0.04
    assert situation.state["target_pose"] == pytest.approx(
        flown.truth[np.searchsorted(flown.ticks["time"], situation.time)]["target_pose"], abs=0.02
    )


def test_noise_that_is_configured_is_added_to_nothing_that_a_robot_reads() -> None:
    noisy = revised(CONFIG, {"perception": {"noise": {"position": 0.05, "force": 1.0}}})
    told = []
    for config in (CONFIG, noisy):
        mission = Mission(config, VirtualRobot(config, Imperfections(), 3))
        mission.request(Command.CAPTURE)
        told.append(mission.advance(40).tobytes())
    assert told[0] == told[1]
