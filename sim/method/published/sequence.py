"""The sequence of the published method: approach, absorb, retreat, plan again; settle, close, lock; open.

`begin`, `react`, `plan` and `hand_twist` are what `sim.method.method` asks of every method.
"""

from __future__ import annotations

import math

from sim.compiled import FloatArray, compiled, compiled_inline
from sim.control.admittance import admitted
from sim.control.hand_motion import NO_HANDS, track
from sim.control.memory import NEVER
from sim.control.phases import Phase, Sequence, Verdict, phase_after
from sim.control.trajectory import BOTH_ARMS, plan_end, plan_opening
from sim.method.published.memory import Activity, PlanKind, PublishedHandle
from sim.method.published.plans import plan_cage, plan_touch
from sim.model.robot import Chain, RobotModel, tip_position
from sim.record import Record, copy_rows


@compiled
def begin(handle: PublishedHandle, memory: Record) -> None:
    """Forget the last sequence; another has begun in the memory's phase."""
    own = handle.own[0]
    own.last_contact, own.slow_since = NEVER, math.inf
    own.replan_after_contact = memory.phase == Phase.DETUMBLING
    own.cage_planned = 0
    own.absorbing = 0
    own.admittance_displacement[:] = 0.0
    own.admittance_velocity[:] = 0.0


@compiled_inline
def react(
    handle: PublishedHandle, memory: Record, parameters: Record, state: Record, verdict: int
) -> tuple[int, int, int]:
    """The phase and activity that follow from what has happened, and the kind of plan to make now."""
    if verdict != Verdict.NONE:
        return phase_after(verdict), Activity.NONE, PlanKind.NONE
    own, phase = handle.own[0], memory.phase
    if phase in (Phase.DETUMBLING, Phase.CAGING):
        _update_contact_and_spin_timers(own, memory, parameters, state)
    if phase == Phase.DETUMBLING:
        detumbled = own.slow_since + parameters.published.touch.absorb_time
        if state.time <= detumbled + 0.5 * parameters.control.period:
            return _detumble(own, memory, parameters, state)
        phase = Phase.HOLDING if memory.sequence == Sequence.DETUMBLE_ONLY else Phase.CAGING
    if phase == Phase.CAGING:
        return _cage(own, memory, parameters, state)
    if phase == Phase.RELEASED:
        return _release(memory, state)
    return phase, Activity.NONE, PlanKind.NONE


@compiled_inline
def _update_contact_and_spin_timers(own: Record, memory: Record, parameters: Record, state: Record) -> None:
    """Contact now, and the first instant of spin under its threshold."""
    contact = state.tip_contact
    if contact[0, 0] or contact[0, 1] or contact[1, 0] or contact[1, 1]:
        own.last_contact = state.time
        own.replan_after_contact = 1
    slow = abs(state.target_twist[2]) < parameters.published.caging.spin_threshold
    if memory.phase == Phase.DETUMBLING and slow and own.slow_since == math.inf:
        own.slow_since = state.time


@compiled_inline
def _detumble(own: Record, memory: Record, parameters: Record, state: Record) -> tuple[int, int, int]:
    """Absorb while in contact and a fixed time after, let the target go, plan again, follow, wait."""
    touch = parameters.published.touch
    half_tick = 0.5 * parameters.control.period
    since_contact = state.time - own.last_contact + half_tick
    if since_contact < touch.admittance_fraction * touch.absorb_time:
        return Phase.DETUMBLING, Activity.ABSORBING, PlanKind.NONE
    if since_contact < touch.absorb_time:
        return Phase.DETUMBLING, Activity.RETREATING, PlanKind.NONE
    if own.replan_after_contact:
        own.replan_after_contact = 0
        return Phase.DETUMBLING, Activity.APPROACHING, PlanKind.TOUCH
    following = state.time < plan_end(memory)
    return Phase.DETUMBLING, Activity.APPROACHING if following else Activity.WAITING, PlanKind.NONE


