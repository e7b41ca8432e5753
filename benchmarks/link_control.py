"""How good the control over the link is with the testbed's imperfections, apart from how busy this machine is.

    python -m benchmarks.link_control                                  20 seeds with the defaults
    python -m benchmarks.link_control --set published.impedance.damping=1.5 --set published.impedance.stiffness=10
    python -m benchmarks.link_control --ideal                          perfect sensors, no drag, no tilt, no delay

Both ends in one process and in virtual time: the plant on its air table, its sensors, the bytes of the wire, motion
capture's delay, joint rates that hold from the next period on, and the console's perception and mission. Same seed,
same numbers. What the clocks of two processes add is measured by benchmarks.link.
"""

from __future__ import annotations

import argparse
from collections import deque
from functools import reduce

import numpy as np

from becalm.typed import parse_setting
from server.link import wire
from server.link.contract import MOTION_CAPTURE_RATE
from server.link.imperfections import BODIES, Imperfections, Sensors
from server.link.perception import Perception
from sim.capture.mission import Mission
from sim.compiled import FloatArray
from sim.config import MissionConfig
from sim.configurations import merged, named_configuration, revised
from sim.control.phases import Command
from sim.model.robot import chain, robot_model
from sim.plant.engine import simulated_plant
from sim.plant.plant import PLANT_STATE
from sim.record import Record
from sim.snapshot import Outcome

SETTLING = 200
"""Control periods before the capture begins: the perception of a robot that was just taken."""
IDEAL = Imperfections(**dict.fromkeys(Imperfections.model_fields, 0.0))


class VirtualLink:
    """A robot behind its sensors, as a plant in virtual time."""

    handle = None

    def __init__(
        self, config: MissionConfig, some: Imperfections, seed: int, truth: MissionConfig | None = None
    ) -> None:
        """A robot that the console takes for that of a configuration, and which truly is that of another one."""
        table = {"drag": some.drag, "tilt_x": some.tilt_x, "tilt_y": some.tilt_y}
        self.truth = simulated_plant(revised(truth or config, {"table": table}))
        self.state: Record = np.zeros(1, PLANT_STATE)[0]
        self.state["tick"] = -1
        self._period = round(1e9 * config.control.period)
        self._robot = robot_model(config.robot)
        self._sensors = Sensors(some, seed)
        self._perception = Perception(config)
        self._every = round(1.0 / (MOTION_CAPTURE_RATE * config.control.period))
        self._delay = round(1e9 * some.motion_capture_delay)
        self._pictures: deque[tuple[int, str, bytes]] = deque()
        self._applied, self._coming = np.zeros((2, 3)), np.zeros((2, 3))
        self._cycle = 0
        self.peak = 0.0
        """True peak force of a hand [N]."""
        for _ in range(SETTLING):
            self._advance()
        self._sensors.tare()
        self._perception.reset()
        while not self._perception.complete:
            self._advance()

    def observe(self) -> None:
        """One control period later, as perceived."""
        joints = self._advance()
        self._perception.write_state(joints, self.state)
        self.state["tick"] += 1
        self.state["time"] = 1e-9 * self.state["tick"] * self._period

    def apply_joint_rates(self, joint_rate: FloatArray) -> None:
        """It arrives within this period and holds from the next on."""
        self._coming = wire.decode_joint_command(
            wire.encode_joint_command(wire.JointCommand(1, "s.1", joint_rate))
        ).rate

    def _advance(self) -> wire.JointSample:
        self.truth.apply_joint_rates(self._applied)
        truth = self.truth.state
        self._applied = self._coming
        self._cycle += 1
        stamp = self._cycle * self._period
        self.peak = max(self.peak, float(np.hypot(*truth["hand_wrench"][:, :2].T).max()))
        links = chain(self._robot, truth["base_pose"], truth["joint_angle"], truth["mount_angle"])
        self._sensors.sense(truth, links.hand_pose[:, 2])
        for arm, wrench in enumerate(self._sensors.wrenches(stamp)):
            self._perception.take_wrench(arm, wire.decode_wrench(wire.encode_wrench(wrench)))
        if self._cycle % self._every == 0:
            for body in BODIES:
                pose = self._sensors.pose(stamp, body)
                if pose is not None:
                    self._pictures.append((stamp + self._delay, body, wire.encode_pose(pose)))
        joints = wire.decode_joints(wire.encode_joints(self._sensors.joints(stamp)._replace(robot="virtual")))
        self._perception.take_joints(joints)
        while self._pictures and self._pictures[0][0] <= stamp:
            _, body, payload = self._pictures.popleft()
            take = self._perception.take_base if body == "base" else self._perception.take_target
            take(wire.decode_pose(payload))
        return joints


def capture(config: MissionConfig, some: Imperfections, seed: int) -> tuple[Outcome, VirtualLink]:
    """One capture."""
    plant = VirtualLink(config, some, seed)
    mission = Mission(config, plant)
    mission.request(Command.CAPTURE)
    while mission.outcome is None:
        mission.advance(20)
    return mission.outcome, plant


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--set", dest="settings", action="append", default=[], metavar="PATH=VALUE")
    parser.add_argument("--imperfection", action="append", default=[], metavar="NAME=VALUE")
    parser.add_argument("--ideal", action="store_true")
    chosen = parser.parse_args()
    config = revised(named_configuration("testbed"), reduce(merged, map(parse_setting, chosen.settings), {}))
    given = dict(each.split("=") for each in chosen.imperfection)
    some = Imperfections(**{**(IDEAL.model_dump() if chosen.ideal else {}), **given})
    rows = []
    for seed in range(chosen.seeds):
        outcome, plant = capture(config, some, seed)
        spin = float(plant.truth.state["target_twist"][2])
        rows.append((outcome.caged, plant.peak, outcome.peak_tip_force_to_closure, outcome.duration, abs(spin)))
        print(
            f"{seed:3} {outcome.outcome:26} caged {outcome.caged!s:5} peak {plant.peak:5.2f} N  spin {spin:+.3f} rad/s"
        )
    caged = np.array([row[1:] for row in rows if row[0]])
    print(f"{len(caged)} of {len(rows)} caged")
    for name, values in zip(("peak", "peak to closure", "duration", "final spin"), caged.T, strict=False):
        print(f"{name}: median {np.median(values):.3g}, from {values.min():.3g} to {values.max():.3g}")


if __name__ == "__main__":
    main()
