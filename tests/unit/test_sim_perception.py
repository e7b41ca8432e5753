"""With perfect sensors the controller knows the truth; with noise nothing of the truth leaks to it."""

from __future__ import annotations

import numpy as np
import pytest

from sim.capture.mission import Mission
from sim.config import MissionConfig
from sim.configurations import nested, revised
from sim.control.phases import Command
from sim.model.clearance import initial_base_pose
from sim.model.robot import chain, initial_joint_angles, robot_model, tip_position
from sim.perception.contact import is_touching, touching_tip
from sim.perception.perceived import PERCEIVED, perceive
from sim.plant.plant import PLANT_STATE
from sim.record import Record, record_of

CONFIG = MissionConfig()
ROBOT = robot_model(CONFIG.robot)
NOISY = {"perception.noise.force": 0.01, "perception.noise.position": 5e-4, "perception.noise.torque": 1e-4}


def at_start() -> Record:
    state = np.zeros(1, PLANT_STATE)[0]
    state["base_pose"] = initial_base_pose(CONFIG)
    state["joint_angle"] = initial_joint_angles(CONFIG.robot.arm)
    state["target_pose"], state["target_twist"] = (0.0, 0.35, 0.0), (0.0, 0.0, 1.0)
    return state


def known_of(state: Record, config: MissionConfig, known: Record | None = None) -> Record:
    """What is known of a state, after what was known before."""
    known = np.zeros(1, PERCEIVED)[0] if known is None else known
    links = chain(ROBOT, state["base_pose"], state["joint_angle"], state["mount_angle"])
    perceive(known, record_of(config), ROBOT, state, links)
    return known


@pytest.mark.parametrize(
    ("before", "force", "after"),
    [(False, 0.11, False), (False, 0.13, True), (True, 0.07, True), (True, 0.05, False)],
)
def test_contact_begins_above_its_threshold_and_ends_under_half_of_it(before: bool, force: float, after: bool) -> None:
    assert is_touching(before, force, 0.12) is after


@pytest.mark.parametrize("tip", [0, 1])
@pytest.mark.parametrize("angle", [0.0, 1.1, -2.3])
def test_the_touching_tip_is_the_one_whose_lever_makes_the_torque(tip: int, angle: float) -> None:
    pose, force = np.array([0.3, -0.2, angle]), np.array([0.4, 0.7])
    x, y = tip_position(ROBOT, pose, tip)
    torque = (x - pose[0]) * force[1] - (y - pose[1]) * force[0]
    assert touching_tip(ROBOT, pose, np.array([*force, torque])) == tip


class TestPerfectSensors:
    def test_know_the_truth(self) -> None:
        state = at_start()
        state["hand_wrench"][1], state["tip_contact"][1, 0] = (1e-3, 0.0, 0.0), 1
        known = known_of(state, CONFIG)
        for name in ("base_pose", "target_pose", "target_twist", "joint_angle", "hand_wrench", "tip_contact"):
            assert np.array_equal(known[name], state[name]), name
        assert known["touching"].tolist() == [0, 1]


class TestNoise:
    config = revised(CONFIG, nested(NOISY))

    def test_hides_a_contact_that_no_wrist_can_tell(self) -> None:
        state = at_start()
        state["hand_wrench"][1], state["tip_contact"][1, 0] = (0.05, 0.0, 0.0), 1
        known = known_of(state, self.config)
        assert not known["tip_contact"].any()
        assert not known["hand_wrench"].any()

    def test_lets_a_firm_contact_through_with_its_tip(self) -> None:
        state = at_start()
        links = chain(ROBOT, state["base_pose"], state["joint_angle"], state["mount_angle"])
        x, y = tip_position(ROBOT, links.hand_pose[1], 1)
        lever = x - links.hand_pose[1, 0], y - links.hand_pose[1, 1]
        state["hand_wrench"][1] = 0.8, 0.0, -lever[1] * 0.8
        known = known_of(state, self.config)
        assert known["tip_contact"].tolist() == [[0, 0], [0, 1]]
        assert known["hand_wrench"][1, 0] == pytest.approx(0.8, abs=0.06)
        assert not known["hand_wrench"][0].any()

    def test_remembers_a_contact_until_its_force_has_fallen(self) -> None:
        state = at_start()
        known = None
        felt = []
        for tick, force in enumerate((0.3, 0.09, 0.0)):
            state["tick"], state["hand_wrench"][0] = tick, (force, 0.0, 0.0)
            known = known_of(state, self.config, known)
            felt.append(int(known["touching"][0]))
        assert felt == [1, 1, 0]

    def test_leaks_nothing_of_the_truth_to_the_controller(self) -> None:
        """Two states whose readings are alike are commanded alike, whatever is true: here, contact and closure."""
        rows = []
        for touched in (0, 1):
            mission = Mission(self.config)
            mission.request(Command.CAPTURE)
            flown = mission.advance(20)
            flown["tip_contact"], flown["closed"] = touched, touched
            follower = Mission(self.config)
            follower.request(Command.CAPTURE)
            rows.append(follower.follow(flown))
        assert rows[0]["perceived_contact"].any() == rows[1]["perceived_contact"].any()
        assert np.array_equal(rows[0]["commanded_joint_rate"], rows[1]["commanded_joint_rate"])
        assert np.array_equal(rows[0]["activity"], rows[1]["activity"])
