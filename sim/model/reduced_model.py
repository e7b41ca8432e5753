"""What a free-flying robot's motion about its centre of mass depends on: its shape, in base axes.

With the centre of mass drifting, one momentum is left, L about it: L = I (base rate) + h . (joint rates), so that
base rate = L / I + c . (joint rates) with c = -h / I. All of it follows from the joint angles alone; nothing here
allocates.
"""

from __future__ import annotations

import math

import numpy as np

from sim.compiled import FloatArray, compiled, compiled_inline
from sim.model.planar import direction
from sim.model.robot import JOINTS, LINKS, RobotModel, freedom
from sim.record import Record

FREE = 2 * LINKS
"""Joints, mounts included: left 1-3, right 1-3, both mounts."""


SHAPE = np.dtype(
    [
        ("turn", np.float64, (FREE,)),  # angles of links 1-3 and hand, left and right: at `body_place`
        ("cosine", np.float64, (FREE,)),  # of each turn
        ("sine", np.float64, (FREE,)),  # likewise
        ("joint", np.float64, (2, LINKS, 2)),  # joints 1-3 and mount
        ("hand", np.float64, (2, 2)),  # hand centres
        ("mass", np.float64, (2, LINKS)),  # of all that a joint carries
        ("moment", np.float64, (2, LINKS, 2)),  # its mass times its centre of mass
        ("second", np.float64, (2, LINKS)),  # its moment of inertia about the origin
        ("lean", np.float64, (FREE, 2)),  # its mass times its centre of mass from the joint
        ("spin", np.float64, (FREE,)),  # h: momentum about the robot's centre of mass per joint rate, base unturning
        ("base_per_joint", np.float64, (FREE,)),  # c = -h / I: base rate per joint rate at zero momentum
        ("centre", np.float64, (2,)),  # the robot's centre of mass
        ("total_mass", np.float64),  # of the robot
        ("inverse_inertia", np.float64),  # of the robot about its centre of mass
    ],
    align=True,
)
"""The robot with its base's centre of mass at the origin and unturned; SI, arrays lead with the arm."""


@compiled_inline
def body_place(arm: int, link: int) -> int:
    """Place among the eight bodies of an arm's link (0-2) or hand (3)."""
    return LINKS * arm + link


@compiled_inline
def joint_place(arm: int, link: int) -> int:
    """Place among the eight joints of an arm's joint (0-2) or mount (3)."""
    return freedom(arm, link) - 3


@compiled_inline
def _set_turns(joint_angle: FloatArray, mount_angle: FloatArray, shape: Record) -> None:
    """The angles of all links from those of joints, shape (2, 3), and mounts, shape (2,) [rad], into a `SHAPE`."""
    for arm in range(2):
        turn = 0.0
        for link in range(LINKS):
            turn += joint_angle[arm, link] if link < JOINTS else mount_angle[arm]
            shape.turn[body_place(arm, link)] = turn


@compiled_inline
def set_shape(robot: RobotModel, shape: Record) -> None:
    """Set all of a record of `SHAPE` from the angles of its links, `turn`."""
    _set_directions(shape.turn, shape.cosine, shape.sine)
    mass, second = robot.base_mass, robot.base_inertia
    moment_x = moment_y = 0.0
    for arm in range(2):
        _set_arm(robot, arm, shape)
        mass += shape.mass[arm, 0]
        moment_x += shape.moment[arm, 0, 0]
        moment_y += shape.moment[arm, 0, 1]
        second += shape.second[arm, 0]
    x, y = moment_x / mass, moment_y / mass
    shape.centre[0], shape.centre[1] = x, y
    shape.total_mass, shape.inverse_inertia = mass, 1.0 / (second - (moment_x * x + moment_y * y))
    for arm in range(2):
        for link in range(LINKS):
            place = joint_place(arm, link)
            spin = shape.second[arm, link] - (
                shape.moment[arm, link, 0] * shape.joint[arm, link, 0]
                + shape.moment[arm, link, 1] * shape.joint[arm, link, 1]
                + x * shape.lean[place, 0]
                + y * shape.lean[place, 1]
            )
            shape.spin[place] = spin
            shape.base_per_joint[place] = -spin * shape.inverse_inertia


