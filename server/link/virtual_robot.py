"""The emulated robot in virtual time: both ends of the link in one process, as a plant that waits for nothing.

What is as on the link: the testbed and its sensors, the bytes of every message, motion capture's delay, joint rates
that hold from the next control period on, and what the console perceives. What is not: clocks, zenoh, and a machine
that does other things. The same seed gives the same flight, bit for bit.
"""

from __future__ import annotations

from collections import deque

import numpy as np

from server.link import contract, wire
from server.link.imperfections import Imperfections
from server.link.perception import Perception
from server.link.testbed import EmulatedTestbed, Measured
from sim.compiled import FloatArray
from sim.config import MissionConfig
from sim.perception.perceived import PERCEIVED
from sim.plant.plant import PLANT_STATE
from sim.record import Record

SETTLING = 200
"""Control periods before the wrists are tared: the perception of a robot that was just taken."""
_NAME = "virtual"


class VirtualRobot:
    """A robot behind its sensors, from after its wrists were tared on."""

    handle = None

    def __init__(
        self, config: MissionConfig, imperfections: Imperfections, seed: int, truth: MissionConfig | None = None
    ) -> None:
        """Laid out as configured, perceived by that configuration; the seed draws all that sensors get wrong.

        With a `truth` the robot is that, and the console takes it for what is configured.
        """
        self.testbed = EmulatedTestbed(truth or config, imperfections, seed)
        self.state: Record = np.zeros(1, PLANT_STATE)[0]
        self.state["tick"] = -1
        self.perceived: Record = np.zeros(1, PERCEIVED)[0]
        self._period = round(1e9 * config.control.period)
        self._perception = Perception(config)
        self._under_way: deque[tuple[int, Measured]] = deque()
        self._applied, self._coming = np.zeros((2, 3)), np.zeros((2, 3))
        self._stamp = 0
        for _ in range(SETTLING):
            self._advance()
        self.testbed.tare()
        self._perception.reset()
        while not self._perception.complete:
            self._advance()
        self._write()

    @property
    def copyable(self) -> None:
        """Nor does an emulated one."""

    @property
    def next_tick(self) -> int:
        """The tick after the last one, which has been observed and answered already."""
        return int(self.state["tick"]) + 1

    def observe(self) -> None:
        """One control period later, as perceived."""
        self._advance()
        tick = self.next_tick
        if tick == 0:
            self._perception.count_from(self._stamp)
        self.state["tick"], self.state["time"] = tick, 1e-9 * tick * self._period
        self._write()

    def apply_joint_rates(self, joint_rate: FloatArray) -> None:
        """It arrives within this period and holds from the next on."""
        command = wire.JointCommand(self._stamp, _NAME, joint_rate)
        self._coming = wire.decode_joint_command(wire.encode_joint_command(command)).rate

    def _write(self) -> None:
        self._perception.write_state(self.state, self.perceived)
        self.perceived["tick"], self.perceived["time"] = self.state["tick"], self.state["time"]

    def _advance(self) -> None:
        self.testbed.move(self._applied)
        self._applied = self._coming
        self._stamp += self._period
        for measured in self.testbed.measure(self._stamp, _NAME):
            if measured.delay > 0.0:
                self._under_way.append((self._stamp + round(1e9 * measured.delay), measured))
            else:
                self._take(measured)
        while self._under_way and self._under_way[0][0] <= self._stamp:
            self._take(self._under_way.popleft()[1])

    def _take(self, measured: Measured) -> None:
        """What comes is decoded, and perceived; twists are not flown with."""
        channel, perception = measured.channel, self._perception
        if channel is contract.JOINT_STATES:
            perception.take_joints(wire.decode_joints(measured.payload))
        elif channel in contract.WRENCHES:
            perception.take_wrench(contract.WRENCHES.index(channel), wire.decode_wrench(measured.payload))
        elif channel is contract.BASE_POSE:
            perception.take_base(wire.decode_pose(measured.payload))
        elif channel is contract.TARGET_POSE:
            perception.take_target(wire.decode_pose(measured.payload))
