"""The link chain: poses, Jacobians and the inertia blocks of eq. 1, for a base and two arms of three joints.

Links lie along their own +y axis at joint angle zero. The hand sits on the end of link 3 by its mount, a
passive fourth joint. Generalized velocity is, in world axes, (base vx, vy of its centre of mass, base angular
velocity, left joints 1-3, right joints 1-3, left mount, right mount), shape (11,).
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from sim.compiled import FloatArray, compiled, compiled_inline
from sim.config import ArmConfig, BaseConfig, RobotConfig
from sim.model.planar import rotated
from sim.model.shape import Shape, rectangle


class RobotModel(NamedTuple):
    """Geometry and mass of the robot; both arms have the same links, mirrored at the base."""

    base_mass: float
    base_inertia: float
    shoulder_in_base: FloatArray
    """Joint 1 of each arm from the base's centre of mass, base axes [m], shape (2, 2)."""
    link_length: FloatArray
    """Of links 1-3 from joint to joint, and from the mount to the hand centre [m], shape (4,)."""
    link_centre: FloatArray
    """Centres of mass of links 1-3 and hand from the proximal joint [m], shape (4,)."""
    link_mass: FloatArray
    """Of links 1-3 and hand [kg], shape (4,)."""
    link_inertia: FloatArray
    """Of links 1-3 and hand about their centres of mass [kg m2], shape (4,)."""
    tip_offset: float
    tip_radius: float

    @property
    def total_mass(self) -> float:
        """Mass of the whole robot [kg]."""
        return float(self.base_mass + 2.0 * self.link_mass.sum())


class Chain(NamedTuple):
    """Where every link is: all in the world, arrays lead with the arm (left, right)."""

    joint: FloatArray
    """Joints 1-3 and mount [m], shape (2, 4, 2)."""
    centre: FloatArray
    """Centres of mass of links 1-3 and hand [m], shape (2, 4, 2)."""
    angle: FloatArray
    """Angles of links 1-3 and hand [rad], shape (2, 4)."""
    hand_pose: FloatArray
    """Hand centres and angles, shape (2, 3)."""


JOINTS = 3
"""Driven joints of an arm."""
LINKS = 4
"""Moving bodies of an arm: links 1-3 and the hand."""
FREEDOMS = 11
"""Of the generalized velocity."""


def robot_model(config: RobotConfig) -> RobotModel:
    """The model of a configured robot."""
    base, arm = config.base, config.arm
    links, hand = (arm.link_1, arm.link_2, arm.link_3), arm.hand
    shoulder_y = base.depth / 2 - base.centre_of_mass_ahead
    return RobotModel(
        base_mass=base.mass,
        base_inertia=base.inertia,
        shoulder_in_base=np.array([[-base.width / 2, shoulder_y], [base.width / 2, shoulder_y]]),
        link_length=np.array([*(link.length for link in links), hand.centre_offset]),
        link_centre=np.array([link.centre_of_mass for link in (*links, hand)]),
        link_mass=np.array([link.mass for link in (*links, hand)]),
        link_inertia=np.array([link.inertia for link in (*links, hand)]),
        tip_offset=hand.tip_offset,
        tip_radius=hand.tip_radius,
    )


def base_shape(config: BaseConfig) -> Shape:
    """The rectangle of a configured base, about its centre of mass; not to be written to."""
    return _base_shape(config.width, config.depth, config.centre_of_mass_ahead)


@lru_cache(maxsize=64)
def _base_shape(width: float, depth: float, ahead: float) -> Shape:
    return rectangle(width, depth, ahead)


@compiled_inline
def freedom(arm: int, link: int) -> int:
    """Place in the generalized velocity of an arm's joint (0-2) or mount (3)."""
    return 3 + JOINTS * arm + link if link < JOINTS else 3 + 2 * JOINTS + arm


def initial_joint_angles(config: ArmConfig) -> FloatArray:
    """Joint angles at the start [rad], shape (2, 3): the right arm mirrors the left."""
    left = np.array([config.initial_joint_angle_1, config.initial_joint_angle_2, config.initial_joint_angle_3])
    return np.array([left, -left])


@compiled
def chain(robot: RobotModel, base_pose: FloatArray, joint_angle: FloatArray, mount_angle: FloatArray) -> Chain:
    """Poses of all links.

    Args:
        robot: the model.
        base_pose: of the base's centre of mass, shape (3,).
        joint_angle: of joints 1-3 [rad], shape (2, 3).
        mount_angle: of the hands on their mounts [rad], shape (2,).

    """
    joint = np.empty((2, LINKS, 2))
    centre = np.empty((2, LINKS, 2))
    angle = np.empty((2, LINKS))
    hand_pose = np.empty((2, 3))
    for arm in range(2):
        dx, dy = rotated(base_pose[2], robot.shoulder_in_base[arm, 0], robot.shoulder_in_base[arm, 1])
        x, y, turn = base_pose[0] + dx, base_pose[1] + dy, base_pose[2]
        for link in range(LINKS):
            turn += joint_angle[arm, link] if link < JOINTS else mount_angle[arm]
            along_x, along_y = -math.sin(turn), math.cos(turn)
            joint[arm, link, 0], joint[arm, link, 1], angle[arm, link] = x, y, turn
            centre[arm, link, 0] = x + robot.link_centre[link] * along_x
            centre[arm, link, 1] = y + robot.link_centre[link] * along_y
            x += robot.link_length[link] * along_x
            y += robot.link_length[link] * along_y
        hand_pose[arm, 0], hand_pose[arm, 1], hand_pose[arm, 2] = x, y, turn
    return Chain(joint, centre, angle, hand_pose)