@compiled
def _set_directions(turn: FloatArray, cosine: FloatArray, sine: FloatArray) -> None:
    """Cosine and sine of each angle, all of shape (n,): a loop that the processor does for eight at a time.

    A known length would have it unrolled instead, which takes three times as long.
    """
    for place in range(turn.shape[0]):
        cosine[place], sine[place] = direction(turn[place])


@compiled_inline
def _set_arm(robot: RobotModel, arm: int, shape: Record) -> None:
    """Joints outwards, then inwards the masses that they carry."""
    x, y = robot.shoulder_in_base[arm, 0], robot.shoulder_in_base[arm, 1]
    for link in range(LINKS):
        shape.joint[arm, link, 0], shape.joint[arm, link, 1] = x, y
        x -= robot.link_length[link] * shape.sine[body_place(arm, link)]
        y += robot.link_length[link] * shape.cosine[body_place(arm, link)]
    shape.hand[arm, 0], shape.hand[arm, 1] = x, y
    mass = moment_x = moment_y = second = 0.0
    for link in range(LINKS - 1, -1, -1):
        m, place = robot.link_mass[link], joint_place(arm, link)
        joint_x, joint_y = shape.joint[arm, link, 0], shape.joint[arm, link, 1]
        x = joint_x - robot.link_centre[link] * shape.sine[body_place(arm, link)]
        y = joint_y + robot.link_centre[link] * shape.cosine[body_place(arm, link)]
        mass += m
        moment_x += m * x
        moment_y += m * y
        second += robot.link_inertia[link] + m * (x * x + y * y)
        shape.mass[arm, link], shape.second[arm, link] = mass, second
        shape.moment[arm, link, 0], shape.moment[arm, link, 1] = moment_x, moment_y
        shape.lean[place, 0], shape.lean[place, 1] = moment_x - mass * joint_x, moment_y - mass * joint_y


@compiled_inline
def shape_of_state(robot: RobotModel, state: Record, shape: Record) -> Record:
    """The robot's shape at a plant's state, or a perceived one: the record of `SHAPE` that is given, set."""
    _set_turns(state.joint_angle, state.mount_angle, shape)
    set_shape(robot, shape)
    return shape


@compiled
def set_shape_at(robot: RobotModel, joint_angle: FloatArray, mount_angle: FloatArray, shape: Record) -> None:
    """Set a record of `SHAPE` for joints, shape (2, 3), and mounts, shape (2,), at these angles [rad]."""
    _set_turns(joint_angle, mount_angle, shape)
    set_shape(robot, shape)


CHAIN = np.dtype([("joint", np.float64, (2, LINKS, 2)), ("hand_pose", np.float64, (2, 3))], align=True)
"""Joints and hands in the world, as in `Chain`: what follows at once from a shape and the base's pose."""


@compiled_inline
def set_chain(base_pose: FloatArray, shape: Record, links: Record) -> None:
    """Set a record of `CHAIN` for a robot of that shape with its base there."""
    c, s = direction(base_pose[2])
    for arm in range(2):
        for link in range(LINKS):
            x, y = shape.joint[arm, link, 0], shape.joint[arm, link, 1]
            links.joint[arm, link, 0] = base_pose[0] + (c * x - s * y)
            links.joint[arm, link, 1] = base_pose[1] + (s * x + c * y)
        x, y = shape.hand[arm, 0], shape.hand[arm, 1]
        links.hand_pose[arm, 0] = base_pose[0] + (c * x - s * y)
        links.hand_pose[arm, 1] = base_pose[1] + (s * x + c * y)
        links.hand_pose[arm, 2] = base_pose[2] + shape.turn[body_place(arm, JOINTS)]


