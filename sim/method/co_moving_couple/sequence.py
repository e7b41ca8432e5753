"""The sequence of the co-moving couple: `begin`, `react`, `plan` and `hand_twist`, as every method has them."""

from __future__ import annotations

import math

from sim.compiled import FloatArray, compiled
from sim.control.hand_motion import NO_HANDS, track
from sim.control.memory import KNOTS, NEVER
from sim.control.phases import Phase, Verdict, phase_after
from sim.control.trajectory import BOTH_ARMS, plan_opening, start_plan
from sim.method.co_moving_couple.following import begin_search, cage, detumble, fail, into, release, search, trouble_now
from sim.method.co_moving_couple.geometry import frame_angle, tip_on_face, to_target
from sim.method.co_moving_couple.laws import follow_faces, note_yielding
from sim.method.co_moving_couple.memory import Activity, CoupleHandle, Dropped, PlanKind, Trouble
from sim.method.co_moving_couple.planner import (
    STEP,
    candidate_closing,
    candidate_touch,
    closing_times,
    friction_lever,
    roll_out_closing,
    roll_out_touch,
    target_at,
    touch_times,
)
from sim.method.co_moving_couple.travel import close, travel
from sim.model.generalized_jacobian import manipulability
from sim.model.robot import Chain, RobotModel
from sim.record import Record


@compiled
def begin(handle: CoupleHandle, memory: Record) -> None:
    """Forget the last sequence; another has begun in the memory's phase."""
    own = handle.own[0]
    own.since, own.manipulability = NEVER, math.inf
    own.failures = own.touches = own.trouble = 0
    own.waiting_since = NEVER
    begin_search(own)


@compiled
def react(
    handle: CoupleHandle, memory: Record, parameters: Record, state: Record, verdict: int
) -> tuple[int, int, int]:
    """The phase and activity that follow from what has happened, and the kind of plan to make now."""
    if verdict != Verdict.NONE:
        return phase_after(verdict), Activity.NONE, PlanKind.NONE
    own, phase = handle.own[0], memory.phase
    if phase == Phase.RELEASED:
        return release(own, memory, state)
    if phase not in (Phase.DETUMBLING, Phase.CAGING):
        return phase, Activity.NONE, PlanKind.NONE
    if memory.activity == Activity.NONE:
        in_touch = state.touching[0] != 0 or state.touching[1] != 0
        return into(own, state, phase, Activity.RECOVERING if in_touch else Activity.ESTIMATING)
    return _go_on(handle, memory, parameters, state)


@compiled
def _go_on(handle: CoupleHandle, memory: Record, parameters: Record, state: Record) -> tuple[int, int, int]:
    """What follows while a sequence is under way."""
    own = handle.own[0]
    if memory.activity == Activity.ESTIMATING:
        return search(handle, memory, parameters, state)
    trouble = trouble_now(own, memory, parameters, state)
    if trouble != Trouble.NONE:
        search_limits = parameters.co_moving_couple.search
        return fail(own, search_limits, state, memory.phase, trouble, Activity.RECOVERING)
    if memory.phase == Phase.DETUMBLING:
        return detumble(own, memory, parameters, state)
    return cage(handle, memory, parameters, state)


@compiled
def plan(
    handle: CoupleHandle, memory: Record, parameters: Record, state: Record, hand_pose: FloatArray, kind: int
) -> None:
    """Make a plan of that kind from the present state; a search rolls one candidate out."""
    own = handle.own[0]
    if kind in (PlanKind.ROLL_OUT_TOUCH, PlanKind.ROLL_OUT_CLOSING):
        trial = own.trial
        if kind == PlanKind.ROLL_OUT_TOUCH:
            candidate_touch(handle, parameters, state, own.candidate, trial)
            roll_out_touch(handle, parameters, state, hand_pose, trial, own.found.cost)
        else:
            candidate_closing(handle, parameters, state, own.candidate, trial)
            roll_out_closing(handle, parameters, state, hand_pose, trial, own.found.cost)
        own.candidate += 1
        own.dropped[trial.dropped_for] += 1
        if trial.dropped_for == Dropped.NONE and trial.cost < own.found.cost:
            own.found = trial
        return
    if kind == PlanKind.RELEASE:
        closing = parameters.co_moving_couple.closing
        plan_opening(memory, state, hand_pose, kind, closing.release_distance, closing.release_time)
        return
    start_plan(memory, kind, BOTH_ARMS, state.time, hand_pose)
    chosen = own.best if kind == PlanKind.TOUCH else own.close
    if kind == PlanKind.TOUCH:
        roll_out_touch(handle, parameters, state, hand_pose, chosen, math.inf)
        own.lever = chosen.lever_start + friction_lever(handle, parameters.co_moving_couple.touch, chosen.side)
        _show_touch(handle, memory, chosen)
    else:
        roll_out_closing(handle, parameters, state, hand_pose, chosen, math.inf)
    _show(handle, memory, parameters, chosen, state)
    expected = memory.prediction
    expected.made, expected.until, expected.force = 1, state.time + chosen.time, chosen.force
    expected.base_rotation, expected.manipulability = chosen.base_rotation, chosen.manipulability
    expected.clearance = chosen.clearance


