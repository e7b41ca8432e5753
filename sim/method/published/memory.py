"""What the published method remembers beside what all do: `PUBLISHED_MEMORY`, its activities and kinds of plan."""

from __future__ import annotations

from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np

from sim.compiled import FloatArray


class Activity(IntEnum):
    """What the hands are doing within a phase."""

    NONE = 0
    APPROACHING = 1
    """A detumbling path is followed."""
    WAITING = 2
    """The path is done, joints are held, and the target comes to the hand."""
    ABSORBING = 3
    """The touched hand yields under admittance."""
    RETREATING = 4
    """Joints are held while the target leaves the hand."""
    SETTLING = 5
    """The spin is under its threshold; joints are held until the caging plan is made."""
    CLOSING = 6
    """A caging path is followed with both hands."""
    OPENING = 7
    """Both hands draw back from the target."""


class PlanKind(IntEnum):
    """What a plan is for."""

    NONE = 0
    TOUCH = 1
    CAGE = 2
    RELEASE = 3


PUBLISHED_MEMORY = np.dtype(
    [
        ("last_contact", np.float64),  # last instant of any tip contact in this sequence [s]
        ("slow_since", np.float64),  # first instant of spin under its threshold [s]
        ("replan_after_contact", np.int64),
        ("cage_planned", np.int64),
        ("absorbing", np.int64),
        ("admittance_displacement", np.float64, (2, 3)),
        ("admittance_velocity", np.float64, (2, 3)),
    ],
    align=True,
)


class PublishedHandle(NamedTuple):
    """What the compiled functions of this method work with."""

    own: np.ndarray[Any, np.dtype[Any]]
    """An array of one `PUBLISHED_MEMORY`."""
    transition: FloatArray
    """Of the admittance over one period, `admittance_transition`, shape (2, 3)."""