@compiled_inline
def set_generalized_jacobian(shape: Record, arm: int, matrix: FloatArray, row: int) -> None:
    """J* of eq. 2 for one hand: rates of the six driven joints to its twist at zero momentum, base axes.

    Args:
        shape: of the robot.
        arm: whose hand.
        matrix: of six columns (left 1-3, right 1-3).
        row: the first of the three that are set.

    """
    for side in range(2):
        for link in range(JOINTS):
            x, y, turn = hand_twist_by_joint(shape, arm, side, link)
            joint = joint_place(side, link)
            matrix[row, joint], matrix[row + 1, joint], matrix[row + 2, joint] = x, y, turn


@compiled_inline
def hand_twist_by_joint(shape: Record, arm: int, side: int, link: int) -> tuple[float, float, float]:
    """A column of J*: the twist of one hand per rate of a joint (link 0-2) or mount (3) of an arm, base axes.

    The hand turns with the base about the robot's centre of mass, is moved by its own joints, and by what keeps that
    centre where it is.
    """
    joint = joint_place(side, link)
    hand_x, hand_y = shape.hand[arm, 0], shape.hand[arm, 1]
    per_mass, turn = 1.0 / shape.total_mass, shape.base_per_joint[joint]
    x = per_mass * shape.lean[joint, 1] - turn * (hand_y - shape.centre[1])
    y = turn * (hand_x - shape.centre[0]) - per_mass * shape.lean[joint, 0]
    if side == arm:
        x -= hand_y - shape.joint[side, link, 1]
        y += hand_x - shape.joint[side, link, 0]
        turn += 1.0
    return x, y, turn


@compiled_inline
def momentum_drift(
    shape: Record, velocity_x: float, velocity_y: float, rate: float, joint_rate: FloatArray
) -> tuple[float, float, float]:
    """What momentum alone moves: velocity of the robot's centre of mass, P / M, and the turn about it, L / I.

    Args:
        shape: of the robot.
        velocity_x: of the base's centre of mass, base axes [m/s].
        velocity_y: likewise.
        rate: of the base [rad/s].
        joint_rate: of all joints, shape (8,) [rad/s].

    """
    lean_x = lean_y = by_joints = 0.0
    for joint in range(FREE):
        lean_x += shape.lean[joint, 0] * joint_rate[joint]
        lean_y += shape.lean[joint, 1] * joint_rate[joint]
        by_joints += shape.base_per_joint[joint] * joint_rate[joint]
    x = velocity_x - rate * shape.centre[1] - lean_y / shape.total_mass
    y = velocity_y + rate * shape.centre[0] + lean_x / shape.total_mass
    return x, y, rate - by_joints


@compiled
def momentum_of(shape: Record, state: Record, momentum: FloatArray) -> None:
    """The robot's momentum about the base's centre of mass, world axes, shape (3,) [N s, N m s] (eq. 1).

    Args:
        shape: of the robot.
        state: one element of `PLANT_STATE` or `PERCEIVED`: its base pose and twist, joint and mount rates.
        momentum: the result.

    """
    c, s = direction(state.base_pose[2])
    vx, vy, rate = state.base_twist[0], state.base_twist[1], state.base_twist[2]
    x, y = c * vx + s * vy, c * vy - s * vx
    px, py = x - rate * shape.centre[1], y + rate * shape.centre[0]
    turn = rate
    for arm in range(2):
        for link in range(LINKS):
            place = joint_place(arm, link)
            speed = state.joint_rate[arm, link] if link < JOINTS else state.mount_rate[arm]
            px -= shape.lean[place, 1] * speed / shape.total_mass
            py += shape.lean[place, 0] * speed / shape.total_mass
            turn -= shape.base_per_joint[place] * speed
    px, py = shape.total_mass * px, shape.total_mass * py
    momentum[0], momentum[1] = c * px - s * py, s * px + c * py
    momentum[2] = turn / shape.inverse_inertia + shape.centre[0] * py - shape.centre[1] * px


