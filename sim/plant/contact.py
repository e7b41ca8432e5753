"""The contact law between a tip and the target: spring, damper, sliding friction (Sec. IV-A of the paper).

F_n = k_p delta + c_p d(delta)/dt, never pulling; F_t = -mu F_n sign(v), regularised as tanh(v / v_s). It is
evaluated at the predicted pose of the end of the step, which makes the explicit step symplectic: no energy
from an undamped bounce beyond 2e-4 (docs/decisions/0002-contact-law.md).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from sim.compiled import FloatArray, compiled
from sim.config import CornerContact
from sim.model.planar import in_frame, point_velocity, rotated
from sim.model.shape import Shape, facing_side, surface
from sim.record import Record, code_of

_FACE = code_of(CornerContact.FACE)


class TipContact(NamedTuple):
    """The contact of one tip, world axes; zero force where it does not touch."""

    touching: bool
    force_x: float
    """Target on tip [N]."""
    force_y: float
    point_x: float
    """Where the force acts [m]."""
    point_y: float


@compiled
def penetration(shape: Shape, radius: float, corner: int, x: float, y: float) -> tuple[float, float, float]:
    """Depth [m] of a tip in the target, and the outward normal of the target there, in the target's frame.

    Beside a corner a tip touches only within its radius of it: radially, or with the formula of the face that it
    penetrates least, if `CornerContact` chooses that and the shape is a square. Not touching: depth zero or less.

    Args:
        shape: of the target.
        radius: of the tip [m].
        corner: code of a `CornerContact`.
        x: tip centre in the target's frame [m].
        y: likewise.

    """
    distance, nx, ny = surface(shape, x, y)
    if corner == _FACE and shape.is_square and distance < radius:
        distance, nx, ny = facing_side(shape, x, y)
    return radius - distance, nx, ny


@compiled
def contact_force(
    stiffness: float,
    damping: float,
    friction: float,
    friction_speed: float,
    depth: float,
    nx: float,
    ny: float,
    vx: float,
    vy: float,
) -> tuple[float, float]:
    """Force on the first of two bodies that overlap [N], world axes.

    Args:
        stiffness: per depth [N/m].
        damping: per speed of approach [N s/m].
        friction: coefficient.
        friction_speed: at which friction reaches tanh(1) of its full value [m/s].
        depth: of the overlap [m].
        nx: the second body's outward normal.
        ny: likewise.
        vx: velocity of the first body's point relative to the second's [m/s].
        vy: likewise.

    """
    normal_force = max(0.0, stiffness * depth - damping * (vx * nx + vy * ny))
    sliding = -vx * ny + vy * nx
    tangential = -friction * normal_force * math.tanh(sliding / friction_speed)
    return normal_force * nx - tangential * ny, normal_force * ny + tangential * nx


@compiled
def tip_contact(
    law: Record,
    shape: Shape,
    radius: float,
    tip_x: float,
    tip_y: float,
    hand_pose: FloatArray,
    hand_twist: FloatArray,
    target_pose: FloatArray,
    target_twist: FloatArray,
) -> TipContact:
    """Force of the target on one tip.

    Args:
        law: record of `ContactConfig`.
        shape: of the target.
        radius: of the tip [m].
        tip_x: world position of the tip's centre [m].
        tip_y: likewise.
        hand_pose: of the body that carries the tip, shape (3,).
        hand_twist: of the same point of that body, shape (3,).
        target_pose: shape (3,).
        target_twist: shape (3,).

    """
    reach = shape.corner_circle + radius
    apart_x, apart_y = tip_x - target_pose[0], tip_y - target_pose[1]
    if apart_x * apart_x + apart_y * apart_y > reach * reach:
        return TipContact(False, 0.0, 0.0, tip_x, tip_y)
    x, y = in_frame(target_pose, tip_x, tip_y)
    depth, normal_u, normal_v = penetration(shape, radius, law.corner, x, y)
    if depth <= 0.0:
        return TipContact(False, 0.0, 0.0, tip_x, tip_y)
    nx, ny = rotated(target_pose[2], normal_u, normal_v)
    px, py = tip_x - radius * nx, tip_y - radius * ny
    hand_vx, hand_vy = point_velocity(hand_pose, hand_twist, px, py)
    target_vx, target_vy = point_velocity(target_pose, target_twist, px, py)
    fx, fy = contact_force(
        law.stiffness, law.damping, law.friction, law.friction_speed,
        depth, nx, ny, hand_vx - target_vx, hand_vy - target_vy,
    )  # fmt: skip
    return TipContact(True, fx, fy, px, py)
