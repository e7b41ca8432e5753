"""Velocities and the present from late, noisy pictures; contact from noisy wrists."""

from __future__ import annotations

import math

import numpy as np
import pytest

from server.link.perception import Perception
from server.link.streams import HISTORY_SPAN, OtherClock, Stream, WorstOf
from server.link.wire import JointSample, PlaneSample
from sim.config import MissionConfig
from sim.configurations import named_configuration, revised
from sim.model.robot import chain, robot_model
from sim.perception.perceived import PERCEIVED
from sim.plant.plant import PLANT_STATE
from sim.plant.pymunk_plant import PymunkPlant
from tests.flying import after

PERIOD = 10_000_000
DELAY = 10_000_000
CLOCK = 1_700_000_000_000_000_000
"""Of the robot: nanoseconds since 1970, of which a double of seconds keeps too few."""
TWIST = np.array([0.02, -0.01, 1.0])
CONFIG = named_configuration("testbed")
BASE = np.array([0.0, 0.0, 0.3])


def _pose(stamp):
    return np.array([0.1, 0.35, 3.0]) + 1e-9 * (stamp - CLOCK) * TWIST


def _seen(stamp, random, noise=(2e-4, 2e-4, 1e-3)):
    value = _pose(stamp) + random.normal(0, 1, 3) * noise
    value[2] = math.remainder(value[2], math.tau)
    return PlaneSample(stamp, "world", value)


def _known(perception: Perception):
    """State and what is perceived at the last joint state."""
    state, perceived = np.zeros(1, PLANT_STATE)[0], np.zeros(1, PERCEIVED)[0]
    perception.write_state(state, perceived)
    return state, perceived


class Watched:
    """A robot that rests with both arms and sees the target pass, at 100 Hz and 10 ms late; joints come at 200 Hz."""

    def __init__(self, config: MissionConfig = CONFIG) -> None:
        self.perception, self.random = Perception(config), np.random.default_rng(3)
        self.joints = PymunkPlant(config).state["joint_angle"].copy()
        self.stamp = CLOCK

    def go_on(self, change=None) -> str:
        """One picture, and the joint states until it has come; what was said of it."""
        taken = self.stamp
        sample = _seen(taken, self.random)
        if change is not None:
            sample = sample._replace(value=sample.value + change)
        for _ in range(2):
            self.joint_state()
        self.perception.take_base(PlaneSample(taken, "world", BASE.copy()))
        return self.perception.take_target(sample)

    def joint_state(self) -> None:
        self.stamp += PERIOD // 2
        self.perception.take_joints(JointSample(self.stamp, self.joints, np.zeros((2, 3))))

    def push(self, arm: int, force: float) -> None:
        self.perception.take_wrench(arm, PlaneSample(self.stamp, "hand", np.array([force, 0.0, 0.0])))


@pytest.fixture
def settled() -> Watched:
    watched = Watched()
    for _ in range(100):
        watched.go_on()
    return watched


def test_the_velocity_is_far_better_than_differences_of_pictures(settled):
    settled.joint_state()
    twist = _known(settled.perception)[0]["target_twist"]
    differences = math.sqrt(2) * np.array([2e-4, 2e-4, 1e-3]) / 0.01
    assert (np.abs(twist - TWIST) < differences / 5).all()


def test_the_delay_is_made_up_for_by_free_motion(settled):
    """At the last joint state, the newest picture is one and a half periods old."""
    settled.joint_state()
    state, perceived = _known(settled.perception)
    error = state["target_pose"] - _pose(settled.stamp)
    error[2] = math.remainder(error[2], math.tau)
    uncompensated = 1e-9 * DELAY * TWIST[2]
    assert abs(error[2]) < uncompensated / 5
    assert np.abs(error[:2]).max() < 3e-4
    assert perceived["time"] - perceived["target_seen_at"] == pytest.approx(1.5e-9 * PERIOD, abs=1e-12)


def test_an_outlier_is_left_out_and_a_jump_that_stays_is_reported(settled):
    taken = settled.stamp
    assert "an outlier: 100 mm" in settled.go_on(np.array([0.1, 0.0, 0.0]))
    assert settled.perception.outlying_since("target") == taken
    assert settled.perception.outlying_since("base") is None
    assert not settled.go_on()
    assert settled.perception.outlying_since("target") is None


def test_a_blow_is_followed_when_a_wrist_felt_it(settled):
    for step in range(1, 17):
        settled.push(0, 1.0)
        settled.go_on(1e-9 * (step - 1) * PERIOD * np.array([0.05, 0.0, -0.3]))
    settled.joint_state()
    twist = _known(settled.perception)[0]["target_twist"]
    assert twist[0] - TWIST[0] == pytest.approx(0.05, abs=0.02)
    assert twist[2] - TWIST[2] == pytest.approx(-0.3, abs=0.15)