@compiled
def base_twist(
    shape: Record,
    base_angle: float,
    momentum: FloatArray,
    joint_rate: FloatArray,
    mount_rate: FloatArray,
    twist: FloatArray,
) -> None:
    """The twist of the base that momentum and joint rates make (eq. 1), world axes.

    Args:
        shape: of the robot.
        base_angle: [rad].
        momentum: of the robot about the base's centre of mass, world axes, shape (3,) [N s, N m s].
        joint_rate: of the driven joints, shape (2, 3) [rad/s].
        mount_rate: of the mounts, at least two [rad/s].
        twist: the result, shape (3,) [m/s, rad/s].

    """
    c, s = direction(base_angle)
    px, py = c * momentum[0] + s * momentum[1], c * momentum[1] - s * momentum[0]
    centre_x, centre_y = shape.centre[0], shape.centre[1]
    rate = (momentum[2] - (centre_x * py - centre_y * px)) * shape.inverse_inertia
    for arm in range(2):
        for link in range(LINKS):
            place, speed = joint_place(arm, link), joint_rate[arm, link] if link < JOINTS else mount_rate[arm]
            rate += shape.base_per_joint[place] * speed
            px += shape.lean[place, 1] * speed
            py -= shape.lean[place, 0] * speed
    vx, vy = px / shape.total_mass + rate * centre_y, py / shape.total_mass - rate * centre_x
    twist[0], twist[1], twist[2] = c * vx - s * vy, s * vx + c * vy, rate


@compiled
def reduced_inertia(total_mass: float, shape: Record, matrix: FloatArray) -> None:
    """H*: joint accelerations to joint torques with base and momentum free [kg m2], into an array of shape (8, 8).

    The inertia of the arms on a still base, less what centre of mass and base take part in.
    """
    lean, spin, inverse = shape.lean, shape.spin, shape.inverse_inertia
    for i in range(FREE):
        for j in range(FREE):
            taken = (lean[i, 0] * lean[j, 0] + lean[i, 1] * lean[j, 1]) / total_mass
            matrix[i, j] = -taken - spin[i] * spin[j] * inverse
    for arm in range(2):
        for outer in range(LINKS):
            column = joint_place(arm, outer)
            x, y = shape.joint[arm, outer, 0], shape.joint[arm, outer, 1]
            for inner in range(outer + 1):
                row = joint_place(arm, inner)
                inner_x, inner_y = shape.joint[arm, inner, 0], shape.joint[arm, inner, 1]
                value = shape.second[arm, outer] + shape.mass[arm, outer] * (x * inner_x + y * inner_y)
                value -= shape.moment[arm, outer, 0] * (x + inner_x) + shape.moment[arm, outer, 1] * (y + inner_y)
                matrix[row, column] += value
                if row != column:
                    matrix[column, row] += value


@compiled
def solve_in_place(matrix: FloatArray, right_side: FloatArray, size: int) -> None:
    """A x = b by Cholesky's factors for the first rows and columns of a symmetric positive A; x replaces b."""
    for j in range(size):
        for k in range(j):
            matrix[j, j] -= matrix[j, k] * matrix[j, k]
        matrix[j, j] = math.sqrt(matrix[j, j])
        for i in range(j + 1, size):
            for k in range(j):
                matrix[i, j] -= matrix[i, k] * matrix[j, k]
            matrix[i, j] /= matrix[j, j]
    for i in range(size):
        for k in range(i):
            right_side[i] -= matrix[i, k] * right_side[k]
        right_side[i] /= matrix[i, i]
    for i in range(size - 1, -1, -1):
        for k in range(i + 1, size):
            right_side[i] -= matrix[k, i] * right_side[k]
        right_side[i] /= matrix[i, i]
