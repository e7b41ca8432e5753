"""What the controller remembers from tick to tick, whatever the method, as one record: `MEMORY`.

What only one method remembers is in a record of its own (`Method.memory`). Everything else is computed at each tick.
"""

from __future__ import annotations

import numpy as np

NEVER = -1e9
"""A time [s] before every mission: 'has not happened', for times that are compared."""

NO_PLAN = 0
"""The kind of no plan; a method numbers its own from 1."""

KNOTS = 16
"""The most poses of a plan."""

PREDICTION = np.dtype(
    [
        ("made", np.int64),  # 0: the method has not rolled its plan out
        ("until", np.float64),  # instant at which what is predicted ends: the closed cage [s]
        ("force", np.float64),  # that each hand will press with [N]; 0: only the closing's
        ("base_rotation", np.float64),  # largest, from here on [rad]
        ("manipulability", np.float64),  # least of both arms [m2]
        ("clearance", np.float64),  # least, of tips that should not touch [m]
    ],
    align=True,
)
"""What a method expects of the plan under way."""

TOUCH_PLAN = np.dtype(
    [
        ("made", np.int64),  # 0: the plan under way has none
        ("side", np.float64, (2, 2, 2)),  # ends of the side that each hand presses on, from the target's middle [m]
        ("point", np.float64, (2, 2)),  # where on it, as the touch begins, likewise, in the target's axes
        ("lever", np.float64),  # that the torque of both hands acts with: planned, then as measured [m]
        ("arc_left", np.float64),  # along which they may still press, turning with the target [rad]
    ],
    align=True,
)
"""The touch that a plan is for, where both hands press on the target's sides."""

MEMORY = np.dtype(
    [
        ("phase", np.int64),
        ("activity", np.int64),  # of the method's own; 0: the joints are held
        ("sequence", np.int64),
        ("plan_kind", np.int64),
        ("plan_count", np.int64),
        ("plan_knots", np.int64),
        ("plan_time", np.float64, (KNOTS,)),  # of each knot [s]
        ("plan_pose", np.float64, (2, KNOTS, 3)),  # arm, knot, (x, y, angle)
        ("plan_arm", np.int64),  # -1: both
        ("predicted_target", np.float64, (3,)),  # at the end of the plan
        ("prediction", PREDICTION),
        ("touch_plan", TOUCH_PLAN),
        ("tracking_integral", np.float64, (2, 3)),
        ("desired_hand_pose", np.float64, (2, 3)),
        ("desired_hand_twist", np.float64, (2, 3)),
        ("commanded_joint_rate", np.float64, (2, 3)),
        ("rate_limited", np.int64),
        ("joint_rate_share", np.float64),  # of the rates that the hands' twists take, that is commanded: 1, or less
        ("expects_contact", np.int64, (2,)),  # that a hand touches though a plan is running is as planned
        ("wanted_force", np.float64, (2,)),  # that a hand should press with; 0 where its motion is what is wanted [N]
        ("trouble", np.int64),  # why the sequence was last broken off or found no plan, by the method; 0: it was not
    ],
    align=True,
)
