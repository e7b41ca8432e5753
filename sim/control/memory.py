"""What the controller remembers from tick to tick, as one record: `MEMORY`. Everything else it computes anew."""

from __future__ import annotations

from enum import IntEnum

import numpy as np

NEVER = -1e9
"""A time [s] before every mission: 'has not happened', for times that are compared as older than."""


class PlanKind(IntEnum):
    """What a plan is for."""

    NONE = 0
    TOUCH = 1
    CAGE = 2
    RELEASE = 3


MEMORY = np.dtype(
    [
        ("phase", np.int64),
        ("activity", np.int64),
        ("sequence", np.int64),
        ("last_contact", np.float64),  # last instant of any tip contact in this sequence [s]
        ("slow_since", np.float64),  # first instant of spin under its threshold [s]
        ("replan_after_contact", np.int64),
        ("cage_planned", np.int64),
        ("plan_kind", np.int64),
        ("plan_count", np.int64),
        ("plan_knots", np.int64),
        ("plan_time", np.float64, (3,)),  # of each knot [s]
        ("plan_pose", np.float64, (2, 3, 3)),  # arm, knot, (x, y, angle)
        ("plan_arm", np.int64),  # -1: both
        ("predicted_target", np.float64, (3,)),  # at the end of the plan
        ("absorbing", np.int64),
        ("admittance_displacement", np.float64, (2, 3)),
        ("admittance_velocity", np.float64, (2, 3)),
        ("tracking_integral", np.float64, (2, 3)),
        ("desired_hand_pose", np.float64, (2, 3)),
        ("desired_hand_twist", np.float64, (2, 3)),
        ("commanded_joint_rate", np.float64, (2, 3)),
        ("rate_limited", np.int64),
        ("closed", np.int64),  # the tips enclose the target at its present angle
    ],
    align=True,
)
