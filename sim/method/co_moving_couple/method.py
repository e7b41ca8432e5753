"""The co-moving couple as a value: `METHOD`."""

from __future__ import annotations

from typing import Any

import numpy as np

from sim.compiled import FloatArray
from sim.config import MissionConfig
from sim.control.phases import Command
from sim.method.co_moving_couple import sequence
from sim.method.co_moving_couple.geometry import closed_radius, hand_before_corner
from sim.method.co_moving_couple.memory import COUPLE_MEMORY, ROLL_OUT, Activity, CoupleHandle, Fixed, PlanKind
from sim.method.co_moving_couple.reference import corner_towards
from sim.method.co_moving_couple.refusal import refusal
from sim.method.co_moving_couple.words import WORDS
from sim.method.method import Method, register_kernel
from sim.model.robot import base_shape, robot_model
from sim.model.target import seen_target_shape
from sim.record import packed

_CAGED_WITHIN = 0.002
"""Hands that are no further out than this from where all tips touch have come in [m]."""


def _handle(config: MissionConfig, own: np.ndarray[Any, np.dtype[Any]]) -> CoupleHandle:
    robot, shape = robot_model(config.robot), seen_target_shape(config.target)
    radius = closed_radius(robot, shape)
    fixed = Fixed(robot, shape, base_shape(config.robot.base), radius + _CAGED_WITHIN, radius)
    return CoupleHandle(own, packed(fixed), np.zeros(1, ROLL_OUT))


def _enclosure(config: MissionConfig) -> FloatArray:
    fixed = _handle(config, np.zeros(1, COUPLE_MEMORY)).fixed[0]
    corner, hands = corner_towards(fixed["shape"], 0.0, 0.0), np.empty((2, 3))
    for arm in range(2):
        hand_before_corner(arm, corner, float(fixed["cage_radius"]), 0.0, 0.0, hands[arm])
    return hands


def _spin_threshold(config: MissionConfig) -> float:
    return float(config.co_moving_couple.touch.no_touch_spin)


METHOD = Method(
    title="Braking by a couple that moves with the faces, closing while turning with the target (Becalm)",
    memory=COUPLE_MEMORY,
    activities=Activity,
    plan_kinds=PlanKind,
    closing=(Activity.CLOSING, Activity.SQUEEZING, Activity.SETTLING),
    commands=frozenset(Command) - {Command.DIRECT_CAGE},
    handle=_handle,
    spin_threshold=_spin_threshold,
    refusal=refusal,
    enclosure=_enclosure,
    words=WORDS,
)

register_kernel(
    CoupleHandle,
    begin=sequence.begin,
    react=sequence.react,
    plan=sequence.plan,
    hand_twist=sequence.hand_twist,
)
