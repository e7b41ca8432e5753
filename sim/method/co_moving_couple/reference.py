"""Where both hands should be at any time of a candidate: what the planner rolls out, and the controller follows.

Stand-off, entry, touch, retreat, regrasp, closing: before contact in the world, from then on as seen from the target.
"""

from __future__ import annotations

import math

from sim.compiled import FloatArray, compiled
from sim.control.trajectory import time_scaling
from sim.method.co_moving_couple.geometry import (
    HALF_TURN,
    hand_at_tip,
    tip_distance,
    tip_on_face,
    touching_tip,
)
from sim.method.co_moving_couple.memory import CoupleHandle
from sim.model.planar import folded
from sim.model.robot import RobotModel, tip_position
from sim.record import Record

ENTRY_GAP = 0.002
"""At the end of the entry a tip is so far from its face [m]."""
OUTWARD = 0.015
"""How far a hand draws back between two touches [m]."""
DRAWING_BACK = 0.6
"""How long hands draw back when something went otherwise than planned [s]."""
LIFTING, LIFTED = 0.05, 0.004
"""Before a closing hands lift off their sides, so long [s] and so far [m]."""


@compiled
def entry_time(spin: float) -> float:
    """How long hands take from the stand-off to the faces [s]."""
    return min(0.5, max(0.2, 0.7 / max(1e-3, abs(spin))))


@compiled
def approach_speed(touch: Record, force: float) -> float:
    """Speed of the guarded approach [m/s]: so slow that the first contact is no harder than the wanted force."""
    return min(0.045, max(0.015, float(force / touch.approach_damping)))


@compiled
def touch_angle(arm: int, plan: Record) -> float:
    """Angle of a hand that touches [rad]: kept while its side turns, so that the wrist need not."""
    return float(plan.hand_angle if arm == 1 else plan.hand_angle - HALF_TURN)


@compiled
def stand_off_pose(
    handle: CoupleHandle, plan: Record, parameters: Record, sense: float, arm: int,
    centre_x: float, centre_y: float, pose: FloatArray,
) -> None:  # fmt: skip
    """Where a hand waits for its face, shape (3,): in the direction of the contact, outside the corners' circle."""
    robot, shape = handle.fixed[0].robot, handle.fixed[0].shape
    out = tip_distance(shape, plan.side, robot)
    normal = plan.contact_angle if arm == 1 else plan.contact_angle - HALF_TURN
    direction = normal - sense * math.atan2(plan.lever_start, out)
    radius = shape.corner_circle + robot.tip_radius + parameters.co_moving_couple.search.stand_off
    angle = touch_angle(arm, plan)
    tip_x, tip_y = centre_x + radius * math.cos(direction), centre_y + radius * math.sin(direction)
    hand_at_tip(robot, touching_tip(sense), tip_x, tip_y, angle, pose)


@compiled
def touch_pose(
    handle: CoupleHandle, plan: Record, sense: float, arm: int, normal_angle: float, gap: float, centre_x: float,
    centre_y: float, pose: FloatArray,
) -> None:  # fmt: skip
    """Where a hand is whose tip follows the side that the right hand's normal angle [rad] tells, shape (3,)."""
    robot, shape = handle.fixed[0].robot, handle.fixed[0].shape
    normal = normal_angle if arm == 1 else normal_angle - HALF_TURN
    lever = lever_at(plan, sense, normal_angle)
    out = tip_distance(shape, plan.side, robot) + gap
    tip_x, tip_y = tip_on_face(out, lever, sense, normal, centre_x, centre_y)
    hand_at_tip(robot, touching_tip(sense), tip_x, tip_y, touch_angle(arm, plan), pose)


@compiled
def lever_at(plan: Record, sense: float, normal_angle: float) -> float:
    """The lever planned for that normal angle [m]."""
    arc = sense * (plan.end_angle - plan.contact_angle)
    part = 0.0 if arc <= 0.0 else sense * (normal_angle - plan.contact_angle) / arc
    return float(plan.lever_start + min(1.0, max(0.0, part)) * (plan.lever_end - plan.lever_start))


@compiled
def corner_towards(shape: Record, target_angle: float, direction: float) -> float:
    """The corner of the target, an angle in its frame [rad], that is nearest to a direction in the world [rad].

    A round target is as good in every direction.
    """
    if shape.sides == 0:
        return direction - target_angle
    best, least = 0.0, math.inf
    for corner in range(shape.corners):
        angle = math.atan2(shape.vertices[corner, 1], shape.vertices[corner, 0])
        apart = folded(angle + target_angle - direction, 2.0 * math.pi)
        if abs(apart) < least:
            best, least = direction + apart - target_angle, abs(apart)
    return best


@compiled
def drawn_back(start: FloatArray, robot: RobotModel, tip: int, way: float, pose: FloatArray) -> None:
    """A hand drawn back from a pose by some way [m], shape (3,), as seen from the target: its tip goes outwards."""
    side = robot.tip_offset if tip == 1 else -robot.tip_offset
    x, y = start[0] + side * math.cos(start[2]), start[1] + side * math.sin(start[2])
    far = math.hypot(x, y)
    pose[0], pose[1] = start[0] + way * x / far, start[1] + way * y / far
    pose[2] = start[2]


@compiled
def enter(
    robot: RobotModel, tip: int, start: FloatArray, met: FloatArray, twist: FloatArray, x: float, y: float,
    whole: float, part: float, pose: FloatArray,
) -> None:  # fmt: skip
    """A hand on its way in, shape (3,): from rest at one pose, until at the other its tip moves with the side.

    The hand does not turn meanwhile, so that all of it moves as its tip does.

    Args:
        robot: for the tip.
        tip: that will touch.
        start: pose where the entry begins, shape (3,).
        met: pose at the side, shape (3,).
        twist: of the target, shape (3,).
        x: of its centre at the entry's end [m].
        y: likewise.
        whole: how long the entry takes [s].
        part: of that time, 0 to 1.
        pose: the result.

    """
    part = min(1.0, max(0.0, part))
    s, _ = time_scaling(part)
    v = part * part * (part - 1.0)  # of cubic Hermite interpolation: the weight of the velocity at the end
    tip_x, tip_y = tip_position(robot, met, tip)
    pose[0] = start[0] + s * (met[0] - start[0]) + v * whole * (twist[0] - twist[2] * (tip_y - y))
    pose[1] = start[1] + s * (met[1] - start[1]) + v * whole * (twist[1] + twist[2] * (tip_x - x))
    pose[2] = start[2] + s * (met[2] - start[2])


@compiled
def between(start: FloatArray, end: FloatArray, part: float, pose: FloatArray) -> None:
    """A pose on the straight way, shape (3,); the part is scaled so that the way begins and ends at rest."""
    s, _ = time_scaling(min(1.0, max(0.0, part)))
    for axis in range(3):
        pose[axis] = start[axis] + s * (end[axis] - start[axis])


@compiled
def closing_radius(handle: CoupleHandle, closing: Record, gap: float, since: float) -> float:
    """Where a hand's centre should be, from the target's [m], that began so far before touching and so long ago [s]."""
    if since < closing.fast_time:
        s, _ = time_scaling(since / closing.fast_time)
        return float(handle.fixed[0].touch_radius + gap + s * (closing.slow_gap - gap))
    return float(handle.fixed[0].touch_radius + closing.slow_gap - closing.slow_speed * (since - closing.fast_time))
