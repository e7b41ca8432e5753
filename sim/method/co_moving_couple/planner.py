"""The planner: rolls the free-flying robot out along a candidate, from where it is to the closed cage.

The base is free, so where a hand's path leads the arms, and how far it turns the base, shows only by integrating the
generalized Jacobian with momentum along it. Each candidate is one lean of the hands' axis, one arc, one face that
passes. A candidate that comes near a singularity, a corner or the base, or brings the hands near each other, is
dropped; the others cost time, force and base rotation.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from sim.compiled import FloatArray, compiled
from sim.config import HandMount
from sim.control.trajectory import time_scaling
from sim.method.co_moving_couple.geometry import (
    HALF_TURN,
    QUARTER_TURN,
    frame_angle,
    from_target,
    half_side,
    hand_before_corner,
    round_torque,
    tip_distance,
    to_target,
    touching_tip,
)
from sim.method.co_moving_couple.memory import NO_CORNER, CoupleHandle, Dropped, Trouble
from sim.method.co_moving_couple.parameters import Part
from sim.method.co_moving_couple.reference import (
    ENTRY_GAP,
    LIFTED,
    LIFTING,
    approach_speed,
    between,
    closing_radius,
    corner_towards,
    drawn_back,
    enter,
    entry_time,
    stand_off_pose,
    touch_pose,
)
from sim.model.generalized_jacobian import manipulability, solve_joint_rates
from sim.model.planar import cross, direction, in_frame, rotated
from sim.model.reduced_model import (
    FREE,
    base_twist,
    hand_twist_by_joint,
    joint_place,
    momentum_of,
    reduced_inertia,
    set_chain,
    set_generalized_jacobian,
    set_shape_at,
    solve_in_place,
)
from sim.model.robot import JOINTS, LINKS, RobotModel, tip_position
from sim.model.shape import signed_distance
from sim.record import Record, code_of, copy_rows, copy_vector

_RIGID = code_of(HandMount.RIGID)
_LEAN, _PREDICTION = code_of(Part.LEAN), code_of(Part.PREDICTION)

ENDS = (0.35, 0.50, 0.65, 0.80, 0.95, 1.10)
"""Where the sides' normals are in the base's frame when the touch ends, in the sense of the spin [rad]: of a square;
of other shapes its corners are where a square's would be, because that is what the hands enclose next."""
LEANS = (0.10, 0.20, 0.30, 0.40, 0.50)
"""How far the hands lean in the base's frame while they touch, in the sense of the spin [rad]."""
ARCS = (0.95, 0.70, 0.45)
MOST_PASSES = 3
"""A plan waits for one of so many sides that pass."""
COARSE = len(ENDS) * len(LEANS) * len(ARCS)
"""Candidates for one passing side."""
_STRIDE = 37
"""From one coarse candidate to the next, without a common factor: good ones are met soon, and spare others."""
REFINED = 13
"""Neighbours of the best that are rolled out afterwards."""
GAP_PARTS = (1.0, 0.55, 0.33)
"""From where hands begin a closing: parts of the usual gap."""
CLOSINGS = 2 * len(GAP_PARTS)
"""Candidates of a closing: each gap, at the nearest corner and at the next."""
ROUND_LEAN = 0.4
"""How far the line of both hands may lean in the sense of the spin to hold a round target [rad]."""
ROUND_BRAKING = 1.5
"""In which friction should brake a round target, where the caps allow it [s]: it costs nothing but time."""
STEP = 0.05
"""Of a roll-out [s]."""
_SOON = 0.1
"""A tip that touches within that time [s], or has, may be near."""
_SAFE = 1.5
"""A plan keeps so many times the floor of manipulability."""
_SETTLED = 0.04
"""From contact until its force has settled, about [s]."""
_FAR_APART = 0.1
"""Hands that are farther apart than this are far enough, and so from the base [m]."""
_UNFINISHED = 15.0
"""What a plan costs that leaves too much spin for the closing [s]: another touch."""
_LOW_MANIPULABILITY = 300.0
"""Cost of manipulability under its comfort [s/m2]."""
_LOW_CLEARANCE = 1000.0
"""Cost of clearance under twice its least [s/m]."""


