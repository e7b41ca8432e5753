"""What the service itself has to refuse.

CaptureError (sim.errors)
├── ServiceBusy     a bounded queue is full, or the plant is still being prepared (REST 503)
├── ConfigOutdated  parameters changed while a change of them was checked (REST 409)
├── PresetNotFound  no such preset (REST 404)
├── StudyNotFound   no such study (REST 404)
├── StudyRefused    a request that the study's status does not allow (REST 409)
├── JobNotFound     no such rehearsal, atlas or fit, or not any more (REST 404)
├── JobRefused      a request that its status, or what it found, does not allow (REST 409)
├── StoredUnreadable  a stored run, study or file is damaged, of another version or not permitted (REST 409)
├── DataFolderInUse another service has the data folder (exit 1)
├── ConfirmationNeeded  a study of very many cells (REST 409)
├── DataFolderLost  the data folder is gone, or cannot be written (REST 503)
├── DiskFull        too little room for another run or study (REST 507)
├── LoopSilent      the mission thread did not answer in time (REST 504)
└── AddressInUse    the port cannot be bound (exit 1)
"""

from __future__ import annotations

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


class JobNotFound(CaptureError):
    """No rehearsal, atlas or fit has that identifier, or not any more."""


class JobRefused(CaptureError):
    """A request that the status of a rehearsal, an atlas or a fit, or what it found, does not allow."""


class StoredUnreadable(CaptureError):
    """Something stored cannot be read: damaged, of another version, or not permitted; it costs nothing else."""

    def __init__(
        self, message: str, *, tip: str = "restore it from a backup, fix its permissions, or remove it"
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
            tip='start it all the same (over REST with "confirm": true), or make the study smaller',
        )
        self.cells = cells
        self.estimated_time = estimated_time
        """Wall time [s]; None if it could not be measured."""


class AddressInUse(CaptureError):
    """The address that the service should listen on cannot be had."""
