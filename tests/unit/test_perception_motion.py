"""What the model-based estimator makes of readings: noise, delays, forces felt, an inertia that nobody knows, bias."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

from sim.compiled import FloatArray
from sim.config import MissionConfig
from sim.configurations import named_configuration, nested, revised
from sim.model.clearance import initial_base_pose
from sim.model.robot import chain, initial_joint_angles, robot_model, tip_position
from sim.model.target import target_shape
from sim.perception.perceived import PERCEIVED, perceive
from sim.plant.plant import PLANT_STATE
from sim.record import Record, record_of

CONFIG = named_configuration("becalm")
NOISE = CONFIG.perception.noise.model_dump()
ROBOT = robot_model(CONFIG.robot)
SQUARE = target_shape(CONFIG.target)
PERIOD = CONFIG.control.period


def cross(a: FloatArray, b: FloatArray) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


Truth = Callable[[float, Record], None]
"""Writes the state at an instant [s]; the robot stands still."""


def with_values(**changes: Any) -> MissionConfig:
    """With that seed and those parameters of perception (`__` for the dot)."""
    seed = changes.pop("seed", 0)
    paths = {f"perception.{path.replace('__', '.')}": value for path, value in changes.items()}
    return revised(CONFIG, nested({"simulation.seed": seed, **paths}))


def at_start(target: tuple[float, float, float] = (0.0, 0.7, 0.0)) -> Record:
    state = np.zeros(1, PLANT_STATE)[0]
    state["base_pose"] = initial_base_pose(CONFIG)
    state["joint_angle"] = initial_joint_angles(CONFIG.robot.arm)
    state["target_pose"] = target
    return state


def watch(config: MissionConfig, truth: Truth, duration: float) -> tuple[Record, list[dict[str, FloatArray]]]:
    """What is known at last, and every tick's belief beside the truth."""
    parameters, known, state, rows = record_of(config), np.zeros(1, PERCEIVED)[0], at_start(), []
    for tick in range(round(duration / PERIOD)):
        state["tick"], state["time"] = tick, tick * PERIOD
        truth(tick * PERIOD, state)
        perceive(known, parameters, ROBOT, SQUARE, state)
        rows.append({name: np.array([known[name], state[name]]) for name in BODIES})
    return known, rows


BODIES = ("base_pose", "base_twist", "target_pose", "target_twist")


def error(rows: list[dict[str, FloatArray]], name: str) -> FloatArray:
    """Of what was believed, shape (ticks, 3)."""
    pairs = np.array([row[name] for row in rows])
    found: FloatArray = pairs[:, 0] - pairs[:, 1]
    if name.endswith("pose"):
        found[:, 2] = (found[:, 2] + math.pi) % math.tau - math.pi
    return found


def drifting(spin: float, velocity: tuple[float, float] = (0.008, -0.005)) -> Truth:
    def truth(time: float, state: Record) -> None:
        state["target_pose"] = (velocity[0] * time, 0.7 + velocity[1] * time, spin * time)
        state["target_twist"] = (*velocity, spin)

    return truth


class TestFreeFlight:
    @pytest.mark.parametrize("spin", [2.5, -2.5])
    def test_errors_fall_far_under_the_readings_noise(self, spin: float) -> None:
        _, rows = watch(with_values(seed=3), drifting(spin), 0.6)
        late = rows[300:]
        rms = {name: np.sqrt((error(late, name) ** 2).mean(axis=0)) for name in BODIES}
        assert rms["target_pose"][:2].max() < NOISE["position"] / 4
        assert rms["target_pose"][2] < NOISE["angle"] / 4
        assert rms["target_twist"][:2].max() < NOISE["velocity"] / 3
        assert rms["target_twist"][2] < NOISE["spin"] / 3
        assert rms["base_pose"][2] < NOISE["angle"] / 4

    def test_it_begins_at_the_reading_without_a_jump(self) -> None:
        _, rows = watch(with_values(seed=3), drifting(2.5), 0.05)
        assert np.abs(error(rows, "target_pose")[:, 2]).max() < 4 * NOISE["angle"]
        assert np.abs(error(rows, "target_twist")[:, 2]).max() < 4 * NOISE["spin"]

    def test_the_deviation_that_is_told_is_that_of_the_error(self) -> None:
        parts = []
        for seed in range(12):
            known, rows = watch(with_values(seed=seed), drifting(1.0), 0.2)
            parts.append(error(rows, "target_twist")[-1] / known["target_twist_deviation"])
        assert 0.6 < math.sqrt(np.mean(np.square(parts))) < 1.5


