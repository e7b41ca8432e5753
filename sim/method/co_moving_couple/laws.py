"""What the hands should do now: pose following, the touch, the closing. Twists of hands, world axes.

Everything is relative to the target as it moves, so that a hand's speed against a face is only what it yields by.
"""

from __future__ import annotations

import math

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.config import HandMount
from sim.control.memory import NEVER
from sim.method.co_moving_couple.geometry import HALF_TURN, QUARTER_TURN, frame_angle, hand_before_corner, touching_tip
from sim.method.co_moving_couple.memory import Activity, CoupleHandle
from sim.method.co_moving_couple.parameters import Part
from sim.method.co_moving_couple.reference import approach_speed, lever_at, touch_angle
from sim.model.generalized_jacobian import free_flying_model, joint_acceleration_under_contact
from sim.model.planar import folded, point_velocity
from sim.model.robot import chain, inertia_matrix, tip_position
from sim.record import Record, code_of

_RIGID = code_of(HandMount.RIGID)
_FOLLOWING, _TURNING = code_of(Part.FOLLOWING), code_of(Part.TURNING)

_LEAST_ARC = 0.06
"""What is left of an arc counts at least so much, so that the force stays finite at its end [rad]."""


_UNDER_THE_CAP = 0.9
"""What is asked for stays so far under the cap, because what is felt overshoots it by a tenth."""
_LEAST_PART = 0.6
"""... and the force does not fall under this part of the planned one, or the last of the spin would take long ..."""
_LEAST_SLIDE = 0.004
"""Speed with which the point of contact slides outwards at least [m/s]: more than hands' velocities are wrong by."""
_STOPPING = 0.06
"""... until that would stop the target within this time [s]."""
_LOOKED_AT = 16
"""Ticks after which it is computed anew how far the servos give way."""


@compiled
def go_to(
    memory: Record, gain: float, hand_pose: FloatArray, arm: int, pose: FloatArray, twist: FloatArray,
    velocity: FloatArray,
) -> None:  # fmt: skip
    """Follow a pose that moves with a twist, shapes (3,); the hand's twist into row `arm` of the velocity."""
    memory.desired_hand_pose[arm, :] = pose
    memory.desired_hand_twist[arm, :] = twist
    for axis in range(3):
        error = pose[axis] - hand_pose[arm, axis]
        if axis == 2:
            error = folded(error, 2.0 * math.pi)
        velocity[arm, axis] = twist[axis] + gain * error


@compiled
def moving_with_target(state: Record, pose: FloatArray, twist: FloatArray) -> None:
    """The twist of a body at that pose that moves as if it were the target's, shape (3,)."""
    twist[0], twist[1] = point_velocity(state.target_pose, state.target_twist, pose[0], pose[1])
    twist[2] = state.target_twist[2]


@compiled
def braking_force(own: Record, touch: Record, state: Record) -> float:
    """F = I (w^2 - w_left^2) / (4 L dpsi) [N]: what brakes the spin that is left in the arc that is left.

    Work and energy: two forces with lever L along an arc dpsi do 2 F L dpsi. It is computed again each tick from what
    is left and from the lever that the measured torque shows, so that a wrong inertia or friction hardly matters.
    """
    spin = state.target_twist[2]
    normal = side_normal(own, state, 1)
    left = max(_LEAST_ARC, own.sense * (own.best.end_angle - normal))
    energy = max(0.0, spin * spin - touch.spin_left * touch.spin_left)
    force = state.target_inertia * energy / (4.0 * own.lever * left)
    to_stop = state.target_inertia * (abs(spin) - touch.spin_left) / (2.0 * own.lever * _STOPPING)
    least = max(touch.least_force, min(_LEAST_PART * own.best.force, to_stop))
    return float(min(_UNDER_THE_CAP * touch.force_cap, max(least, force)))


