"""Twists of the hands where they go somewhere, and where they close: world axes."""

from __future__ import annotations

import math

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.control.phases import Phase
from sim.control.trajectory import time_scaling
from sim.method.co_moving_couple.geometry import frame_angle, from_target, hand_before_corner, touching_tip
from sim.method.co_moving_couple.laws import close_in, go_to
from sim.method.co_moving_couple.memory import Activity, CoupleHandle
from sim.method.co_moving_couple.planner import time_to_contact
from sim.method.co_moving_couple.reference import (
    DRAWING_BACK,
    ENTRY_GAP,
    LIFTED,
    LIFTING,
    OUTWARD,
    between,
    closing_radius,
    drawn_back,
    enter,
    entry_time,
    stand_off_pose,
    touch_pose,
)
from sim.record import Record


@compiled
def travel(
    handle: CoupleHandle, memory: Record, parameters: Record, state: Record, hand_pose: FloatArray, velocity: FloatArray
) -> None:
    """Where nothing is touched: approach, entry, retreat, regrasp, backing out; twists of shape (2, 3)."""
    own, period = handle.own[0], parameters.control.period
    gain, since = parameters.co_moving_couple.closing.gain, state.time - own.since
    pose, ahead, twist = np.empty(3), np.empty(3), np.empty(3)
    for arm in range(2):
        _goal(handle, memory, parameters, state, since, 0.0, arm, pose)
        _goal(handle, memory, parameters, state, since, period, arm, ahead)
        for axis in range(3):
            twist[axis] = (ahead[axis] - pose[axis]) / period
        go_to(memory, gain, hand_pose, arm, pose, twist, velocity)


@compiled
def _goal(
    handle: CoupleHandle, memory: Record, parameters: Record, state: Record, since: float, ahead: float, arm: int,
    pose: FloatArray,
) -> None:  # fmt: skip
    """Where a hand should be, shape (3,), so long after its activity began and so far ahead of now [s]."""
    own, activity = handle.own[0], memory.activity
    start, target = own.start_pose[arm], state.target_pose + ahead * state.target_twist
    target[2] = frame_angle(handle.fixed[0].shape, target)
    goal = np.empty(3)
    if activity in (Activity.APPROACHING, Activity.ENTERING):
        _to_the_side(handle, activity, parameters, state, since + ahead, ahead, arm, pose)
    elif activity == Activity.RETREATING:
        between_touches = memory.phase == Phase.DETUMBLING
        duration = parameters.co_moving_couple.closing.retreat_time if between_touches else LIFTING
        s, _ = time_scaling(min(1.0, (since + ahead) / duration))
        drawn_back(
            start, handle.fixed[0].robot, touching_tip(own.sense), s * (OUTWARD if between_touches else LIFTED), goal
        )
        from_target(target, goal, pose)
    elif activity == Activity.REGRASPING:
        hand_before_corner(arm, own.close.corner, handle.fixed[0].touch_radius + own.close.gap, 0.0, 0.0, goal)
        between(start, goal, (since + ahead) / own.close.regrasp, goal)
        from_target(target, goal, pose)
    else:
        _back_out(parameters, state, since + ahead, start, pose)


@compiled
def _to_the_side(
    handle: CoupleHandle, activity: int, parameters: Record, state: Record, since: float, ahead: float, arm: int,
    pose: FloatArray,
) -> None:  # fmt: skip
    """A hand on its way to the stand-off or in from there, shape (3,), aimed anew at what is believed now."""
    own = handle.own[0]
    left = time_to_contact(own.best, state)
    if activity == Activity.APPROACHING:
        left -= entry_time(state.target_twist[2])
    x = state.target_pose[0] + left * state.target_twist[0]
    y = state.target_pose[1] + left * state.target_twist[1]
    whole, goal = max(1e-3, since + max(0.0, left - ahead)), np.empty(3)
    if activity == Activity.APPROACHING:
        stand_off_pose(handle, own.best, parameters, own.sense, arm, x, y, goal)
        between(own.start_pose[arm], goal, since / whole, pose)
    else:
        touch_pose(handle, own.best, own.sense, arm, own.best.contact_angle, ENTRY_GAP, x, y, goal)
        tip = touching_tip(own.sense)
        enter(
            handle.fixed[0].robot, tip, own.start_pose[arm], goal, state.target_twist, x, y, whole, since / whole, pose
        )


@compiled
def _back_out(parameters: Record, state: Record, since: float, start: FloatArray, pose: FloatArray) -> None:
    """A hand that backs out, away from the target's centre and without turning, shape (3,)."""
    s, _ = time_scaling(min(1.0, since / DRAWING_BACK))
    x, y = start[0] - state.target_pose[0], start[1] - state.target_pose[1]
    far = math.hypot(x, y)
    step = s * max(0.0, parameters.co_moving_couple.closing.release_distance - far) / far
    pose[0], pose[1], pose[2] = start[0] + step * x, start[1] + step * y, start[2]


@compiled
def close(
    handle: CoupleHandle, memory: Record, parameters: Record, state: Record, hand_pose: FloatArray, velocity: FloatArray
) -> None:
    """Close, squeeze and settle; the last leaves less and less to the joints."""
    own, closing, activity = handle.own[0], parameters.co_moving_couple.closing, memory.activity
    since, period = state.time - own.since, parameters.control.period
    if activity == Activity.CLOSING:
        radius = closing_radius(handle, closing, own.close.gap, since)
        rate = (closing_radius(handle, closing, own.close.gap, since + period) - radius) / period
        force = closing.contact_force
    else:
        radius, rate, force = 0.0, 0.0, closing.squeeze_force
        if activity == Activity.SQUEEZING:
            force = max(force, own.close.force)  # that brakes a round target
    memory.wanted_force[:] = force
    if activity == Activity.SETTLING:
        memory.joint_rate_share = 1.0 - time_scaling(min(1.0, since / closing.settling_time))[0]
    close_in(handle, memory, parameters, state, hand_pose, force, radius, rate, velocity)