class Push:
    """A hand that pushes on a spinning target for a while: both bodies as they really move, the robot's joints held."""

    def __init__(
        self, arm: int, *, force: tuple[float, float], torque: float, inertia: float, spin: float = 0.0
    ) -> None:
        """Begin at rest but for that spin; force on the hand [N], torque on the target about its centre [N m]."""
        start = at_start()
        links = chain(ROBOT, start["base_pose"], start["joint_angle"], np.zeros(2))
        masses = np.array([ROBOT.base_mass, *ROBOT.link_mass, *ROBOT.link_mass])
        places = np.array([start["base_pose"][:2], *links.centre.reshape(-1, 2)])
        self.centre = masses @ places / ROBOT.total_mass
        own = ROBOT.base_inertia + 2.0 * ROBOT.link_inertia.sum()
        robot_inertia = own + masses @ ((places - self.centre) ** 2).sum(axis=1)
        self.arm, self.force, self.torque, self.base = arm, np.array(force), torque, start["base_pose"].copy()
        self.mass = np.array([[ROBOT.total_mass] * 2 + [robot_inertia], [CONFIG.target.mass] * 2 + [inertia]])
        x, y = tip_position(ROBOT, links.hand_pose[arm], 1)
        self.pose = np.array([[*self.centre, 0.0], [x, y + 0.09, 0.0]])
        self.twist = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, spin]])

    def __call__(self, time: float, state: Record) -> None:
        """Write the state, then go on by a tick."""
        turned = self.pose[0, 2]
        c, s = math.cos(turned), math.sin(turned)
        from_centre = np.array([[c, -s], [s, c]]) @ (self.base[:2] - self.centre)
        state["base_pose"] = (*(self.pose[0, :2] + from_centre), self.base[2] + turned)
        spin = self.twist[0, 2]
        state["base_twist"] = (*(self.twist[0, :2] + spin * np.array([-from_centre[1], from_centre[0]])), spin)
        state["target_pose"], state["target_twist"] = self.pose[1], self.twist[1]
        load, state["hand_wrench"] = np.zeros((2, 3)), 0.0
        if 0.2 <= time < 0.7:
            hand = chain(ROBOT, state["base_pose"], state["joint_angle"], np.zeros(2)).hand_pose[self.arm, :2]
            on_hand = -self.torque - cross(hand - self.pose[1, :2], self.force)
            state["hand_wrench"][self.arm] = (*self.force, on_hand)
            load[0] = (*self.force, on_hand + cross(hand - self.pose[0, :2], self.force))
            load[1] = (*-self.force, self.torque)
        change = PERIOD * load / self.mass
        self.pose += PERIOD * (self.twist + 0.5 * change)
        self.twist += change


class TestInertia:
    @pytest.mark.parametrize("part", [0.7, 1.0, 1.4])
    def test_is_learnt_from_one_push_with_a_deviation_that_covers(self, part: float) -> None:
        config = with_values(seed=5)
        inertia = part * config.perception.assumed_inertia
        known, _ = watch(config, Push(1, force=(0.0, -0.2), torque=-0.02, inertia=inertia, spin=2.0), 0.75)
        assert known["target_inertia"] == pytest.approx(inertia, rel=0.05)
        assert abs(known["target_inertia"] - inertia) < 3.0 * known["target_inertia_deviation"]
        assert known["target_inertia_deviation"] < 0.05 * inertia

    def test_is_as_assumed_and_as_unsure_before(self) -> None:
        known, _ = watch(with_values(assumed_inertia=0.012, assumed_inertia_uncertainty=0.4), drifting(2.0), 0.3)
        assert known["target_inertia"] == pytest.approx(0.012, rel=1e-6)
        assert known["target_inertia_deviation"] == pytest.approx(0.4 * 0.012, rel=1e-6)

    def test_the_spin_follows_a_push_at_once(self) -> None:
        """With the force fed forward the error stays what noise makes; without it the filter would lag by far more."""
        inertia = CONFIG.perception.assumed_inertia
        _, rows = watch(with_values(seed=5), Push(1, force=(0.0, -0.2), torque=-0.02, inertia=inertia, spin=2.0), 0.75)
        assert rows[0]["target_twist"][1, 2] - rows[-1]["target_twist"][1, 2] > 1.0
        assert np.abs(error(rows, "target_twist")[:, 2]).max() < 0.05


def test_felt_momentum_moves_the_base_without_lag() -> None:
    """The filter is told that readings are worth nothing, so that only the momentum can tell the motion in time."""
    config = with_values(seed=1, filter__velocity=0.2, filter__spin=2.0, filter__position=0.05, filter__angle=0.5)
    _, rows = watch(config, Push(0, force=(0.0, -0.5), torque=0.0, inertia=9e-3), 0.7)
    gained = rows[-1]["base_twist"][1] - rows[200]["base_twist"][1]
    late = error(rows, "base_twist")[200:]
    assert abs(gained[1]) > 0.015
    assert abs(gained[2]) > 0.05
    assert np.abs(late[:, 1] - late[0, 1]).max() < 0.1 * abs(gained[1])
    assert np.abs(late[:, 2] - late[0, 2]).max() < 0.1 * abs(gained[2])


