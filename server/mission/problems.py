"""What an operator must see, and what the service itself has to refuse.

CaptureError (sim.errors)
├── ServiceBusy     a bounded queue is full, or the plant is still being prepared (REST 503)
├── ConfigOutdated  parameters changed while a change of them was checked (REST 409)
├── PresetNotFound  no such preset (REST 404)
├── StudyNotFound   no such study (REST 404)
├── StudyRefused    a request that the study's status does not allow (REST 409)
├── StoredUnreadable  a stored run, study or file is damaged, of another version or not permitted (REST 409)
├── DataFolderInUse another service has the data folder (exit 1)
├── ConfirmationNeeded  a study of very many cells (REST 409)
├── DataFolderLost  the data folder is gone, or cannot be written (REST 503)
├── DiskFull        too little room for another run or study (REST 507)
├── LoopSilent      the mission thread did not answer in time (REST 504)
└── AddressInUse    the port cannot be bound (exit 1)
"""

from __future__ import annotations

from pydantic import Field

from server.mission.causes import cause_of
from sim.capture.events import Event, Severity
from sim.capture.snapshot import Published
from sim.errors import CaptureError
from sim.study.flight import in_words


class ServiceBusy(CaptureError):
    """Asked too much, or too early; the same request may succeed later."""


class ConfigOutdated(CaptureError):
    """The configuration in force is not the one any more that a change was checked against."""


class LoopSilent(CaptureError):
    """The mission thread did not answer in time."""


class DiskFull(CaptureError):
    """Too little room is left on the disk to begin something that would take more."""


class DataFolderLost(CaptureError):
    """The data folder is gone while the service runs, or it cannot be written any more."""


class PresetNotFound(CaptureError):
    """No preset has that name."""


class StudyNotFound(CaptureError):
    """No study has that identifier."""


class StudyRefused(CaptureError):
    """A request that the study's status does not allow."""


class StoredUnreadable(CaptureError):
    """Something stored cannot be read: damaged, of another version, or not permitted; it costs nothing else."""

    def __init__(
        self, message: str, *, tip: str = "restore it from a backup, mend its permissions, or remove it"
    ) -> None:
        super().__init__(message, tip=tip)


class DataFolderInUse(CaptureError):
    """Another living service has the data folder."""


class ConfirmationNeeded(CaptureError):
    """A study so large that whoever starts it must say that it is meant."""

    def __init__(self, cells: int, estimated_time: float | None) -> None:
        duration = (
            "; how long they take is not known"
            if estimated_time is None
            else f", which take about {in_words(estimated_time)}"
        )
        super().__init__(
            f"the study has {cells} cells{duration}",
            tip='send the same request with "confirm": true, or make the study smaller',
        )
        self.cells = cells
        self.estimated_time = estimated_time
        """Wall time [s]; None if it could not be measured."""


class AddressInUse(CaptureError):
    """The address that the service should listen on cannot be had."""


class Problem(Published):
    """Something that the operator must see, and what to do about it."""

    severity: Severity
    title: str
    message: str
    tip: str
    since: float = Field(description="Mission time when it began [s]")


_TIPS = {
    "solid_contact": "reset, then raise control.caging.close_margin or lower the target's spin before the next try",
    "base_overlap": "stop, then reset; a lower control.impedance.damping keeps the target from following the hands",
    "rate_limit": "an arm is near a singularity; watch its manipulability, or set "
    "control.rates.singularity_handling to damped_least_squares and reset",
    "manipulability": "an arm is near a singularity; hold, and release, or set "
    "control.rates.singularity_handling to damped_least_squares and reset",
}

_TITLES = {
    "solid_contact": "Unplanned contact",
    "base_overlap": "Target at the base",
    "rate_limit": "Joint rates at their limit",
    "manipulability": "Manipulability low",
}


def problem_of(event: Event) -> Problem | None:
    """The event as a problem with a title and a tip; None if there is nothing to do about it."""
    if event.severity == "info":
        return None
    if event.kind in ("link", "fault", "verdict"):
        _, title, tip = cause_of(event.kind, event.message)
    elif event.kind in _TITLES:
        title, tip = _TITLES[event.kind], _TIPS[event.kind]
    else:
        return None
    return Problem(severity=event.severity, title=title, message=event.message, tip=tip, since=event.time)


class ProblemBoard:
    """The problems of a mission that the operator has to see now; one of each key."""

    def __init__(self) -> None:
        self._problems: dict[str, Problem] = {}

    def show(self, key: str, problem: Problem) -> None:
        """Show a problem; one that is shown already keeps the time when it began."""
        present = self._problems.get(key)
        since = present.since if present else problem.since
        self._problems[key] = problem.model_copy(update={"since": since})

    def clear(self, key: str) -> None:
        """Take a problem off the board, if it is there."""
        self._problems.pop(key, None)

    def shown(self) -> tuple[Problem, ...]:
        """All of them, the oldest first."""
        return tuple(self._problems.values())