@compiled
def share_forces(own: Record, memory: Record, touch: Record, state: Record, mass: float) -> None:
    """The wanted force of each hand [N]: equal but for what takes the drift out along the hands' axis."""
    force = braking_force(own, touch, state)
    normal = side_normal(own, state, 1)
    drift = state.target_twist[0] * math.cos(normal) + state.target_twist[1] * math.sin(normal)
    half = 0.5 * mass * drift / touch.drift_time
    half = min(touch.drift_part * force, max(-touch.drift_part * force, half))
    memory.wanted_force[0] = min(_UNDER_THE_CAP * touch.force_cap, force - half)
    memory.wanted_force[1] = min(_UNDER_THE_CAP * touch.force_cap, force + half)


@compiled
def follow_faces(
    handle: CoupleHandle, memory: Record, parameters: Record, state: Record, hand_pose: FloatArray,
    velocity: FloatArray,
) -> None:  # fmt: skip
    """Both hands press on their faces and move with them (`COUPLE_MEMORY` is changed), twists of shape (2, 3)."""
    own, touch = handle.own[0], parameters.co_moving_couple.touch
    if state.tick % _LOOKED_AT == 0:
        note_yielding(handle, parameters, state)
    _note_contacts(own, state)
    _measure_lever(handle, parameters, state, hand_pose)
    share_forces(own, memory, touch, state, parameters.perception.assumed_mass)
    memory.touch_plan.lever = own.lever
    memory.touch_plan.arc_left = max(0.0, own.sense * (own.best.end_angle - side_normal(own, state, 1)))
    for arm in range(2):
        _follow_face(handle, memory, parameters, state, hand_pose, arm, velocity)


@compiled
def _note_contacts(own: Record, state: Record) -> None:
    left, right = state.touching[0] != 0, state.touching[1] != 0
    if (left or right) and own.first_touch == NEVER:
        own.first_touch = state.time
    if left and right:
        own.both_touch = 1


@compiled
def side_normal(own: Record, state: Record, arm: int) -> float:
    """Normal angle of the side that a hand touches [rad], the right hand's unwrapped."""
    return float(state.target_pose[2] + own.best.normal_offset - (HALF_TURN if arm == 0 else 0.0))


@compiled
def face_force(own: Record, state: Record, arm: int) -> float:
    """What the target pushes a hand away with along its side's normal [N]."""
    normal = side_normal(own, state, arm)
    return float(state.hand_wrench[arm, 0] * math.cos(normal) + state.hand_wrench[arm, 1] * math.sin(normal))


@compiled
def _measure_lever(handle: CoupleHandle, parameters: Record, state: Record, hand_pose: FloatArray) -> None:
    """Follow the lever that torque over force shows, friction and all, once both hands press."""
    own = handle.own[0]
    if state.touching[0] == 0 or state.touching[1] == 0:
        return
    torque, force = 0.0, 0.0
    for arm in range(2):
        x, y = hand_pose[arm, 0] - state.target_pose[0], hand_pose[arm, 1] - state.target_pose[1]
        fx, fy = state.hand_wrench[arm, 0], state.hand_wrench[arm, 1]
        torque += x * fy - y * fx + state.hand_wrench[arm, 2]
        force += face_force(own, state, arm)
    if force < 2.0 * parameters.co_moving_couple.touch.least_force:
        return
    planned = lever_at(own.best, own.sense, side_normal(own, state, 1))
    measured = min(2.0 * planned, max(0.5 * planned, own.sense * torque / force))
    own.lever += min(1.0, parameters.control.period / 0.05) * (measured - own.lever)


