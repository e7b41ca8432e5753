"""Where the hands should be and when: touch plan (eq. 4, 5), caging plan, straight paths, cubic time scaling.

Plans are made from the target's pose and twist as they are at that instant, which is assumed to drift and
spin on freely. They are written into the controller's memory as up to three knots per hand.
"""

from __future__ import annotations

import math

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.control.memory import PlanKind
from sim.model.planar import folded, rotated, sign
from sim.record import Record

_QUARTER = math.pi / 4
_HALF = math.pi / 2
BOTH_ARMS = -1
LEFT, RIGHT = 0, 1


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
def start_plan(memory: Record, kind: int, arm: int, time: float, hand_pose: FloatArray) -> None:
    """Begin a plan of that kind at the hands' present poses, shape (2, 3); knots are added next."""
    memory.plan_kind = kind
    memory.plan_count += 1
    memory.plan_arm = arm
    memory.plan_knots = 1
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
def plan_touch(memory: Record, parameters: Record, state: Record, hand_pose: FloatArray) -> None:
    """Plan one touch: the arm that the target drifts to waits outside the corner circle, then meets the face.

    Eq. 4 and 5 with the published wait point: T1 to just outside the circle that the corners sweep, as a
    corner has passed; T2, a part of the time the face still needs, to the contact pose, where the hand rests.
    """
    touch, hand = parameters.control.touch, parameters.robot.arm.hand
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
    caging, hand = parameters.control.caging, parameters.robot.arm.hand
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


@compiled
def plan_release(memory: Record, parameters: Record, state: Record, hand_pose: FloatArray) -> None:
    """Plan the opening: each hand draws back from the target along its own axis, without turning."""
    caging, pose = parameters.control.caging, state.target_pose
    start_plan(memory, PlanKind.RELEASE, BOTH_ARMS, state.time, hand_pose)
    for arm in range(2):
        x, y, angle = hand_pose[arm, 0], hand_pose[arm, 1], hand_pose[arm, 2]
        back_x, back_y = math.sin(angle), -math.cos(angle)
        present = (x - pose[0]) * back_x + (y - pose[1]) * back_y
        step = max(0.0, caging.release_distance - present)
        add_knot(memory, arm, caging.release_time, x + step * back_x, y + step * back_y, angle)
    memory.plan_knots = 2
    predict_target(memory, pose, state.target_twist, caging.release_time)


@compiled
def time_scaling(part: float) -> tuple[float, float]:
    """S and ds/dpart of the cubic scaling s = 3 p^2 - 2 p^3, p the part of the duration, 0 to 1."""
    return part * part * (3.0 - 2.0 * part), 6.0 * part * (1.0 - part)


@compiled
def plan_end(memory: Record) -> float:
    """When the plan ends [s]; before every mission if there is none."""
    return memory.plan_time[memory.plan_knots - 1] if memory.plan_knots > 1 else -1.0e9


@compiled
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
