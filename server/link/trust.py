"""Whether a reading of the robot's can be believed. Pure: each answers with the reason why not, or with nothing."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from server.link.bounds import Bounds, WristFrame
from server.link.contract import CONTROL_RATE, JOINT_NAMES
from server.link.trouble import Trouble
from server.link.wire import JointSample, PlaneSample, printable
from sim.compiled import FloatArray
from sim.errors import Cause

JUMP = 0.05
"""Farther than this beyond where its rates lead from one joint state to the next, a joint has jumped [rad]."""
DRIFT_LIMIT = 0.25
"""How far joint angles may come from where their rates lead [rad]."""
DRIFT_TIME = 0.6
"""How long that is remembered [s]."""
_UNITS = ((86400 * 365.25, "years"), (86400, "days"), (3600, "h"), (1.0, "s"))


class Times(NamedTuple):
    """What a stamp is held against."""

    present: int | None
    """The robot's clock now, as the console knows it [ns]; None: not known yet."""
    joints: int
    """Stamp of the last joint state that was believed [ns]; 0: none."""
    deadline: float
    """How old a reading may be [s]."""


def stamp_fault(stamp: int, times: Times, bounds: Bounds) -> str:
    """Whether a reading is too old or of the future, by both clocks; before they are known, by the joint states."""
    known = times.present is not None
    reference = times.present if times.present is not None else times.joints
    if not reference:
        return ""
    age = 1e-9 * (reference - stamp)
    against = "" if known else " against the joint states"
    if age > times.deadline:
        return f"measured {duration(age)} ago{against}, at most {duration(times.deadline)}"
    if age < -bounds.ahead - (0.0 if known else times.deadline):
        return f"stamped {duration(-age)} in the future{against}"
    return ""


def order_fault(stamp: int, latest: int) -> str:
    """Why a reading that is not newer than the last one is not taken."""
    if stamp == latest:
        return "its stamp stands still"
    return f"its stamp runs back: {duration(1e-9 * (latest - stamp))} before one that came earlier"


def frame_fault(frame: str, wanted: str) -> str:
    """Whether a reading is in another frame than it is taken for."""
    if frame == wanted:
        return ""
    described = f"frame {printable(frame, 60)!r}" if frame else "header.frame_id is empty: in no frame"
    return f"{described}, not in {wanted!r}"


def joints_fault(sample: JointSample, bounds: Bounds) -> str:
    """Whether angles and rates are those of such a robot, in radians."""
    for what, values, limit, unit in (
        ("angle", sample.angle, bounds.joint_angle, "rad"),
        ("rate", sample.rate, bounds.joint_rate, "rad/s"),
    ):
        worst = int(np.abs(values).argmax())
        value = float(values.flat[worst])
        if abs(value) > limit:
            degrees = "; it looks like degrees" if abs(value) <= 100.0 * limit else ""
            return f"{what} of {JOINT_NAMES[worst]} = {value:.4g} {unit}, at most {limit:.4g} {unit}{degrees}"
    return ""


def pose_fault(sample: PlaneSample, bounds: Bounds) -> str:
    """Whether a body is on the testbed and in its plane."""
    far = max(abs(sample.value[0]), abs(sample.value[1]))
    if far > bounds.position:
        millimetres = "; it looks like millimetres" if 50.0 < far < 1000.0 * bounds.position else ""
        return f"outside of the testbed: {far:.4g} m from its origin, at most {bounds.position:g} m{millimetres}"
    height, tilt, _ = sample.rest
    if abs(height) > bounds.height:
        return f"out of the plane: z = {height:.4g} m, at most {bounds.height:g} m"
    if tilt > bounds.tilt:
        turned = f"{tilt:.3g} rad ({math.degrees(tilt):.3g} degrees)"
        return f"out of the plane: tilted by {turned}, at most {bounds.tilt:g} rad"
    return ""


def twist_fault(sample: PlaneSample, bounds: Bounds) -> str:
    """Whether a body moves as one can on the testbed, and in its plane."""
    speed, spin = math.hypot(sample.value[0], sample.value[1]), abs(float(sample.value[2]))
    vertical, tumble = abs(float(sample.rest[0])), math.hypot(sample.rest[1], sample.rest[2])
    for what, value, limit, unit in (
        ("moves at", speed, bounds.speed, "m/s"),
        ("spins at", spin, bounds.spin, "rad/s"),
        ("moves out of the plane at", vertical, bounds.vertical_speed, "m/s"),
        ("turns out of the plane at", tumble, bounds.tumble, "rad/s"),
    ):
        if value > limit:
            return f"{what} {value:.4g} {unit}, at most {limit:g} {unit}"
    return ""


