"""With perfect sensors the controller knows the truth; with noise nothing of the truth leaks to it."""

from __future__ import annotations

import numpy as np
import pytest

from sim.capture.mission import Mission
from sim.capture.run import run_capture
from sim.capture.tick_loop import know, recall
from sim.config import MissionConfig
from sim.configurations import named_configuration, nested, revised
from sim.control.phases import Command
from sim.errors import ConfigError
from sim.model.clearance import initial_base_pose, shapes_of
from sim.model.robot import chain, initial_joint_angles, robot_model, tip_position
from sim.perception.contact import is_touching, touching_tip
from sim.perception.perceived import PERCEIVED, perceive
from sim.plant.plant import PLANT_STATE
from sim.record import Record, record_of

CONFIG = MissionConfig()
ROBOT = robot_model(CONFIG.robot)
TARGET = shapes_of(CONFIG)["target"]
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
    perceive(known, record_of(config), ROBOT, TARGET, state)
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
        """Two states whose readings are alike are commanded alike, whatever is true: here, contact."""
        rows = []
        for touched in (0, 1):
            mission = Mission(self.config)
            mission.request(Command.CAPTURE)
            flown = mission.advance(20)
            flown["tip_contact"] = touched
            follower = Mission(self.config)
            follower.request(Command.CAPTURE)
            rows.append(follower.follow(flown))
        assert rows[0]["perceived_contact"].any() == rows[1]["perceived_contact"].any()
        assert np.array_equal(rows[0]["commanded_joint_rate"], rows[1]["commanded_joint_rate"])
        assert np.array_equal(rows[0]["activity"], rows[1]["activity"])


def test_closure_is_asked_of_what_is_perceived() -> None:
    """Hands that truly enclose the target, seen 50 mm apart from where they are: not closed."""
    mission = Mission(CONFIG)
    mission.request(Command.CAPTURE)
    while mission.outcome is None:
        rows = mission.advance(500)
    state, monitor_closed = np.zeros(1, PLANT_STATE)[0], int(rows["closed"][-1])
    recall(rows[-1], state)
    assert monitor_closed == 1
    shapes = shapes_of(CONFIG)
    closed = []
    for config in (CONFIG, revised(CONFIG, nested({"perception.noise.position": 0.05}))):
        known = np.zeros(1, PERCEIVED)[0]
        know(known, record_of(config), ROBOT, shapes, state, monitor_closed)
        closed.append(int(known["closed"]))
    assert closed == [1, 0]


