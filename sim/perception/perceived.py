"""What the controller knows, as one record: `PERCEIVED`. It gets nothing else; the monitor and the log know the truth.

With perfect sensors it is the truth, contact and all. With noise every reading has its own, with imperfections what
its sensor gets wrong; contact is what the
wrists tell, and a hand that does not touch feels nothing, so that none yields to noise. Where motion capture is the
source, the motion of base and target is what the filter makes of late pictures, as on the robot. With the model-based
estimator the filter takes every reading, late or not, knows what the hands feel, and learns the target's inertia.

What a robot's sensors read is perceived by the same code (`perceive_readings`), as its readings come.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sim.compiled import FloatArray, compiled, compiled_inline
from sim.config import Estimator, Source
from sim.model.planar import rotated
from sim.model.reduced_model import CHAIN, SHAPE, set_chain, shape_of_state
from sim.model.robot import RobotModel
from sim.model.shape import Shape
from sim.model.target import to_middle
from sim.perception.cameras import CAMERAS, film
from sim.perception.contact import is_touching, touching_tip
from sim.perception.imperfections import add_imperfections, is_imperfect, is_miscalibrated, miscalibrate
from sim.perception.motion import (
    MOTION,
    assume,
    begin_estimating,
    feel,
    predict,
    see_base,
    see_target,
    stamp_of,
    take_readings,
    tell,
    watched,
)
from sim.perception.sensing import add_noise, is_noisy
from sim.perception.wrists import WRISTS, smooth_wrench, tare_and_smooth
from sim.record import Record, code_of, copy_rows, copy_vector

_MOTION_CAPTURE = code_of(Source.MOTION_CAPTURE)
_MODEL_BASED = code_of(Estimator.MODEL_BASED)

_FAR_OFF = 4.0
"""Times the threshold, a force counts as contact of a hand that should not be able to touch."""

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
        ("target_pose", np.float64, (3,)),  # of its middle, which is what motion capture sees
        ("target_twist", np.float64, (3,)),
        ("hand_wrench", np.float64, (2, 3)),  # target on hand, about the hand centre, world axes; zero without contact
        ("tip_contact", np.int64, (2, 2)),
        ("touching", np.int64, (2,)),  # each hand, with hysteresis: what is remembered from tick to tick
        ("closed", np.int64),  # the tips enclose the target at its present angle
        ("target_twist_deviation", np.float64, (3,)),  # standard deviation of the twist; zero without an estimator
        ("target_inertia", np.float64),  # [kg m2]; as assumed without an estimator
        ("target_inertia_deviation", np.float64),
        ("target_seen_at", np.float64),  # instant of the last reading of the target that was taken [s]
        ("motion", MOTION),  # of the estimators: what is remembered from tick to tick
        ("wrists", WRISTS),  # likewise
        ("cameras", CAMERAS),  # of motion capture: likewise
        ("shape", SHAPE),  # the robot's, as it is believed to be; not set where that is the truth
        ("links", CHAIN),  # likewise
    ],
    align=True,
)
"""As `PLANT_STATE`, but believed."""

Perceived = np.ndarray[Any, np.dtype[Any]]
"""An array of one `PERCEIVED`."""


@compiled_inline
def is_perfect(perception: Record) -> bool:
    """Whether what is known is the truth; `perception` is a record of `PerceptionConfig`."""
    if perception.source == _MOTION_CAPTURE or perception.estimator == _MODEL_BASED:
        return False
    return (
        not is_noisy(perception.noise)
        and not is_imperfect(perception.imperfections)
        and not is_miscalibrated(perception.wrist)
    )


@compiled_inline
def perceive(known: Record, parameters: Record, robot: RobotModel, target: Shape, state: Record) -> bool:
    """What is known of a true state, into one element of `PERCEIVED` but for `closed`; whether it is the truth.

    How far a hand gives way on its mount is known as it is: no sensor of the testbed measures it, its hands are rigid.

    Args:
        known: what was known at the tick before, all zero at first; changed.
        parameters: record of `MissionConfig`.
        robot: the robot's model.
        target: its shape about its middle.
        state: the true one, one element of `PLANT_STATE`.

    """
    _copy(known, state)
    to_middle(parameters.target, known.target_pose, known.target_twist)
    known.target_seen_at = state.time
    if is_perfect(parameters.perception):
        _assume_inertia(known, parameters.perception)
        for arm in range(2):
            known.touching[arm] = state.tip_contact[arm, 0] != 0 or state.tip_contact[arm, 1] != 0
        return True
    _sense(known, parameters, robot, target)
    return False


@compiled
def _sense(known: Record, parameters: Record, robot: RobotModel, target: Shape) -> None:
    """What sensors that are not perfect make of the truth, which `known` holds."""
    perception = parameters.perception
    modelled, filmed = perception.estimator == _MODEL_BASED, perception.source == _MOTION_CAPTURE
    if not known.motion.begun:
        _begin(known, parameters, filmed)
    hand_angle = np.empty(2)
    for arm in range(2):  # before any noise: a bias turns with the hand as it is
        hand_angle[arm] = known.base_pose[2] + known.joint_angle[arm].sum() + known.mount_angle[arm]
    if is_miscalibrated(perception.wrist):
        miscalibrate(perception.wrist, hand_angle, known)
    if is_noisy(perception.noise):
        add_noise(perception.noise, parameters.simulation.seed, known)
    if is_imperfect(perception.imperfections):
        add_imperfections(perception.imperfections, parameters.simulation.seed, hand_angle, known)
    shape = shape_of_state(robot, known, known.shape)
    if modelled or filmed:
        _estimate(known, parameters, shape, modelled, filmed)
    set_chain(known.base_pose, shape, known.links)
    _feel_both(known, parameters, robot, target)


@compiled
def begin_perceiving(known: Record, parameters: Record) -> None:
    """Know nothing yet of what sensors elsewhere read: one element of `PERCEIVED`, for `perceive_readings`.

    Args:
        known: all zero; changed.
        parameters: record of `MissionConfig`.

    """
    begin_estimating(known.motion, known.joint_angle, known.time)
    if parameters.perception.estimator == _MODEL_BASED:
        assume(known.motion.target, parameters.perception)


@compiled
def see(known: Record, parameters: Record, stamp: int, pose: FloatArray, target: bool) -> tuple[bool, float, float]:
    """Take a pose that a body was seen at by cameras elsewhere, the target or the base, unless it is an outlier.

    Args:
        known: one element of `PERCEIVED` that has begun; changed.
        parameters: record of `MissionConfig`.
        stamp: of the picture [ns], by the clock of `known`.
        pose: shape (3,) [m, m, rad].
        target: whose pose it is.

    Returns:
        Whether it is an outlier, and how far from where the body can be [m, rad].

    """
    modelled = parameters.perception.estimator == _MODEL_BASED
    if target:
        return see_target(known.motion, parameters.perception, stamp, pose, modelled)
    return see_base(known.motion, parameters.perception, stamp, pose, modelled)


@compiled
def perceive_readings(
    known: Record, parameters: Record, robot: RobotModel, target: Shape, wrench_in_hand: FloatArray
) -> None:
    """What is known by a joint state and the wrists' readings of sensors elsewhere: `perceive` for those of a robot.

    Its hands are rigid. Poses of base and target are those that `see` was given until now.

    Args:
        known: one element of `PERCEIVED` that has begun: its time, joint angles and rates are the readings; changed.
        parameters: record of `MissionConfig`.
        robot: the robot's model.
        target: its shape about its middle.
        wrench_in_hand: of each wrist about the hand's centre, in its hand's axes, shape (2, 3) [N, N, N m].

    """
    motion = known.motion
    if known.touching[0] != 0 or known.touching[1] != 0:
        motion.last_contact = known.time
    motion.joint_angle[:] = known.joint_angle
    shape = shape_of_state(robot, known, known.shape)
    predict(motion, shape, known)
    known.target_seen_at = 1e-9 * motion.target.stamp
    tell(motion, parameters.perception, known)
    set_chain(known.base_pose, shape, known.links)
    for arm in range(2):
        along, across = wrench_in_hand[arm, 0], wrench_in_hand[arm, 1]
        known.hand_wrench[arm, 0], known.hand_wrench[arm, 1] = rotated(known.links.hand_pose[arm, 2], along, across)
        known.hand_wrench[arm, 2] = wrench_in_hand[arm, 2]
    _feel_both(known, parameters, robot, target)


@compiled
def _feel_both(known: Record, parameters: Record, robot: RobotModel, target: Shape) -> None:
    """Contact of both hands from their wrenches, and what is believed of the target's inertia."""
    perception = parameters.perception
    if perception.estimator == _MODEL_BASED:
        _feel_smoothly(known, parameters, robot, target)
        return
    _assume_inertia(known, perception)
    for arm in range(2):
        _feel(known, known.hand_wrench[arm], perception.contact_threshold, robot, arm)


