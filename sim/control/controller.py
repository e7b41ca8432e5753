"""One control tick: plant state -> what has happened -> phase -> hand velocity -> joint rates, limits last.

`control` is the whole controller. It reads the plant's state and the parameters, changes its memory, and
leaves the joint rates to command in it. The published method is told in docs/method.md.
"""

from __future__ import annotations

import math

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.config import SingularityHandling
from sim.control.admittance import admitted
from sim.control.memory import NEVER, PlanKind
from sim.control.phases import Activity, Phase, Sequence
from sim.control.tracking import tracking_velocity
from sim.control.trajectory import BOTH_ARMS, follow, plan_cage, plan_end, plan_release, plan_touch
from sim.model.generalized_jacobian import (
    damping_near_singularity,
    free_flying_model,
    joint_rates,
    manipulability,
    momentum,
)
from sim.model.planar import point_velocity
from sim.model.robot import (
    FREEDOMS,
    JOINTS,
    LINKS,
    Chain,
    RobotModel,
    arm_jacobian,
    freedom,
    tip_position,
)
from sim.record import Record, code_of

_DAMPED = code_of(SingularityHandling.DAMPED)


@compiled
def begin_sequence(memory: Record, phase: int, sequence: int) -> None:
    """Put the memory at the start of a phase that an operator asked for; a plan under way is dropped."""
    memory.phase, memory.sequence, memory.activity = phase, sequence, Activity.NONE
    memory.last_contact, memory.slow_since = NEVER, math.inf
    memory.replan_after_contact = phase == Phase.DETUMBLING
    memory.cage_planned = 0
    memory.plan_kind, memory.plan_knots = PlanKind.NONE, 0
    memory.absorbing = 0
    memory.admittance_displacement[:] = 0.0
    memory.admittance_velocity[:] = 0.0


@compiled
def control(
    memory: Record, parameters: Record, transition: FloatArray, robot: RobotModel, state: Record, links: Chain
) -> None:
    """One tick of the controller.

    Args:
        memory: one element of `MEMORY`; changed. `commanded_joint_rate` is the result [rad/s].
        parameters: record of `MissionConfig`.
        transition: of the admittance over one period, `admittance_transition`.
        robot: the robot's model.
        state: one element of `PLANT_STATE`.
        links: the chain at that state.

    """
    note_events(memory, parameters, state)
    advance_phase(memory, parameters, state, links.hand_pose)
    memory.rate_limited = 0
    if memory.activity != Activity.ABSORBING:
        memory.absorbing = 0
    velocity = np.zeros((2, 3))
    if memory.activity == Activity.ABSORBING:
        absorb(memory, transition, state, links.hand_pose, velocity)
    elif memory.activity in (Activity.APPROACHING, Activity.CLOSING, Activity.OPENING):
        track(memory, parameters, state, links, velocity)
    else:
        hold_joints(memory, links.hand_pose)
        return
    command_hands(memory, parameters, robot, state, links, velocity)


@compiled
def command_hands(
    memory: Record, parameters: Record, robot: RobotModel, state: Record, links: Chain, velocity: FloatArray
) -> None:
    """Joint rates that give the hands these velocities, shape (2, 3), on the free-flying base (eq. 2).

    While the idle arm is free only the working hand is asked for, and the least rates of all six joints do it.
    """
    model = free_flying_model(robot, state.base_pose, links)
    base_momentum = momentum(model.momentum_matrix, generalized_velocity(state))
    one_hand = memory.activity == Activity.APPROACHING and idle_arm_is_free(
        memory, parameters, robot, state, links.hand_pose
    )
    first, rows = (3 * memory.plan_arm, 3) if one_hand else (0, 6)
    wanted = np.empty(rows)
    for row in range(rows):
        hand, axis = (first + row) // 3, (first + row) % 3
        wanted[row] = velocity[hand, axis]
        for k in range(3):
            wanted[row] -= model.momentum_map[first + row, k] * base_momentum[k]
    jacobian = model.generalized_jacobian[first : first + rows, : 2 * JOINTS]
    command_rates(memory, parameters, joint_rates(jacobian, wanted, _damping(parameters, links)))