@compiled
def hand_jacobian(base_pose: FloatArray, links: Chain) -> FloatArray:
    """[J_b, J_m] of eq. 1: generalized velocity to the twists of both hands, shape (6, 11), world axes."""
    jacobian = np.zeros((6, FREEDOMS))
    for arm in range(2):
        x, y = links.hand_pose[arm, 0], links.hand_pose[arm, 1]
        row = 3 * arm
        jacobian[row, 0] = jacobian[row + 1, 1] = jacobian[row + 2, 2] = 1.0
        jacobian[row, 2], jacobian[row + 1, 2] = -(y - base_pose[1]), x - base_pose[0]
        for link in range(LINKS):
            column = freedom(arm, link)
            jacobian[row, column] = -(y - links.joint[arm, link, 1])
            jacobian[row + 1, column] = x - links.joint[arm, link, 0]
            jacobian[row + 2, column] = 1.0
    return jacobian


@compiled
def momentum_matrix(robot: RobotModel, base_pose: FloatArray, links: Chain) -> FloatArray:
    """[H_b, H_bm] of eq. 1: generalized velocity to the robot's momentum about the base's centre of mass.

    The first rows of the inertia matrix, shape (3, 11), without the cost of the rest.
    """
    H = np.zeros((3, FREEDOMS))
    H[0, 0] = H[1, 1] = robot.base_mass
    H[2, 2] = robot.base_inertia
    for arm in range(2):
        for link in range(LINKS):
            m, inertia = robot.link_mass[link], robot.link_inertia[link]
            cx, cy = links.centre[arm, link, 0], links.centre[arm, link, 1]
            x, y = cx - base_pose[0], cy - base_pose[1]
            H[0, 0] += m
            H[1, 1] += m
            H[0, 2] -= m * y
            H[1, 2] += m * x
            H[2, 2] += inertia + m * (x * x + y * y)
            for j in range(link + 1):
                from_x, from_y = cx - links.joint[arm, j, 0], cy - links.joint[arm, j, 1]
                column = freedom(arm, j)
                H[0, column] -= m * from_y
                H[1, column] += m * from_x
                H[2, column] += inertia + m * (x * from_x + y * from_y)
    H[2, 0], H[2, 1] = H[0, 2], H[1, 2]
    return H


@compiled
def inertia_matrix(robot: RobotModel, base_pose: FloatArray, links: Chain) -> FloatArray:
    """The inertia matrix of eq. 1, shape (11, 11): H_b = [:3, :3], H_bm = [:3, 3:], H_m = [3:, 3:]."""
    H = np.zeros((FREEDOMS, FREEDOMS))
    H[0, 0] = H[1, 1] = robot.base_mass
    H[2, 2] = robot.base_inertia
    columns = np.empty((LINKS + 1, 2))  # velocity of a centre of mass per unit of base rate and joint rates
    index = np.empty(LINKS + 1, np.int64)
    for arm in range(2):
        for link in range(LINKS):
            m, inertia = robot.link_mass[link], robot.link_inertia[link]
            cx, cy = links.centre[arm, link, 0], links.centre[arm, link, 1]
            columns[0, 0], columns[0, 1], index[0] = -(cy - base_pose[1]), cx - base_pose[0], 2
            for j in range(link + 1):
                columns[j + 1, 0] = -(cy - links.joint[arm, j, 1])
                columns[j + 1, 1] = cx - links.joint[arm, j, 0]
                index[j + 1] = freedom(arm, j)
            H[0, 0] += m
            H[1, 1] += m
            for a in range(link + 2):
                row = index[a]
                H[0, row] += m * columns[a, 0]
                H[1, row] += m * columns[a, 1]
                for b in range(link + 2):
                    H[row, index[b]] += inertia + m * (columns[a, 0] * columns[b, 0] + columns[a, 1] * columns[b, 1])
    for row in range(2, FREEDOMS):
        H[row, 0], H[row, 1] = H[0, row], H[1, row]
    return H


@compiled_inline
def tip_position(robot: RobotModel, hand_pose: FloatArray, tip: int) -> tuple[float, float]:
    """World position of a hand's tip [m]: 0 lies on the hand's -x side, 1 on its +x side."""
    dx, dy = rotated(hand_pose[2], robot.tip_offset if tip == 1 else -robot.tip_offset, 0.0)
    return hand_pose[0] + dx, hand_pose[1] + dy
