"""`/health`: whether the service and its mission are alive."""

from __future__ import annotations

import time
from typing import Literal

from fastapi import APIRouter
from pydantic import BaseModel, ConfigDict, Field

from server.api.services import ServicesDep
from server.mission.loop import LoopStatus
from server.versions import becalm_version

router = APIRouter(tags=["service"])


class Health(BaseModel):
    """Alive, and what of it is old."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "status": "ok",
                "prepared": 1.0,
                "version": "0.1.0",
                "plant": "simulation",
                "service_time": 5123.4071,
                "tick_age": 0.0012,
                "link_age": None,
                "phase": "idle",
                "recorder_lag": 0.0,
                "recorder_failure": None,
                "access_failure": None,
            }
        }
    )

    status: LoopStatus = Field(description="preparing: the simulation is being compiled; faulted: reset it")
    prepared: float = Field(description="How much of the simulation is compiled, from 0 to 1; 1 when it can fly")
    version: str
    plant: Literal["simulation", "zenoh"]
    service_time: float = Field(description="The service's monotonic clock [s], by which snapshots are stamped")
    tick_age: float | None = Field(description="Since the last tick [s]; null before the first")
    link_age: float | None = Field(description="Since the robot was last heard of [s]; null in simulation")
    phase: str | None = Field(description="Of the mission; null before there is one")
    recorder_lag: float = Field(description="How long the oldest tick in memory may have waited for the disk [s]")
    recorder_failure: str | None = Field(description="Why the run is not being recorded; null while it is")
    access_failure: str | None = Field(
        description="Why the tokens cannot be read, so that those last read go on holding; null while they can"
    )


@router.get("/health")
async def health(services: ServicesDep) -> Health:
    """Whether the service is alive; it answers while the simulation is still being prepared."""
    latest = services.feed.latest
    return Health(
        status=services.loop.status,
        prepared=services.loop.prepared,
        version=becalm_version(),
        plant=services.settings.plant,
        service_time=time.monotonic(),
        tick_age=services.loop.tick_age,
        link_age=services.link.age() if services.link is not None else None,
        phase=latest.phase if latest else None,
        recorder_lag=services.recorder.lag,
        recorder_failure=services.recorder.failure,
        access_failure=services.access.failure,
    )
