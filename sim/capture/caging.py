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
from typing import NamedTuple

import numpy as np

from sim.compiled import FloatArray, IntArray, compiled, compiled_inline
from sim.config import MissionConfig
from sim.model.clearance import hand_outline
from sim.model.planar import cross, direction, rotated
from sim.model.robot import JOINTS, RobotModel
from sim.model.shape import Shape, signed_distance, surface
from sim.model.target import target_shape
from sim.record import packed

_POSITION_STEP = 1.5e-3
_ANGLE_STEP = math.radians(1.0)
_MOST_STEPS = 400  # from the hands' middle outwards: what is larger has a coarser grid, and the margin its error
_ABREAST = 4  # sides of a shape
_BITS = 64  # of a word that says which places have been looked at
_ROOM = 4096  # places that wait in a search, before its arrays grow
_ROUNDING = 1e-9  # by which a bound may be above what it bounds, at most [m]
_OUTLINE_SPACING = 12e-3  # between discs along fingers and palm: what they leave out only lessens the margin


class Cage(NamedTuple):
    """What the configuration-space search found."""

    caged: bool
    """No motion of the target, turning included, leads it out of the hands."""
    margin: float
    """How far the hands' surfaces would at least have to give way to let it out [m]; not positive if it is free."""


@compiled_inline
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
    apart_x, apart_y = hand_pose[1, 0] - hand_pose[0, 0], hand_pose[1, 1] - hand_pose[0, 1]
    overlapping = 2.0 * (shape.corner_circle + robot.tip_radius + robot.tip_offset)
    if apart_x * apart_x + apart_y * apart_y > overlapping * overlapping:  # no tips of two hands can overlap
        return False
    return _tips_surround(robot, shape, hand_pose, target_pose)


@compiled
def _tips_surround(robot: RobotModel, shape: Shape, hand_pose: FloatArray, target_pose: FloatArray) -> bool:
    """`tips_enclose` of hands that are near enough to each other."""
    left, right = _way_along(robot, hand_pose[0], target_pose), _way_along(robot, hand_pose[1], target_pose)
    for x, y in (left[0], left[3], right[0], right[3]):
        if signed_distance(shape, x, y) <= robot.tip_radius:
            return False
    windings = 0
    for tip, opposite in ((left[3], right[0]), (right[3], left[0])):
        barred, x, y = barred_by_both(shape, robot.tip_radius, tip[0], tip[1], opposite[0], opposite[1])
        if not barred:
            return False
        windings += _crossing(tip, (x, y)) + _crossing((x, y), opposite)
    for place in range(3):
        windings += _crossing(left[place], left[place + 1]) + _crossing(right[place], right[place + 1])
    return windings != 0


_Point = tuple[float, float]


@compiled
def _crossing(start: _Point, end: _Point) -> int:
    """Whether a straight way crosses the half line from the origin along +x: upwards 1, downwards -1, else 0."""
    upwards = start[1] <= 0.0
    if upwards == (end[1] <= 0.0):
        return 0
    turn = cross(start[0], start[1], end[0], end[1])
    if upwards:
        return 1 if turn > 0.0 else 0
    return -1 if turn < 0.0 else 0


