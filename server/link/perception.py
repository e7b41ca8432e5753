"""From what arrives to the plant's state: contact from the wrists, velocities and the present from motion capture.

Motion capture tells where bodies were some milliseconds ago, with noise, gaps and outliers. What is made of it, and of
the wrists' forces, is `sim.perception`: the same as in the simulation.
"""

from __future__ import annotations

import math

import numpy as np

from server.link.wire import JointSample, PlaneSample
from sim.compiled import FloatArray
from sim.config import FilterConfig, MissionConfig
from sim.control.hand_motion import generalized_velocity
from sim.model.generalized_jacobian import free_flying_model, momentum
from sim.model.reduced_model import SHAPE, set_shape_at
from sim.model.robot import Chain, chain, robot_model
from sim.perception.contact import is_touching, touching_tip
from sim.perception.estimators import (
    BODY_ESTIMATE,
    DRIFT,
    ENOUGH,
    NO_STAMP,
    body_at,
    forget_body,
    forget_drift,
    push_expected,
    set_way,
    take_joints,
    take_picture,
)
from sim.record import Record, record_of


class BodyEstimate:
    """Pose and twist of one body from poses that arrive late."""

    def __init__(self, expected: FilterConfig) -> None:
        """Nothing is known yet; `expected` of pictures and bodies."""
        self._expected = record_of(expected)
        self._estimate: Record = np.zeros(1, BODY_ESTIMATE)[0]
        forget_body(self._estimate)

    @property
    def stamp(self) -> int:
        """Of the last picture that was taken [ns]."""
        return int(self._estimate["stamp"])

    @property
    def taken(self) -> int:
        """Pictures so far."""
        return int(self._estimate["taken"])

    @property
    def outliers(self) -> int:
        """Pictures that were left out."""
        return int(self._estimate["outliers"])

    @property
    def outlying_since(self) -> int | None:
        """Stamp of the first of the outliers that have come in a row [ns]; None if the last picture was none."""
        since = int(self._estimate["outlying_since"])
        return None if since == NO_STAMP else since

    def take(self, sample: PlaneSample, *, touched: bool) -> str:
        """Take a pose, unless it is an outlier; why it is one, empty if it is none."""
        push = np.empty(3)
        push_expected(self._expected, touched, push)
        outlier, way, turn = take_picture(self._estimate, self._expected, sample.stamp, sample.value, push, np.zeros(3))
        return f"an outlier: {1e3 * way:.0f} mm and {turn:.3f} rad from where the body can be" if outlier else ""

    def at(self, stamp: int) -> tuple[FloatArray, FloatArray]:
        """Pose and twist at that instant [ns], as if the body had moved freely since the last picture."""
        pose, twist = np.empty(3), np.empty(3)
        body_at(self._estimate, stamp, pose, twist)
        return pose, twist


class Perception:
    """The plant's state as the controller sees it. One thread at a time."""

    def __init__(self, config: MissionConfig) -> None:
        """For a robot and target of that configuration."""
        self.configure(config)
        self.reset()

    def configure(self, config: MissionConfig) -> None:
        """Perceive by that configuration from now on; its filter, which is not live, from the next reset on."""
        self.contact_threshold = config.perception.contact_threshold
        """Wrist force that counts as contact [N]."""
        self._expected = config.perception.filter
        self._robot = robot_model(config.robot)
        self._target_mass, self._target_inertia = config.target.mass, config.target.inertia

    def begin(self, config: MissionConfig) -> None:
        """Perceive by that configuration for a new mission; what another filter has made of pictures is forgotten."""
        before = self._expected
        self.configure(config)
        if self._expected != before:
            self.reset()

    def reset(self) -> None:
        """Forget all that was seen."""
        self.base, self.target = BodyEstimate(self._expected), BodyEstimate(self._expected)
        """The base's is that of its motion without the arms' part."""
        self._drift: Record = np.zeros(1, DRIFT)[0]
        forget_drift(self._drift)
        self._shape: Record = np.zeros(1, SHAPE)[0]
        self._wrench = np.zeros((2, 3))
        self._touching = [False, False]
        self._last_contact = -(10**18)

    @property
    def complete(self) -> bool:
        """Whether both bodies have been seen often enough for their velocities."""
        return min(self.base.taken, self.target.taken) >= ENOUGH

    def take_wrench(self, arm: int, sample: PlaneSample) -> None:
        """Take a wrist's wrench, hand's axes."""
        force = math.hypot(sample.value[0], sample.value[1])
        self._touching[arm] = is_touching(self._touching[arm], force, self.contact_threshold)
        self._wrench[arm] = sample.value
        if self._touching[arm]:
            self._last_contact = sample.stamp

    def take_joints(self, joints: JointSample) -> None:
        """Take a joint state, for the arms' part in the base's motion."""
        if self.base.taken:
            angle = float(self._base_pose(joints.stamp)[2])
            rigid = np.zeros(2)  # no sensor measures how far a hand gives way on its mount
            set_shape_at(self._robot, joints.angle, rigid, self._shape)
            take_joints(self._drift, self._shape, joints.stamp, angle, joints.rate, rigid, np.zeros(3))

    def take_base(self, sample: PlaneSample) -> str:
        """Take a pose of the base, unless it is an outlier; why it is one."""
        rest = sample._replace(value=sample.value - self._way(sample.stamp))
        return self.base.take(rest, touched=self._touched(sample))

    def take_target(self, sample: PlaneSample) -> str:
        """Take a pose of the target, unless it is an outlier; why it is one."""
        return self.target.take(sample, touched=self._touched(sample))

    def write_state(self, joints: JointSample, state: Record) -> None:
        """The state at that instant, into one element of `PLANT_STATE` but for `tick` and `time`."""
        state["target_pose"], state["target_twist"] = self.target.at(joints.stamp)
        state["base_pose"] = self._base_pose(joints.stamp)
        state["base_twist"] = self.base.at(joints.stamp)[1] + self._drift["twist"]
        state["joint_angle"], state["joint_rate"] = joints.angle, joints.rate
        links = chain(self._robot, state["base_pose"], state["joint_angle"], state["mount_angle"])
        for arm in range(2):
            self._write_contact(arm, links, state)
        self._write_momentum(links, state)

    def _base_pose(self, stamp: int) -> FloatArray:
        return self.base.at(stamp)[0] + self._way(stamp)

    def _way(self, stamp: int) -> FloatArray:
        """Of the base by its arms, until that instant [ns]."""
        set_way(self._drift, stamp)
        return np.array(self._drift["way_until"])

    def _touched(self, sample: PlaneSample) -> bool:
        """Whether a contact may show in this picture."""
        return sample.stamp - self._last_contact < self._expected.contact_memory * 1e9

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
