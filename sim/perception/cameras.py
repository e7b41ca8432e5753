"""Motion capture in the simulation: pictures at a rate of their own, late, with gaps, and the filter that takes them.

The cameras have watched for a while before the first tick: the filter begins as sure as it is after `ENOUGH` pictures,
and as wrong as that, drawn by the seed. Joint rates are the encoders' differences over a tick, as on the robot.
"""

from __future__ import annotations

import math

import numpy as np

from sim.compiled import compiled
from sim.perception.imperfections import is_missed, misplacement
from sim.perception.motion import see_base, see_target, stamp_of
from sim.record import Record

_UNDER_WAY = 64
"""Pictures that may be on their way at once; `sim.config` bounds their delay by it."""
_ROUNDING = 1e-9

CAMERAS = np.dtype(
    [
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
def film(cameras: Record, motion: Record, known: Record, parameters: Record, modelled: bool) -> None:
    """Take a picture if one is due, and give the filter those that have arrived.

    Args:
        cameras: one element of `CAMERAS`; changed.
        motion: one element of `MOTION`; changed.
        known: one element of `PERCEIVED`: the readings of this tick, of which cameras would make pictures.
        parameters: record of `MissionConfig`.
        modelled: whether felt forces are fed forward.

    """
    capture, period = parameters.perception.capture, parameters.control.period
    if _is_due(known.tick, capture.rate * period):
        stamp = stamp_of(known.time + capture.stamp_error)
        _take(cameras, known, parameters, stamp, round(capture.delay / period))
    _develop(cameras, motion, parameters.perception, known.tick, modelled)


@compiled
def _is_due(tick: int, pictures_a_tick: float) -> bool:
    """Whether a picture is taken in this tick: as many in the long run as the rate says."""
    return math.floor((tick + 1) * pictures_a_tick + _ROUNDING) > math.floor(tick * pictures_a_tick + _ROUNDING)


@compiled
def _take(cameras: Record, known: Record, parameters: Record, stamp: int, delay: int) -> None:
    """Take a picture, which arrives that many ticks later."""
    perception, seed = parameters.perception, parameters.simulation.seed
    place = cameras.after_last % _UNDER_WAY
    cameras.due[place], cameras.stamp[place] = known.tick + delay, stamp
    cameras.pose[place, 0, :], cameras.pose[place, 1, :] = known.base_pose, known.target_pose
    for body in range(2):
        cameras.there[place, body] = not is_missed(perception.capture.dropouts, seed, known.tick, body)
        aside_x, aside_y = misplacement(perception.imperfections, seed, known.tick, body)
        cameras.pose[place, body, 0] += aside_x
        cameras.pose[place, body, 1] += aside_y
    cameras.after_last += 1


@compiled
def _develop(cameras: Record, motion: Record, perception: Record, tick: int, modelled: bool) -> None:
    """Give the filter the pictures that have arrived until this tick."""
    while cameras.first < cameras.after_last and cameras.due[cameras.first % _UNDER_WAY] <= tick:
        place = cameras.first % _UNDER_WAY
        stamp = cameras.stamp[place]
        if cameras.there[place, 0]:
            see_base(motion, perception, stamp, cameras.pose[place, 0], modelled)
        if cameras.there[place, 1]:
            see_target(motion, perception, stamp, cameras.pose[place, 1], modelled)
        cameras.first += 1