@compiled
def barred_by_both(
    shape: Shape, radius: float, x: float, y: float, other_x: float, other_y: float
) -> tuple[bool, float, float]:
    """Whether two tips bar the target's centre from a common place, and that place [m]; all in the target's axes.

    The middle between the tips is such a place, if any is, of a shape that is the same after half a turn. Of another
    shape the regions are two polygons, turned by half a turn about the tips, and rounded: they overlap if a corner of
    one is near enough to the other, and then halfway between. (If two polygons of one shape and attitude overlap, one
    has a corner in the other; if not, a corner is as near as any of their points.)

    Args:
        shape: of the target.
        radius: of the tips [m].
        x: of a tip [m].
        y: likewise.
        other_x: of the other tip [m].
        other_y: likewise.

    """
    between_x, between_y = 0.5 * (x + other_x), 0.5 * (y + other_y)
    half_x, half_y = 0.5 * (other_x - x), 0.5 * (other_y - y)
    if max(signed_distance(shape, half_x, half_y), signed_distance(shape, -half_x, -half_y)) <= radius:
        return True, between_x, between_y
    halves = math.pi / shape.symmetry_angle if shape.symmetry_angle > 0.0 else 1.0
    if abs(halves - math.floor(halves + 0.5)) < 1e-9:
        return False, 0.0, 0.0
    nearest, aside_x, aside_y = 2.0 * (radius + shape.rounding), math.nan, math.nan
    for sign in (-1.0, 1.0):
        for corner in range(shape.corners):
            from_x, from_y = shape.vertices[corner, 0], shape.vertices[corner, 1]
            gap, normal_x, normal_y = surface(shape, from_x - 2.0 * sign * half_x, from_y - 2.0 * sign * half_y)
            gap = max(gap + shape.rounding, 0.0)
            if gap <= nearest:
                nearest = gap
                aside_x, aside_y = sign * half_x - from_x, sign * half_y - from_y
                aside_x, aside_y = aside_x + 0.5 * gap * normal_x, aside_y + 0.5 * gap * normal_y
    return not math.isnan(aside_x), between_x + aside_x, between_y + aside_y


@compiled
def _way_along(
    robot: RobotModel, hand_pose: FloatArray, target_pose: FloatArray
) -> tuple[_Point, _Point, _Point, _Point]:
    """Along a hand from tip to tip, in the target's frame [m].

    The hands face each other, so that the second tip of one is beside the first of the other.
    """
    half, depth = robot.tip_offset, robot.link_length[JOINTS]
    from_target = hand_pose[0] - target_pose[0], hand_pose[1] - target_pose[1]
    cosine, sine = direction(target_pose[2])
    c, s = direction(hand_pose[2])
    return (
        _placed(from_target, c, s, cosine, sine, -half, 0.0),
        _placed(from_target, c, s, cosine, sine, -half, -depth),
        _placed(from_target, c, s, cosine, sine, half, -depth),
        _placed(from_target, c, s, cosine, sine, half, 0.0),
    )


@compiled
def _placed(origin: _Point, c: float, s: float, cosine: float, sine: float, x: float, y: float) -> _Point:
    """A hand's point (x, y) in the target's frame: the hand's origin from the target's, and their axes in the world."""
    dx, dy = origin[0] + (c * x - s * y), origin[1] + (s * x + c * y)
    return cosine * dx + sine * dy, -sine * dx + cosine * dy


def cage(config: MissionConfig, hand_pose: FloatArray, target_pose: FloatArray) -> Cage:
    """Whether the hands at rest at these poses, shape (2, 3), cage the target, and by what margin.

    The search runs on a grid; its whole error, half a step in each direction, is taken off the margin, so
    that a positive margin is a proof up to rounding. Only the hands count, neither links nor base.
    """
    shape = target_shape(config.target)
    hand = config.robot.arm.hand
    discs = _hand_discs(hand_outline(config.robot.arm), hand.tip_radius, hand.finger_radius, hand_pose)
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


@compiled
def _hand_discs(outline: FloatArray, tip_radius: float, finger_radius: float, hand_pose: FloatArray) -> FloatArray:
    """Tips, fingers and palms as discs (x, y, radius) [m], world, shape (n, 3).

    Args:
        outline: of a hand in its own frame, shape (points, 2) [m]; tips are at its ends.
        tip_radius: [m].
        finger_radius: of the rest [m].
        hand_pose: of both hands, shape (2, 3), world.

    """
    discs, points = [(0.0, 0.0, 0.0) for _ in range(0)], np.empty_like(outline)
    for arm in range(2):
        for place in range(len(outline)):
            dx, dy = rotated(hand_pose[arm, 2], outline[place, 0], outline[place, 1])
            points[place, 0], points[place, 1] = hand_pose[arm, 0] + dx, hand_pose[arm, 1] + dy
        for x, y in (points[0], points[-1]):
            discs.append((x, y, tip_radius))
        for place in range(len(outline) - 1):
            (x, y), (along_x, along_y) = points[place], points[place + 1] - points[place]
            count = max(2, math.ceil(math.hypot(along_x, along_y) / _OUTLINE_SPACING) + 1)
            for part in np.linspace(0.0, 1.0, count):
                discs.append((x + part * along_x, y + part * along_y, finger_radius))
    return np.array(discs)


