"""From wanted hand twists to joint rates on the free-flying base (eq. 2), limits last: tools of every method."""

from __future__ import annotations

import math

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.config import SingularityHandling
from sim.control.tracking import tracking_velocity
from sim.control.trajectory import BOTH_ARMS, follow
from sim.model.generalized_jacobian import (
    damping_near_singularity,
    free_flying_model,
    joint_rates,
    manipulability,
    momentum,
)
from sim.model.planar import point_velocity
from sim.model.robot import FREEDOMS, JOINTS, LINKS, Chain, RobotModel, arm_jacobian, freedom
from sim.record import Record, code_of

NO_HANDS = -2
"""In place of an arm or `BOTH_ARMS`: the joints are held."""

_DAMPED = code_of(SingularityHandling.DAMPED)


@compiled
def command_hand_twists(
    memory: Record, parameters: Record, robot: RobotModel, state: Record, links: Chain, velocity: FloatArray, arm: int
) -> None:
    """Command the joint rates that give the hands these velocities, shape (2, 3), on the free-flying base (eq. 2).

    With one `arm` in place of `BOTH_ARMS` only its hand is asked for, and the least rates of all six joints do it.
    """
    model = free_flying_model(robot, state.base_pose, links)
    base_momentum = momentum(model.momentum_matrix, generalized_velocity(state))
    first, rows = (0, 6) if arm == BOTH_ARMS else (3 * arm, 3)
    wanted = np.empty(rows)
    for row in range(rows):
        hand, axis = (first + row) // 3, (first + row) % 3
        wanted[row] = velocity[hand, axis]
        for k in range(3):
            wanted[row] -= model.momentum_map[first + row, k] * base_momentum[k]
    jacobian = model.generalized_jacobian[first : first + rows, : 2 * JOINTS]
    command_joint_rates(memory, parameters, joint_rates(jacobian, wanted, _damping(parameters, links)))


@compiled
def _damping(parameters: Record, links: Chain) -> float:
    """Damping [m] of the joint-rate solution: none for the plain pseudo-inverse, else by the lesser manipulability."""
    rates = parameters.control.rates
    if rates.singularity_handling != _DAMPED:
        return 0.0
    smallest = min(manipulability(arm_jacobian(links, 0)), manipulability(arm_jacobian(links, 1)))
    return damping_near_singularity(smallest, rates.manipulability_warning, rates.damping_factor)


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
def hold_joints(memory: Record, hand_pose: FloatArray) -> None:
    """Command joint rates of zero; the hands are where they should be."""
    memory.commanded_joint_rate[:] = 0.0
    memory.desired_hand_twist[:] = 0.0
    memory.desired_hand_pose[:] = hand_pose


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
def command_joint_rates(memory: Record, parameters: Record, rates: FloatArray) -> None:
    """Command joint rates, shape (6,), within their bound: all scaled together, so that a hand keeps its course."""
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