@compiled_inline
def _assume_inertia(known: Record, perception: Record) -> None:
    known.target_inertia = perception.assumed_inertia
    known.target_inertia_deviation = perception.assumed_inertia_uncertainty * perception.assumed_inertia


@compiled
def _begin(known: Record, parameters: Record, filmed: bool) -> None:
    """Begin to remember, from readings without noise."""
    motion, seed, stamp = known.motion, parameters.simulation.seed, stamp_of(known.time)
    begin_estimating(motion, known.joint_angle, known.time)
    known.cameras.first = known.cameras.after_last = 0
    if filmed:
        watched(motion.base, known.base_pose, known.base_twist, seed, known.tick, 0, stamp)
        watched(motion.target, known.target_pose, known.target_twist, seed, known.tick, 1, stamp)
    if parameters.perception.estimator == _MODEL_BASED:
        assume(motion.target, parameters.perception)


@compiled
def _estimate(known: Record, parameters: Record, shape: Record, modelled: bool, filmed: bool) -> None:
    """Motion of base and target, from this tick's readings or from pictures."""
    motion, perception = known.motion, parameters.perception
    touching = known.touching[0] != 0 or known.touching[1] != 0
    if touching:
        motion.last_contact = known.time
    if filmed:
        known.joint_rate[:] = (known.joint_angle - motion.joint_angle) / parameters.control.period
        motion.joint_angle[:] = known.joint_angle
    predict(motion, shape, known)
    if filmed:
        film(known.cameras, motion, known, parameters, modelled)
        known.target_seen_at = 1e-9 * motion.target.stamp
    else:
        take_readings(motion, perception, known, touching)
    tell(motion, perception, known)