class _Grid(NamedTuple):
    """The grid that is searched: (x, y) about the hands' middle and the symmetry angle, periodic."""

    size: int
    """Places along x and along y; odd."""
    step: float
    """Between two of them [m]."""
    turns: int
    """Places of the angle."""
    turn: float
    """Between two of them [rad]."""
    cosine: FloatArray
    """Of each, shape (turns,)."""
    sine: FloatArray
    normals: FloatArray
    """Of the shape's sides at each angle, shape (turns, sides, 2), with zeros up to a multiple of `_ABREAST` sides."""
    beyond: FloatArray
    """How far each disc's edge would be outside of each side's line if the target were in the middle [m].

    Shape (turns, sides, discs), and minus infinity where there is no side. What a target aside has less is the same for
    all discs: one subtraction gives the distance from a side's line, and the largest of these is the least that the
    distance from the shape can be.
    """


@compiled
def _grid(discs: FloatArray, shape: Shape, size: int, step: float, turns: int) -> _Grid:
    """A grid of that size, step [m] and turns."""
    turn = shape.symmetry_angle / turns
    cosine, sine = np.empty(turns), np.empty(turns)
    rows = _ABREAST * math.ceil(shape.sides / _ABREAST)
    normals, beyond = np.zeros((turns, rows, 2)), np.full((turns, rows, discs.shape[0]), -math.inf)
    for k in range(turns):
        c, s = cosine[k], sine[k] = direction(k * turn)
        for side in range(shape.sides):
            x, y = shape.normals[side, 0], shape.normals[side, 1]
            nx, ny = normals[k, side] = c * x - s * y, s * x + c * y
            for place in range(discs.shape[0]):
                along = nx * discs[place, 0] + ny * discs[place, 1]
                beyond[k, side, place] = along - shape.offsets[side] - shape.rounding - discs[place, 2]
    return _Grid(size, step, turns, turn, cosine, sine, normals, beyond)


