"""From wanted hand twists to joint rates on the free-flying base (eq. 2), limits last: tools of every method."""

from __future__ import annotations

import math

import numpy as np

from sim.compiled import FloatArray, compiled, compiled_inline
from sim.config import SingularityHandling
from sim.control.tracking import tracking_velocity
from sim.control.trajectory import BOTH_ARMS, follow
from sim.model.generalized_jacobian import (
    JOINT_RATES,
    damping_near_singularity,
    manipulability,
    solve_joint_rates,
)
from sim.model.planar import direction, point_velocity
from sim.model.reduced_model import FREE, joint_place, momentum_drift, set_generalized_jacobian
from sim.model.robot import FREEDOMS, JOINTS, LINKS, Chain, freedom
from sim.record import Record, code_of, copy_rows

NO_HANDS = -2
"""In place of an arm or `BOTH_ARMS`: the joints are held."""

_DAMPED = code_of(SingularityHandling.DAMPED)

HAND_MOTION = np.dtype(
    [
        ("hand_velocity", np.float64, (2, 3)),  # that the hands should have, world axes
        ("joint_rate", np.float64, (FREE,)),  # of all joints, as perceived
        ("problem", JOINT_RATES),  # base axes
    ],
    align=True,
)
"""What a tick of the controller works with and forgets."""


@compiled_inline
def command_hand_twists(
    memory: Record, parameters: Record, state: Record, shape: Record, links: Record, motion: Record, arm: int
) -> None:
    """Command the joint rates that give the hands their velocities on the free-flying base (eq. 2).

    With one `arm` in place of `BOTH_ARMS` only its hand is asked for, and the least rates of all six joints do it.

    Args:
        memory: one element of `MEMORY`; changed.
        parameters: record of `MissionConfig`.
        state: what is known, one element of `PERCEIVED`.
        shape: the robot's as it is believed to be, one element of `SHAPE`.
        links: the chain likewise, one element of `CHAIN`.
        motion: one element of `HAND_MOTION`, with `hand_velocity`; changed.
        arm: which hand, or `BOTH_ARMS`.

    """
    problem, rate, wanted = motion.problem, motion.joint_rate, motion.hand_velocity
    for side in range(2):
        for link in range(JOINTS):
            rate[joint_place(side, link)] = state.joint_rate[side, link]
        rate[joint_place(side, JOINTS)] = state.mount_rate[side]
    c, s = direction(state.base_pose[2])
    vx, vy = state.base_twist[0], state.base_twist[1]
    drift_x, drift_y, turn = momentum_drift(shape, c * vx + s * vy, c * vy - s * vx, state.base_twist[2], rate)
    first, hands = (0, 2) if arm == BOTH_ARMS else (arm, 1)
    for place in range(hands):
        hand, row = first + place, 3 * place
        x, y = shape.hand[hand, 0] - shape.centre[0], shape.hand[hand, 1] - shape.centre[1]
        problem.hand_velocity[row] = c * wanted[hand, 0] + s * wanted[hand, 1] - (drift_x - turn * y)
        problem.hand_velocity[row + 1] = c * wanted[hand, 1] - s * wanted[hand, 0] - (drift_y + turn * x)
        problem.hand_velocity[row + 2] = wanted[hand, 2] - turn
        set_generalized_jacobian(shape, hand, problem.jacobian, row)
    solve_joint_rates(problem, 3 * hands, _damping(parameters, links))
    for joint in range(2 * JOINTS):
        problem.rates[joint] *= memory.joint_rate_share
    command_joint_rates(memory, parameters, problem.rates)


@compiled_inline
def _damping(parameters: Record, links: Chain) -> float:
    """Damping [m] of the joint-rate solution: none for the plain pseudo-inverse, else by the lesser manipulability."""
    rates = parameters.control.rates
    if rates.singularity_handling != _DAMPED:
        return 0.0
    smallest = min(manipulability(links, 0), manipulability(links, 1))
    return damping_near_singularity(smallest, rates.manipulability_warning, rates.damping_factor)


@compiled_inline
def track(memory: Record, parameters: Record, state: Record, links: Chain, velocity: FloatArray) -> None:
    """Hand velocities, shape (2, 3), that follow the plan; an arm without a part in it is held in the world."""
    for arm in range(2):
        if memory.plan_arm not in (BOTH_ARMS, arm):
            for axis in range(3):
                memory.desired_hand_pose[arm, axis] = links.hand_pose[arm, axis]
                memory.desired_hand_twist[arm, axis] = 0.0
            continue
        follow(memory, state.time, arm)
        tracking_velocity(
            parameters.control.tracking, parameters.control.period,
            memory.desired_hand_pose[arm], memory.desired_hand_twist[arm],
            links.hand_pose[arm], hand_twist(state, links, arm), memory.tracking_integral[arm], velocity[arm],
        )  # fmt: skip


@compiled_inline
def hold_joints(memory: Record, hand_pose: FloatArray) -> None:
    """Command joint rates of zero; the hands are where they should be."""
    memory.commanded_joint_rate[:] = 0.0
    memory.desired_hand_twist[:] = 0.0
    copy_rows(memory.desired_hand_pose, hand_pose)


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


@compiled_inline
def hand_twist(state: Record, links: Chain, arm: int) -> tuple[float, float, float]:
    """Twist of a hand, world axes [m/s, rad/s]."""
    x, y = links.hand_pose[arm, 0], links.hand_pose[arm, 1]
    vx, vy = point_velocity(state.base_pose, state.base_twist, x, y)
    turn = state.base_twist[2]
    for link in range(LINKS):
        rate = state.joint_rate[arm, link] if link < JOINTS else state.mount_rate[arm]
        vx -= rate * (y - links.joint[arm, link, 1])
        vy += rate * (x - links.joint[arm, link, 0])
        turn += rate
    return vx, vy, turn


@compiled_inline
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