@compiled
def _feel_smoothly(known: Record, parameters: Record, robot: RobotModel, target: Shape) -> None:
    """Contact from tared and smoothed wrenches, which the controller gets; what they do to the bodies is noted."""
    perception = parameters.perception
    tare_and_smooth(known.wrists, perception, parameters.control.period, robot, target, known)
    felt, smooth = known.hand_wrench.copy(), np.empty(3)
    for arm in range(2):
        smooth_wrench(known.wrists, arm, known.links.hand_pose[arm, 2], smooth)
        least = perception.contact_threshold if known.wrists.near[arm] else _FAR_OFF * perception.contact_threshold
        _feel(known, smooth, least, robot, arm)
        if known.touching[arm]:
            known.hand_wrench[arm, :] = smooth
    feel(known.motion, known, felt)


@compiled_inline
def _copy(known: Record, state: Record) -> None:
    known.tick, known.time = state.tick, state.time
    copy_vector(known.base_pose, state.base_pose)
    copy_vector(known.base_twist, state.base_twist)
    copy_rows(known.joint_angle, state.joint_angle)
    copy_rows(known.joint_rate, state.joint_rate)
    copy_vector(known.mount_angle, state.mount_angle)
    copy_vector(known.mount_rate, state.mount_rate)
    copy_vector(known.target_pose, state.target_pose)
    copy_vector(known.target_twist, state.target_twist)
    copy_rows(known.hand_wrench, state.hand_wrench)
    copy_rows(known.tip_contact, state.tip_contact)


@compiled
def _feel(known: Record, wrench: FloatArray, threshold: float, robot: RobotModel, arm: int) -> None:
    """Contact of one hand, from its wrench, shape (3,)."""
    touching = is_touching(known.touching[arm] != 0, math.hypot(wrench[0], wrench[1]), threshold)
    known.touching[arm] = touching
    known.tip_contact[arm, :] = 0
    if touching:
        known.tip_contact[arm, touching_tip(robot, known.links.hand_pose[arm], wrench)] = 1
    else:
        known.hand_wrench[arm, :] = 0.0