@compiled
def _show(handle: CoupleHandle, memory: Record, parameters: Record, plan: Record, state: Record) -> None:
    """The way that was rolled out, as the plan that everybody sees."""
    for knot in range(1, KNOTS):
        step = max(0, plan.steps * knot // (KNOTS - 1) - 1)
        memory.plan_time[knot] = state.time + STEP * (step + 1)
        memory.plan_pose[:, knot, :] = handle.work[0].path[step, :2]
    memory.plan_knots = KNOTS
    method = parameters.co_moving_couple
    if memory.plan_kind == PlanKind.TOUCH:
        times = touch_times(plan, method, state)
    else:
        times = closing_times(handle, parameters, state, plan)
    target_at(plan, state, times, times.end, memory.predicted_target)


@compiled
def _show_touch(handle: CoupleHandle, memory: Record, chosen: Record) -> None:
    """The sides that both hands will press on, and where, for everybody to see."""
    own, touch, shape = handle.own[0], memory.touch_plan, handle.fixed[0].shape
    opposite = (chosen.side + shape.corners // 2) % shape.corners
    for arm in range(2):
        side = chosen.side if arm == 1 else opposite
        normal = math.atan2(shape.normals[side, 1], shape.normals[side, 0])
        reach = shape.offsets[side] + shape.rounding
        touch.side[arm, 0, :] = shape.vertices[side]
        touch.side[arm, 1, :] = shape.vertices[(side + 1) % shape.corners]
        touch.point[arm, 0], touch.point[arm, 1] = tip_on_face(reach, chosen.lever_start, own.sense, normal, 0.0, 0.0)
    touch.made, touch.lever = 1, own.lever
    touch.arc_left = own.sense * (chosen.end_angle - chosen.contact_angle)


@compiled
def hand_twist(
    handle: CoupleHandle,
    memory: Record,
    parameters: Record,
    robot: RobotModel,
    state: Record,
    links: Chain,
    velocity: FloatArray,
) -> int:
    """Twists that the hands should have now, shape (2, 3), and which hands that is about."""
    own, activity = handle.own[0], memory.activity
    memory.trouble = own.trouble
    memory.expects_contact[:] = activity in (
        Activity.ENTERING,
        Activity.TOUCHING,
        Activity.RETREATING,
        Activity.CLOSING,
        Activity.SQUEEZING,
        Activity.SETTLING,
    )
    if activity in (Activity.NONE, Activity.ESTIMATING):
        return NO_HANDS
    own.manipulability = min(manipulability(links, 0), manipulability(links, 1))
    if not own.start_kept:
        own.start_kept = 1
        _keep_start(handle, memory, state, links.hand_pose)
        if activity == Activity.TOUCHING:
            note_yielding(handle, parameters, state)
    if activity == Activity.OPENING:
        track(memory, parameters, state, links, velocity)
    elif activity == Activity.TOUCHING:
        follow_faces(handle, memory, parameters, state, links.hand_pose, velocity)
    elif activity in (Activity.CLOSING, Activity.SQUEEZING, Activity.SETTLING):
        close(handle, memory, parameters, state, links.hand_pose, velocity)
    else:
        travel(handle, memory, parameters, state, links.hand_pose, velocity)
    return BOTH_ARMS


@compiled
def _keep_start(handle: CoupleHandle, memory: Record, state: Record, hand_pose: FloatArray) -> None:
    """Remember where the hands are as an activity begins: in the world, or as seen from the target."""
    own = handle.own[0]
    relative = memory.activity in (Activity.RETREATING, Activity.REGRASPING)
    for arm in range(2):
        own.start_pose[arm, :] = hand_pose[arm]
        if relative:
            target = state.target_pose.copy()
            target[2] = frame_angle(handle.fixed[0].shape, target)
            to_target(target, hand_pose[arm], own.start_pose[arm])
