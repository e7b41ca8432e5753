"""What the co-moving couple remembers beside what all methods do: `COUPLE_MEMORY`; its activities and kinds of plan."""

from __future__ import annotations

from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np

from sim.model.generalized_jacobian import JOINT_RATES
from sim.model.reduced_model import CHAIN, FREE, SHAPE
from sim.model.robot import RobotModel
from sim.model.shape import Shape


class Activity(IntEnum):
    """What the hands are doing within a phase."""

    NONE = 0
    ESTIMATING = 1
    """Base and target are watched, joints held, and plans are rolled out, one a tick."""
    APPROACHING = 2
    """Both hands go to where they wait for the faces, outside the circle that the corners sweep."""
    ENTERING = 3
    """Both hands follow the faces in and take up their motion."""
    TOUCHING = 4
    """Both hands press on opposite faces, and move with them."""
    RETREATING = 5
    """Both hands draw back, still turning with the target."""
    REGRASPING = 6
    """Both hands go to opposite corners."""
    CLOSING = 7
    """Both hands come in along the corners' line, turning with it."""
    SQUEEZING = 8
    """Both hands press lightly."""
    SETTLING = 9
    """The joints come to rest, as robot and target will turn on together."""
    RECOVERING = 10
    """Something went otherwise than planned: both hands back out, and a new plan is looked for."""
    OPENING = 11
    """Both hands draw back from the caged target."""


class PlanKind(IntEnum):
    """What a plan is for."""

    NONE = 0
    ROLL_OUT_TOUCH = 1
    """Roll the next candidate of a touch out; the memory's plan stays as it is."""
    TOUCH = 2
    CAGE = 3
    RELEASE = 4
    ROLL_OUT_CLOSING = 5
    """Roll the next candidate of a closing out; likewise."""


class Trouble(IntEnum):
    """Why a sequence was broken off or found no plan."""

    NONE = 0
    NO_PLAN = 1
    """No candidate keeps to the constraints."""
    HAND_MISSED = 2
    """One hand did not meet its face."""
    OUT_OF_REACH = 3
    """A hand came under the floor of manipulability."""
    FORCE_OVER_CAP = 4
    """One and a half times the cap was felt."""
    SENSOR_LOST = 5
    """The target has not been seen for too long."""
    NOT_ENCLOSED = 6
    """The closing did not end, or with hands too far out for a cage."""
    TOO_MANY_TOUCHES = 7


NO_CORNER = 1e9
"""In place of a corner's angle: none is chosen."""

CANDIDATE = np.dtype(
    [
        ("turn", np.float64),  # where the right hand's side faces as the touch ends, by the base's angle now [rad]
        ("lean", np.float64),  # of the hands while they touch, likewise [rad]
        ("arc", np.float64),  # along which they may press at most [rad]
        ("passing", np.int64),  # sides let go by
        ("side", np.int64),  # of the shape, that the right hand touches; the left has the opposite one
        ("normal_offset", np.float64),  # from the target's angle to the normal angle of that side as it passes [rad]
        ("contact_angle", np.float64),  # of that side's normal in the world at first contact, unwrapped [rad]
        ("end_angle", np.float64),  # ... at the end of the touch
        ("hand_angle", np.float64),  # of the right hand while it touches [rad]; the left one's is half a turn less
        ("force", np.float64),  # [N]
        ("spin_after", np.float64),  # size of the spin after the touch [rad/s]
        ("unfinished", np.int64),  # that force leaves more spin than a closing bears: another touch follows
        ("lever_start", np.float64),  # of the tips on their faces [m]
        ("lever_end", np.float64),
        ("corner", np.float64),  # that the right hand encloses, in the target's frame [rad]; NO_CORNER: the nearest
        ("gap", np.float64),  # to both tips' touching, where the closing begins [m]
        ("regrasp", np.float64),  # how long the hands take to get there [s]
        ("time", np.float64),  # from now to the closed cage [s]
        ("steps", np.int64),  # rolled out
        ("base_rotation", np.float64),  # largest, of what is to come [rad]
        ("manipulability", np.float64),  # least [m2]
        ("clearance", np.float64),  # least, of tips that should not touch [m]
        ("apart", np.float64),  # least between both hands, and from either to the base, or 0.1 [m]
        ("cost", np.float64),  # [s]
        ("dropped_for", np.int64),  # a code of `Dropped`
    ],
    align=True,
)


