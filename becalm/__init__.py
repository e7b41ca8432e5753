"""Becalm: calms a spinning piece of debris by soft touches, then encloses it with both hands.

import becalm

config = becalm.revised(becalm.named_configuration("published"), {"target": {"initial_spin": 0.8}})
result = becalm.run_capture(config)
print(result.outcome.outcome, result.outcome.peak_tip_force)

with becalm.Client() as service:  # of `becalm serve`
    service.command("capture")
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from server.versions import becalm_version
from sim.capture.run import RunResult, run_capture
from sim.config import MissionConfig
from sim.configurations import NAMED_CONFIGURATIONS, named_configuration, revised
from sim.errors import CaptureError, ConfigError, MissionRefused, PlantDiverged, RunNotFound
from sim.snapshot import Outcome, OutcomeClass, Snapshot

if TYPE_CHECKING:
    from becalm.calls import ProxyUnusable, ServiceRefused, ServiceUnreachable
    from becalm.client import AsyncClient, Client

__version__ = becalm_version()

__all__ = [
    "NAMED_CONFIGURATIONS",
    "AsyncClient",
    "CaptureError",
    "Client",
    "ConfigError",
    "MissionConfig",
    "MissionRefused",
    "Outcome",
    "OutcomeClass",
    "PlantDiverged",
    "ProxyUnusable",
    "RunNotFound",
    "RunResult",
    "ServiceRefused",
    "ServiceUnreachable",
    "Snapshot",
    "__version__",
    "named_configuration",
    "revised",
    "run_capture",
]


def __getattr__(name: str) -> Any:
    """The client, when it is asked for: what it needs takes half a second to load."""
    if name in ("AsyncClient", "Client", "ProxyUnusable", "ServiceRefused", "ServiceUnreachable"):
        from becalm import calls, client  # noqa: PLC0415

        return getattr(client if name.endswith("Client") else calls, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
