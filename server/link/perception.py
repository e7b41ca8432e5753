"""From what arrives to the plant's state: contact from the wrists, velocities and the present from motion capture.

Motion capture tells where bodies were some milliseconds ago, with noise, gaps and outliers. A Kalman filter for each
body (constant velocity, white acceleration) gives its velocity, and its free motion is extrapolated to the instant
of the joint state. The base moves with its arms: what they make of it at zero momentum follows from the encoders at
once, and the filter estimates only the rest.

A wrist's force counts as contact above a threshold well over its noise, until it falls under half of it; without
contact the wrench is zero, so that no hand yields to noise.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections import deque
from typing import NamedTuple

import numpy as np

from server.link.wire import JointSample, PlaneSample
from sim.compiled import FloatArray
from sim.config import MissionConfig
from sim.control.hand_motion import generalized_velocity
from sim.model.generalized_jacobian import free_flying_model, momentum
from sim.model.robot import FREEDOMS, JOINTS, Chain, RobotModel, chain, freedom, robot_model
from sim.perception.contact import is_touching, touching_tip
from sim.record import Record

AFTER_CONTACT = 0.15
"""How long after a contact pictures may still show it [s]: motion capture's delay, and more."""
GATE = 6.0
"""Standard deviations beyond which a picture is an outlier."""
SEEN_ENOUGH = 50
"""Pictures after which a velocity is good to 0.3 mm/s and 2 mrad/s: a plan reaches two seconds ahead."""
FASTEST = 5.0
"""Between its first two pictures a body does not move faster [m/s]."""
DOUBTFUL = 3
"""So many outliers in a row are no chance: the velocity is doubted."""
DOUBT = (0.05, 0.05, 0.5)
"""... by so much more with each [m/s, rad/s]: something moved the body that no wrist felt."""
DRIFT_KEPT = 200
"""Joint states that motion capture may be behind: a second."""
_BIG = 1e4


class Noise(NamedTuple):
    """What the filter expects; standard deviations."""

    position: float = 3e-4
    angle: float = 1.5e-3
    free_acceleration: float = 0.02
    """Of a body that nothing touches: drag and tilt of the table [m/s2]."""
    free_angular_acceleration: float = 0.05
    touched_acceleration: float = 0.6
    """Of a body that is touched [m/s2]."""
    touched_angular_acceleration: float = 6.0


class BodyEstimate:
    """Pose and twist of one body from poses that arrive late."""

    def __init__(self, noise: Noise) -> None:
        self._measured = np.array([noise.position, noise.position, noise.angle]) ** 2
        self._free = np.array([noise.free_acceleration] * 2 + [noise.free_angular_acceleration]) ** 2
        self._touched = np.array([noise.touched_acceleration] * 2 + [noise.touched_angular_acceleration]) ** 2
        self.stamp = 0
        self.seen = 0
        self.outliers = 0
        self.outlying_since: int | None = None
        """Stamp of the first of the outliers that have come in a row [ns]."""
        self._row = 0
        self._doubt = np.array(DOUBT) ** 2
        self._x = np.zeros((3, 2))
        self._p = np.zeros((3, 2, 2))

    def take(self, sample: PlaneSample, *, touched: bool) -> str:
        """Take a pose, unless it is an outlier; why it is one, empty if it is none."""
        if not self.seen:
            self._begin(sample)
            return ""
        dt = 1e-9 * (sample.stamp - self.stamp)
        if dt <= 0.0:
            return ""
        x, p = self._predicted(dt, touched=touched)
        innovation = sample.value - x[:, 0]
        innovation[2] = math.remainder(innovation[2], math.tau)
        if self.seen == 1 and math.hypot(innovation[0], innovation[1]) > FASTEST * dt:
            self._begin(sample)  # one of the two is an outlier, and the next will tell
            return ""
        spread = p[:, 0, 0] + self._measured
        if (np.abs(innovation) > GATE * np.sqrt(spread)).any():
            self.outliers += 1
            self.outlying_since = self.outlying_since or sample.stamp
            self._row += 1
            if self._row >= DOUBTFUL:
                self._p[:, 1, 1] += self._doubt
            way, turn = math.hypot(innovation[0], innovation[1]), abs(innovation[2])
            return f"an outlier: {1e3 * way:.0f} mm and {turn:.3f} rad from where the body can be"
        gain = p[:, :, 0] / spread[:, None]
        self._x = x + gain * innovation[:, None]
        self._p = p - gain[:, :, None] * p[:, None, 0, :]
        self.stamp, self.outlying_since, self._row = sample.stamp, None, 0
        self.seen += 1
        return ""

    def at(self, stamp: int) -> tuple[FloatArray, FloatArray]:
        """Pose and twist at that instant [ns], as if the body had moved freely since the last picture."""
        dt = 1e-9 * (stamp - self.stamp)
        return self._x[:, 0] + dt * self._x[:, 1], self._x[:, 1].copy()

    def _begin(self, sample: PlaneSample) -> None:
        self._x[:, 0], self._x[:, 1] = sample.value, 0.0
        self._p[:] = 0.0
        self._p[:, 0, 0], self._p[:, 1, 1] = self._measured, _BIG
        self.stamp, self.seen = sample.stamp, 1

    def _predicted(self, dt: float, *, touched: bool) -> tuple[FloatArray, FloatArray]:
        motion = np.array([[1.0, dt], [0.0, 1.0]])
        push = np.array([[dt**4 / 4, dt**3 / 2], [dt**3 / 2, dt**2]])
        acceleration = self._touched if touched else self._free
        return self._x @ motion.T, motion @ self._p @ motion.T + acceleration[:, None, None] * push


