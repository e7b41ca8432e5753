"""Where the hands should be and when: straight paths between knots, with cubic time scaling.

A method writes its plan into the controller's memory, as up to `KNOTS` poses per hand and their times.
"""

from __future__ import annotations

import math

from sim.compiled import FloatArray, compiled, compiled_inline
from sim.control.memory import NEVER
from sim.record import Record

BOTH_ARMS = -1
LEFT, RIGHT = 0, 1


@compiled
def start_plan(memory: Record, kind: int, arm: int, time: float, hand_pose: FloatArray) -> None:
    """Begin a plan of that kind at the hands' present poses, shape (2, 3); knots are added next."""
    memory.plan_kind = kind
    memory.plan_count += 1
    memory.plan_arm = arm
    memory.plan_knots = 1
    memory.prediction.made = 0
    memory.touch_plan.made = 0
    memory.plan_time[0] = time
    for side in range(2):
        memory.plan_pose[side, 0, :] = hand_pose[side]
        memory.tracking_integral[side, :] = 0.0


@compiled
def add_knot(memory: Record, arm: int, duration: float, x: float, y: float, angle: float) -> None:
    """Set an arm's pose `duration` [s] after the last knot; the other arm of a pair shares the knot."""
    knot = memory.plan_knots
    memory.plan_time[knot] = memory.plan_time[knot - 1] + duration
    memory.plan_pose[arm, knot, 0] = x
    memory.plan_pose[arm, knot, 1] = y
    memory.plan_pose[arm, knot, 2] = angle


@compiled
def predict_target(memory: Record, pose: FloatArray, twist: FloatArray, duration: float) -> None:
    """Keep the target's predicted pose `duration` [s] ahead, its free motion continued."""
    for axis in range(3):
        memory.predicted_target[axis] = pose[axis] + twist[axis] * duration


@compiled
def plan_opening(
    memory: Record, state: Record, hand_pose: FloatArray, kind: int, distance: float, duration: float
) -> None:
    """Plan an opening: each hand draws back from the target along its own axis, without turning.

    Args:
        memory: one element of `MEMORY`; changed.
        state: one element of `PERCEIVED`.
        hand_pose: of both hands, shape (2, 3).
        kind: of the plan, the method's.
        distance: of the hand centres from the target's centre, along their axes, at the end [m].
        duration: [s].

    """
    pose = state.target_pose
    start_plan(memory, kind, BOTH_ARMS, state.time, hand_pose)
    for arm in range(2):
        x, y, angle = hand_pose[arm, 0], hand_pose[arm, 1], hand_pose[arm, 2]
        back_x, back_y = math.sin(angle), -math.cos(angle)
        present = (x - pose[0]) * back_x + (y - pose[1]) * back_y
        step = max(0.0, distance - present)
        add_knot(memory, arm, duration, x + step * back_x, y + step * back_y, angle)
    memory.plan_knots = 2
    predict_target(memory, pose, state.target_twist, duration)


@compiled_inline
def time_scaling(part: float) -> tuple[float, float]:
    """S and ds/dpart of the cubic scaling s = 3 p^2 - 2 p^3, p the part of the duration, 0 to 1."""
    return part * part * (3.0 - 2.0 * part), 6.0 * part * (1.0 - part)


@compiled_inline
def plan_end(memory: Record) -> float:
    """When the plan ends [s]; before every mission if there is none."""
    return memory.plan_time[memory.plan_knots - 1] if memory.plan_knots > 1 else NEVER


@compiled
def end_plan(memory: Record, time: float) -> None:
    """The plan has been carried out by now [s], if not before: sooner than was predicted."""
    for knot in range(memory.plan_knots):
        memory.plan_time[knot] = min(memory.plan_time[knot], time)


@compiled_inline
def follow(memory: Record, time: float, arm: int) -> None:
    """Desired pose and twist of one hand on the plan now, into the memory; at rest at the last knot after it."""
    knot = memory.plan_knots - 1
    if time >= memory.plan_time[knot]:
        memory.desired_hand_pose[arm, :] = memory.plan_pose[arm, knot]
        memory.desired_hand_twist[arm, :] = 0.0
        return
    while knot > 1 and time < memory.plan_time[knot - 1]:
        knot -= 1
    duration = memory.plan_time[knot] - memory.plan_time[knot - 1]
    s, rate = time_scaling((time - memory.plan_time[knot - 1]) / duration)
    for axis in range(3):
        start = memory.plan_pose[arm, knot - 1, axis]
        way = memory.plan_pose[arm, knot, axis] - start
        memory.desired_hand_pose[arm, axis] = start + s * way
        memory.desired_hand_twist[arm, axis] = rate / duration * way