def test_contact_begins_over_the_threshold_and_ends_under_half_of_it(settled):
    told = []
    for force in (0.11, 0.13, 0.07, 0.05, 0.11):
        settled.push(1, force)
        settled.joint_state()
        state, perceived = _known(settled.perception)
        told.append(bool(state["tip_contact"][1].any()))
        assert bool(state["hand_wrench"][1].any()) == bool(perceived["touching"][1]) == told[-1]
        assert not state["hand_wrench"][0].any()
    assert told == [False, True, True, False, False]


def test_the_threshold_is_that_of_the_configuration_in_force(settled):
    told = []
    for threshold in (0.5, 0.3):
        settled.perception.configure(revised(CONFIG, {"perception": {"contact_threshold": threshold}}))
        settled.push(0, 0.4)
        settled.joint_state()
        told.append(bool(_known(settled.perception)[0]["tip_contact"][0].any()))
    assert told == [False, True]


@pytest.mark.parametrize(
    ("changes", "kept"),
    [
        ({"contact_threshold": 0.7}, True),
        ({"filter": {"position": 1e-3}}, False),
        ({"estimator": "model_based"}, False),
        ({"assumed_inertia": 0.02}, False),
    ],
)
def test_a_new_mission_keeps_what_was_seen_unless_it_would_be_made_otherwise(settled, changes, kept):
    assert settled.perception.complete
    settled.perception.begin(revised(CONFIG, {"perception": changes}))
    assert settled.perception.complete == kept


def test_times_are_told_from_where_a_mission_begins(settled):
    before = _known(settled.perception)[0]["target_pose"].copy()
    settled.perception.count_from(settled.stamp)
    state, perceived = _known(settled.perception)
    assert perceived["time"] == pytest.approx(0.0, abs=1e-9)
    assert perceived["target_seen_at"] == pytest.approx(-2e-9 * PERIOD, abs=1e-9)
    assert state["target_pose"] == pytest.approx(before, abs=1e-12)
    settled.go_on()
    settled.joint_state()
    assert _known(settled.perception)[1]["time"] == pytest.approx(1.5e-9 * PERIOD, abs=1e-12)
    assert _known(settled.perception)[0]["target_twist"] == pytest.approx(TWIST, abs=0.02)


def test_nothing_of_the_target_but_its_outline_is_known():
    """What is true of a simulated target, and of no robot's, changes nothing of what is perceived."""
    told = []
    for target in ({}, {"mass": 3.0, "inertia": 0.012, "initial_spin": -2.0, "initial_y": 0.4}):
        watched = Watched(revised(named_configuration("testbed_becalm"), {"target": target}))
        for _ in range(60):
            watched.go_on()
        told.append([each.tobytes() for each in _known(watched.perception)])
    assert told[0] == told[1]


@pytest.mark.parametrize("arm", [0, 1])
@pytest.mark.parametrize("tip", [0, 1])
def test_a_wrists_wrench_is_turned_into_the_worlds_axes_and_given_to_the_tip_that_explains_it(arm, tip):
    """A force at a tip, in the axes of a hand that stands turned: the same vector, written in the world's axes."""
    plant = PymunkPlant(CONFIG)
    angles = plant.state["joint_angle"] + np.array([[0.1, 0.2, -0.8], [-0.3, 0.1, 0.7]])
    perception = Perception(CONFIG)
    base = plant.state["base_pose"].copy()
    perception.take_base(PlaneSample(0, "world", base))
    perception.take_target(PlaneSample(0, "world", plant.state["target_pose"].copy()))
    hand = chain(robot_model(CONFIG.robot), base, angles, np.zeros(2)).hand_pose[arm]
    assert abs(math.sin(hand[2])) > 0.1
    assert abs(math.cos(hand[2])) > 0.1
    lever = np.array([-1.0, 1.0])[tip] * CONFIG.robot.arm.hand.tip_offset  # along the hand's x axis
    in_hand = np.array([0.3, -1.7, lever * -1.7])
    perception.take_wrench(arm, PlaneSample(0, ("left_hand", "right_hand")[arm], in_hand))
    perception.take_joints(JointSample(0, angles, np.zeros((2, 3))))
    state, perceived = _known(perception)
    ahead = np.array([math.cos(hand[2]), math.sin(hand[2])])  # the hand's x axis in the world
    across = np.array([-math.sin(hand[2]), math.cos(hand[2])])
    force = 0.3 * ahead - 1.7 * across
    assert state["hand_wrench"][arm] == pytest.approx([*force, in_hand[2]], abs=1e-12)
    assert state["tip_force"][arm, tip] == pytest.approx(force, abs=1e-12)
    assert state["tip_contact"][arm].tolist() == [tip == 0, tip == 1]
    assert perceived["hand_wrench"][arm] == pytest.approx(state["hand_wrench"][arm], abs=1e-12)
    assert not state["hand_wrench"][1 - arm].any()
    assert not state["tip_force"][arm, 1 - tip].any()


