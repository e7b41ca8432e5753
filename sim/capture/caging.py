"""Is the target caged? Two tests: the paper's, at the present angle, and the true one, over all motions.

`tips_enclose` asks whether the four tips close around the square if it only translates (object closure,
Wang and Kumar 2002). `cage` searches the square's configuration space (x, y, angle) for the way out of
the hands that needs the tips to give way least: that much is the margin of the cage.
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
from sim.model.planar import rotated
from sim.model.robot import RobotModel, tip_position
from sim.model.target import distance_from_square, in_target

_POSITION_STEP = 1.5e-3
_ANGLE_STEP = math.radians(1.0)
_QUARTER_TURN = math.pi / 2
_OUTLINE_SPACING = 12e-3  # between discs along fingers and palm: what they leave out only lessens the margin


class Cage(NamedTuple):
    """What the configuration-space search found."""

    caged: bool
    """No motion of the square, turning included, leads it out of the hands."""
    margin: float
    """How far the hands' surfaces would at least have to give way to let it out [m]; not positive if it is free."""


@compiled
def tips_enclose(robot: RobotModel, hand_pose: FloatArray, target_pose: FloatArray, side: float) -> bool:
    """Whether the tips close around the square at its present angle, its centre inside.

    In the square's frame a tip bars its centre from a square of side `side` + 2 r with rounded corners. Closed means:
    the bars of neighbouring tips of the two hands overlap, opposite tips leave room, the centre is in it.

    Args:
        robot: for the tips.
        hand_pose: both hands, shape (2, 3), world.
        target_pose: shape (3,), world.
        side: of the square [m].

    """
    width = side + 2.0 * robot.tip_radius
    apart = math.hypot(hand_pose[1, 0] - hand_pose[0, 0], hand_pose[1, 1] - hand_pose[0, 1])
    if apart > math.sqrt(2.0) * width + 2.0 * robot.tip_offset:  # no neighbouring tips can overlap
        return False
    pose = target_pose.copy()
    # The square's axes that lie between the hands' line and its normal: they tell which tips are neighbours.
    line = math.atan2(hand_pose[1, 1] - hand_pose[0, 1], hand_pose[1, 0] - hand_pose[0, 0])
    pose[2] = line + (target_pose[2] - line) % _QUARTER_TURN
    tips = np.empty((2, 2, 2))
    for arm in range(2):
        for tip in range(2):
            x, y = tip_position(robot, hand_pose[arm], tip)
            tips[arm, tip, 0], tips[arm, tip, 1] = in_target(pose, x, y)
    room_x = tips[1, 1, 0] - tips[0, 1, 0] - width
    room_y = tips[0, 0, 1] - tips[1, 0, 1] - width
    if room_x < 0.0 or room_y < 0.0:
        return False
    for tip in range(2):
        beyond_x = max(abs(tips[0, tip, 0] - tips[1, 1 - tip, 0]) - side, 0.0)
        beyond_y = max(abs(tips[0, tip, 1] - tips[1, 1 - tip, 1]) - side, 0.0)
        if math.hypot(beyond_x, beyond_y) > 2.0 * robot.tip_radius:
            return False
    from_left = -tips[0, 1, 0] - 0.5 * width
    from_above = tips[0, 0, 1] - 0.5 * width
    return bool(0.0 < from_left < room_x and 0.0 < from_above < room_y)


def cage(config: MissionConfig, hand_pose: FloatArray, target_pose: FloatArray) -> Cage:
    """Whether the hands at rest at these poses, shape (2, 3), cage the target, and by what margin.

    The search runs on a grid; its whole error, half a step in each direction, is taken off the margin, so
    that a positive margin is a proof up to rounding. Only the hands count, neither links nor base.
    """
    discs = _hand_discs(config.robot.arm, hand_pose)
    middle = discs[:, :2].mean(axis=0)
    discs[:, :2] -= middle
    half_side = config.target.side / 2
    reach = float(np.hypot(discs[:, 0], discs[:, 1]).max() + discs[:, 2].max() + half_side * math.sqrt(2.0))
    start = np.array([target_pose[0] - middle[0], target_pose[1] - middle[1], target_pose[2] % _QUARTER_TURN])
    if max(abs(start[0]), abs(start[1])) >= reach:
        return Cage(caged=False, margin=-math.inf)
    clearance = _clearance_on_the_way_out(discs, half_side, start, reach, _POSITION_STEP, _ANGLE_STEP)
    error = _POSITION_STEP / math.sqrt(2.0) + 0.5 * _ANGLE_STEP * half_side * math.sqrt(2.0)
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
def _clearance(discs: FloatArray, half_side: float, x: float, y: float, angle: float) -> float:
    """Smallest distance [m] of the square at (x, y, angle) from the discs; negative where they overlap."""
    c, s = math.cos(angle), math.sin(angle)
    smallest = math.inf
    for disc in discs:
        dx, dy = disc[0] - x, disc[1] - y
        smallest = min(smallest, distance_from_square(half_side, c * dx + s * dy, -s * dx + c * dy) - disc[2])
    return smallest


@compiled
def _clearance_on_the_way_out(
    discs: FloatArray, half_side: float, start: FloatArray, reach: float, step: float, turn: float
) -> float:
    """The smallest clearance [m] on the way out that keeps most clearance; best-first search on a grid.

    The grid spans (x, y) within `reach` of the hands' middle and the quarter turn of the angle, periodic.
    """
    n = 2 * math.ceil(reach / step) + 1
    turns = round(_QUARTER_TURN / turn)
    i, j, k = round(start[0] / step) + n // 2, round(start[1] / step) + n // 2, round(start[2] / turn) % turns
    seen = np.zeros((turns, n, n), np.bool_)
    seen[k, i, j] = True
    heap = [(-_clearance(discs, half_side, (i - n // 2) * step, (j - n // 2) * step, k * turn), k, i, j)]
    rising, worst = True, math.inf
    while len(heap) > 0:
        negative, k, i, j = heappop(heap)
        if i in (0, n - 1) or j in (0, n - 1):
            return worst
        before = len(heap)
        for di, dj, dk in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)):
            a, b, c = i + di, j + dj, (k + dk) % turns
            if not seen[c, a, b]:
                seen[c, a, b] = True
                free = _clearance(discs, half_side, (a - n // 2) * step, (b - n // 2) * step, c * turn)
                heappush(heap, (-free, c, a, b))
        # A square that still presses on a tip first rises to the clearest place nearby: that is not a way out.
        if rising and (len(heap) == before or heap[0][0] >= negative):
            rising = False
        if not rising:
            worst = min(worst, -negative)
    return -math.inf
