"""Where hands belong on a target: tips on its faces, hands before its corners. World axes unless said otherwise.

The right hand touches a side of the target, the left hand the opposite one. A side's *normal angle* is that of its
outward normal. A tip's *lever* is how far it is from the foot of the centre on its side, counted towards the half that
comes out to meet the hand (the trailing half), so that pressing there brakes.
"""

from __future__ import annotations

import math

from sim.compiled import FloatArray, compiled
from sim.model.planar import rotated
from sim.model.robot import RobotModel
from sim.model.shape import Shape, signed_distance
from sim.record import Record

HALF_TURN = math.pi
QUARTER_TURN = 0.5 * math.pi
_HALVINGS = 50


@compiled
def closed_radius(robot: RobotModel, shape: Shape) -> float:
    """How far a hand's centre is from that of a target whose corner it faces, where both its tips touch [m].

    By bisection, from as far out as a tip reaches to where a tip's centre lies on the corner's own circle.
    """
    corner = math.atan2(shape.vertices[0, 1], shape.vertices[0, 0])
    near, far = 0.0, shape.corner_circle + robot.tip_radius
    for _ in range(_HALVINGS):
        middle = 0.5 * (near + far)
        x, y = rotated(corner, middle, robot.tip_offset)
        if signed_distance(shape, x, y) > robot.tip_radius:
            far = middle
        else:
            near = middle
    return far


@compiled
def frame_angle(shape: Record, target_pose: FloatArray) -> float:
    """The target's angle that hands go by [rad]; a round one has none, and hands stay where they are while it turns."""
    return float(target_pose[2]) if shape.sides > 0 else 0.0


@compiled
def round_torque(robot: RobotModel, shape: Record, force: float, friction: float) -> float:
    """With which friction brakes a round target that both hands press on with all their tips [N m].

    Each of a hand's two tips presses with F / (2 cos a) towards the centre, a being how far it is aside; friction has
    the target's radius as its lever, at four tips.

    Args:
        robot: for the tips.
        shape: of the target.
        force: of a hand [N].
        friction: coefficient.

    """
    aside = robot.tip_offset / (shape.corner_circle + robot.tip_radius)
    return float(2.0 * friction * force * shape.corner_circle / math.sqrt(1.0 - aside * aside))


@compiled
def touching_tip(sense: float) -> int:
    """The tip of both hands that touches a target which spins in that sense (+1, -1)."""
    return 1 if sense > 0.0 else 0


@compiled
def tip_distance(shape: Record, side: int, robot: RobotModel) -> float:
    """From the target's centre, along a side's normal, to the centre of a tip that just touches it [m]."""
    return float(shape.offsets[side] + shape.rounding + robot.tip_radius)


@compiled
def half_side(shape: Record, side: int, sense: float) -> float:
    """From the foot of the centre on a side to its end, on the half that pressing brakes [m]."""
    nx, ny = shape.normals[side, 0], shape.normals[side, 1]
    end = side if sense > 0.0 else (side + 1) % shape.corners
    along = -ny * shape.vertices[end, 0] + nx * shape.vertices[end, 1]
    return float(-sense * along)


@compiled
def tip_on_face(
    distance: float, lever: float, sense: float, normal_angle: float, centre_x: float, centre_y: float
) -> tuple[float, float]:
    """Centre of a tip [m] at that distance along the normal and that lever."""
    dx, dy = rotated(normal_angle, distance, -sense * lever)
    return centre_x + dx, centre_y + dy


@compiled
def hand_at_tip(robot: RobotModel, tip: int, tip_x: float, tip_y: float, angle: float, pose: FloatArray) -> None:
    """The pose of a hand at that angle [rad] whose tip has its centre there, shape (3,)."""
    dx, dy = rotated(angle, robot.tip_offset if tip == 1 else -robot.tip_offset, 0.0)
    pose[0], pose[1], pose[2] = tip_x - dx, tip_y - dy, angle


@compiled
def hand_before_corner(
    arm: int, corner_angle: float, radius: float, centre_x: float, centre_y: float, pose: FloatArray
) -> None:
    """The pose of a hand that faces the target's centre, shape (3,); the right one at that angle [rad]."""
    outward = corner_angle if arm == 1 else corner_angle - HALF_TURN
    pose[0], pose[1] = centre_x + radius * math.cos(outward), centre_y + radius * math.sin(outward)
    pose[2] = outward + QUARTER_TURN


@compiled
def to_target(target_pose: FloatArray, pose: FloatArray, relative: FloatArray) -> None:
    """A pose as seen from the target, shape (3,)."""
    dx, dy = pose[0] - target_pose[0], pose[1] - target_pose[1]
    relative[0], relative[1] = rotated(-target_pose[2], dx, dy)
    relative[2] = pose[2] - target_pose[2]


@compiled
def from_target(target_pose: FloatArray, relative: FloatArray, pose: FloatArray) -> None:
    """A pose that is seen so from the target, in the world, shape (3,)."""
    dx, dy = rotated(target_pose[2], relative[0], relative[1])
    pose[0], pose[1], pose[2] = target_pose[0] + dx, target_pose[1] + dy, target_pose[2] + relative[2]
