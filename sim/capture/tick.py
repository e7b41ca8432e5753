"""One tick as it is recorded: `TICK`, a structured array type, and its columns with their units.

Every consumer (recorder, telemetry, scene, plots, replay) reads this one record. Poses and twists are
in world axes; hands are their centres; wrenches and forces are what the target does to the hand. What is
`perceived` is what the controller knew; all else is the truth, of a robot as far as it can be known.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

ARMS = ("left", "right")
POSE_AXES = (("x", "m"), ("y", "m"), ("angle", "rad"))
TWIST_AXES = (("x", "m/s"), ("y", "m/s"), ("angle", "rad/s"))
WRENCH_AXES = (("x", "N"), ("y", "N"), ("torque", "N m"))
JOINTS = ("1", "2", "3")


class Quantity(NamedTuple):
    """One field of `TICK`."""

    name: str
    group: str
    """`mission`, `base`, `target`, `system`, or `arm`: then the leading axis is (left, right)."""
    kind: str
    """Numpy type of an element."""
    axes: tuple[tuple[str, str], ...] = ()
    """(axis, unit) of each element; empty for a scalar."""
    unit: str = "1"
    """Unit of a scalar."""
    shape: tuple[int, ...] = ()
    """Shape within the group, if it is not simply the number of axes."""


def _joint_axes(unit: str) -> tuple[tuple[str, str], ...]:
    return tuple((joint, unit) for joint in JOINTS)


_TIP_FORCES = (("tip_1.x", "N"), ("tip_1.y", "N"), ("tip_2.x", "N"), ("tip_2.y", "N"))

QUANTITIES = (
    Quantity("tick", "mission", "i8"),
    Quantity("time", "mission", "f8", unit="s"),
    Quantity("phase", "mission", "u1"),
    Quantity("activity", "mission", "u1"),
    Quantity("plan", "mission", "u2"),
    Quantity("closed", "mission", "u1"),
    Quantity("base_overlap", "mission", "u1"),
    Quantity("solid_contact", "mission", "u1"),
    Quantity("rate_limited", "mission", "u1"),
    Quantity("trouble", "mission", "u4"),
    Quantity("contact_expected", "arm", "u2"),
    Quantity("base_contact", "mission", "u4"),
    Quantity("tip_contact", "arm", "u1", (("tip_1", "1"), ("tip_2", "1"))),
    Quantity("perceived_closed", "mission", "u4"),
    Quantity("perceived_contact", "arm", "u2"),
    Quantity("base_pose", "base", "f8", POSE_AXES),
    Quantity("base_twist", "base", "f8", TWIST_AXES),
    Quantity("target_pose", "target", "f8", POSE_AXES),
    Quantity("target_twist", "target", "f8", TWIST_AXES),
    Quantity("joint_angle", "arm", "f8", _joint_axes("rad")),
    Quantity("joint_rate", "arm", "f8", _joint_axes("rad/s")),
    Quantity("mount_angle", "arm", "f8", unit="rad"),
    Quantity("mount_rate", "arm", "f8", unit="rad/s"),
    Quantity("commanded_joint_rate", "arm", "f8", _joint_axes("rad/s")),
    Quantity("hand_pose", "arm", "f8", POSE_AXES),
    Quantity("hand_twist", "arm", "f8", TWIST_AXES),
    Quantity("desired_hand_pose", "arm", "f8", POSE_AXES),
    Quantity("desired_hand_twist", "arm", "f8", TWIST_AXES),
    Quantity("hand_wrench", "arm", "f8", WRENCH_AXES),
    Quantity("tip_force", "arm", "f8", _TIP_FORCES, shape=(2, 2)),
    Quantity("base_perceived_pose", "base", "f8", POSE_AXES),
    Quantity("base_perceived_twist", "base", "f8", TWIST_AXES),
    Quantity("target_perceived_pose", "target", "f8", POSE_AXES),
    Quantity("target_perceived_twist", "target", "f8", TWIST_AXES),
    Quantity("target_perceived_twist_deviation", "target", "f8", TWIST_AXES),
    Quantity("target_perceived_inertia", "target", "f8", unit="kg m2"),
    Quantity("target_perceived_inertia_deviation", "target", "f8", unit="kg m2"),
    Quantity("perceived_hand_wrench", "arm", "f8", WRENCH_AXES),
    Quantity("wanted_force", "arm", "f8", unit="N"),
    Quantity("manipulability", "arm", "f8", unit="m2"),
    Quantity("momentum", "system", "f8", (("x", "N s"), ("y", "N s"), ("angular", "N m s"))),
)


def _dtype() -> np.dtype[Any]:
    fields: list[tuple[str, str] | tuple[str, str, tuple[int, ...]]] = []
    for quantity in QUANTITIES:
        inner = quantity.shape or ((len(quantity.axes),) if quantity.axes else ())
        shape = (len(ARMS), *inner) if quantity.group == "arm" else inner
        fields.append((quantity.name, quantity.kind, shape) if shape else (quantity.name, quantity.kind))
    return np.dtype(fields, align=True)


TICK = _dtype()
"""Without a gap between its fields, so that equal ticks are equal bytes."""


class TickColumn(NamedTuple):
    """One column of a table of ticks."""

    name: str
    """`group.quantity.axis`, for example `left.hand_wrench.x` or `target.twist.angle`."""
    unit: str
    quantity: str
    """The field of `TICK`."""
    place: tuple[int, ...]
    """Where in that field, after the tick's axis."""


def columns_of(quantity: Quantity) -> list[TickColumn]:
    """The columns of one field of `TICK`."""
    groups = [(name, (arm,)) for arm, name in enumerate(ARMS)] if quantity.group == "arm" else [(quantity.group, ())]
    columns: list[TickColumn] = []
    for group, leading in groups:
        stem = f"{group}.{quantity.name.removeprefix(group + '_')}"
        if not quantity.axes:
            columns.append(TickColumn(stem, quantity.unit, quantity.name, leading))
        for element, (axis, unit) in enumerate(quantity.axes):
            inner = tuple(int(i) for i in np.unravel_index(element, quantity.shape)) if quantity.shape else (element,)
            columns.append(TickColumn(f"{stem}.{axis}", unit, quantity.name, (*leading, *inner)))
    return columns


COLUMNS: tuple[TickColumn, ...] = tuple(column for quantity in QUANTITIES for column in columns_of(quantity))


def all_column_values(ticks: np.ndarray[Any, np.dtype[Any]]) -> Iterator[np.ndarray[Any, np.dtype[Any]]]:
    """The values of each of `COLUMNS` over an array of `TICK`, each contiguous, shape (ticks,)."""
    for quantity in QUANTITIES:
        width = math.prod(TICK[quantity.name].shape)
        yield from np.ascontiguousarray(ticks[quantity.name].reshape(len(ticks), width).T)


def column_values(ticks: np.ndarray[Any, np.dtype[Any]], column: TickColumn) -> np.ndarray[Any, np.dtype[Any]]:
    """The values of one column over an array of `TICK`, shape (ticks,)."""
    where: tuple[Any, ...] = (slice(None), *column.place)
    values: np.ndarray[Any, np.dtype[Any]] = ticks[column.quantity][where]
    return values
