"""What the emulated testbed's sensors measure of the plant's true state; seeded, the same numbers for the same seed."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from server.link.contract import ARMS, HAND_FRAMES, WORLD
from server.link.wire import JointSample, PlaneSample
from sim.compiled import FloatArray
from sim.record import Record

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


class Sensors:
    """All sensors of the emulated testbed."""

    def __init__(self, imperfections: Imperfections, seed: int) -> None:
        self.tared = False
        self._of = imperfections
        self._random = np.random.default_rng(seed)
        spread = np.array([imperfections.force_bias, imperfections.force_bias, imperfections.torque_bias])
        self._bias = self._random.normal(0.0, 1.0, (2, 3)) * spread
        self._zero = np.zeros((2, 3))
        self._encoded: JointSample | None = None
        self._readings: list[FloatArray] = []

    def joints(self, stamp: int, state: Record) -> JointSample:
        """Encoder angles, and rates as their differences since the last reading; zero at the first."""
        step = self._of.encoder_resolution
        angle = np.round(state["joint_angle"] / step) * step if step else state["joint_angle"].copy()
        before = self._encoded
        rate = np.zeros((2, 3)) if before is None else (angle - before.angle) / (1e-9 * (stamp - before.stamp))
        self._encoded = JointSample(stamp, angle, rate)
        return self._encoded

    def wrenches(self, stamp: int, state: Record, hand_angle: FloatArray) -> list[PlaneSample]:
        """Target on hand about the hand's centre, in each hand's axes, with noise and bias, less the taring.

        Args:
            stamp: of the readings [ns].
            state: one element of `PLANT_STATE`.
            hand_angle: of both hands in the world [rad], shape (2,).

        """
        spread = np.array([self._of.force_noise, self._of.force_noise, self._of.torque_noise])
        noise = self._random.normal(0.0, 1.0, (2, 3)) * spread
        raw = np.array([_in_hand(state["hand_wrench"][arm], hand_angle[arm]) for arm in range(2)]) + self._bias + noise
        self._readings = [*self._readings[1 - TARE_SAMPLES :], raw]
        return [PlaneSample(stamp, HAND_FRAMES[arm], raw[arm] - self._zero[arm]) for arm in range(len(ARMS))]

    def tare(self) -> None:
        """What the wrists read now is zero from here on."""
        if self._readings:
            self._zero = np.mean(self._readings, axis=0)
            self.tared = True

    def pose(self, stamp: int, pose: FloatArray) -> PlaneSample | None:
        """A body as motion capture sees it, or None if it does not."""
        if self._random.random() < self._of.dropouts:
            return None
        spread = np.array([self._of.position_noise, self._of.position_noise, self._of.angle_noise])
        seen = pose + self._random.normal(0.0, 1.0, 3) * spread
        if self._random.random() < self._of.outliers:
            way = self._random.uniform(-math.pi, math.pi)
            seen[:2] += self._of.outlier_distance * np.array([math.cos(way), math.sin(way)])
        return PlaneSample(stamp, WORLD, seen)

    def twist(self, stamp: int, twist: FloatArray) -> PlaneSample:
        """A body's velocity as motion capture measures it."""
        spread = np.array([self._of.velocity_noise, self._of.velocity_noise, self._of.spin_noise])
        return PlaneSample(stamp, WORLD, twist + self._random.normal(0.0, 1.0, 3) * spread)


def _in_hand(wrench: FloatArray, angle: float) -> FloatArray:
    """A wrench in world axes, in the axes of a hand at this angle [rad]."""
    cosine, sine = math.cos(angle), math.sin(angle)
    fx, fy, torque = wrench
    return np.array([cosine * fx + sine * fy, cosine * fy - sine * fx, torque])