def range_fault(sample: PlaneSample, bounds: Bounds) -> str:
    """Whether a wrench is beyond what the sensor can measure; as it comes, all six components."""
    force = max(abs(float(each)) for each in (*sample.value[:2], sample.rest[0]))
    torque = max(abs(float(each)) for each in (sample.value[2], *sample.rest[1:]))
    for what, value, limit, unit in (("force", force, bounds.force, "N"), ("torque", torque, bounds.torque, "N m")):
        if value > limit:
            return f"beyond the sensor's range: {what} {value:.4g} {unit}, at most {limit:g} {unit}"
    return ""


class WristWatch:
    """One wrist's readings, one after the other: in the hand's axes, in range, without a jump."""

    def __init__(self, frame: WristFrame, bounds: Bounds) -> None:
        self.frame = frame
        self._bounds = bounds
        self._last: PlaneSample | None = None

    def fault(self, sample: PlaneSample) -> str:
        """Whether this reading cannot be believed by itself."""
        return frame_fault(sample.frame, self.frame.frame) or range_fault(sample, self._bounds)

    def in_hand(self, sample: PlaneSample) -> PlaneSample:
        """The reading in the hand's axes."""
        return sample._replace(value=self.frame.in_hand(sample.value))

    def jump(self, sample: PlaneSample) -> str:
        """How it jumped since the reading before, whether that was believed or not; empty if it did not.

        Where readings between were lost it may have changed by as much more.
        """
        last, self._last = self._last, sample
        if last is None:
            return ""
        dt = 1e-9 * (sample.stamp - last.stamp)
        periods = max(1.0, dt * CONTROL_RATE)
        change = sample.value - last.value
        for what, value, limit, unit in (
            ("force", math.hypot(change[0], change[1]), self._bounds.force_jump, "N"),
            ("torque", abs(float(change[2])), self._bounds.torque_jump, "N m"),
        ):
            if value > limit * periods:
                return f"{what} jumped by {value:.4g} {unit} in {duration(dt)}, at most {limit:g} {unit} in a period"
        return ""


class JointWatch:
    """Joint states, one after the other: angles go where the rates lead."""

    def __init__(self) -> None:
        self._last: JointSample | None = None
        self._drift = np.zeros((2, 3))

    def forget(self) -> None:
        """Begin with what comes next."""
        self._last = None
        self._drift = np.zeros((2, 3))

    def drift(self, sample: JointSample) -> Trouble | None:
        """Which joint's angle does not go where its rate leads; None if all do."""
        last, self._last = self._last, sample
        if last is None:
            return None
        dt, moved = 1e-9 * (sample.stamp - last.stamp), sample.angle - last.angle
        beyond = np.abs(moved) - dt * np.maximum(np.abs(sample.rate), np.abs(last.rate))
        worst = int(beyond.argmax())
        if beyond.flat[worst] > JUMP:
            words = f"{JOINT_NAMES[worst]} jumped by {abs(moved.flat[worst]):.3f} rad in {duration(dt)}"
            return Trouble(Cause.READING_JUMPED, words)
        led: FloatArray = dt * sample.rate
        self._drift = self._drift * math.exp(-dt / DRIFT_TIME) + led - moved
        worst = int(np.abs(self._drift).argmax())
        if abs(float(self._drift.flat[worst])) <= DRIFT_LIMIT:
            return None
        self._drift[:] = 0.0
        rate = f"rate of {JOINT_NAMES[worst]} = {float(sample.rate.flat[worst]):.3g} rad/s"
        return Trouble(Cause.READING_REFUSED, f"{rate} does not fit how its angle changes; are they in degrees?")


def duration(seconds: float) -> str:
    """A time in the unit that it is read best in."""
    if seconds < 10.0:
        return f"{1e3 * seconds:.0f} ms"
    size, unit = next((each for each in _UNITS if seconds >= 2.0 * each[0]), _UNITS[-1])
    return f"{seconds / size:.3g} {unit}"