@compiled
def _damping(parameters: Record, links: Chain) -> float:
    """Damping [m] of the joint-rate solution: none for the plain pseudo-inverse, else by the lesser manipulability."""
    rates = parameters.control.rates
    if rates.singularity_handling != _DAMPED:
        return 0.0
    smallest = min(manipulability(arm_jacobian(links, 0)), manipulability(arm_jacobian(links, 1)))
    return damping_near_singularity(smallest, rates.manipulability_warning, rates.damping_factor)


@compiled
def note_events(memory: Record, parameters: Record, state: Record) -> None:
    """What has happened since the last tick that phases depend on: contact, spin under its threshold."""
    if memory.phase not in (Phase.DETUMBLING, Phase.CAGING):
        return
    if state.tip_contact.any():
        memory.last_contact = state.time
        memory.replan_after_contact = 1
    slow = abs(state.target_twist[2]) < parameters.control.caging.spin_threshold
    if memory.phase == Phase.DETUMBLING and slow and memory.slow_since == math.inf:
        memory.slow_since = state.time


@compiled
def advance_phase(memory: Record, parameters: Record, state: Record, hand_pose: FloatArray) -> None:
    """The transitions that follow from time and measurement, and the activity of this tick."""
    if memory.phase == Phase.DETUMBLING:
        detumbled = memory.slow_since + parameters.control.touch.absorb_time
        if state.time > detumbled + 0.5 * parameters.control.period:
            memory.phase = Phase.HOLDING if memory.sequence == Sequence.DETUMBLE_ONLY else Phase.CAGING
        else:
            _detumble(memory, parameters, state, hand_pose)
    if memory.phase == Phase.CAGING:
        _cage(memory, parameters, state, hand_pose)
    elif memory.phase == Phase.RELEASED:
        _release(memory, parameters, state, hand_pose)
    elif memory.phase != Phase.DETUMBLING:
        memory.activity = Activity.NONE


@compiled
def _detumble(memory: Record, parameters: Record, state: Record, hand_pose: FloatArray) -> None:
    """Absorb while in contact and a fixed time after, let the target go, plan again, follow, wait."""
    touch = parameters.control.touch
    half_tick = 0.5 * parameters.control.period
    since_contact = state.time - memory.last_contact + half_tick
    if since_contact < touch.admittance_fraction * touch.absorb_time:
        memory.activity = Activity.ABSORBING
        return
    if since_contact < touch.absorb_time:
        memory.activity = Activity.RETREATING
        return
    if memory.replan_after_contact:
        memory.replan_after_contact = 0
        plan_touch(memory, parameters, state, hand_pose)
    memory.activity = Activity.APPROACHING if state.time < plan_end(memory) else Activity.WAITING


@compiled
def _cage(memory: Record, parameters: Record, state: Record, hand_pose: FloatArray) -> None:
    """Plan the enclosure when it is due, follow it, lock the arms once it is done and closed."""
    caging, touch = parameters.control.caging, parameters.control.touch
    half_tick = 0.5 * parameters.control.period
    direct = memory.sequence == Sequence.DIRECT_CAGE
    at_once = direct or memory.sequence == Sequence.CAGE_ONLY
    first_due = not memory.cage_planned and (
        at_once or state.time + half_tick >= memory.slow_since + caging.switching_delay
    )
    again_due = False
    if memory.replan_after_contact and not direct and state.time + half_tick >= memory.last_contact + touch.absorb_time:
        memory.replan_after_contact = 0
        again_due = not memory.closed
    if first_due or again_due:
        memory.cage_planned = memory.cage_planned or first_due
        plan_cage(memory, parameters, state, hand_pose, caging.direct_capture_time if direct else caging.capture_time)
    if memory.plan_kind != PlanKind.CAGE:
        memory.activity = Activity.SETTLING
    elif state.time < plan_end(memory):
        memory.activity = Activity.CLOSING
    else:
        memory.activity = Activity.WAITING
        if memory.closed:
            memory.phase, memory.activity = Phase.HOLDING, Activity.NONE


@compiled
def _release(memory: Record, parameters: Record, state: Record, hand_pose: FloatArray) -> None:
    if memory.plan_kind != PlanKind.RELEASE:
        plan_release(memory, parameters, state, hand_pose)
    memory.activity = Activity.OPENING if state.time < plan_end(memory) else Activity.NONE


