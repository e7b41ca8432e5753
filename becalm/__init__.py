"""Becalm: calms a spinning piece of debris by soft touches, then encloses it with both hands.

import becalm

config = becalm.revised(becalm.named_configuration("published"), {"target": {"initial_spin": 0.8}})
result = becalm.run_capture(config)
print(result.outcome.outcome, result.outcome.peak_tip_force)
"""

from server.versions import becalm_version
from sim.capture.run import RunResult, run_capture
from sim.capture.snapshot import Outcome, OutcomeClass, Snapshot
from sim.config import MissionConfig
from sim.configurations import NAMED_CONFIGURATIONS, named_configuration, revised
from sim.errors import CaptureError, ConfigError, MissionRefused, PlantDiverged, RunNotFound

__version__ = becalm_version()

__all__ = [
    "NAMED_CONFIGURATIONS",
    "CaptureError",
    "ConfigError",
    "MissionConfig",
    "MissionRefused",
    "Outcome",
    "OutcomeClass",
    "PlantDiverged",
    "RunNotFound",
    "RunResult",
    "Snapshot",
    "__version__",
    "named_configuration",
    "revised",
    "run_capture",
]
