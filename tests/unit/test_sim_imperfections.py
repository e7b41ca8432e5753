"""What sensors get wrong beside noise: as large and as often as it says, the same for a seed, and in a flight."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from sim.capture.mission import Mission
from sim.config import ImperfectionsConfig, MissionConfig, WristConfig, WristsConfig
from sim.configurations import nested, revised
from sim.control.phases import Command
from sim.perception.imperfections import (
    add_imperfections,
    is_imperfect,
    is_miscalibrated,
    is_missed,
    miscalibrate,
    misplacement,
)
from sim.perception.perceived import PERCEIVED
from sim.record import Record, record_of

CONFIG = MissionConfig()
SAMPLES = 4000
EVERY = {
    "perception.source": "motion_capture",
    "perception.imperfections.force_bias": 0.05,
    "perception.imperfections.torque_bias": 1e-3,
    "perception.imperfections.encoder_resolution": 1e-4,
    "perception.imperfections.outliers": 0.02,
}


def imperfect(**values: float) -> Record:
    return record_of(ImperfectionsConfig(**values))


def bias(record: Record, seed: int, hand_angle: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """What a wrist reads that feels nothing, world axes, shape (2, 3)."""
    known = np.zeros(1, PERCEIVED)[0]
    add_imperfections(record, seed, np.array(hand_angle), known)
    wrench: np.ndarray = known["hand_wrench"].copy()
    return wrench


def flown(changes: dict[str, object], ticks: int = 1500) -> np.ndarray:
    mission = Mission(revised(CONFIG, nested(changes)))
    mission.request(Command.CAPTURE)
    return mission.advance(ticks)


def test_none_are_there_unless_asked_for():
    assert not is_imperfect(imperfect())
    assert not bias(imperfect(), 1).any()
    assert not any(is_missed(0.0, 3, tick, body) for tick in range(SAMPLES) for body in (0, 1))
    assert all(misplacement(imperfect(), 3, tick, 0) == (0.0, 0.0) for tick in range(SAMPLES))


def test_a_bias_is_as_large_as_it_says_and_each_wrists_own():
    drawn = np.array([bias(imperfect(force_bias=0.2, torque_bias=5e-3), seed) for seed in range(SAMPLES)])
    assert drawn.std(axis=0) == pytest.approx(np.array([[0.2, 0.2, 5e-3]] * 2), rel=0.06)
    assert np.abs(np.corrcoef(drawn.reshape(SAMPLES, 6).T) - np.eye(6)).max() < 0.06


def test_a_bias_turns_with_its_hand():
    record = imperfect(force_bias=0.2, torque_bias=5e-3)
    still, turned = bias(record, 7), bias(record, 7, (math.pi / 6, -0.4))
    for arm, angle in enumerate((math.pi / 6, -0.4)):
        force = complex(*still[arm, :2]) * cmath.rect(1.0, angle)
        assert turned[arm] == pytest.approx([force.real, force.imag, still[arm, 2]])


def test_encoders_have_steps():
    known = np.zeros(1, PERCEIVED)[0]
    known["joint_angle"] = [[0.013, 0.016, -0.013], [-0.016, 0.0, 1.0]]
    add_imperfections(imperfect(encoder_resolution=0.01), 0, np.zeros(2), known)
    assert known["joint_angle"] == pytest.approx(np.array([[0.01, 0.02, -0.01], [-0.02, 0.0, 1.0]]))


def test_pictures_are_missed_and_misplaced_as_often_and_as_far_as_it_says():
    record = imperfect(outliers=0.1, outlier_distance=0.5)
    assert np.mean([is_missed(0.2, 1, tick, 0) for tick in range(SAMPLES)]) == pytest.approx(0.2, abs=0.032)
    aside = np.array([misplacement(record, 1, tick, 1) for tick in range(SAMPLES)])
    distance = np.hypot(*aside.T)
    far = aside[distance > 0.0]
    assert len(far) / SAMPLES == pytest.approx(0.1, abs=0.024)
    assert distance[distance > 0.0] == pytest.approx(np.full(len(far), 0.5))
    assert np.abs(far.mean(axis=0)).max() < 0.1, "they lie to one side"


def test_a_flight_has_them_in_what_is_perceived_and_not_in_the_truth():
    rows = flown({"perception.imperfections.force_bias": 0.5}, ticks=200)
    assert not rows["hand_wrench"].any()
    felt = rows["perceived_hand_wrench"]
    assert felt[:, :, :2].any(), "no bias above the contact threshold is felt"
    size = np.hypot(felt[..., 0], felt[..., 1])
    for arm in range(2):
        assert len(np.unique(np.round(size[size[:, arm] > 0.0, arm], 12))) <= 1, "a bias changes"


def test_the_same_seed_gives_the_same_flight_and_a_replay_measures_the_same():
    same, again, other = (flown({**EVERY, "simulation.seed": seed}) for seed in (1, 1, 2))
    assert same.tobytes() == again.tobytes()
    assert not np.array_equal(same["target_perceived_pose"], other["target_perceived_pose"])
    follower = Mission(revised(CONFIG, nested({**EVERY, "simulation.seed": 1})))
    follower.request(Command.CAPTURE)
    assert np.array_equal(follower.follow(same)["commanded_joint_rate"], same["commanded_joint_rate"])


def test_outliers_are_left_out_by_the_filter():
    pictures = {"perception.source": "motion_capture", "perception.imperfections.outlier_distance": 0.5}
    errors = []
    for part in (0.0, 0.05):
        rows = flown({**pictures, "perception.imperfections.outliers": part}, ticks=800)
        errors.append(np.abs(rows["target_perceived_pose"][:, :2] - rows["target_pose"][:, :2]).max())
    assert errors[1] < 2.0 * errors[0] + 1e-3


def test_a_wrist_reads_by_its_gain_and_bias_which_turns_with_the_hand():
    wrists = record_of(WristsConfig(right=WristConfig(gain=1.2, bias_x=0.3, bias_torque=-0.01)))
    assert is_miscalibrated(wrists)
    assert not is_miscalibrated(record_of(WristsConfig()))
    known = np.zeros(1, PERCEIVED)[0]
    known["hand_wrench"] = [[1.0, 2.0, 0.1], [1.0, 2.0, 0.1]]
    miscalibrate(wrists, np.array([0.0, math.pi / 2]), known)
    assert known["hand_wrench"][0].tolist() == [1.0, 2.0, 0.1]
    assert known["hand_wrench"][1] == pytest.approx([1.2, 2.4 + 0.3, 0.12 - 0.01])


def test_a_capture_feels_with_such_wrists():
    usual: dict[str, object] = {}
    strange: dict[str, object] = {"perception.wrist.right.gain": 1.5}
    felt = [flown(changes, 4000)["perceived_hand_wrench"][:, 1] for changes in (usual, strange)]
    true = flown(strange, 4000)["hand_wrench"][:, 1]
    touching = np.abs(felt[1]).max(axis=1) > 0.0
    assert touching.any()
    assert felt[1][touching] == pytest.approx(1.5 * true[touching])
    assert felt[0].max() != pytest.approx(felt[1].max(), rel=0.05)