@compiled
def hold_joints(memory: Record, hand_pose: FloatArray) -> None:
    """Command joint rates of zero; the hands are where they should be."""
    memory.commanded_joint_rate[:] = 0.0
    memory.desired_hand_twist[:] = 0.0
    memory.desired_hand_pose[:] = hand_pose


@compiled
def absorb(memory: Record, transition: FloatArray, state: Record, hand_pose: FloatArray, velocity: FloatArray) -> None:
    """Hand velocities, shape (2, 3), by the admittance of both hands: at rest on entry, displacement kept."""
    if not memory.absorbing:
        memory.admittance_velocity[:] = 0.0
        memory.absorbing = 1
    for arm in range(2):
        for axis in range(3):
            displacement, speed = admitted(
                transition,
                memory.admittance_displacement[arm, axis],
                memory.admittance_velocity[arm, axis],
                state.hand_wrench[arm, axis],
            )
            memory.admittance_displacement[arm, axis] = displacement
            memory.admittance_velocity[arm, axis] = speed
            velocity[arm, axis] = speed
    memory.desired_hand_pose[:] = hand_pose
    memory.desired_hand_twist[:] = velocity


@compiled
def track(memory: Record, parameters: Record, state: Record, links: Chain, velocity: FloatArray) -> None:
    """Hand velocities, shape (2, 3), that follow the plan; an arm without a part in it is held in the world."""
    twist = hand_twists(state, links)
    for arm in range(2):
        if memory.plan_arm not in (BOTH_ARMS, arm):
            memory.desired_hand_pose[arm, :] = links.hand_pose[arm]
            memory.desired_hand_twist[arm, :] = 0.0
            continue
        follow(memory, state.time, arm)
        tracking_velocity(
            parameters.control.tracking, parameters.control.period,
            memory.desired_hand_pose[arm], memory.desired_hand_twist[arm],
            links.hand_pose[arm], twist[arm], memory.tracking_integral[arm], velocity[arm],
        )  # fmt: skip


@compiled
def generalized_velocity(state: Record) -> FloatArray:
    """Base twist, joint rates and mount rates of a plant's state, shape (11,)."""
    velocity = np.empty(FREEDOMS)
    velocity[:3] = state.base_twist
    for arm in range(2):
        for link in range(JOINTS):
            velocity[freedom(arm, link)] = state.joint_rate[arm, link]
        velocity[freedom(arm, JOINTS)] = state.mount_rate[arm]
    return velocity


@compiled
def hand_twists(state: Record, links: Chain) -> FloatArray:
    """Twists of both hands, world axes, shape (2, 3) [m/s, rad/s]."""
    twist = np.empty((2, 3))
    for arm in range(2):
        x, y = links.hand_pose[arm, 0], links.hand_pose[arm, 1]
        vx, vy = point_velocity(state.base_pose, state.base_twist, x, y)
        turn = state.base_twist[2]
        for link in range(LINKS):
            rate = state.joint_rate[arm, link] if link < JOINTS else state.mount_rate[arm]
            vx -= rate * (y - links.joint[arm, link, 1])
            vy += rate * (x - links.joint[arm, link, 0])
            turn += rate
        twist[arm, 0], twist[arm, 1], twist[arm, 2] = vx, vy, turn
    return twist


@compiled
def idle_arm_is_free(
    memory: Record, parameters: Record, robot: RobotModel, state: Record, hand_pose: FloatArray
) -> bool:
    """Whether the idle arm may share the motion: its tips far from the target, all elbows and wrists bent."""
    touch = parameters.control.touch
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


@compiled
def command_rates(memory: Record, parameters: Record, rates: FloatArray) -> None:
    """The joint rates, shape (6,), within their bound: all are scaled together, so that the hand keeps its course."""
    limit, largest = parameters.control.rates.joint_rate_limit, 0.0
    finite = True
    for rate in rates:
        finite = finite and math.isfinite(rate)
        largest = max(largest, abs(rate))
    scale = 1.0
    if not finite or largest > limit:
        memory.rate_limited = 1
        scale = limit / largest if finite else 0.0
    for joint in range(6):
        memory.commanded_joint_rate[joint // 3, joint % 3] = scale * rates[joint] if finite else 0.0
