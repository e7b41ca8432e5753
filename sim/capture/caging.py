"""Is the target caged? Two tests: the paper's, at the present angle, and the true one, over all motions.

`tips_enclose` asks whether the four tips close around the target if it only translates (object closure,
Wang and Kumar 2002). `cage` searches the target's configuration space (x, y, angle) for the way out of
the hands that needs the tips to give way least: that much is the margin of the cage.

Why a positive margin is a proof, for any convex shape. At a pose of the target let its clearance be the smallest of
its signed distances from the hands' discs, less their radii. A signed distance from a convex body is the largest of
u.q - h(u) over all unit vectors u, h being how far the body reaches along u; so it changes by no more than the body's
points move. Between a pose and the nearest of the grid they move by at most step / sqrt(2) by translation and, all of
them being within the corner circle of radius R, by R turn / 2 by rotation. A continuous way out passes from the cell
of one grid pose to that of a neighbour; the search finds the chain of neighbours whose smallest clearance is largest.
The clearance on the continuous way is therefore, somewhere, at most the search's plus that error. The angle is
searched over the shape's symmetry angle only, at whose ends it is the same shape; a circle's not at all.
"""

from __future__ import annotations

import math
from heapq import heappop, heappush
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from sim.compiled import FloatArray, compiled
from sim.config import ArmConfig, MissionConfig
from sim.model.clearance import hand_outline
from sim.model.planar import cross, rotated
from sim.model.robot import JOINTS, RobotModel
from sim.model.shape import Shape, signed_distance
from sim.model.target import target_shape
from sim.record import packed

_POSITION_STEP = 1.5e-3
_ANGLE_STEP = math.radians(1.0)
_MOST_STEPS = 400  # from the hands' middle outwards: what is larger has a coarser grid, and the margin its error
_OUTLINE_SPACING = 12e-3  # between discs along fingers and palm: what they leave out only lessens the margin


class Cage(NamedTuple):
    """What the configuration-space search found."""

    caged: bool
    """No motion of the target, turning included, leads it out of the hands."""
    margin: float
    """How far the hands' surfaces would at least have to give way to let it out [m]; not positive if it is free."""


@compiled
def tips_enclose(robot: RobotModel, shape: Shape, hand_pose: FloatArray, target_pose: FloatArray) -> bool:
    """Whether the tips close around the target at its present angle, its centre inside.

    At that angle each tip bars the target's centre from a convex region around itself. Closed means: the centre is in
    none of these regions, neighbouring tips of the two hands have regions that overlap, and the way around, along
    each hand from tip to tip and straight across to the other, winds around the centre. All of that way is barred:
    two regions count as overlapping if both hold the middle between their tips, which is whenever they overlap at all
    if the shape is the same after half a turn.

    Args:
        robot: for the tips.
        shape: of the target.
        hand_pose: both hands, shape (2, 3), world.
        target_pose: shape (3,), world.

    """
    apart = math.hypot(hand_pose[1, 0] - hand_pose[0, 0], hand_pose[1, 1] - hand_pose[0, 1])
    if apart > 2.0 * (shape.corner_circle + robot.tip_radius + robot.tip_offset):  # no tips of two hands can overlap
        return False
    way = _way_around(robot, hand_pose, target_pose)
    for tip in (0, 3, 4, 7):
        if signed_distance(shape, way[tip, 0], way[tip, 1]) <= robot.tip_radius:
            return False
    for tip, opposite in ((3, 4), (7, 0)):
        x, y = 0.5 * (way[opposite, 0] - way[tip, 0]), 0.5 * (way[opposite, 1] - way[tip, 1])
        if max(signed_distance(shape, x, y), signed_distance(shape, -x, -y)) > robot.tip_radius:
            return False
    winding = 0.0
    for place in range(8):
        x, y = way[place, 0], way[place, 1]
        next_x, next_y = way[(place + 1) % 8, 0], way[(place + 1) % 8, 1]
        winding += math.atan2(cross(x, y, next_x, next_y), x * next_x + y * next_y)
    return bool(abs(winding) > math.pi)


@compiled
def _way_around(robot: RobotModel, hand_pose: FloatArray, target_pose: FloatArray) -> FloatArray:
    """Along the left hand from tip to tip, then along the right, in the target's frame [m], shape (8, 2).

    The hands face each other, so that the second tip of one is beside the first of the other.
    """
    way = np.empty((8, 2))
    half, depth = robot.tip_offset, robot.link_length[JOINTS]
    cosine, sine = math.cos(target_pose[2]), math.sin(target_pose[2])
    for arm in range(2):
        c, s = math.cos(hand_pose[arm, 2]), math.sin(hand_pose[arm, 2])
        for place in range(4):
            x, y = half if place > 1 else -half, 0.0 if place in {0, 3} else -depth
            dx = hand_pose[arm, 0] + (c * x - s * y) - target_pose[0]
            dy = hand_pose[arm, 1] + (s * x + c * y) - target_pose[1]
            way[4 * arm + place, 0], way[4 * arm + place, 1] = cosine * dx + sine * dy, -sine * dx + cosine * dy
    return way


