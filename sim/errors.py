"""What can go wrong in a capture.

CaptureError
├── ConfigError        a configuration that cannot be (REST 422, exit 2)
├── MissionRefused     a request that the phase does not allow (REST 409)
├── RunNotFound        no such run (REST 404)
├── TableUnusable      the file of a study's results: another study's, in use, not writable (sim.study.table)
├── WorkersUnavailable no worker process of a study starts (sim.study.executors)
└── PlantError         the plant can no longer be trusted (phase `faulted`)
    ├── PlantDiverged  a state that is not finite, or momentum that jumped
    └── LinkLost       the robot at the other end of the link is silent, late, or tells what cannot be
"""


class CaptureError(Exception):
    """Anything that Becalm itself refuses or gives up on; `tip` says what a person can do."""

    def __init__(self, message: str, *, tip: str = "") -> None:
        super().__init__(message)
        self.tip = tip


class ConfigError(CaptureError):
    """A configuration that cannot be; the message names field, value and bound."""


class MissionRefused(CaptureError):
    """A request that the mission's phase does not allow."""


class RunNotFound(CaptureError):
    """No run has that identifier."""


class PlantError(CaptureError):
    """The plant can no longer be trusted."""


class PlantDiverged(PlantError):
    """The plant's state is not finite, or its momentum jumped."""


class LinkLost(PlantError):
    """The robot at the other end of the link is silent, late, or tells what cannot be."""
