"""A plant as the mission sees it: `PLANT_STATE` out, joint rates in, once a control period."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from sim.compiled import FloatArray
from sim.record import Record

PLANT_STATE = np.dtype(
    [
        ("tick", np.int64),  # control periods since the start
        ("time", np.float64),  # [s]
        ("base_pose", np.float64, (3,)),  # of the centre of mass
        ("base_twist", np.float64, (3,)),
        ("joint_angle", np.float64, (2, 3)),
        ("joint_rate", np.float64, (2, 3)),
        ("mount_angle", np.float64, (2,)),  # of the hands on link 3
        ("mount_rate", np.float64, (2,)),
        ("target_pose", np.float64, (3,)),
        ("target_twist", np.float64, (3,)),
        ("hand_wrench", np.float64, (2, 3)),  # target on hand, about the hand centre, world axes
        ("tip_force", np.float64, (2, 2, 2)),  # target on tip, world axes
        ("tip_contact", np.int64, (2, 2)),
        ("base_contact", np.int64),  # solid contact of the target with the base, now
        ("arm_contact", np.int64),  # ... with a link or the back of a hand, now
        ("momentum", np.float64, (3,)),  # robot and target, about the world's origin
    ],
    align=True,
)
"""What a plant reports; SI, world axes; arrays lead with the arm (left, right)."""


class Plant(Protocol):
    """Anything that can be flown, tick by tick: observe, decide, command."""

    @property
    def state(self) -> Record:
        """The latest state, one element of `PLANT_STATE`; always the same element, changed by `observe`."""
        ...

    def observe(self) -> None:
        """Wait for the next state.

        Raises:
            PlantError: the plant can no longer be trusted.

        """
        ...

    def command(self, joint_rate: FloatArray) -> None:
        """Apply joint rates [rad/s], shape (2, 3), from now on; does not wait for what comes of it.

        Raises:
            PlantError: the plant can no longer be trusted.

        """
        ...