@compiled
def _follow_face(
    handle: CoupleHandle, memory: Record, parameters: Record, state: Record, hand_pose: FloatArray, arm: int,
    velocity: FloatArray,
) -> None:  # fmt: skip
    """One hand: with the face, along its normal by the force's error, outwards along it as planned."""
    own, touch, robot = handle.own[0], parameters.co_moving_couple.touch, handle.fixed[0].robot
    gain, sense = parameters.co_moving_couple.closing.gain, own.sense
    normal = side_normal(own, state, 1)
    lever, spin = lever_at(own.best, sense, normal), abs(state.target_twist[2])
    nx, ny = math.cos(normal), math.sin(normal)
    if arm == 0:
        nx, ny = -nx, -ny
    tip_x, tip_y = tip_position(robot, hand_pose[arm], touching_tip(sense))
    vx, vy = point_velocity(state.target_pose, state.target_twist, tip_x, tip_y)
    if parameters.co_moving_couple.without == _FOLLOWING:
        vx, vy = 0.0, 0.0
    wanted = memory.wanted_force[arm]
    if state.touching[arm] and _waits(own, touch, state):
        wanted = min(wanted, touch.equalising_force)
    outward = _normal_speed(own, touch, state, arm, wanted, parameters.control.period)
    from_x, from_y = tip_x - state.target_pose[0], tip_y - state.target_pose[1]
    present = -sense * (-ny * from_x + nx * from_y)
    arc = max(0.05, sense * (own.best.end_angle - own.best.contact_angle))
    slide = (own.best.lever_end - own.best.lever_start) / arc * spin + gain * (lever - present)
    if state.touching[arm]:
        slide = max(slide, robot.tip_radius * spin + _LEAST_SLIDE)  # never back: friction would drive the target
    slide = min(slide, 0.25)
    vx += outward * nx + sense * slide * ny
    vy += outward * ny - sense * slide * nx
    turn = gain * folded(touch_angle(arm, own.best) - hand_pose[arm, 2], 2.0 * math.pi)
    x, y = hand_pose[arm, 0] - tip_x, hand_pose[arm, 1] - tip_y
    velocity[arm, 0], velocity[arm, 1], velocity[arm, 2] = vx - turn * y, vy + turn * x, turn
    if state.touching[arm]:  # a hand that tilts on its mount is left to: to turn it back would turn the base
        for axis in range(2):
            velocity[arm, axis] -= wanted * own.yielding[arm, axis]
    memory.desired_hand_pose[arm, :] = hand_pose[arm]
    memory.desired_hand_twist[arm, :] = velocity[arm]


@compiled
def _waits(own: Record, touch: Record, state: Record) -> bool:
    """Whether the first hand that touches waits for the other."""
    return bool(not own.both_touch and state.time - own.first_touch < touch.equalising_time)


@compiled
def _normal_speed(own: Record, touch: Record, state: Record, arm: int, wanted: float, period: float) -> float:
    """Speed of a hand away from its face [m/s]: guarded approach before contact, first-order yielding in it."""
    if state.touching[arm] == 0:
        speed = -approach_speed(touch, wanted)
        own.force_error[arm], own.admittance[arm, 0], own.admittance[arm, 1] = 0.0, 0.0, speed
        return speed
    error = face_force(own, state, arm) - wanted
    if touch.imposed_mass > 0.0:
        return _imposed_speed(own, touch, arm, error, period)
    if not _waits(own, touch, state):
        total = own.force_error[arm] + period / touch.integral_time * error
        own.force_error[arm] = min(touch.integral_limit, max(-touch.integral_limit, total))
    return float((error + own.force_error[arm]) / touch.damping)


@compiled
def _imposed_speed(own: Record, touch: Record, arm: int, error: float, period: float) -> float:
    """Of m a + d v + k x = F - F_wanted about the moving face (eq. 3), by backward Euler: stable for any m, d and k."""
    mass, damping, stiffness = touch.imposed_mass, touch.imposed_damping, touch.imposed_stiffness
    place, speed = own.admittance[arm, 0], own.admittance[arm, 1]
    speed = (mass * speed + period * (error - stiffness * place)) / (mass + period * (damping + period * stiffness))
    own.admittance[arm, 0], own.admittance[arm, 1] = place + period * speed, speed
    return float(speed)


