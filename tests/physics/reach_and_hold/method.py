"""The method as a value: `METHOD`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.config import MissionConfig
from sim.control.hand_motion import NO_HANDS, track
from sim.control.phases import Command, Phase, Verdict, phase_after
from sim.control.trajectory import BOTH_ARMS, add_knot, plan_end, start_plan
from sim.method.method import Method, Words, register_kernel
from sim.model.robot import Chain, RobotModel
from sim.record import Record
from sim.snapshot import Condition, Plan, Touch


class Activity(IntEnum):
    NONE = 0
    REACHING = 1
    STILL = 2


class PlanKind(IntEnum):
    NONE = 0
    REACH = 1


MEMORY = np.dtype([("arrived_at", np.float64)], align=True)


class Handle(NamedTuple):
    own: np.ndarray[Any, np.dtype[Any]]


@compiled
def begin(handle: Handle, memory: Record) -> None:
    handle.own[0].arrived_at = math.inf


@compiled
def react(handle: Handle, memory: Record, parameters: Record, state: Record, verdict: int) -> tuple[int, int, int]:
    if verdict != Verdict.NONE:
        return phase_after(verdict), Activity.NONE, PlanKind.NONE
    if memory.phase != Phase.DETUMBLING:
        return memory.phase, Activity.NONE, PlanKind.NONE
    if memory.plan_kind != PlanKind.REACH:
        return Phase.DETUMBLING, Activity.REACHING, PlanKind.REACH
    if state.time < plan_end(memory):
        return Phase.DETUMBLING, Activity.REACHING, PlanKind.NONE
    handle.own[0].arrived_at = min(handle.own[0].arrived_at, state.time)
    if state.time < handle.own[0].arrived_at + parameters.reach_and_hold.stillness:
        return Phase.DETUMBLING, Activity.STILL, PlanKind.NONE
    return Phase.HOLDING, Activity.NONE, PlanKind.NONE


@compiled
def plan(handle: Handle, memory: Record, parameters: Record, state: Record, hand_pose: FloatArray, kind: int) -> None:
    own = parameters.reach_and_hold
    start_plan(memory, kind, BOTH_ARMS, state.time, hand_pose)
    for arm in range(2):
        x, y, angle = hand_pose[arm, 0], hand_pose[arm, 1], hand_pose[arm, 2]
        back_x, back_y = math.sin(angle) * own.distance, -math.cos(angle) * own.distance
        add_knot(memory, arm, own.duration, x + back_x, y + back_y, angle)
    memory.plan_knots = 2


@compiled
def hand_twist(
    handle: Handle,
    memory: Record,
    parameters: Record,
    robot: RobotModel,
    state: Record,
    links: Chain,
    velocity: FloatArray,
) -> int:
    if memory.activity != Activity.REACHING:
        return NO_HANDS
    track(memory, parameters, state, links, velocity)
    return BOTH_ARMS


def _motion(row: Any, plan: Plan | None, touches: Sequence[Touch]) -> str:
    return "Both hands reach back." if row["activity"] == Activity.REACHING else "Both hands hold still."


def _next_step(row: Any, config: MissionConfig, phase: Phase) -> tuple[str, list[Condition]]:
    return "holding", [Condition.of("still", "the hands hold still", met=row["activity"] == Activity.STILL)]


def _unmet(row: Any, config: MissionConfig) -> str:
    return ""


METHOD = Method(
    title="Reach back and hold still",
    memory=MEMORY,
    activities=Activity,
    plan_kinds=PlanKind,
    closing=(),
    commands=frozenset({Command.CAPTURE, Command.HOLD}),
    handle=lambda config, own: Handle(own),
    spin_threshold=lambda config: None,
    enclosure=None,
    refusal=lambda command, config, row, *, on_robot: "",
    words=Words(
        phase={Phase.DETUMBLING: "The hands move"},
        plan={Activity.REACHING: "A reach is planned"},
        trouble={},
        motion=_motion,
        next_step=_next_step,
        unmet=_unmet,
    ),
)

register_kernel(Handle, begin=begin, react=react, plan=plan, hand_twist=hand_twist)
