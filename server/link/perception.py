"""From what arrives to what is known of robot and target: a robot's readings, perceived as the simulation's are.

Motion capture tells where bodies were some milliseconds ago, with noise, gaps and outliers; wrists tell forces with a
bias. What is made of them is `sim.perception`, the same compiled code that makes it of simulated sensors: by the filter
of pictures alone, or by the model-based estimator. Nothing of `target.*` but its outline is used: mass and inertia are
those that are assumed or estimated.
"""

from __future__ import annotations

import numpy as np

from server.link.contract import BODIES, Body
from server.link.wire import JointSample, PlaneSample
from sim.config import MissionConfig, PerceptionConfig
from sim.control.hand_motion import generalized_velocity
from sim.model.clearance import shapes_of
from sim.model.generalized_jacobian import free_flying_model, momentum
from sim.model.planar import rotated
from sim.model.robot import chain, robot_model
from sim.model.target import to_centre_of_mass
from sim.perception.estimators import ENOUGH, NO_STAMP
from sim.perception.motion import count_from
from sim.perception.perceived import PERCEIVED, begin_perceiving, perceive_readings, see
from sim.record import Record, packed, record_of

_LEAD = 1_000_000_000
"""Readings are counted from so long before the first of them [ns]: instants stay small, and none is negative."""
_REMADE = ("filter", "estimator", "assumed_mass", "assumed_mass_uncertainty", "assumed_inertia",
           "assumed_inertia_uncertainty")  # fmt: skip
"""What of `PerceptionConfig` decides what has been made of pictures."""


class Perception:
    """What the controller knows of the robot at the other end. One thread at a time."""

    def __init__(self, config: MissionConfig) -> None:
        """For a robot and target of that configuration."""
        self.configure(config)
        self.reset()

    def configure(self, config: MissionConfig) -> None:
        """Perceive by that configuration from now on; what is not live, from the next reset on."""
        self._config = config.perception
        self._parameters = record_of(config)
        self._model = robot_model(config.robot)
        self._robot, self._target = packed(self._model)[0], shapes_of(config)["seen_target"]

    @property
    def contact_threshold(self) -> float:
        """Wrist force that counts as contact [N]."""
        return self._config.contact_threshold

    def begin(self, config: MissionConfig) -> None:
        """Perceive by that configuration for a new mission; what is made in another way is forgotten."""
        before = self._config
        self.configure(config)
        if _remade(before, config.perception):
            self.reset()

    def reset(self) -> None:
        """Forget all that was seen and felt."""
        self._known: Record = np.zeros(1, PERCEIVED)[0]
        begin_perceiving(self._known, self._parameters)
        self._wrench = np.zeros((2, 3))
        self._origin: int | None = None
        self._is_known = False

    @property
    def complete(self) -> bool:
        """Whether both bodies have been seen often enough for their velocities, and the joints since then."""
        return self._is_known and self._pictures >= ENOUGH

    @property
    def _pictures(self) -> int:
        """How many were taken of the body that was seen less often."""
        return min(int(self._known["motion"][body]["taken"]) for body in BODIES)

    def outlying_since(self, body: Body) -> int | None:
        """Stamp of the first of the outliers that have come in a row [ns]; None if the last picture was none."""
        since = int(self._known["motion"][body]["outlying_since"])
        return None if since == NO_STAMP or self._origin is None else since + self._origin

    def take_wrench(self, arm: int, sample: PlaneSample) -> None:
        """Take a wrist's wrench, hand's axes; it counts from the next joint state on."""
        self._wrench[arm] = sample.value

    def take_joints(self, joints: JointSample) -> None:
        """Take a joint state: what is known at its instant, as soon as both bodies have been seen."""
        known = self._known
        known["time"] = 1e-9 * self._since(joints.stamp)
        known["joint_angle"], known["joint_rate"] = joints.angle, joints.rate
        if self._pictures:
            self._is_known = True
            perceive_readings(known, self._parameters, self._robot, self._target, self._wrench)

    def take_base(self, sample: PlaneSample) -> str:
        """Take a pose of the base, unless it is an outlier; why it is one."""
        return self._see(sample, "base")

    def take_target(self, sample: PlaneSample) -> str:
        """Take a pose of the target, unless it is an outlier; why it is one."""
        return self._see(sample, "target")

    def count_from(self, stamp: int) -> None:
        """Tell times from that instant on [ns], of the robot's clock: the first tick of a mission."""
        ahead = self._since(stamp)
        self._origin = stamp
        count_from(self._known["motion"], ahead)
        for name in ("time", "target_seen_at"):
            self._known[name] -= 1e-9 * ahead

    def write_state(self, state: Record, perceived: Record) -> None:
        """What is known at the last joint state.

        Args:
            state: one element of `PLANT_STATE`: the robot as far as it can be known; all but `tick` and `time` are set.
            perceived: one element of `PERCEIVED`: what the controller gets; all but `tick` is set.

        """
        known = self._known
        tick = perceived["tick"]
        for name in PERCEIVED.names or ():
            perceived[name] = known[name]
        perceived["tick"] = tick
        for name in _OF_STATE:
            state[name] = known[name]
        to_centre_of_mass(self._parameters["target"], state["target_pose"], state["target_twist"])
        for arm in range(2):
            self._write_contact(arm, state)
        self._write_momentum(state)

    def _see(self, sample: PlaneSample, body: Body) -> str:
        stamp = self._since(sample.stamp)
        outlier, way, turn = see(self._known, self._parameters, stamp, sample.value, body == "target")
        return f"an outlier: {1e3 * way:.0f} mm and {turn:.3f} rad from where the body can be" if outlier else ""

    def _since(self, stamp: int) -> int:
        """An instant of the robot's clock, as it is counted here [ns]."""
        if self._origin is None:
            self._origin = stamp - _LEAD
        return stamp - self._origin

    def _write_contact(self, arm: int, state: Record) -> None:
        """What the wrist felt less its bias, not smoothed; nothing where that counts as no contact."""
        known = self._known
        state["hand_wrench"][arm], state["tip_force"][arm] = 0.0, 0.0
        state["tip_contact"][arm] = known["tip_contact"][arm]
        if not known["touching"][arm]:
            return
        along, across, torque = self._wrench[arm] - known["wrists"]["bias"][arm]
        force = rotated(float(known["links"]["hand_pose"][arm, 2]), along, across)
        state["hand_wrench"][arm] = *force, torque
        state["tip_force"][arm, int(known["tip_contact"][arm, 1])] = force

    def _write_momentum(self, state: Record) -> None:
        base, target, twist = state["base_pose"], state["target_pose"], state["target_twist"]
        links = chain(self._model, base, state["joint_angle"], state["mount_angle"])
        total = momentum(free_flying_model(self._model, base, links).momentum_matrix, generalized_velocity(state))
        total[2] += base[0] * total[1] - base[1] * total[0]
        px, py = self._config.assumed_mass * twist[0], self._config.assumed_mass * twist[1]
        spin = float(self._known["target_inertia"]) * twist[2]
        total += px, py, spin + target[0] * py - target[1] * px
        state["momentum"] = total


_OF_STATE = (
    "base_pose", "base_twist", "joint_angle", "joint_rate", "mount_angle", "mount_rate", "target_pose", "target_twist",
)  # fmt: skip
"""What `PLANT_STATE` has of `PERCEIVED`: for a robot the best that is known."""


def _remade(before: PerceptionConfig, now: PerceptionConfig) -> bool:
    """Whether what has been made of readings is not what would be made of them now."""
    return any(getattr(before, name) != getattr(now, name) for name in _REMADE)