class Times(NamedTuple):
    """When the parts of a plan begin, from now [s]; parts that it lacks take no time."""

    contact: float
    pressing: float
    """The hands press with the planned force."""
    leave: float
    """They leave the sides."""
    away: float
    """They have drawn back."""
    grasp: float
    """They are before the corners."""
    end: float
    drift: float
    """Not an instant: in which time a touch takes the drift along the hands' axis out [s]."""


@compiled
def candidate_touch(handle: CoupleHandle, parameters: Record, state: Record, index: int, plan: Record) -> None:
    """The candidate of that number, without its predictions; beyond the coarse ones a neighbour of the best so far."""
    own = handle.own[0]
    index = index if index >= COARSE else (_STRIDE * index) % COARSE
    plan.turn = ENDS[index % len(ENDS)] + 0.5 * handle.fixed[0].shape.symmetry_angle - 0.5 * QUARTER_TURN
    plan.lean = LEANS[(index // len(ENDS)) % len(LEANS)]
    plan.arc, plan.passing = ARCS[(index // (len(ENDS) * len(LEANS))) % len(ARCS)], own.passing
    if index >= COARSE:
        plan.turn, plan.lean, plan.arc, plan.passing = own.found.turn, own.found.lean, own.found.arc, own.found.passing
        step, way = (index - COARSE) // 2, 1.0 - 2.0 * ((index - COARSE) % 2)
        if step == REFINED // 2:
            plan.passing += 1
        elif step % 3 == 0:
            plan.turn += 0.07 * way / (1 + step // 3)
        elif step % 3 == 1:
            plan.lean += 0.05 * way / (1 + step // 3)
        else:
            plan.arc *= 1.15**way
    if parameters.co_moving_couple.without == _LEAN:
        plan.lean = 0.0
    _complete(handle, parameters, state, plan)


@compiled
def _complete(handle: CoupleHandle, parameters: Record, state: Record, plan: Record) -> None:
    """What follows from turn, lean, arc and passing of a candidate: side, angles, levers, force."""
    method, shape = parameters.co_moving_couple, handle.fixed[0].shape
    touch, spin, arc = method.touch, state.target_twist[2], plan.arc
    sense = 1.0 if spin >= 0.0 else -1.0
    kinds = max(1, round(shape.sides * shape.symmetry_angle / (2.0 * math.pi)))
    plan.side = plan.passing % kinds
    half = half_side(shape, plan.side, sense)
    plan.lever_end = half - touch.edge_distance
    outward = handle.fixed[0].robot.tip_radius + touch.slip * half
    lever = mean_lever(handle, touch, plan.side, sense, arc)
    energy = state.target_inertia * max(0.0, spin * spin - touch.spin_left * touch.spin_left)
    force = energy / (4.0 * lever * arc)
    if force < touch.force_floor:
        arc = max(0.05, arc * force / touch.force_floor)
        force = touch.force_floor
    plan.force = min(force, touch.planned_cap, touch.force_cap)
    plan.unfinished = force > plan.force
    plan.spin_after = touch.spin_left
    plan.lever_start = plan.lever_end - outward * arc
    plan.end_angle = state.base_pose[2] + sense * plan.turn
    plan.contact_angle = plan.end_angle - sense * (arc + abs(spin) * time_to_press(touch, plan.force))
    plan.hand_angle = state.base_pose[2] + QUARTER_TURN + sense * plan.lean
    plan.corner, plan.gap, plan.regrasp = NO_CORNER, method.closing.near_gap, method.closing.regrasp_time
    least = method.search.least_approach_time + entry_time(spin)
    plan.normal_offset = _next_face(shape, plan, state, sense, least, plan.passing // kinds)


@compiled
def mean_lever(handle: CoupleHandle, touch: Record, side: int, sense: float, arc: float) -> float:
    """With which the force of one hand brakes along an arc [m]: the tip's, less what it rolls out, and friction's."""
    half = half_side(handle.fixed[0].shape, side, sense)
    outward = handle.fixed[0].robot.tip_radius + touch.slip * half
    return float(half - touch.edge_distance - 0.5 * outward * arc + friction_lever(handle, touch, side))


@compiled
def friction_lever(handle: CoupleHandle, touch: Record, side: int) -> float:
    """What friction that brakes adds to the lever of the normal force [m], as it is assumed."""
    robot = handle.fixed[0].robot
    return float(touch.assumed_friction * (tip_distance(handle.fixed[0].shape, side, robot) - robot.tip_radius))


@compiled
def candidate_closing(handle: CoupleHandle, parameters: Record, state: Record, index: int, plan: Record) -> None:
    """The candidate of a closing of that number: which corner, and from how far the hands come in."""
    own, closing, shape = handle.own[0], parameters.co_moving_couple.closing, handle.fixed[0].shape
    after_touch = own.touches > 0 and own.trouble == Trouble.NONE
    widest = closing.near_gap if after_touch else closing.far_gap
    plan.gap = widest * GAP_PARTS[index % len(GAP_PARTS)]
    plan.regrasp = closing.regrasp_time if after_touch else parameters.co_moving_couple.search.least_approach_time
    plan.corner = corner_towards(shape, frame_angle(shape, state.target_pose), state.base_pose[2])
    if shape.sides == 0:
        plan.force = _round_force(handle, parameters, state)
        plan.spin_after = min(abs(state.target_twist[2]), parameters.co_moving_couple.touch.spin_left)
        plan.corner += ROUND_LEAN * math.copysign(index // len(GAP_PARTS), state.target_twist[2])
    elif index >= len(GAP_PARTS):
        away = plan.corner + state.target_pose[2] - state.base_pose[2]
        plan.corner -= math.copysign(shape.symmetry_angle, away)


@compiled
def _round_force(handle: CoupleHandle, parameters: Record, state: Record) -> float:
    """With which hands press on a round target so that friction brakes it in `ROUND_BRAKING`, within the caps [N]."""
    touch, fixed = parameters.co_moving_couple.touch, handle.fixed[0]
    per_newton = round_torque(fixed.robot, fixed.shape, 1.0, touch.assumed_friction)
    torque = state.target_inertia * max(0.0, abs(state.target_twist[2]) - touch.spin_left) / ROUND_BRAKING
    most = min(touch.planned_cap, touch.force_cap)
    return float(min(most, max(parameters.co_moving_couple.closing.squeeze_force, torque / per_newton)))


@compiled
def _round_braking(handle: CoupleHandle, parameters: Record, state: Record, plan: Record) -> float:
    """How long friction takes to brake a round target with the plan's force [s]; no time for any other."""
    fixed, friction = handle.fixed[0], parameters.co_moving_couple.touch.assumed_friction
    if fixed.shape.sides > 0 or plan.force == 0.0:
        return 0.0
    lost = state.target_inertia * (abs(state.target_twist[2]) - plan.spin_after)
    return float(lost / round_torque(fixed.robot, fixed.shape, plan.force, friction))


@compiled
def _next_face(shape: Record, plan: Record, state: Record, sense: float, least: float, passing: int) -> float:
    """What to add to the target's angle for the normal angle of the side that comes to the contact angle in time.

    Args:
        shape: of the target.
        plan: one element of `CANDIDATE`, with side and contact angle.
        state: one element of `PERCEIVED`.
        sense: of the spin.
        least: time until then [s].
        passing: 0 for the first side of its kind in time, 1 for the next.

    """
    pitch, normal = shape.symmetry_angle, math.atan2(shape.normals[plan.side, 1], shape.normals[plan.side, 0])
    to_go = sense * (plan.contact_angle - state.target_pose[2] - normal)
    speed = max(1e-3, abs(state.target_twist[2]))
    sides = math.ceil((least * speed - to_go) / pitch) + passing
    return float(normal - sense * sides * pitch)


@compiled
def time_to_press(touch: Record, force: float) -> float:
    """From the end of the entry until a hand presses with its force [s]: the guarded approach, and its settling."""
    return float(ENTRY_GAP / approach_speed(touch, force) + _SETTLED)


@compiled
def time_to_contact(plan: Record, state: Record) -> float:
    """Until the plan's side has come to its contact angle [s]; negative after it."""
    spin = state.target_twist[2]
    sense = 1.0 if spin >= 0.0 else -1.0
    normal = state.target_pose[2] + plan.normal_offset
    return float(sense * (plan.contact_angle - normal) / max(1e-3, abs(spin)))


@compiled
def touch_times(plan: Record, method: Record, state: Record) -> Times:
    """When the parts of a touch and of the closing after it begin and end, from now."""
    spin = abs(state.target_twist[2])
    contact = time_to_contact(plan, state)
    pressing = contact + time_to_press(method.touch, plan.force)
    arc = abs(plan.end_angle - plan.contact_angle) - spin * (pressing - contact)
    leave = pressing + 2.0 * arc / max(0.1, spin + plan.spin_after)
    return _times(contact, pressing, leave, method, plan.regrasp)


@compiled
def _times(contact: float, pressing: float, leave: float, method: Record, regrasp: float) -> Times:
    away = leave + LIFTING
    grasp = away + regrasp
    return Times(contact, pressing, leave, away, grasp, _locked(grasp, method.closing), method.touch.drift_time)


@compiled
def closing_times(handle: CoupleHandle, parameters: Record, state: Record, plan: Record) -> Times:
    """The same of a closing that begins now; the squeeze brakes a target that is round."""
    method = parameters.co_moving_couple
    times = _times(0.0, 0.0, 0.0, method, plan.regrasp)
    braking = _round_braking(handle, parameters, state, plan)
    return Times(0.0, 0.0, 0.0, times.away, times.grasp, times.end + braking, times.drift)


@compiled
def _locked(grasp: float, closing: Record) -> float:
    """When the joints have nearly come to rest [s], of hands that are before the corners then [s]."""
    closed = grasp + closing.fast_time + closing.slow_gap / closing.slow_speed
    return float(closed + closing.squeeze_time + 0.5 * closing.settling_time)


@compiled
def roll_out_touch(
    handle: CoupleHandle, parameters: Record, state: Record, hand_pose: FloatArray, plan: Record, worth: float
) -> None:
    """Roll a touch and the closing after it out from now; its predictions, and why it is dropped, are filled in.

    Args:
        handle: of the method; `path` is filled with both hands' poses and with (base rotation [rad], manipulability
            of left and right [m2]), one row a `STEP`.
        parameters: record of `MissionConfig`.
        state: one element of `PERCEIVED`.
        hand_pose: of both hands now, shape (2, 3).
        plan: one element of `CANDIDATE`; changed.
        worth: a candidate of that cost or more is of no use [s].

    """
    _roll_out(handle, parameters, state, hand_pose, plan, touch_times(plan, parameters.co_moving_couple, state), worth)


@compiled
def roll_out_closing(
    handle: CoupleHandle, parameters: Record, state: Record, hand_pose: FloatArray, plan: Record, worth: float
) -> None:
    """Roll a closing out from now, with its `corner`, `gap` and `regrasp`; otherwise as `roll_out_touch`."""
    plan.unfinished = 0
    if handle.fixed[0].shape.sides > 0:
        plan.spin_after, plan.force = abs(state.target_twist[2]), 0.0
    _roll_out(handle, parameters, state, hand_pose, plan, closing_times(handle, parameters, state, plan), worth)


@compiled
def _roll_out(
    handle: CoupleHandle, parameters: Record, state: Record, hand_pose: FloatArray, plan: Record, times: Times,
    worth: float,
) -> None:  # fmt: skip
    """Follow the reference from now to its end, the base moving as momentum says; note what comes of it.

    The target is taken to be as heavy to turn as it may well be: the robot then turns further, and arms stretch.
    """
    method, now = parameters.co_moving_couple, handle.work[0]
    plan.base_rotation, plan.dropped_for = 0.0, Dropped.NONE
    plan.manipulability, plan.clearance, plan.apart = math.inf, math.inf, _FAR_APART
    plan.time, plan.steps = times.end, 0
    if times.end > STEP * handle.work[0].path.shape[0]:
        plan.dropped_for = Dropped.HORIZON
        return
    _begin_roll_out(handle, state, hand_pose, now)
    floor = (_SAFE if times.contact > 0.0 else 1.0) * method.search.manipulability_floor
    most_rotation = method.search.most_base_rotation
    if method.without == _PREDICTION:
        floor, most_rotation = 0.0, math.inf
    for step in range(math.ceil(times.end / STEP)):
        if cost(plan, method) >= worth:
            plan.dropped_for = Dropped.COSTLIER
            return
        time, plan.steps = (step + 1) * STEP, step + 1
        spin = target_at(plan, state, times, time, now.target)
        spin = _round_spin(handle, parameters, state, plan, times, time, spin)
        if time > times.away and plan.corner == NO_CORNER:
            plan.corner = corner_towards(handle.fixed[0].shape, now.target[2], state.base_pose[2])
        if time - STEP < times.pressing <= time < times.leave:
            _set_mount_rates(handle, plan, parameters, state)
        elif time > times.leave:
            now.mount_rate[:] = 0.0
        for arm in range(2):
            goal_at(handle, plan, parameters, state, times, time, hand_pose[arm], arm)
            copy_vector(handle.work[0].path[step, arm], now.goal[arm])
        _step(now, (state.target_inertia + state.target_inertia_deviation) * (state.target_twist[2] - spin))
        set_shape_at(handle.fixed[0].robot, now.joint_angle, now.mount_angle, now.shape)
        set_chain(now.base, now.shape, now.links)
        _note(handle, plan, state, times, time, handle.work[0].path[step, 2])
        if not plan.manipulability >= floor:
            plan.dropped_for, plan.time = Dropped.MANIPULABILITY, time
            return
        if not plan.base_rotation <= most_rotation:
            plan.dropped_for, plan.time = Dropped.BASE, time
            return
        if plan.apart < method.search.least_apart:
            plan.dropped_for, plan.time = Dropped.HANDS, time
            return
    if plan.clearance < method.search.least_clearance:
        plan.dropped_for = Dropped.CLEARANCE
    plan.cost = cost(plan, method)


@compiled
def _begin_roll_out(handle: CoupleHandle, state: Record, hand_pose: FloatArray, now: Record) -> None:
    """Robot, target and hands as they are, with the momentum that the robot has."""
    copy_vector(now.base, state.base_pose)
    copy_rows(now.joint_angle, state.joint_angle)
    copy_vector(now.mount_angle, state.mount_angle)
    now.mount_rate[:] = 0.0
    copy_vector(now.target, state.target_pose)
    now.target[2] = frame_angle(handle.fixed[0].shape, state.target_pose)
    robot = handle.fixed[0].robot
    set_shape_at(robot, now.joint_angle, now.mount_angle, now.shape)
    set_chain(now.base, now.shape, now.links)
    momentum_of(now.shape, state, now.momentum)
    now.momentum[2] += cross(now.base[0], now.base[1], now.momentum[0], now.momentum[1])
    for arm in range(2):
        to_target(now.target, hand_pose[arm], now.start[arm])


@compiled
def target_at(plan: Record, state: Record, times: Times, time: float, pose: FloatArray) -> float:
    """The target's pose so long from now [s], shape (3,), and its spin: braked evenly while it is pressed on."""
    spin = state.target_twist[2]
    _drift(plan, state, times, time, pose)
    last, whole = math.copysign(plan.spin_after, spin), times.leave - times.pressing
    free, braked, rest = min(time, times.pressing), min(max(0.0, time - times.pressing), whole), time - times.leave
    rate = (last - spin) / whole if whole > 0.0 else 0.0
    pose[2] = state.target_pose[2] + spin * free + (spin + 0.5 * rate * braked) * braked + last * max(0.0, rest)
    return float(spin + rate * braked)


@compiled
def _round_spin(
    handle: CoupleHandle, parameters: Record, state: Record, plan: Record, times: Times, time: float, otherwise: float
) -> float:
    """The spin of a round target so long from now [s], braked evenly at the end of a closing; of others as given.

    The round one of the roll-out has no angle that hands go by.
    """
    if handle.fixed[0].shape.sides > 0:
        return otherwise
    handle.work[0].target[2] = 0.0
    spin, braking = state.target_twist[2], _round_braking(handle, parameters, state, plan)
    part = 1.0 if braking == 0.0 else min(1.0, max(0.0, 1.0 - (times.end - time) / braking))
    return float(spin + part * (math.copysign(plan.spin_after, spin) - spin))


@compiled
def _drift(plan: Record, state: Record, times: Times, time: float, pose: FloatArray) -> None:
    """The centre of the target so long from now [s], shape (3,): a touch takes out its drift along the hands' axis."""
    vx, vy = state.target_twist[0], state.target_twist[1]
    pose[0], pose[1] = state.target_pose[0] + time * vx, state.target_pose[1] + time * vy
    touched = time - times.pressing
    if touched <= 0.0 or times.leave <= 0.0:
        return
    normal = 0.5 * (plan.contact_angle + plan.end_angle)
    nx, ny = math.cos(normal), math.sin(normal)
    gone = touched - times.drift * (1.0 - math.exp(-touched / times.drift))
    pose[0] -= gone * (vx * nx + vy * ny) * nx
    pose[1] -= gone * (vx * nx + vy * ny) * ny


@compiled
def goal_at(
    handle: CoupleHandle, plan: Record, parameters: Record, state: Record, times: Times, time: float,
    hand_pose: FloatArray, arm: int,
) -> None:  # fmt: skip
    """Set where a hand should be so long from now [s] in the handle's `ROLL_OUT`, whose target is where it is then.

    Args:
        handle: of the method; the start as seen from the target is where the hand leaves the side.
        plan: one element of `CANDIDATE`.
        parameters: record of `MissionConfig`.
        state: one element of `PERCEIVED`.
        times: of the plan.
        time: from now [s].
        hand_pose: of the hand now, shape (3,).
        arm: 0 left, 1 right.

    """
    now = handle.work[0]
    target, start, pose, between_them = now.target, now.start[arm], now.goal[arm], now.pose[0]
    sense = 1.0 if state.target_twist[2] >= 0.0 else -1.0
    closing, normal = parameters.co_moving_couple.closing, target[2] + plan.normal_offset
    if time <= times.contact:
        _before_contact(handle, plan, parameters, state, sense, arm, times.contact, time, hand_pose, pose)
    elif time <= times.leave:
        touch_pose(handle, plan, sense, arm, normal, 0.0, target[0], target[1], pose)
        to_target(target, pose, start)
    elif time <= times.away:
        part, _ = time_scaling((time - times.leave) / (times.away - times.leave))
        drawn_back(start, handle.fixed[0].robot, touching_tip(sense), part * LIFTED, between_them)
        from_target(target, between_them, pose)
    else:
        radius = closing_radius(handle, closing, plan.gap, max(0.0, time - times.grasp))
        radius = max(radius, handle.fixed[0].touch_radius)
        hand_before_corner(arm, plan.corner, radius, 0.0, 0.0, between_them)
        if time <= times.grasp:
            between(start, between_them, (time - times.away) / (times.grasp - times.away), between_them)
        from_target(target, between_them, pose)


@compiled
def _before_contact(
    handle: CoupleHandle, plan: Record, parameters: Record, state: Record, sense: float, arm: int, contact: float,
    time: float, hand_pose: FloatArray, pose: FloatArray,
) -> None:  # fmt: skip
    """Where a hand should be so long from now [s], on its way to the stand-off or in from there, shape (3,)."""
    spin, waiting, met = state.target_twist[2], handle.work[0].pose[0], handle.work[0].pose[1]
    entry = entry_time(spin)
    x, y = state.target_pose[0] + time * state.target_twist[0], state.target_pose[1] + time * state.target_twist[1]
    stand_off_pose(handle, plan, parameters, sense, arm, x, y, waiting)
    if time <= contact - entry:
        between(hand_pose, waiting, time / (contact - entry), pose)
        return
    touch_pose(handle, plan, sense, arm, plan.contact_angle, ENTRY_GAP, x, y, met)
    part = 1.0 - (contact - time) / entry
    enter(handle.fixed[0].robot, touching_tip(sense), waiting, met, state.target_twist, x, y, entry, part, pose)


@compiled
def _set_mount_rates(handle: CoupleHandle, plan: Record, parameters: Record, state: Record) -> None:
    """How the hands give way on their mounts while they press, time_constant H*^-1 J*^T F: no joint makes up for it.

    Over a touch it comes to some degrees, which the wrists turn back, and the base with them.
    """
    now, sense = handle.work[0], 1.0 if state.target_twist[2] >= 0.0 else -1.0
    if parameters.robot.servo.hand_mount == _RIGID:
        return
    shape, torque = now.shape, now.torque
    torque[:] = 0.0
    for arm in range(2):
        normal = now.target[2] + plan.normal_offset - (HALF_TURN if arm == 0 else 0.0) - now.base[2]
        fx, fy = plan.force * math.cos(normal), plan.force * math.sin(normal)
        tip_x, tip_y = tip_position(handle.fixed[0].robot, now.links.hand_pose[arm], touching_tip(sense))
        x, y = rotated(-now.base[2], tip_x - now.links.hand_pose[arm, 0], tip_y - now.links.hand_pose[arm, 1])
        about_hand = x * fy - y * fx
        for side in range(2):
            for link in range(LINKS):
                vx, vy, turn = hand_twist_by_joint(shape, arm, side, link)
                torque[joint_place(side, link)] += fx * vx + fy * vy + about_hand * turn
    reduced_inertia(shape.total_mass, shape, now.inertia)
    solve_in_place(now.inertia, torque, FREE)
    for arm in range(2):
        now.mount_rate[arm] = parameters.robot.servo.time_constant * torque[joint_place(arm, JOINTS)]


@compiled
def _step(now: Record, taken: float) -> None:
    """Move base and joints, so that the hands come to their goals within one step (eq. 2), one element of `ROLL_OUT`.

    `taken` is the angular momentum that the target has lost to the robot [N m s].
    """
    base, shape, problem, about_base = now.base, now.shape, now.problem, now.about_base
    copy_vector(about_base, now.momentum)
    about_base[2] += taken - cross(base[0], base[1], about_base[0], about_base[1])
    c, s = direction(base[2])
    px, py = c * about_base[0] + s * about_base[1], c * about_base[1] - s * about_base[0]
    turn = (about_base[2] - cross(shape.centre[0], shape.centre[1], px, py)) * shape.inverse_inertia
    px, py = px / shape.total_mass, py / shape.total_mass
    for arm in range(2):
        row, goal, hand = 3 * arm, now.goal[arm], now.links.hand_pose[arm]
        x, y = (goal[0] - hand[0]) / STEP, (goal[1] - hand[1]) / STEP
        from_x, from_y = shape.hand[arm, 0] - shape.centre[0], shape.hand[arm, 1] - shape.centre[1]
        problem.hand_velocity[row] = c * x + s * y - (px - turn * from_y)
        problem.hand_velocity[row + 1] = c * y - s * x - (py + turn * from_x)
        problem.hand_velocity[row + 2] = (goal[2] - hand[2]) / STEP - turn
        for side in range(2):
            by_mount = hand_twist_by_joint(shape, arm, side, JOINTS)
            for axis in range(3):
                problem.hand_velocity[row + axis] -= by_mount[axis] * now.mount_rate[side]
        set_generalized_jacobian(shape, arm, problem.jacobian, row)
    solve_joint_rates(problem, 6, 0.0)
    for arm in range(2):
        for link in range(JOINTS):
            now.joint_rate[arm, link] = problem.rates[JOINTS * arm + link]
            now.joint_angle[arm, link] += STEP * now.joint_rate[arm, link]
        now.mount_angle[arm] += STEP * now.mount_rate[arm]
    base_twist(shape, base[2], about_base, now.joint_rate, now.mount_rate, now.twist)
    for axis in range(3):
        base[axis] += STEP * now.twist[axis]


@compiled
def _note(handle: CoupleHandle, plan: Record, state: Record, times: Times, time: float, row: FloatArray) -> None:
    """Note base rotation, manipulability and clearance of a step, in the plan's predictions and a row of the path."""
    now = handle.work[0]
    row[0] = now.base[2] - state.base_pose[2]
    plan.base_rotation = max(plan.base_rotation, abs(row[0])) if math.isfinite(row[0]) else math.inf
    for arm in range(2):
        row[1 + arm] = manipulability(now.links, arm)
        plan.manipulability = min(plan.manipulability, row[1 + arm])
    note_gaps(handle, plan)
    if time > times.grasp:
        return
    sense = 1.0 if state.target_twist[2] >= 0.0 else -1.0
    touching = times.contact - _SOON < time
    for arm in range(2):
        for tip in range(2):
            if touching and tip == touching_tip(sense):
                continue
            tip_x, tip_y = tip_position(handle.fixed[0].robot, now.links.hand_pose[arm], tip)
            x, y = in_frame(now.target, tip_x, tip_y)
            clear = signed_distance(handle.fixed[0].shape, x, y) - handle.fixed[0].robot.tip_radius
            plan.clearance = min(plan.clearance, clear)


@compiled
def note_gaps(handle: CoupleHandle, plan: Record) -> None:
    """Note the least gap between the hands, and from either to the base, of tips and palms' ends, all as thick as tips.

    What cannot be nearer than was noted already is not looked at.
    """
    now, robot, base = handle.work[0], handle.fixed[0].robot, handle.fixed[0].base
    corners, thick = now.corners, robot.tip_radius
    reach = robot.link_length[JOINTS] + robot.tip_offset + thick
    for arm in range(2):
        _place_corners(robot, now.links.hand_pose[arm], corners[arm])
    nearest = math.inf
    for place in range(4):
        for opposite in range(4):
            x, y = corners[1, opposite, 0] - corners[0, place, 0], corners[1, opposite, 1] - corners[0, place, 1]
            nearest = min(nearest, x * x + y * y)
    plan.apart = min(plan.apart, math.sqrt(nearest) - 2.0 * thick)
    c, s = direction(now.base[2])
    for arm in range(2):
        x, y = now.links.hand_pose[arm, 0] - now.base[0], now.links.hand_pose[arm, 1] - now.base[1]
        if signed_distance(base, c * x + s * y, c * y - s * x) - reach < plan.apart:
            for place in range(4):
                x, y = corners[arm, place, 0] - now.base[0], corners[arm, place, 1] - now.base[1]
                plan.apart = min(plan.apart, signed_distance(base, c * x + s * y, c * y - s * x) - thick)


@compiled
def _place_corners(robot: RobotModel, pose: FloatArray, corners: FloatArray) -> None:
    """Of a hand's U: the centres of its tips, and the palm's ends behind them [m], world, shape (4, 2)."""
    c, s = direction(pose[2])
    half, depth = robot.tip_offset, robot.link_length[JOINTS]
    for place in range(4):
        x, y = half if place % 2 == 1 else -half, 0.0 if place < 2 else -depth
        corners[place, 0], corners[place, 1] = pose[0] + c * x - s * y, pose[1] + s * x + c * y


@compiled
def cost(plan: Record, method: Record) -> float:
    """What a candidate costs by its predictions [s]; by those of a part of its way, no more than it will cost."""
    search = method.search
    total = plan.time + search.force_price * plan.force
    if method.without == _PREDICTION:
        return float(total)
    total += search.turn_price * plan.base_rotation
    total += _LOW_MANIPULABILITY * max(0.0, search.manipulability_comfort - plan.manipulability)
    total += _LOW_CLEARANCE * max(0.0, 2.0 * search.least_clearance - plan.clearance)
    return float(total + (_UNFINISHED if plan.unfinished else 0.0))