def cage(config: MissionConfig, hand_pose: FloatArray, target_pose: FloatArray) -> Cage:
    """Whether the hands at rest at these poses, shape (2, 3), cage the target, and by what margin.

    The search runs on a grid; its whole error, half a step in each direction, is taken off the margin, so
    that a positive margin is a proof up to rounding. Only the hands count, neither links nor base.
    """
    shape = target_shape(config.target)
    discs = _hand_discs(config.robot.arm, hand_pose)
    middle = discs[:, :2].mean(axis=0)
    discs[:, :2] -= middle
    reach = float(np.hypot(discs[:, 0], discs[:, 1]).max() + discs[:, 2].max() + shape.corner_circle)
    turns = max(1, round(shape.symmetry_angle / _ANGLE_STEP))
    step, turn = max(_POSITION_STEP, reach / _MOST_STEPS), shape.symmetry_angle / turns
    start = np.array([target_pose[0] - middle[0], target_pose[1] - middle[1], target_pose[2]])
    if max(abs(start[0]), abs(start[1])) >= reach:
        return Cage(caged=False, margin=-math.inf)
    clearance = _clearance_on_the_way_out(discs, packed(shape)[0], start, reach, step, turns)
    error = step / math.sqrt(2.0) + 0.5 * turn * shape.corner_circle
    margin = -clearance - error
    return Cage(caged=margin > 0.0, margin=margin)


def _hand_discs(arm: ArmConfig, hand_pose: FloatArray) -> FloatArray:
    """Tips, fingers and palms as discs (x, y, radius) [m], world, shape (n, 3)."""
    outline = hand_outline(arm)
    discs = []
    for pose in hand_pose:
        points = [np.array([pose[0], pose[1]]) + rotated(pose[2], *point) for point in outline]
        discs += [(*points[end], arm.hand.tip_radius) for end in (0, -1)]
        for start, end in pairwise(points):
            count = max(2, math.ceil(float(np.hypot(*(end - start))) / _OUTLINE_SPACING) + 1)
            discs += [(*(start + part * (end - start)), arm.hand.finger_radius) for part in np.linspace(0, 1, count)]
    return np.array(discs)


@compiled
def _clearance(discs: FloatArray, shape: Shape, x: float, y: float, angle: float) -> float:
    """Smallest distance [m] of the target at (x, y, angle) from the discs; negative where they overlap."""
    c, s = math.cos(angle), math.sin(angle)
    smallest = math.inf
    for disc in discs:
        dx, dy = disc[0] - x, disc[1] - y
        smallest = min(smallest, signed_distance(shape, c * dx + s * dy, -s * dx + c * dy) - disc[2])
    return smallest


@compiled
def _clearance_on_the_way_out(
    discs: FloatArray, shape: Shape, start: FloatArray, reach: float, step: float, turns: int
) -> float:
    """The smallest clearance [m] on the way out that keeps most clearance; best-first search on a grid.

    The grid spans (x, y) within `reach` of the hands' middle and the symmetry angle in that many turns, periodic.
    """
    n = 2 * math.ceil(reach / step) + 1
    turn = shape.symmetry_angle / turns
    i, j = round(start[0] / step) + n // 2, round(start[1] / step) + n // 2
    k = round((start[2] % shape.symmetry_angle) / turn) % turns if turn > 0.0 else 0
    visited = np.zeros((turns, n, n), np.bool_)
    visited[k, i, j] = True
    heap = [(-_clearance(discs, shape, (i - n // 2) * step, (j - n // 2) * step, k * turn), k, i, j)]
    rising, worst = True, math.inf
    while len(heap) > 0:
        negative, k, i, j = heappop(heap)
        if i in (0, n - 1) or j in (0, n - 1):
            return worst
        before = len(heap)
        for di, dj, dk in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)):
            a, b, c = i + di, j + dj, (k + dk) % turns
            if not visited[c, a, b]:
                visited[c, a, b] = True
                free = _clearance(discs, shape, (a - n // 2) * step, (b - n // 2) * step, c * turn)
                heappush(heap, (-free, c, a, b))
        # A target that still presses on a tip first rises to the clearest place nearby: that is not a way out.
        if rising and (len(heap) == before or heap[0][0] >= negative):
            rising = False
        if not rising:
            worst = min(worst, -negative)
    return -math.inf