@compiled
def _clearance(
    discs: FloatArray, shape: Shape, grid: _Grid, i: int, j: int, k: int, nearest: int, least: FloatArray
) -> tuple[float, int]:
    """Smallest distance [m] of the target at a place of the grid from the discs, and of which disc; negative inside.

    Args:
        discs: (x, y, radius) [m], shape (n, 3).
        shape: of the target.
        grid: that is searched.
        i: place along x.
        j: along y.
        k: of the angle.
        nearest: the disc that is looked at first: the nearer it is, the fewer of the others are.
        least: scratch, shape (n,).

    """
    x, y = (i - grid.size // 2) * grid.step, (j - grid.size // 2) * grid.step
    c, s = grid.cosine[k], grid.sine[k]
    _find_least(grid, x, y, k, least)
    smallest = _distance(discs, shape, x, y, c, s, nearest)
    least[nearest] = math.inf
    for place in range(least.shape[0]):
        if least[place] < smallest:
            away = _distance(discs, shape, x, y, c, s, place)
            if away < smallest:
                smallest, nearest = away, place
    return smallest, nearest


@compiled_inline
def _find_least(grid: _Grid, x: float, y: float, k: int, least: FloatArray) -> None:
    """The least that each disc's distance from the target there can be [m]: four sides abreast, all discs at once."""
    least[:] = -math.inf
    for first in range(0, grid.beyond.shape[1], _ABREAST):
        normals, beyond = grid.normals[k, first : first + _ABREAST], grid.beyond[k, first : first + _ABREAST]
        a, b = normals[0, 0] * x + normals[0, 1] * y + _ROUNDING, normals[1, 0] * x + normals[1, 1] * y + _ROUNDING
        c, d = normals[2, 0] * x + normals[2, 1] * y + _ROUNDING, normals[3, 0] * x + normals[3, 1] * y + _ROUNDING
        for place in range(least.shape[0]):
            largest = max(beyond[0, place] - a, beyond[1, place] - b, beyond[2, place] - c, beyond[3, place] - d)
            least[place] = max(least[place], largest)


@compiled_inline
def _distance(discs: FloatArray, shape: Shape, x: float, y: float, c: float, s: float, place: int) -> float:
    """Of the target there, turned by the angle of that cosine and sine, from a disc [m]."""
    dx, dy = discs[place, 0] - x, discs[place, 1] - y
    return float(signed_distance(shape, c * dx + s * dy, c * dy - s * dx) - discs[place, 2])


@compiled
def _clearance_on_the_way_out(
    discs: FloatArray, shape: Shape, start: FloatArray, reach: float, step: float, turns: int
) -> float:
    """The smallest clearance [m] on the way out that keeps most clearance; best-first search on a grid.

    The grid spans (x, y) within `reach` of the hands' middle and the symmetry angle in that many turns, periodic.
    """
    n, count, least = 2 * math.ceil(reach / step) + 1, discs.shape[0], np.empty(discs.shape[0])
    grid = _grid(discs, shape, n, step, turns)
    seen = np.zeros(n * n * turns // _BITS + 1, np.int64)  # a bit a place: bytes would take longer to clear than to use
    keys, places, waiting = np.empty(_ROOM), np.empty(_ROOM, np.int64), 0
    i, j = round(start[0] / step) + n // 2, round(start[1] / step) + n // 2
    k = round((start[2] % shape.symmetry_angle) / grid.turn) % turns if grid.turn > 0.0 else 0
    _see(seen, (k * n + i) * n + j)
    free, nearest = _clearance(discs, shape, grid, i, j, k, 0, least)
    waiting = _push(keys, places, waiting, -free, ((k * n + i) * n + j) * count + nearest)
    rising, worst = True, math.inf
    while waiting > 0:
        negative, place, nearest = keys[0], places[0] // count, places[0] % count
        i, j, k = place // n % n, place % n, place // (n * n)
        waiting = _drop_first(keys, places, waiting)
        if i in (0, n - 1) or j in (0, n - 1):
            return worst
        before = waiting
        if waiting + 6 > len(keys):
            keys, places = np.concatenate((keys, keys)), np.concatenate((places, places))
        for di, dj, dk in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)):
            a, b, c = i + di, j + dj, (k + dk) % turns
            if _see(seen, (c * n + a) * n + b):
                free, there = _clearance(discs, shape, grid, a, b, c, nearest, least)
                waiting = _push(keys, places, waiting, -free, ((c * n + a) * n + b) * count + there)
        # A target that still presses on a tip first rises to the clearest place nearby: that is not a way out.
        if rising and (waiting == before or keys[0] >= negative):
            rising = False
        if not rising:
            worst = min(worst, -negative)
    return -math.inf


@compiled_inline
def _see(seen: IntArray, place: int) -> bool:
    """Note that a place has been looked at; whether it had not been before."""
    word, bit = place // _BITS, np.int64(1) << (place % _BITS)
    if seen[word] & bit:
        return False
    seen[word] |= bit
    return True


@compiled
def _push(keys: FloatArray, places: IntArray, waiting: int, key: float, place: int) -> int:
    """Put a place into the binary heap of those that wait, the smallest key first; how many there are now.

    (A heap of Python's own takes twice as long, compiled.)
    """
    _rise(keys, places, waiting, key, place)
    return waiting + 1


@compiled
def _drop_first(keys: FloatArray, places: IntArray, waiting: int) -> int:
    """Take the first place out of the heap; how many wait still."""
    waiting -= 1
    at, child = 0, 1
    while child < waiting:
        other = child + 1
        child += other < waiting and _precedes(keys[other], places[other], keys[child], places[child])
        keys[at], places[at] = keys[child], places[child]
        at, child = child, 2 * child + 1
    _rise(keys, places, at, keys[waiting], places[waiting])
    return waiting


@compiled_inline
def _rise(keys: FloatArray, places: IntArray, at: int, key: float, place: int) -> None:
    """Put a place where the heap has an empty one, or above it, where it belongs."""
    while at > 0:
        above = (at - 1) // 2
        if _precedes(keys[above], places[above], key, place):
            break
        keys[at], places[at] = keys[above], places[above]
        at = above
    keys[at], places[at] = key, place


@compiled_inline
def _precedes(key: float, place: int, other_key: float, other_place: int) -> bool:
    """Whether one comes before another: the same search, whatever the order in which equal ones were found."""
    return bool((key < other_key) | ((key == other_key) & (place < other_place)))