class BaseDrift:
    """How far the arms have turned and moved the base at zero momentum, now and for a while back."""

    def __init__(self, robot: RobotModel) -> None:
        self._robot = robot
        self._still = np.zeros(2)
        self._past: deque[tuple[int, FloatArray]] = deque(maxlen=DRIFT_KEPT)
        self.twist = np.zeros(3)

    def take(self, joints: JointSample, base_pose: FloatArray) -> None:
        """Go on to that instant; rates are the means since the last one."""
        links = chain(self._robot, base_pose, joints.angle, self._still)
        matrix = free_flying_model(self._robot, base_pose, links).momentum_matrix
        velocity = np.zeros(FREEDOMS)
        for arm in range(2):
            for link in range(JOINTS):
                velocity[freedom(arm, link)] = joints.rate[arm, link]
        self.twist = -np.linalg.solve(matrix[:, :3], momentum(matrix, velocity))
        stamp, pose = self._past[-1] if self._past else (joints.stamp, np.zeros(3))
        self._past.append((joints.stamp, pose + 1e-9 * (joints.stamp - stamp) * self.twist))

    def at(self, stamp: int) -> FloatArray:
        """The way until that instant, shape (3,) [m, m, rad]."""
        if not self._past:
            return np.zeros(3)
        past = list(self._past)
        place = bisect_right(past, stamp, key=lambda each: each[0])
        if place in (0, len(past)):
            return past[min(place, len(past) - 1)][1]
        (before, there), (after, then) = past[place - 1], past[place]
        return there + (stamp - before) / (after - before) * (then - there)


class Perception:
    """The plant's state as the controller sees it. One thread at a time."""

    def __init__(self, config: MissionConfig, contact_threshold: float, noise: Noise | None = None) -> None:
        """For a robot and target of that configuration; contact above the threshold [N]."""
        self.contact_threshold = contact_threshold
        self._noise = noise or Noise()
        self._robot = robot_model(config.robot)
        self._target_mass, self._target_inertia = config.target.mass, config.target.inertia
        self.reset()

    def reset(self) -> None:
        """Forget all that was seen."""
        self.base, self.target = BodyEstimate(self._noise), BodyEstimate(self._noise)
        """The base's is that of its motion without the arms' part."""
        self._drift = BaseDrift(self._robot)
        self._wrench = np.zeros((2, 3))
        self._touching = [False, False]
        self._last_contact = -(10**18)

    @property
    def complete(self) -> bool:
        """Whether both bodies have been seen often enough for their velocities."""
        return min(self.base.seen, self.target.seen) >= SEEN_ENOUGH

    def take_wrench(self, arm: int, sample: PlaneSample) -> None:
        """Take a wrist's wrench, hand's axes."""
        force = math.hypot(sample.value[0], sample.value[1])
        self._touching[arm] = is_touching(self._touching[arm], force, self.contact_threshold)
        self._wrench[arm] = sample.value
        if self._touching[arm]:
            self._last_contact = sample.stamp

    def take_joints(self, joints: JointSample) -> None:
        """Take a joint state, for the arms' part in the base's motion."""
        if self.base.seen:
            self._drift.take(joints, self._base_pose(joints.stamp))

    def take_base(self, sample: PlaneSample) -> str:
        """Take a pose of the base, unless it is an outlier; why it is one."""
        rest = sample._replace(value=sample.value - self._drift.at(sample.stamp))
        return self.base.take(rest, touched=self._touched(sample))

    def take_target(self, sample: PlaneSample) -> str:
        """Take a pose of the target, unless it is an outlier; why it is one."""
        return self.target.take(sample, touched=self._touched(sample))

    def write_state(self, joints: JointSample, state: Record) -> None:
        """The state at that instant, into one element of `PLANT_STATE` but for `tick` and `time`."""
        state["target_pose"], state["target_twist"] = self.target.at(joints.stamp)
        state["base_pose"] = self._base_pose(joints.stamp)
        state["base_twist"] = self.base.at(joints.stamp)[1] + self._drift.twist
        state["joint_angle"], state["joint_rate"] = joints.angle, joints.rate
        links = chain(self._robot, state["base_pose"], state["joint_angle"], state["mount_angle"])
        for arm in range(2):
            self._write_contact(arm, links, state)
        self._write_momentum(links, state)

    def _base_pose(self, stamp: int) -> FloatArray:
        return self.base.at(stamp)[0] + self._drift.at(stamp)

    def _touched(self, sample: PlaneSample) -> bool:
        """Whether a contact may show in this picture."""
        return sample.stamp - self._last_contact < AFTER_CONTACT * 1e9

    def _write_contact(self, arm: int, links: Chain, state: Record) -> None:
        state["hand_wrench"][arm] = 0.0
        state["tip_force"][arm] = 0.0
        state["tip_contact"][arm] = 0
        if not self._touching[arm]:
            return
        pose = links.hand_pose[arm]
        fx, fy, torque = self._wrench[arm]
        cosine, sine = math.cos(pose[2]), math.sin(pose[2])
        force = np.array([cosine * fx - sine * fy, sine * fx + cosine * fy])
        state["hand_wrench"][arm] = *force, torque
        tip = touching_tip(self._robot, pose, state["hand_wrench"][arm])
        state["tip_force"][arm, tip] = force
        state["tip_contact"][arm, tip] = 1

    def _write_momentum(self, links: Chain, state: Record) -> None:
        base, target, twist = state["base_pose"], state["target_pose"], state["target_twist"]
        model = free_flying_model(self._robot, base, links)
        total = momentum(model.momentum_matrix, generalized_velocity(state))
        total[2] += base[0] * total[1] - base[1] * total[0]
        px, py = self._target_mass * twist[0], self._target_mass * twist[1]
        total += px, py, self._target_inertia * twist[2] + target[0] * py - target[1] * px
        state["momentum"] = total
