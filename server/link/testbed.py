"""The emulated air-bearing testbed without a clock: the simulated plant on its table, and the messages of its sensors.

`becalm robot` drives it in real time behind zenoh (`server.link.robot_emulator`), `server.link.virtual_robot` without,
in virtual time.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from server.link import contract, wire
from server.link.contract import BODIES, Body, Channel
from server.link.faults import Sensor
from server.link.imperfections import Imperfections, Sensors
from sim.compiled import FloatArray
from sim.config import MissionConfig
from sim.configurations import revised
from sim.model.robot import chain, robot_model
from sim.model.target import to_middle
from sim.plant.engine import simulated_plant
from sim.record import Record, record_of

POSES = {"base": contract.BASE_POSE, "target": contract.TARGET_POSE}
TWISTS = {"base": contract.BASE_TWIST, "target": contract.TARGET_TWIST}


class Measured(NamedTuple):
    """A message of a sensor."""

    channel: Channel
    payload: bytes
    delay: float
    """From the measurement to its being sent [s]."""


class EmulatedTestbed:
    """Robot and target on their air table, and the sensors that see them. One thread at a time."""

    def __init__(self, config: MissionConfig, imperfections: Imperfections, seed: int) -> None:
        """Laid out as configured; the seed draws all that sensors get wrong."""
        some = imperfections
        table = {"drag": some.drag, "tilt_x": some.tilt_x, "tilt_y": some.tilt_y}
        self._plant = simulated_plant(revised(config, {"table": table}))
        self._model = robot_model(config.robot)
        self._target = record_of(config.target)
        self._sensors = Sensors(some, seed)
        self._capture_delay = some.motion_capture_delay
        self._capture_every = max(1, round(1.0 / (contract.MOTION_CAPTURE_RATE * config.control.period)))
        self._frozen: dict[str, Any] = {}
        self._measured = 0
        self.peak_force = 0.0
        """Largest true force of a hand until now [N]."""

    @property
    def state(self) -> Record:
        """The true one, one element of `PLANT_STATE`."""
        return self._plant.state

    @property
    def tared(self) -> bool:
        """Whether the wrists have been tared."""
        return self._sensors.tared

    def hand_pose(self) -> FloatArray:
        """Where both hands truly are, shape (2, 3)."""
        state = self.state
        pose: FloatArray = chain(self._model, state["base_pose"], state["joint_angle"], state["mount_angle"]).hand_pose
        return pose

    def move(self, joint_rate: FloatArray) -> None:
        """One control period under these joint rates, shape (2, 3) [rad/s]."""
        self._plant.apply_joint_rates(joint_rate)
        self.peak_force = max(self.peak_force, float(np.hypot(*self.state["hand_wrench"][:, :2].T).max()))

    def tare(self) -> None:
        """What the wrists read now is zero from here on."""
        self._sensors.tare()

    def measure(self, stamp: int, robot: str, frozen: Sensor | None = None) -> Iterator[Measured]:
        """The messages of one control period, in the order in which they are sent.

        Args:
            stamp: when it is, by the robot's clock [ns].
            robot: its identity.
            frozen: a sensor that repeats what it read last.

        """
        sensors = self._sensors
        seen = self.state.copy()
        to_middle(self._target, seen["target_pose"], seen["target_twist"])
        sensors.sense(seen, self.hand_pose()[:, 2])
        self._measured += 1
        for arm, wrench in enumerate(sensors.wrenches(stamp)):
            seen = self._or_frozen("left_wrist" if arm == 0 else "right_wrist", wrench, frozen)
            yield Measured(contract.WRENCHES[arm], wire.encode_wrench(seen._replace(stamp=stamp)), 0.0)
        if self._measured % self._capture_every == 0:
            for body in BODIES:
                yield from self._see(stamp, body, frozen)
        # Last: whoever takes a joint state has the wrenches of the same instant already.
        joints = self._or_frozen("joints", sensors.joints(stamp), frozen)
        yield Measured(contract.JOINT_STATES, wire.encode_joints(joints._replace(stamp=stamp, robot=robot)), 0.0)

    def _see(self, stamp: int, body: Body, frozen: Sensor | None) -> Iterator[Measured]:
        pose, twist = self._sensors.pose(stamp, body), self._sensors.twist(stamp, body)
        if pose is None:
            return
        pose, twist = self._or_frozen(body, (pose, twist), frozen)
        yield Measured(POSES[body], wire.encode_pose(pose._replace(stamp=stamp)), self._capture_delay)
        yield Measured(TWISTS[body], wire.encode_twist(twist._replace(stamp=stamp)), self._capture_delay)

    def _or_frozen(self, sensor: Sensor, reading: Any, frozen: Sensor | None) -> Any:
        """The reading, or the last one before this sensor froze."""
        if frozen == sensor and sensor in self._frozen:
            return self._frozen[sensor]
        self._frozen[sensor] = reading
        return reading
