"""What the emulated testbed's sensors measure of the plant's true state; seeded, the same numbers for the same seed."""

from __future__ import annotations

import math
from collections import deque
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from server.link.contract import ARMS, BODIES, HAND_FRAMES, WORLD, Body
from server.link.wire import JointSample, PlaneSample
from sim.compiled import FloatArray
from sim.config import ImperfectionsConfig, NoiseConfig
from sim.perception.imperfections import add_imperfections, is_missed, misplacement
from sim.perception.perceived import PERCEIVED
from sim.perception.sensing import add_noise
from sim.record import Record, record_of

TARE_SAMPLES = 40
"""Readings of a wrist sensor that a taring averages: a fifth of a second."""


def _number(default: float, words: str, *, ge: float, le: float) -> Any:
    return Field(default, description=words, allow_inf_nan=False, ge=ge, le=le)


class Imperfections(BaseModel):
    """Of sensors and air table; the defaults are those of good laboratory equipment."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    force_noise: float = _number(0.02, "Standard deviation of a wrist's forces [N]", ge=0, le=100)
    torque_noise: float = _number(1e-3, "Standard deviation of a wrist's torque [N m]", ge=0, le=100)
    force_bias: float = _number(0.2, "Standard deviation of the forces' bias, drawn at the start [N]", ge=0, le=100)
    torque_bias: float = _number(5e-3, "Standard deviation of the torque's bias [N m]", ge=0, le=100)
    encoder_resolution: float = _number(2 * math.pi / 2**19, "Step of the joint encoders [rad]", ge=0, le=0.1)
    position_noise: float = _number(2e-4, "Standard deviation of motion-capture positions [m]", ge=0, le=1)
    angle_noise: float = _number(1e-3, "Standard deviation of motion-capture angles [rad]", ge=0, le=1)
    velocity_noise: float = _number(5e-3, "Standard deviation of motion-capture velocities [m/s]", ge=0, le=1)
    spin_noise: float = _number(0.02, "Standard deviation of motion-capture spins [rad/s]", ge=0, le=10)
    motion_capture_delay: float = _number(0.01, "From the picture to the message [s]", ge=0, le=1)
    dropouts: float = _number(0.005, "Part of the pictures in which a body is not seen", ge=0, le=1)
    outliers: float = _number(0.001, "Part of the pictures in which a body is seen elsewhere", ge=0, le=1)
    outlier_distance: float = _number(0.1, "How far elsewhere [m]", ge=0, le=10)
    drag: float = _number(0.005, "Air drag: part of a velocity that is lost in a second [1/s]", ge=0, le=10)
    tilt_x: float = _number(2e-6, "Tilt of the table along x [rad]", ge=-0.1, le=0.1)
    tilt_y: float = _number(-2e-6, "Tilt of the table along y [rad]", ge=-0.1, le=0.1)


_READ = ("base_pose", "base_twist", "target_pose", "target_twist", "joint_angle", "hand_wrench")
"""The fields of the true state that sensors measure."""


class Sensors:
    """All sensors of the emulated testbed; they measure with the code of the simulation (`sim.perception`)."""

    def __init__(self, imperfections: Imperfections, seed: int) -> None:
        self.tared = False
        self._of = some = imperfections
        self._seed = seed
        self._noise = record_of(
            NoiseConfig(
                position=some.position_noise,
                angle=some.angle_noise,
                velocity=some.velocity_noise,
                spin=some.spin_noise,
                force=some.force_noise,
                torque=some.torque_noise,
            )
        )
        wrong = {name: getattr(some, name) for name in ImperfectionsConfig.model_fields}
        self._imperfections = record_of(ImperfectionsConfig(**wrong))
        self._reading: Record = np.zeros(1, PERCEIVED)[0]
        self._raw, self._zero = np.zeros((2, 3)), np.zeros((2, 3))
        self._encoded: JointSample | None = None
        self._readings: deque[FloatArray] = deque(maxlen=TARE_SAMPLES)

    def sense(self, state: Record, hand_angle: FloatArray) -> None:
        """Measure once; the others tell what came of it.

        Args:
            state: the true one, one element of `PLANT_STATE`.
            hand_angle: of both hands in the world [rad], shape (2,).

        """
        reading = self._reading
        reading["tick"] += 1
        for name in _READ:
            reading[name] = state[name]
        add_noise(self._noise, self._seed, reading)
        add_imperfections(self._imperfections, self._seed, hand_angle, reading)
        self._raw = np.array([_in_hand(reading["hand_wrench"][arm], hand_angle[arm]) for arm in range(2)])
        self._readings.append(self._raw)

    def joints(self, stamp: int) -> JointSample:
        """Encoder angles, and rates as their differences since the last time; zero at the first."""
        angle, before = self._reading["joint_angle"].copy(), self._encoded
        rate = np.zeros((2, 3)) if before is None else (angle - before.angle) / (1e-9 * (stamp - before.stamp))
        self._encoded = JointSample(stamp, angle, rate)
        return self._encoded

    def wrenches(self, stamp: int) -> list[PlaneSample]:
        """Target on hand about the hand's centre, in each hand's axes, less the taring."""
        return [PlaneSample(stamp, HAND_FRAMES[arm], self._raw[arm] - self._zero[arm]) for arm in range(len(ARMS))]

    def tare(self) -> None:
        """What the wrists read now is zero from here on."""
        if self._readings:
            self._zero = np.mean(self._readings, axis=0)
            self.tared = True

    def pose(self, stamp: int, body: Body) -> PlaneSample | None:
        """A body as motion capture sees it, or None if it does not."""
        tick, place = int(self._reading["tick"]), BODIES.index(body)
        if is_missed(self._of.dropouts, self._seed, tick, place):
            return None
        seen = self._reading[f"{body}_pose"].copy()
        seen[:2] += misplacement(self._imperfections, self._seed, tick, place)
        return PlaneSample(stamp, WORLD, seen)

    def twist(self, stamp: int, body: Body) -> PlaneSample:
        """A body's velocity as motion capture measures it."""
        return PlaneSample(stamp, WORLD, self._reading[f"{body}_twist"].copy())


def _in_hand(wrench: FloatArray, angle: float) -> FloatArray:
    """A wrench in world axes, in the axes of a hand at this angle [rad]."""
    cosine, sine = math.cos(angle), math.sin(angle)
    fx, fy, torque = wrench
    return np.array([cosine * fx + sine * fy, cosine * fy - sine * fx, torque])