@compiled_inline
def _cage(own: Record, memory: Record, parameters: Record, state: Record) -> tuple[int, int, int]:
    """Plan the enclosure when it is due, follow it, lock the arms once it is done and closed."""
    caging, touch = parameters.published.caging, parameters.published.touch
    half_tick = 0.5 * parameters.control.period
    direct = memory.sequence == Sequence.DIRECT_CAGE
    at_once = direct or memory.sequence == Sequence.CAGE_ONLY
    first_due = not own.cage_planned and (at_once or state.time + half_tick >= own.slow_since + caging.switching_delay)
    again_due = False
    if own.replan_after_contact and not direct and state.time + half_tick >= own.last_contact + touch.absorb_time:
        own.replan_after_contact = 0
        again_due = not state.closed
    if first_due or again_due:
        own.cage_planned = own.cage_planned or first_due
        return Phase.CAGING, Activity.CLOSING, PlanKind.CAGE
    if memory.plan_kind != PlanKind.CAGE:
        return Phase.CAGING, Activity.SETTLING, PlanKind.NONE
    if state.time < plan_end(memory):
        return Phase.CAGING, Activity.CLOSING, PlanKind.NONE
    if state.closed:
        return Phase.HOLDING, Activity.NONE, PlanKind.NONE
    return Phase.CAGING, Activity.WAITING, PlanKind.NONE


@compiled
def _release(memory: Record, state: Record) -> tuple[int, int, int]:
    if memory.plan_kind != PlanKind.RELEASE:
        return Phase.RELEASED, Activity.OPENING, PlanKind.RELEASE
    opening = state.time < plan_end(memory)
    return Phase.RELEASED, Activity.OPENING if opening else Activity.NONE, PlanKind.NONE


@compiled
def plan(
    handle: PublishedHandle, memory: Record, parameters: Record, state: Record, hand_pose: FloatArray, kind: int
) -> None:
    """Make a plan of that kind from the present state."""
    caging = parameters.published.caging
    if kind == PlanKind.TOUCH:
        plan_touch(memory, parameters, state, hand_pose)
    elif kind == PlanKind.CAGE:
        direct = memory.sequence == Sequence.DIRECT_CAGE
        plan_cage(memory, parameters, state, hand_pose, caging.direct_capture_time if direct else caging.capture_time)
    else:
        plan_opening(memory, state, hand_pose, kind, caging.release_distance, caging.release_time)


@compiled_inline
def hand_twist(
    handle: PublishedHandle,
    memory: Record,
    parameters: Record,
    robot: RobotModel,
    state: Record,
    links: Chain,
    velocity: FloatArray,
) -> int:
    """Twists that the hands should have now, shape (2, 3), and which hands that is about."""
    own = handle.own[0]
    if memory.activity == Activity.ABSORBING:
        absorb(own, memory, handle.transition, state, links.hand_pose, velocity)
        return BOTH_ARMS
    own.absorbing = 0
    if memory.activity not in (Activity.APPROACHING, Activity.CLOSING, Activity.OPENING):
        return NO_HANDS
    track(memory, parameters, state, links, velocity)
    if memory.activity == Activity.APPROACHING and idle_arm_is_free(memory, parameters, robot, state, links.hand_pose):
        return int(memory.plan_arm)
    return BOTH_ARMS


@compiled_inline
def absorb(
    own: Record, memory: Record, transition: FloatArray, state: Record, hand_pose: FloatArray, velocity: FloatArray
) -> None:
    """Hand velocities, shape (2, 3), by the admittance of both hands: at rest on entry, displacement kept."""
    if not own.absorbing:
        own.admittance_velocity[:] = 0.0
        own.absorbing = 1
    for arm in range(2):
        for axis in range(3):
            displacement, speed = admitted(
                transition,
                own.admittance_displacement[arm, axis],
                own.admittance_velocity[arm, axis],
                state.hand_wrench[arm, axis],
            )
            own.admittance_displacement[arm, axis] = displacement
            own.admittance_velocity[arm, axis] = speed
            velocity[arm, axis] = speed
    copy_rows(memory.desired_hand_pose, hand_pose)
    copy_rows(memory.desired_hand_twist, velocity)


@compiled_inline
def idle_arm_is_free(
    memory: Record, parameters: Record, robot: RobotModel, state: Record, hand_pose: FloatArray
) -> bool:
    """Whether the idle arm may share the motion: its tips far from the target, all elbows and wrists bent."""
    touch = parameters.published.touch
    idle = 1 - memory.plan_arm
    clear = touch.idle_arm_distance_factor * parameters.target.side / math.sqrt(2.0) + robot.tip_radius
    for tip in range(2):
        x, y = tip_position(robot, hand_pose[idle], tip)
        if math.hypot(x - state.target_pose[0], y - state.target_pose[1]) < clear:
            return False
    for arm in range(2):
        for joint in range(1, 3):
            if abs(state.joint_angle[arm, joint]) < touch.idle_arm_joint_limit:
                return False
    return True