class TestMotionCapture:
    config = revised(
        named_configuration("testbed"),
        nested(
            {
                "perception.source": "motion_capture",
                "perception.noise.position": 2e-4,
                "perception.noise.angle": 1e-3,
                "perception.noise.joint_angle": 6e-6,
                "perception.noise.force": 0.02,
                "perception.noise.torque": 1e-3,
            }
        ),
    )

    def flown(self, changes: dict[str, object], ticks: int = 400) -> np.ndarray:
        """Ticks of a capture's approach, before any touch."""
        mission = Mission(revised(self.config, nested(changes)))
        mission.request(Command.CAPTURE)
        return mission.advance(ticks)

    @staticmethod
    def error(rows: np.ndarray, name: str) -> np.ndarray:
        """Of what is believed, over the ticks: a pose or twist of base or target, shape (ticks, 3)."""
        body, quantity = name.split("_")
        return np.abs(rows[f"{body}_perceived_{quantity}"] - rows[name])

    def test_knows_twists_far_better_than_differences_of_pictures(self) -> None:
        differences = np.sqrt(2) * np.array([2e-4, 2e-4, 1e-3]) * 100.0
        worst = self.error(self.flown({}), "target_twist").max(axis=0)
        assert (worst < differences / 5).all()
        assert (worst > 0.0).all()

    def test_takes_its_pictures(self) -> None:
        """What it believes without them is as wrong as it began, and drifts: on the mean of four seeds."""
        last = []
        for dropouts in (0.0, 1.0 - 1e-12):
            flights = [
                self.flown({"simulation.seed": seed, "perception.capture.dropouts": dropouts}) for seed in range(4)
            ]
            last.append(np.mean([self.error(rows[-40:], "target_pose")[:, 2].mean() for rows in flights]))
        assert last[0] < 0.5 * last[1]

    def test_follows_a_target_that_a_touch_has_slowed(self) -> None:
        pieces: list[np.ndarray] = []
        run_capture(self.config, on_ticks=lambda ticks: pieces.append(ticks.copy()))
        rows = np.concatenate(pieces)
        touched = int(np.argmax(rows["perceived_contact"].any(axis=1)))
        later = rows[touched + 100 : touched + 110]  # half a second after it began
        assert abs(later["target_twist"][0, 2] - rows["target_twist"][0, 2]) > 0.2
        assert self.error(later, "target_twist")[:, 2].max() < 0.05

    def test_takes_as_many_pictures_as_its_rate_says(self) -> None:
        known, parameters = (
            np.zeros(1, PERCEIVED)[0],
            record_of(
                revised(self.config, nested({"perception.capture.rate": 60.0, "perception.capture.dropouts": 0.0}))
            ),
        )
        state = at_start()
        for tick in range(1000):
            state["tick"], state["time"] = tick, 0.005 * tick
            perceive(known, parameters, ROBOT, TARGET, state)
        assert known["cameras"]["after_last"] == 300

    @pytest.mark.parametrize(
        ("changes", "words"),
        [
            ({"perception.capture.rate": 400.0}, r"perception\.capture\.rate = 400 Hz"),
            ({"perception.capture.delay": 1.0}, r"perception\.capture\.delay = 1 s.*0\.6 s late"),
        ],
    )
    def test_that_would_be_forgotten_on_its_way_is_refused(self, changes: dict[str, object], words: str) -> None:
        with pytest.raises(ConfigError, match=words):
            revised(self.config, nested(changes))

    def test_of_a_replay_is_the_same_though_ticks_at_rest_are_not_recorded(self) -> None:
        mission = Mission(self.config)
        first = mission.advance(300)[:1].copy()
        mission.request(Command.CAPTURE)
        rows = mission.advance(200)
        follower = Mission(self.config)
        follower.follow(first)
        follower.recall(rows[0])
        follower.request(Command.CAPTURE)
        assert follower.follow(rows).tobytes() == rows.tobytes()

    def test_makes_up_for_the_delay_of_base_and_target(self) -> None:
        """At 50 ms delay a target at 1 rad/s would be 50 mrad behind, and the base by what the arms moved it."""
        rows = self.flown({"perception.capture.delay": 0.05})
        target = rows["target_perceived_pose"] - rows["target_pose"]
        assert np.abs(target[:, 2]).max() < 5e-3
        base = rows["base_perceived_pose"] - rows["base_pose"]
        moved = np.ptp(rows["base_pose"][:, 2])
        assert moved > 0.02
        assert np.abs(base[:, 2]).max() < 4e-3
        assert np.abs(base[:, :2]).max() < 1e-3

    def test_lives_through_gaps(self) -> None:
        rows = self.flown({"perception.capture.dropouts": 0.8})
        assert np.abs(rows["target_perceived_pose"] - rows["target_pose"]).max() < 5e-3

    def test_is_repeatable_and_unlike_another_seeds(self) -> None:
        one, again, other = (self.flown({"simulation.seed": seed}, 60) for seed in (1, 1, 2))
        assert one.tobytes() == again.tobytes()
        assert not np.array_equal(one["target_perceived_pose"], other["target_perceived_pose"])

    def test_of_a_replay_is_the_same(self) -> None:
        rows = self.flown({})
        follower = Mission(self.config)
        follower.request(Command.CAPTURE)
        assert np.array_equal(follower.follow(rows)["commanded_joint_rate"], rows["commanded_joint_rate"])
