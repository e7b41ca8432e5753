"""The plans of the published method: a touch (eq. 4, 5), the closing, the opening.

Plans are made from the target's pose and twist as they are at that instant, which is assumed to drift and spin on
freely.
"""

from __future__ import annotations

import math

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.control.trajectory import BOTH_ARMS, LEFT, RIGHT, add_knot, predict_target, start_plan
from sim.method.published.memory import PlanKind
from sim.model.planar import folded, rotated, sign
from sim.record import Record

_QUARTER = math.pi / 4
_HALF = math.pi / 2


@compiled
def time_to_angle(angle_to_go: float, spin: float, at_least: float) -> float:
    """Time [s] until a square spinning at `spin` [rad/s] has turned by an angle, modulo its quarter turn.

    Not less than `at_least` [s]: quarter turns are added until it is.
    """
    time: float = np.fmod(angle_to_go, _HALF) / spin
    quarter_turn = _HALF / abs(spin)
    if time < at_least:
        time += quarter_turn * math.ceil((at_least - time) / quarter_turn)
    return time


@compiled
def plan_touch(memory: Record, parameters: Record, state: Record, hand_pose: FloatArray) -> None:
    """Plan one touch: the arm that the target drifts to waits outside the corner circle, then meets the face.

    Eq. 4 and 5 with the published wait point: T1 to just outside the circle that the corners sweep, as a
    corner has passed; T2, a part of the time the face still needs, to the contact pose, where the hand rests.
    """
    touch, hand = parameters.published.touch, parameters.robot.arm.hand
    pose, twist = state.target_pose, state.target_twist
    spin = twist[2]
    a, b = sign(twist[0]), sign(spin)
    c = -a * b
    half_side, radius = 0.5 * parameters.target.side, hand.tip_radius
    corner_circle = half_side * math.sqrt(2.0) + radius
    tilt = touch.target_tilt
    tip_x, tip_y = rotated(b * tilt, half_side * a + radius * a, half_side * c * touch.contact_position)
    hand_tilt = -b * (tilt + touch.hand_tilt)
    from_tip_x, from_tip_y = rotated(hand_tilt, 0.0, -hand.tip_offset * c)
    eta = a * math.asin(tip_y / corner_circle)
    if spin == 0.0:
        wait, meet = touch.minimum_approach_time, touch.minimum_approach_time
    else:
        wait = time_to_angle(_QUARTER + eta - pose[2], spin, touch.minimum_approach_time)
        meet = touch.contact_time_factor * (tilt + _QUARTER - eta) / abs(spin)
    arm = RIGHT if a > 0.0 else LEFT
    angle = a * _HALF + hand_tilt
    wait_x = touch.wait_margin * a * corner_circle * math.cos(eta) + from_tip_x
    start_plan(memory, PlanKind.TOUCH, arm, state.time, hand_pose)
    add_knot(
        memory, arm, wait, pose[0] + twist[0] * wait + wait_x, pose[1] + twist[1] * wait + tip_y + from_tip_y, angle
    )
    memory.plan_knots = 2
    both = wait + meet
    add_knot(
        memory, arm, meet,
        pose[0] + twist[0] * both + tip_x + from_tip_x, pose[1] + twist[1] * both + tip_y + from_tip_y, angle,
    )  # fmt: skip
    memory.plan_knots = 3
    predict_target(memory, pose, twist, both)


@compiled
def plan_cage(memory: Record, parameters: Record, state: Record, hand_pose: FloatArray, capture_time: float) -> None:
    """Plan the enclosure by both hands: to just clear of the corner circle, then in to just clear of the faces.

    A slow target is met at once, the hands turned to it; for a faster one they wait until a corner points
    into each hand. The target's motion during the capture time is ignored, as published.
    """
    caging, hand = parameters.published.caging, parameters.robot.arm.hand
    pose, twist = state.target_pose, state.target_twist
    spin, side, radius = twist[2], parameters.target.side, hand.tip_radius
    corner_circle = side / math.sqrt(2.0) + radius
    if abs(spin) <= caging.slow_spin:
        duration = caging.minimum_approach_time
        turn = folded(pose[2] + spin * duration - _QUARTER, _HALF)
    else:
        turn = 0.0
        lead = math.asin(hand.tip_offset / corner_circle)
        duration = time_to_angle(_QUARTER - sign(spin) * lead - pose[2], spin, caging.minimum_approach_time)
    close = caging.close_margin * math.sqrt(corner_circle**2 - hand.tip_offset**2)
    capture = caging.capture_margin * (side + 2.0 * radius) / math.sqrt(2.0) - hand.tip_offset
    centre_x, centre_y = pose[0] + twist[0] * duration, pose[1] + twist[1] * duration
    start_plan(memory, PlanKind.CAGE, BOTH_ARMS, state.time, hand_pose)
    _add_pair(memory, duration, centre_x, centre_y, close, turn)
    _add_pair(memory, capture_time, centre_x, centre_y, capture, turn)
    predict_target(memory, pose, twist, duration)


@compiled
def _add_pair(memory: Record, duration: float, x: float, y: float, distance: float, turn: float) -> None:
    """A knot of both hands, facing each other across (x, y) at a distance [m], their line turned by an angle."""
    along_x, along_y = rotated(turn, distance, 0.0)
    add_knot(memory, LEFT, duration, x - along_x, y - along_y, turn - _HALF)
    add_knot(memory, RIGHT, duration, x + along_x, y + along_y, turn + _HALF)
    memory.plan_knots += 1
