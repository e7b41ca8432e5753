"""Sensor noise: as large as it says, the same wherever and whenever it is drawn, and nothing at all without it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import kstest

from sim.capture.mission import Mission
from sim.config import MissionConfig
from sim.configurations import nested, revised
from sim.control.phases import Command
from sim.perception.perceived import PERCEIVED
from sim.perception.sensing import add_noise, gaussian
from sim.record import record_of

NOISY = {
    "perception.noise.position": 1e-3,
    "perception.noise.angle": 2e-3,
    "perception.noise.velocity": 3e-3,
    "perception.noise.spin": 4e-3,
    "perception.noise.joint_angle": 5e-4,
    "perception.noise.joint_rate": 6e-3,
    "perception.noise.force": 7e-3,
    "perception.noise.torque": 8e-4,
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


def test_pairs_are_standard_normal():
    config = revised(MissionConfig(), nested({**NOISY, "perception.noise.draws": "in_pairs"}))
    noise, draws = record_of(config)["perception"]["noise"], []
    for tick in range(4000):
        known = np.zeros(1, PERCEIVED)[0]
        known["tick"] = tick
        add_noise(noise, 3, known)
        draws.append([*(known["base_pose"][:2] / 1e-3), *(known["base_twist"][:2] / 3e-3)])
    assert kstest(np.ravel(draws), "norm").pvalue > 0.01


SPREADS = {
    "base_pose": [1e-3, 1e-3, 2e-3],
    "base_twist": [3e-3, 3e-3, 4e-3],
    "target_pose": [1e-3, 1e-3, 2e-3],
    "target_twist": [3e-3, 3e-3, 4e-3],
    "joint_angle": 6 * [5e-4],
    "joint_rate": 6 * [6e-3],
    "hand_wrench": 2 * [7e-3, 7e-3, 8e-4],
}


def _sensed(state, draws, ticks=2000):
    """What is read of this state at so many ticks, less the state itself, by field: shape (ticks, numbers)."""
    config = revised(MissionConfig(), nested({**NOISY, "perception.noise.draws": draws}))
    noise = record_of(config)["perception"]["noise"]
    kept = []
    for tick in range(ticks):
        state["tick"] = tick
        known = state.copy()
        add_noise(noise, 5, known)
        kept.append(known)
    readings = (name for name in PERCEIVED.names if PERCEIVED[name].names is None)  # the others are remembered
    fields = [name for name in readings if name != "tick"]
    return {name: np.array([np.ravel(row[name] - state[name]) for row in kept], float) for name in fields}


@pytest.mark.parametrize("draws", ["singly", "in_pairs"])
def test_every_channel_has_the_noise_of_its_own_sensor_around_the_true_value(draws):
    state = np.zeros(1, PERCEIVED)[0]
    for place, name in enumerate(SPREADS):
        state[name] = np.arange(state[name].size).reshape(state[name].shape) + 10.0 * place
    sensed = _sensed(state, draws)
    for name, errors in sensed.items():
        spread = np.array(SPREADS.get(name, [0.0] * errors.shape[1]))
        assert errors.std(axis=0) == pytest.approx(spread, rel=0.1), name
        assert np.abs(errors.mean(axis=0)).max() <= 5.0 * spread.max() / math.sqrt(len(errors)), name


@pytest.mark.parametrize("draws", ["singly", "in_pairs"])
def test_no_two_channels_hear_the_same_noise(draws):
    sensed = _sensed(np.zeros(1, PERCEIVED)[0], draws)
    channels = np.hstack([sensed[name] for name in SPREADS])
    assert channels.shape[1] == 30
    assert np.abs(np.corrcoef(channels.T) - np.eye(30)).max() < 0.1


def test_without_noise_nothing_changes_by_the_seed():
    rows = [flown({"simulation.seed": seed})[1] for seed in (1, 2)]
    assert rows[0].tobytes() == rows[1].tobytes()


def test_the_same_seed_gives_the_same_flight_and_another_another():
    same, again, other = (flown({**NOISY, "simulation.seed": seed})[1] for seed in (1, 1, 2))
    assert same.tobytes() == again.tobytes()
    assert not np.array_equal(same["commanded_joint_rate"], other["commanded_joint_rate"])


@pytest.mark.parametrize("draws", ["singly", "in_pairs"])
def test_a_replay_hears_the_same_noise(draws):
    noisy = {**NOISY, "perception.noise.draws": draws}
    _, rows = flown(noisy)
    follower = Mission(revised(MissionConfig(), nested(noisy)))
    follower.request(Command.CAPTURE)
    assert np.array_equal(follower.follow(rows)["commanded_joint_rate"], rows["commanded_joint_rate"])


def test_the_log_has_the_truth_and_beside_it_what_was_known():
    _, rows = flown({"perception.noise.position": 1e-3}, ticks=50)
    assert np.abs(np.diff(rows["target_pose"][:, 0])).max() < 1e-9
    errors = rows["target_perceived_pose"][:, :2] - rows["target_pose"][:, :2]
    assert errors.std() == pytest.approx(1e-3, rel=0.2)
    assert np.array_equal(rows["target_perceived_pose"][:, 2], rows["target_pose"][:, 2])
