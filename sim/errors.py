"""What can go wrong in a capture.

CaptureError
├── ConfigError        an invalid configuration (REST 422, exit 2)
├── MissionRefused     a request that the phase does not allow (REST 409)
├── RunNotFound        no such run (REST 404)
├── TableUnusable      the file of a study's results: another study's, in use, not writable (sim.study.table)
├── WorkersUnavailable no worker process of a study starts (sim.study.executors)
└── PlantError         the plant can no longer be trusted (phase `faulted`)
    ├── PlantDiverged  a state that is not finite, or momentum that jumped
    └── LinkLost       the robot at the other end of the link is silent, late, or reports an impossible state
"""

from __future__ import annotations

from enum import StrEnum


class Cause(StrEnum):
    """Why a mission ended without a cage. Titles and tips go by it; the wording of a message is free."""

    DIVERGED = "diverged"
    """The simulated state is not finite, or its momentum jumped."""
    PLANT_FAILED = "plant_failed"
    """The plant cannot be trusted for another reason."""
    BECALM_FAILED = "becalm_failed"
    """A bug in Becalm."""
    JOINT_BLOCKED = "joint_blocked"
    """A joint does not follow its commanded rate."""
    SEVERAL_ROBOTS = "several_robots"
    """Messages come from a robot other than the one being flown."""
    SESSION_TAKEN = "session_taken"
    """Another console holds the robot, or nobody does."""
    ROBOT_STOPPED = "robot_stopped"
    """The robot follows no joint commands, for a reason that it names."""
    NO_ANSWER = "no_answer"
    """The robot did not acknowledge what it was asked, or not soon enough."""
    READING_REFUSED = "reading_refused"
    """A stream's readings are implausible."""
    READING_JUMPED = "reading_jumped"
    """A reading differs from the one before by more than anything can move."""
    CLOCK_JUMPED = "clock_jumped"
    """The robot's clock jumped."""
    SENSOR_FROZEN = "sensor_frozen"
    """A noisy sensor repeats itself."""
    ROBOT_SILENT = "robot_silent"
    """No joint states come."""
    STREAM_LATE = "stream_late"
    """A needed stream is too old, or does not come."""
    TARGET_EJECTED = "target_ejected"
    """The verdict: the target left the robot's reach."""
    BASE_STRUCK = "base_struck"
    """The verdict: the target struck the base."""
    TIME_UP = "time_up"
    """The verdict: not caged within the time limit."""


class CaptureError(Exception):
    """Anything that Becalm itself refuses or gives up on; `tip` says what a person can do."""

    def __init__(self, message: str, *, tip: str = "") -> None:
        super().__init__(message)
        self.tip = tip


class ConfigError(CaptureError):
    """An invalid configuration; the message names field, value and bound."""


class MissionRefused(CaptureError):
    """A request that the mission's phase does not allow."""


class RunNotFound(CaptureError):
    """No run has that identifier."""


class PlantError(CaptureError):
    """The plant can no longer be trusted."""

    cause = Cause.PLANT_FAILED


class PlantDiverged(PlantError):
    """The plant's state is not finite, or its momentum jumped."""

    cause = Cause.DIVERGED


class LinkLost(PlantError):
    """The robot at the other end of the link is silent, late, or reports an impossible state."""

    def __init__(self, message: str, *, cause: Cause, tip: str = "") -> None:
        super().__init__(message, tip=tip)
        self.cause = cause