@compiled
def note_yielding(handle: CoupleHandle, parameters: Record, state: Record) -> None:
    """Note how the servos let the touching tips be pushed back, per newton on both along their sides' normals.

    Rates of joints that contact wrenches F act on give way by time_constant H*^-1 J*^T F (the servo's description).
    That changes as an arm stretches, so it is computed again and again while the hands press.
    """
    own, robot = handle.own[0], handle.fixed[0].robot
    links = chain(robot, state.base_pose, state.joint_angle, state.mount_angle)
    model = free_flying_model(robot, state.base_pose, links)
    inertia = inertia_matrix(robot, state.base_pose, links)
    free = 6 if parameters.robot.servo.hand_mount == _RIGID else 8
    wrench = np.zeros((2, 3))
    for arm in range(2):
        normal = side_normal(own, state, arm)
        nx, ny = math.cos(normal), math.sin(normal)
        tip_x, tip_y = tip_position(robot, links.hand_pose[arm], touching_tip(own.sense))
        x, y = tip_x - links.hand_pose[arm, 0], tip_y - links.hand_pose[arm, 1]
        wrench[arm, 0], wrench[arm, 1], wrench[arm, 2] = nx, ny, x * ny - y * nx
    rates = joint_acceleration_under_contact(model, inertia, wrench, free)
    for arm in range(2):
        pushed = np.zeros(3)
        for axis in range(3):
            for joint in range(8):
                pushed[axis] += model.generalized_jacobian[3 * arm + axis, joint] * rates[joint]
        lag, normal = parameters.robot.servo.time_constant, side_normal(own, state, arm)
        nx, ny = math.cos(normal), math.sin(normal)
        back = lag * (wrench[arm, 0] * pushed[0] + wrench[arm, 1] * pushed[1] + wrench[arm, 2] * pushed[2])
        own.yielding[arm, 0], own.yielding[arm, 1] = back * nx, back * ny


@compiled
def radial_force(state: Record, hand_pose: FloatArray, arm: int) -> float:
    """What the target pushes a hand away with, along the line from its centre to the hand's [N]."""
    x, y = hand_pose[arm, 0] - state.target_pose[0], hand_pose[arm, 1] - state.target_pose[1]
    return float((x * state.hand_wrench[arm, 0] + y * state.hand_wrench[arm, 1]) / math.hypot(x, y))


@compiled
def close_in(
    handle: CoupleHandle, memory: Record, parameters: Record, state: Record, hand_pose: FloatArray, wanted: float,
    radius: float, advancing: float, velocity: FloatArray,
) -> None:  # fmt: skip
    """Both hands on the corners' line, turning with it; where one feels the target it presses with a force.

    Args:
        handle: of the method.
        memory: the controller's; changed.
        parameters: record of `MissionConfig`.
        state: one element of `PERCEIVED`.
        hand_pose: shape (2, 3).
        wanted: force of a hand that feels the target [N].
        radius: of a hand that does not, from the target's centre [m].
        advancing: its rate [m/s].
        velocity: twists, shape (2, 3); changed.

    """
    own, gain, shape = handle.own[0], parameters.co_moving_couple.closing.gain, handle.fixed[0].shape
    damping = parameters.co_moving_couple.touch.damping
    pose, twist = np.empty(3), np.empty(3)
    for arm in range(2):
        corner = frame_angle(shape, state.target_pose) + own.close.corner
        line = corner - (HALF_TURN if arm == 0 else 0.0)
        nx, ny = math.cos(line), math.sin(line)
        far = nx * (hand_pose[arm, 0] - state.target_pose[0]) + ny * (hand_pose[arm, 1] - state.target_pose[1])
        aim, speed = radius, advancing
        if state.touching[arm]:
            aim, speed = far, (radial_force(state, hand_pose, arm) - wanted) / damping
        elif memory.activity != Activity.CLOSING:
            aim, speed = far, -parameters.co_moving_couple.closing.slow_speed
        if parameters.co_moving_couple.without == _TURNING:
            corner = own.start_pose[1, 2] - QUARTER_TURN
        hand_before_corner(arm, corner, aim, state.target_pose[0], state.target_pose[1], pose)
        moving_with_target(state, pose, twist)
        if parameters.co_moving_couple.without == _TURNING:
            twist[:] = 0.0
        if shape.sides == 0:
            twist[0], twist[1], twist[2] = state.target_twist[0], state.target_twist[1], 0.0
        twist[0] += speed * nx
        twist[1] += speed * ny
        go_to(memory, gain, hand_pose, arm, pose, twist, velocity)
        own.radius[arm] = far
