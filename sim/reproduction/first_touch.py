"""The first touch as a collision: a spinning square against a virtual mass, spring and damper, and nothing else.

Two models, neither of which knows the robot or the planner. In closed form: the touched point moves along the
face's normal with the target's effective mass there, and the hand is a dashpot; `restitution` is that of such a
contact. By integration in the plane: the same contact law, friction and impedance as in flight, but on a hand
that obeys its admittance at once. Both give what a touch leaves: the residual spin and the drift.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.config import MissionConfig
from sim.control.admittance import admittance_transition, admitted
from sim.model.planar import in_frame, rotated
from sim.model.shape import Shape
from sim.model.target import target_shape
from sim.plant.contact import tip_contact
from sim.record import Record, packed, record_of

_STEP = 2e-5  # of the planar model [s]: sticking friction on a hand of 0.01 kg settles within some 3e-5 s


class TouchState(NamedTuple):
    """Hand and target at the first instant of a touch."""

    hand_pose: FloatArray
    """Shape (3,), world."""
    tip_across: FloatArray
    """Where each tip is across the hand centre [m], shape (2,)."""
    target_pose: FloatArray
    """Shape (3,), world."""
    target_twist: FloatArray
    """Shape (3,)."""


class Residual(NamedTuple):
    """What a touch leaves of the target's motion."""

    spin: float
    """[rad/s]"""
    drift: float
    """Speed of its centre [m/s]."""
    duration: float
    """From the first contact to the last [s]."""


def effective_mass(mass: float, inertia: float, lever: float) -> float:
    """Mass [kg] with which a free body answers a push that passes its centre at that distance [m]."""
    return 1.0 / (1.0 / mass + lever**2 / inertia)


def damping_ratio(damping: float, stiffness: float, mass: float) -> float:
    """D / (2 sqrt(k m)); infinite without stiffness, where nothing pushes back."""
    if stiffness <= 0.0:
        return math.inf if damping > 0.0 else 0.0
    return damping / (2.0 * math.sqrt(stiffness * mass))


def restitution(ratio: float) -> float:
    """Rebound speed over approach speed of a linear spring and dashpot that can push but not pull.

    The contact ends where its force is zero, before the spring is relaxed (Schwager and Poeschel 2007):
    1 without damping, exp(-2) at the critical one, 0 in the limit.

    Args:
        ratio: damping ratio of the contact.

    """
    if math.isinf(ratio):
        return 0.0
    if abs(ratio - 1.0) < 1e-9:
        return math.exp(-2.0)
    if ratio < 1.0:
        root = math.sqrt(1.0 - ratio**2)
        return math.exp(-ratio / root * math.atan2(2.0 * ratio * root, 2.0 * ratio**2 - 1.0))
    root = math.sqrt(ratio**2 - 1.0)
    return math.exp(-2.0 * ratio / root * math.log(ratio + root))  # (a + b) / (a - b) = (a + b)^2


def lever_of(state: TouchState, config: MissionConfig) -> float:
    """Distance [m] from the target's centre at which the normal of the touched face passes: the lever of the push."""
    return abs(_tip_in_target(state, config)[1])


def _tip_in_target(state: TouchState, config: MissionConfig) -> tuple[float, float]:
    """The tip that is nearest to a face: (distance outwards, along the face) from the target's centre [m]."""
    half = config.target.side / 2
    best = (math.inf, 0.0)
    for across in state.tip_across:
        dx, dy = rotated(state.hand_pose[2], across, 0.0)
        u, v = in_frame(state.target_pose, state.hand_pose[0] + dx, state.hand_pose[1] + dy)
        outwards, along = (abs(u), v) if abs(u) > abs(v) else (abs(v), u)
        if outwards - half < best[0] - half:
            best = (outwards, along)
    return best


def collision(config: MissionConfig, lever: float, spin: float) -> Residual:
    """What a touch of that lever [m] leaves of that spin [rad/s], in closed form and without friction.

    The hand's virtual mass is taken along first (a plastic blow), then both ride on its spring and damper.
    """
    target, impedance = config.target, config.published.impedance
    effective = effective_mass(target.mass, target.inertia, lever)
    carried = effective + impedance.mass
    rebound = restitution(damping_ratio(impedance.damping, impedance.stiffness, carried)) * effective / carried
    impulse = (1.0 + rebound) * effective * abs(spin) * lever
    left = abs(spin) - lever * impulse / target.inertia
    return Residual(math.copysign(1.0, spin) * left, impulse / target.mass, math.nan)


def planar_touch(config: MissionConfig, state: TouchState) -> Residual:
    """What the touch leaves by integration in the plane: the flight's contact law, friction and impedance.

    Ends when nothing has touched for as long as the hand yields after a contact.
    """
    touch = config.published.touch
    transition = admittance_transition(config.published.impedance, _STEP)
    spin, drift, duration = _integrate(
        record_of(config),
        packed(target_shape(config.target))[0],
        transition,
        touch.admittance_fraction * touch.absorb_time,
        _STEP,
        *state,
    )
    return Residual(spin, drift, duration)


@compiled
def _integrate(
    parameters: Record,
    shape: Shape,
    transition: FloatArray,
    patience: float,
    step: float,
    hand_start: FloatArray,
    tip_across: FloatArray,
    target_start: FloatArray,
    twist_start: FloatArray,
) -> tuple[float, float, float]:
    """Spin [rad/s], drift [m/s] and duration [s] of a touch."""
    target, law = parameters.target, parameters.contact
    radius = parameters.robot.arm.hand.tip_radius
    hand, pose, twist = hand_start.copy(), target_start.copy(), twist_start.copy()
    velocity, wrench = np.zeros(3), np.zeros(3)
    time = last = 0.0
    while time - last < patience and time < 30.0:
        wrench[:] = 0.0
        for across in tip_across:
            dx, dy = rotated(hand[2], across, 0.0)
            contact = tip_contact(law, shape, radius, hand[0] + dx, hand[1] + dy, hand, velocity, pose, twist)
            if not contact.touching:
                continue
            last = time
            arm_x, arm_y = contact.point_x - hand[0], contact.point_y - hand[1]
            wrench[0] += contact.force_x
            wrench[1] += contact.force_y
            wrench[2] += arm_x * contact.force_y - arm_y * contact.force_x
            lever_x, lever_y = contact.point_x - pose[0], contact.point_y - pose[1]
            twist[0] -= step * contact.force_x / target.mass
            twist[1] -= step * contact.force_y / target.mass
            twist[2] -= step * (lever_x * contact.force_y - lever_y * contact.force_x) / target.inertia
        for axis in range(3):
            displacement = hand[axis] - hand_start[axis]
            displacement, velocity[axis] = admitted(transition, displacement, velocity[axis], wrench[axis])
            hand[axis] = hand_start[axis] + displacement
            pose[axis] += step * twist[axis]
        time += step
    return twist[2], math.hypot(twist[0], twist[1]), last
