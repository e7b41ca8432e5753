"""Sensor noise: as large as it says, the same wherever and whenever it is drawn, and nothing at all without it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import kstest

from sim.capture.mission import Mission
from sim.config import MissionConfig
from sim.configurations import nested, revised
from sim.control.phases import Command
from sim.plant.plant import PLANT_STATE
from sim.plant.sensing import gaussian, sense
from sim.record import record_of

NOISY = {
    "sensing.noise.position": 1e-3,
    "sensing.noise.angle": 2e-3,
    "sensing.noise.velocity": 3e-3,
    "sensing.noise.spin": 4e-3,
    "sensing.noise.joint_angle": 5e-4,
    "sensing.noise.joint_rate": 6e-3,
    "sensing.noise.force": 7e-3,
    "sensing.noise.torque": 8e-4,
}


def flown(changes, ticks=3000):
    mission = Mission(revised(MissionConfig(), nested(changes)))
    mission.request(Command.CAPTURE)
    return mission, mission.advance(ticks)


def test_draws_are_standard_normal_and_unlike_their_neighbours():
    draws = np.array([[gaussian(3, tick, channel) for tick in range(4000)] for channel in range(3)])
    assert kstest(draws.ravel(), "norm").pvalue > 0.01
    assert np.abs(np.corrcoef(draws) - np.eye(3)).max() < 0.06
    assert abs(np.corrcoef(draws[0, 1:], draws[0, :-1])[0, 1]) < 0.06
    other_seed = np.array([gaussian(4, tick, 0) for tick in range(4000)])
    assert abs(np.corrcoef(draws[0], other_seed)[0, 1]) < 0.06


def test_each_sensor_has_its_own_noise():
    noise = record_of(revised(MissionConfig(), nested(NOISY)))["sensing"]["noise"]
    state, seen = np.zeros(1, PLANT_STATE)[0], np.zeros(1, PLANT_STATE)
    kept = []
    for tick in range(2000):
        state["tick"] = tick
        sense(noise, 5, state, seen)
        kept.append(seen[0].copy())
    spread = {name: np.std([row[name] for row in kept], axis=0) for name in PLANT_STATE.names}
    assert spread["target_pose"] == pytest.approx([1e-3, 1e-3, 2e-3], rel=0.1)
    assert spread["base_twist"] == pytest.approx([3e-3, 3e-3, 4e-3], rel=0.1)
    assert spread["joint_angle"].ravel() == pytest.approx(6 * [5e-4], rel=0.1)
    assert spread["joint_rate"].ravel() == pytest.approx(6 * [6e-3], rel=0.1)
    assert spread["hand_wrench"].ravel() == pytest.approx(2 * [7e-3, 7e-3, 8e-4], rel=0.1)
    assert not spread["momentum"].any()


def test_without_noise_nothing_changes_by_the_seed():
    rows = [flown({"simulation.seed": seed})[1] for seed in (1, 2)]
    assert rows[0].tobytes() == rows[1].tobytes()


def test_the_same_seed_gives_the_same_flight_and_another_another():
    same, again, other = (flown({**NOISY, "simulation.seed": seed})[1] for seed in (1, 1, 2))
    assert same.tobytes() == again.tobytes()
    assert not np.array_equal(same["commanded_joint_rate"], other["commanded_joint_rate"])


def test_a_replay_hears_the_same_noise():
    _, rows = flown(NOISY)
    follower = Mission(revised(MissionConfig(), nested(NOISY)))
    follower.request(Command.CAPTURE)
    assert np.array_equal(follower.follow(rows)["commanded_joint_rate"], rows["commanded_joint_rate"])


def test_the_log_tells_the_truth():
    _, rows = flown({"sensing.noise.position": 1e-3}, ticks=50)
    moved = np.diff(rows["target_pose"][:, 0])
    assert np.abs(moved).max() < 1e-9
