"""What the controller knows, as one record: `PERCEIVED`. It gets nothing else; the monitor and the log know the truth.

With perfect sensors it is the truth, contact and all. With noise every reading has its own, contact is what the
wrists tell, and a hand that does not touch feels nothing, so that none yields to noise. Where motion capture is the
source, the motion of base and target is what the filter makes of late pictures, as on the robot.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sim.compiled import compiled
from sim.config import Source
from sim.model.robot import Chain, RobotModel, chain
from sim.perception.cameras import CAMERAS, begin_watching, film
from sim.perception.contact import is_touching, touching_tip
from sim.perception.sensing import add_noise, is_noisy
from sim.record import Record, code_of

_MOTION_CAPTURE = code_of(Source.MOTION_CAPTURE)

PERCEIVED = np.dtype(
    [
        ("tick", np.int64),
        ("time", np.float64),  # [s]
        ("base_pose", np.float64, (3,)),
        ("base_twist", np.float64, (3,)),
        ("joint_angle", np.float64, (2, 3)),
        ("joint_rate", np.float64, (2, 3)),
        ("mount_angle", np.float64, (2,)),
        ("mount_rate", np.float64, (2,)),
        ("target_pose", np.float64, (3,)),
        ("target_twist", np.float64, (3,)),
        ("hand_wrench", np.float64, (2, 3)),  # target on hand, about the hand centre, world axes; zero without contact
        ("tip_contact", np.int64, (2, 2)),
        ("touching", np.int64, (2,)),  # each hand, with hysteresis: what is remembered from tick to tick
        ("closed", np.int64),  # the tips enclose the target at its present angle
        ("cameras", CAMERAS),  # of motion capture: what is remembered from tick to tick
    ],
    align=True,
)
"""As `PLANT_STATE`, but believed."""

Perceived = np.ndarray[Any, np.dtype[Any]]
"""An array of one `PERCEIVED`."""


@compiled
def is_perfect(perception: Record) -> bool:
    """Whether what is known is the truth; `perception` is a record of `PerceptionConfig`."""
    return perception.source != _MOTION_CAPTURE and not is_noisy(perception.noise)


@compiled
def perceive(known: Record, parameters: Record, robot: RobotModel, state: Record, links: Chain) -> Chain:
    """What is known of a true state, into one element of `PERCEIVED` but for `closed`; the chain as it is believed.

    How far a hand gives way on its mount is known as it is: no sensor of the testbed measures it, its hands are rigid.

    Args:
        known: what was known at the tick before, all zero at first; changed.
        parameters: record of `MissionConfig`.
        robot: the robot's model.
        state: the true one, one element of `PLANT_STATE`.
        links: the chain at that state.

    """
    perception = parameters.perception
    _copy(known, state)
    if is_perfect(perception):
        for arm in range(2):
            known.touching[arm] = state.tip_contact[arm, 0] != 0 or state.tip_contact[arm, 1] != 0
        return links
    filmed = perception.source == _MOTION_CAPTURE
    if filmed and not known.cameras.begun:
        begin_watching(known.cameras, known, parameters.simulation.seed)
    if is_noisy(perception.noise):
        add_noise(perception.noise, parameters.simulation.seed, known)
    if filmed:
        film(known.cameras, known, parameters, robot, known.touching[0] != 0 or known.touching[1] != 0)
    believed = chain(robot, known.base_pose, known.joint_angle, known.mount_angle)
    for arm in range(2):
        _feel(known, perception.contact_threshold, robot, believed, arm)
    return believed


@compiled
def _copy(known: Record, state: Record) -> None:
    known.tick, known.time = state.tick, state.time
    known.base_pose[:], known.base_twist[:] = state.base_pose, state.base_twist
    known.joint_angle[:], known.joint_rate[:] = state.joint_angle, state.joint_rate
    known.mount_angle[:], known.mount_rate[:] = state.mount_angle, state.mount_rate
    known.target_pose[:], known.target_twist[:] = state.target_pose, state.target_twist
    known.hand_wrench[:], known.tip_contact[:] = state.hand_wrench, state.tip_contact


@compiled
def _feel(known: Record, threshold: float, robot: RobotModel, links: Chain, arm: int) -> None:
    """Contact of one hand, from its wrench."""
    force = math.hypot(known.hand_wrench[arm, 0], known.hand_wrench[arm, 1])
    touching = is_touching(known.touching[arm] != 0, force, threshold)
    known.touching[arm] = touching
    known.tip_contact[arm, :] = 0
    if touching:
        known.tip_contact[arm, touching_tip(robot, links.hand_pose[arm], known.hand_wrench[arm])] = 1
    else:
        known.hand_wrench[arm, :] = 0.0