class TestLatePictures:
    spin = 2.0

    def late(self, **changes: float) -> FloatArray:
        filmed: Mapping[str, Any] = {f"capture__{name}": value for name, value in changes.items()}
        config = with_values(seed=2, source="motion_capture", capture__dropouts=0.0, **filmed)
        _, rows = watch(config, drifting(self.spin), 1.0)
        found: FloatArray = error(rows, "target_pose")[500:]
        return found

    def test_are_compared_with_what_was_known_at_their_instant(self) -> None:
        assert np.abs(self.late(delay=0.030)[:, 2].mean()) < 0.05 * self.spin * 0.030

    def test_whose_stamps_are_wrong_put_the_target_that_far_behind(self) -> None:
        behind = self.late(delay=0.030, stamp_error=0.010)[:, 2].mean()
        ahead = self.late(delay=0.030, stamp_error=-0.010)[:, 2].mean()
        assert ahead - behind == pytest.approx(2.0 * self.spin * 0.010, rel=0.15)

    def test_show_a_push_that_was_felt_before_they_came(self) -> None:
        """The spin of a pushed target is known although its pictures are 30 ms old."""
        config = with_values(
            seed=2,
            source="motion_capture",
            capture__delay=0.030,
            capture__dropouts=0.0,
            assumed_inertia_uncertainty=0.01,
        )
        inertia = CONFIG.perception.assumed_inertia
        _, rows = watch(config, Push(1, force=(0.0, -0.2), torque=-0.02, inertia=inertia, spin=2.0), 0.75)
        uncompensated = 0.02 / CONFIG.perception.assumed_inertia * 0.030
        assert np.abs(error(rows, "target_twist")[200:, 2]).max() < 0.5 * uncompensated


class TestWristBias:
    """The right hand is first far from the target, then comes so near that it might touch it."""

    force = np.array([0.0, 0.1])
    near = at_start()["joint_angle"] + np.array([[0.0, 0.0, 0.0], [0.5, -0.5, 0.0]])

    def target(self) -> tuple[float, float, float]:
        pose = chain(ROBOT, at_start()["base_pose"], self.near, np.zeros(2)).hand_pose[1]
        x, y = tip_position(ROBOT, pose, 1)
        return x, y + 0.075 + 0.015 + 0.004, 0.0

    def felt(self, bias: float, contact_after: float) -> tuple[Record, Record]:
        """What is known and what is true after the hand has been far for that long and near for 2 s more."""
        config = with_values(seed=4, imperfections__force_bias=bias)
        parameters, known = record_of(config), np.zeros(1, PERCEIVED)[0]
        state, target = at_start(), self.target()
        for tick in range(round((contact_after + 2.0) / PERIOD)):
            state["tick"], state["time"], state["target_pose"] = tick, tick * PERIOD, target
            if tick * PERIOD >= contact_after:
                state["joint_angle"] = self.near
                state["hand_wrench"][1] = (*self.force, 0.0)
            perceive(known, parameters, ROBOT, SQUARE, state)
        return known, state

    def test_is_tared_away_while_the_hand_is_far_and_a_contact_never_is(self) -> None:
        known, _ = self.felt(bias=0.1, contact_after=1.0)
        assert known["touching"].tolist() == [0, 1]
        assert known["hand_wrench"][1, :2] == pytest.approx(self.force, abs=0.025)
        assert not known["hand_wrench"][0].any()

    def test_that_was_never_tared_stays(self) -> None:
        """The same hand, near from the first tick: what its wrist reads may be a contact."""
        known, _ = self.felt(bias=0.1, contact_after=0.0)
        assert not known["wrists"]["bias"][1].any()
        assert np.abs(known["hand_wrench"][1, :2] - self.force).max() > 0.05


@pytest.mark.parametrize(("times", "touching"), [(2.0, [0, 0]), (6.0, [0, 1])])
def test_a_little_force_far_from_the_target_is_noise_and_a_great_one_is_a_contact(
    times: float, touching: list[int]
) -> None:
    config = with_values(noise__force=0.0, noise__torque=0.0)
    parameters, known, state = record_of(config), np.zeros(1, PERCEIVED)[0], at_start()
    for tick in range(100):
        state["tick"], state["time"] = tick, tick * PERIOD
        if tick >= 50:
            state["hand_wrench"][1, 1] = times * config.perception.contact_threshold
        perceive(known, parameters, ROBOT, SQUARE, state)
    assert known["touching"].tolist() == touching