class Dropped(IntEnum):
    """Why a candidate was dropped."""

    NONE = 0
    MANIPULABILITY = 1
    """An arm comes near a singularity: its reach, or folded."""
    CLEARANCE = 2
    """A tip that should not touch comes too near the target."""
    BASE = 3
    """The base turns too far."""
    HORIZON = 4
    """It lasts longer than can be rolled out."""
    COSTLIER = 5
    """It costs more than one that was found before, whatever the rest of its way: it is not rolled out to the end."""
    HANDS = 6
    """A hand comes too near the other, or the base."""


COUPLE_MEMORY = np.dtype(
    [
        ("since", np.float64),  # the activity began [s]
        ("candidate", np.int64),  # that is rolled out next
        ("passing", np.int64),  # sides let go by in this part of the search
        ("failures", np.int64),  # sequences broken off, in a row
        ("waiting_since", np.float64),  # for a plan, since the last touch [s]; NEVER while none is missed
        ("touches", np.int64),  # of this sequence
        ("trouble", np.int64),  # the last one, a code of `Trouble`
        ("trial", CANDIDATE),
        ("found", CANDIDATE),  # the best so far of a search
        ("best", CANDIDATE),  # the touch chosen
        ("dropped", np.int64, (len(Dropped),)),  # candidates of this search, by why
        ("start_kept", np.int64),  # whether the next is of this activity
        ("start_pose", np.float64, (2, 3)),  # of the hands as it began: in the world, or as seen from the target
        ("sense", np.float64),  # +1 for a counter-clockwise spin, else -1
        ("close", CANDIDATE),  # the closing chosen
        ("yielding", np.float64, (2, 2)),  # velocity of a touching tip that the servos give way with [m/s per N]
        (
            "admittance",
            np.float64,
            (2, 2),
        ),  # way from the face [m] and its rate, of an imposed impedance
        ("force_error", np.float64, (2,)),  # integral over its time constant [N]
        ("first_touch", np.float64),  # of this touch [s]; NEVER before
        ("both_touch", np.int64),
        ("lever", np.float64),  # that the torque acts with, measured; starts as planned [m]
        ("radius", np.float64, (2,)),  # of the hands about the target's centre, as believed, while closing [m]
        ("manipulability", np.float64),  # the lesser of both arms, at the last tick of a motion [m2]
    ],
    align=True,
)


STEPS = 300
"""A roll-out has at most so many steps."""

ROLL_OUT = np.dtype(
    [
        ("path", np.float64, (STEPS, 3, 3)),  # poses of both hands, base rotation [rad] and manipulability of both [m2]
        ("base", np.float64, (3,)),
        ("joint_angle", np.float64, (2, 3)),
        ("joint_rate", np.float64, (2, 3)),
        ("mount_angle", np.float64, (2,)),
        ("mount_rate", np.float64, (2,)),  # that the hands give way with on their mounts, while they press
        ("inertia", np.float64, (FREE, FREE)),  # to work with
        ("torque", np.float64, (FREE,)),  # likewise
        ("momentum", np.float64, (3,)),  # of the robot about the world's origin
        ("about_base", np.float64, (3,)),  # ... about the base's centre of mass, when the target has lost its part
        ("twist", np.float64, (3,)),  # of the base
        ("target", np.float64, (3,)),
        ("start", np.float64, (2, 3)),  # of the hands, as seen from the target
        ("goal", np.float64, (2, 3)),
        ("pose", np.float64, (2, 3)),  # to work with
        ("corners", np.float64, (2, 4, 2)),  # of both hands [m]
        ("shape", SHAPE),  # of the robot
        ("links", CHAIN),
        ("problem", JOINT_RATES),
    ],
    align=True,
)
"""Where a roll-out has come to: robot, target, hands' goals; and the way there, one row of `path` a step."""


class Fixed(NamedTuple):
    """What the configuration says, and stays."""

    robot: RobotModel
    shape: Shape
    """Of the target."""
    base: Shape
    cage_radius: float
    """Hand centres that are at most so far from the target's, on a line of corners, cage it [m]."""
    touch_radius: float
    """... touch it there with both tips [m]."""


class CoupleHandle(NamedTuple):
    """What the compiled functions of this method work with: arrays of one record each, which cost little to hand on."""

    own: np.ndarray[Any, np.dtype[Any]]
    """Of `COUPLE_MEMORY`."""
    fixed: np.ndarray[Any, np.dtype[Any]]
    """Of `Fixed`, packed."""
    work: np.ndarray[Any, np.dtype[Any]]
    """Of `ROLL_OUT`."""