def test_a_state_that_is_told_back_is_the_state():
    plant = PymunkPlant(CONFIG)
    for _ in range(40):
        truth = after(plant, np.array([[0.2, -0.1, 0.3], [0.1, 0.2, -0.3]]))
    perception = Perception(CONFIG)
    joints = JointSample(0, truth["joint_angle"].copy(), np.zeros((2, 3)))
    for step in range(120):
        stamp = step * PERIOD // 2
        truth = after(plant, np.array([[0.2, -0.1, 0.3], [0.1, 0.2, -0.3]]) * math.cos(0.1 * step))
        before = joints.angle
        joints = JointSample(stamp, truth["joint_angle"].copy(), (truth["joint_angle"] - before) / 0.005)
        perception.take_joints(joints)
        if step % 2:
            perception.take_base(PlaneSample(stamp, "world", truth["base_pose"].copy()))
            perception.take_target(PlaneSample(stamp, "world", truth["target_pose"].copy()))
    assert perception.complete
    perception.take_joints(joints._replace(stamp=joints.stamp + 1))
    state, _ = _known(perception)
    # The encoders tell the mean of the last control period; what the filter holds lags by the rest of a change.
    np.testing.assert_allclose(state["base_pose"], truth["base_pose"], atol=1e-4)
    np.testing.assert_allclose(state["base_twist"], truth["base_twist"], atol=5e-3)
    np.testing.assert_allclose(state["target_pose"], truth["target_pose"], atol=1e-6)
    np.testing.assert_allclose(state["target_twist"], truth["target_twist"], atol=1e-6)
    np.testing.assert_allclose(state["momentum"], truth["momentum"], atol=1e-2)


def test_a_stream_knows_its_rate_age_jitter_and_loss():
    stream = Stream(200.0)
    for number in range(400):
        if number % 10:
            stream.arrive(number * 5_000_000, np.array([number]), 100.0 + number * 0.005 + 0.001 * (number % 2))
    rate, jitter, loss = stream.measured(102.0)
    assert rate == pytest.approx(180.0, abs=1.0)
    assert loss == pytest.approx(0.1, abs=0.01)
    assert jitter == pytest.approx(0.0005, rel=0.02)
    assert stream.age(102.0) == pytest.approx(0.004, abs=1e-6)
    assert stream.lost == 39  # nothing is known to be missing before the first


def test_a_stream_takes_nothing_that_is_older_and_knows_when_values_stay():
    stream = Stream(100.0)
    assert stream.arrive(20, np.zeros(3), 1.0)
    assert not stream.arrive(10, np.ones(3), 1.1)
    assert stream.arrive(30, np.zeros(3), 1.5)
    assert stream.unchanged_for == pytest.approx(0.5)
    assert stream.arrive(40, np.ones(3), 1.6)
    assert stream.unchanged_for == 0.0


def test_the_offset_is_that_of_the_quickest_round_trip():
    clock = OtherClock()
    assert clock.offset is None
    ahead = 3_000_000_000
    for there, back in ((200_000, 300_000), (100_000, 100_000), (9_000_000, 1_000_000)):
        clock.note(0, there + ahead, there + back, 1.0)
    assert clock.offset == pytest.approx(3.0, abs=1e-9)
    assert [trip.duration for trip in clock.trips(0.0)] == pytest.approx([5e-4, 2e-4, 1e-2])


def test_what_was_overtaken_by_seconds_is_not_taken_for_a_restarted_clock():
    stream = Stream(100.0)
    assert stream.arrive(9_000_000_000, np.zeros(3), 1.0)
    assert not stream.arrive(5_000_000_000, np.ones(3), 1.01)
    assert stream.latest == 9_000_000_000
    assert stream.arrive(10_000_000, np.ones(3), 3.0)
    assert stream.latest == 10_000_000


def test_the_worst_of_each_step_is_kept_for_a_minute():
    worst = WorstOf()
    for value, at in ((0.002, 100.01), (0.009, 100.05), (0.001, 100.19), (0.004, 100.61)):
        worst.note(value, at)
    assert list(worst.ago(101.0).items()) == [(5, 0.009), (2, 0.004)]
    assert worst.ago(100.21 + HISTORY_SPAN)
    assert not worst.ago(100.9 + HISTORY_SPAN)
