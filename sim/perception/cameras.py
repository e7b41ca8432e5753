"""Motion capture in the simulation: pictures at a rate of their own, late, with gaps, and the filter that takes them.

The cameras have watched for a while before the first tick: the filter begins as sure as it is after `ENOUGH` pictures,
and as wrong as that, drawn by the seed. Joint rates are the encoders' differences over a tick, as on the robot.
"""

from __future__ import annotations

import math

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.model.robot import RobotModel
from sim.perception.estimators import (
    BASE_DRIFT,
    BODY_ESTIMATE,
    ENOUGH,
    body_at,
    drift_until,
    forget_body,
    forget_drift,
    take_joints,
    take_picture,
)
from sim.perception.sensing import gaussian, uniform
from sim.record import Record

_UNDER_WAY = 64
"""Pictures that may be on their way at once; `sim.config` bounds their delay by it."""
_SURE = (1e-4, 1e-4, 5e-4)
"""Standard deviations of poses that have been watched for a while [m, m, rad]."""
_SURE_OF_RATE = (3e-4, 3e-4, 2e-3)
"""... of twists [m/s, m/s, rad/s]."""
_ROUNDING = 1e-9
_LONG_AGO = -1e9
"""Before every contact [s]."""
_FIRST_CHANNEL = 100
"""Beyond those of the sensors' noise."""

CAMERAS = np.dtype(
    [
        ("begun", np.int64),
        ("base", BODY_ESTIMATE),  # of the base's motion without the arms' part
        ("target", BODY_ESTIMATE),
        ("drift", BASE_DRIFT),
        ("last_contact", np.float64),  # as the wrists felt it [s]
        ("joint_angle", np.float64, (2, 3)),  # by the encoders at the tick before: rates are their differences
        ("first", np.int64),  # picture on its way
        ("after_last", np.int64),
        ("due", np.int64, (_UNDER_WAY,)),  # tick at which it arrives
        ("stamp", np.int64, (_UNDER_WAY,)),  # [ns]
        ("pose", np.float64, (_UNDER_WAY, 2, 3)),  # base, target
        ("there", np.int64, (_UNDER_WAY, 2)),  # whether the body is in the picture
    ],
    align=True,
)
"""What is remembered from tick to tick."""


@compiled
def film(cameras: Record, known: Record, parameters: Record, robot: RobotModel, touching: bool) -> None:
    """What motion capture makes of the poses and twists of base and target that are in `known`, in their place.

    Args:
        cameras: one element of `CAMERAS`; changed.
        known: one element of `PERCEIVED`: the readings of this tick, of which cameras would make pictures.
        parameters: record of `MissionConfig`.
        robot: the robot's model.
        touching: whether a wrist felt a contact at the tick before.

    """
    capture, seed, period = parameters.perception.capture, parameters.simulation.seed, parameters.control.period
    stamp = _stamp(known.time)
    if touching:
        cameras.last_contact = known.time
    pose, twist = np.empty(3), np.empty(3)
    body_at(cameras.base, stamp, pose, twist)
    known.joint_rate[:] = (known.joint_angle - cameras.joint_angle) / period
    cameras.joint_angle[:] = known.joint_angle
    take_joints(
        cameras.drift, robot, stamp, pose + drift_until(cameras.drift, stamp), known.joint_angle, known.joint_rate
    )
    if _is_due(known.tick, capture.rate * period):
        _take(cameras, known, seed, stamp, round(capture.delay / period), capture.dropouts)
    _develop(cameras, parameters, known.tick)
    body_at(cameras.base, stamp, pose, twist)
    known.base_pose[:] = pose + drift_until(cameras.drift, stamp)
    known.base_twist[:] = twist + cameras.drift.twist
    body_at(cameras.target, stamp, known.target_pose, known.target_twist)


@compiled
def _stamp(time: float) -> int:
    return round(1e9 * time)


@compiled
def _is_due(tick: int, pictures_a_tick: float) -> bool:
    """Whether a picture is taken in this tick: as many in the long run as the rate says."""
    return math.floor((tick + 1) * pictures_a_tick + _ROUNDING) > math.floor(tick * pictures_a_tick + _ROUNDING)


@compiled
def begin_watching(cameras: Record, truth: Record, seed: int) -> None:
    """Know base and target as well as after a while of watching them; `truth` is an element of `PERCEIVED`."""
    forget_body(cameras.base)
    forget_body(cameras.target)
    forget_drift(cameras.drift)
    cameras.begun, cameras.first, cameras.after_last = 1, 0, 0
    cameras.last_contact = _LONG_AGO
    _watched(cameras.base, truth.base_pose, truth.base_twist, seed, truth.tick, _FIRST_CHANNEL)
    _watched(cameras.target, truth.target_pose, truth.target_twist, seed, truth.tick, _FIRST_CHANNEL + 6)
    cameras.base.stamp = cameras.target.stamp = _stamp(truth.time)
    cameras.joint_angle[:] = truth.joint_angle


@compiled
def _watched(estimate: Record, pose: FloatArray, twist: FloatArray, seed: int, tick: int, channel: int) -> None:
    """As sure and as wrong as after a while of watching."""
    for axis in range(3):
        sure, of_rate = _SURE[axis], _SURE_OF_RATE[axis]
        estimate.x[axis, 0] = pose[axis] + sure * gaussian(seed, tick, channel + axis)
        estimate.x[axis, 1] = twist[axis] + of_rate * gaussian(seed, tick, channel + 3 + axis)
        estimate.p[axis, 0, 0], estimate.p[axis, 1, 1] = sure * sure, of_rate * of_rate
    estimate.taken = ENOUGH


@compiled
def _take(cameras: Record, known: Record, seed: int, stamp: int, delay: int, dropouts: float) -> None:
    """Take a picture, which arrives that many ticks later."""
    place = cameras.after_last % _UNDER_WAY
    cameras.due[place], cameras.stamp[place] = known.tick + delay, stamp
    cameras.pose[place, 0, :], cameras.pose[place, 1, :] = known.base_pose, known.target_pose
    for body in range(2):
        cameras.there[place, body] = uniform(seed, known.tick, _FIRST_CHANNEL + 12 + body) > dropouts
    cameras.after_last += 1


@compiled
def _develop(cameras: Record, parameters: Record, tick: int) -> None:
    """Give the filter the pictures that have arrived until this tick."""
    while cameras.first < cameras.after_last and cameras.due[cameras.first % _UNDER_WAY] <= tick:
        place = cameras.first % _UNDER_WAY
        stamp = cameras.stamp[place]
        touched = 1e-9 * stamp - cameras.last_contact < parameters.perception.filter.contact_memory
        if cameras.there[place, 0]:
            rest = cameras.pose[place, 0] - drift_until(cameras.drift, stamp)
            take_picture(cameras.base, parameters.perception.filter, stamp, rest, touched)
        if cameras.there[place, 1]:
            take_picture(cameras.target, parameters.perception.filter, stamp, cameras.pose[place, 1], touched)
        cameras.first += 1
