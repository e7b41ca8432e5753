"""`/alarms`: what of the live mission is beyond its limits, the limits, and what happened to alarms."""

from __future__ import annotations

import asyncio
from datetime import UTC, datetime, timedelta
from typing import Annotated

from fastapi import APIRouter, Query, Response
from fastapi import Path as InPath
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from server.alarms.board import Alarm, AlarmRecord
from server.alarms.limits import SIGNALS, ChosenLimits, Limits, Side, Signal, signal_of
from server.api.services import AskerDep, Services, ServicesDep
from server.edge.etags import IfNoneMatch, known_or_new
from server.edge.problem_json import responses
from server.edge.values import Number
from server.instants import wall_clock
from server.library.journal import AT_HAND

router = APIRouter(prefix="/alarms", tags=["alarms"], responses=responses(422))

LONGEST_SHELF = 480
"""Minutes for which an alarm may be shelved: a shift."""

SignalName = Annotated[str, InPath(max_length=60, examples=["tip_force"])]


class WatchedSignal(BaseModel):
    """A signal, and the limits that hold for it."""

    name: str
    title: str
    unit: str
    side: Side = Field(description="Where its limits are gone beyond")
    description: str
    default: Limits
    limits: Limits = Field(description="In force")
    chosen_by: str | None = Field(description="Who chose them; null where the defaults hold")
    chosen_at: str | None = Field(description="When, ISO 8601 in UTC")


class Acknowledgement(BaseModel):
    """Which alarm somebody has seen."""

    model_config = ConfigDict(extra="forbid")

    alarm: str | None = Field(None, max_length=200, description="Its key; null: all that are in the list")


class Shelving(BaseModel):
    """Which alarm is to say nothing, and for how long."""

    model_config = ConfigDict(extra="forbid")

    alarm: str = Field(max_length=200, description="Its key")
    minutes: Number = Field(gt=0, le=LONGEST_SHELF, description="It has its voice again afterwards")


class Unshelving(BaseModel):
    """Which alarm is to have its voice again."""

    model_config = ConfigDict(extra="forbid")

    alarm: str = Field(max_length=200, description="Its key")


_ALARMS = TypeAdapter(tuple[Alarm, ...])
_RECORDS = TypeAdapter(list[AlarmRecord])


@router.get("", response_model=list[Alarm])
async def alarms(services: ServicesDep, if_none_match: IfNoneMatch = None) -> Response:
    """What is beyond its limits, or was and has not been acknowledged; the oldest first."""
    return known_or_new(_ALARMS.dump_json(services.alarms.board.alarms), if_none_match)


@router.get("/history", response_model=list[AlarmRecord])
async def alarm_history(
    services: ServicesDep,
    limit: Annotated[int, Query(ge=1, le=AT_HAND)] = 200,
    if_none_match: IfNoneMatch = None,
) -> Response:
    """What happened to alarms, the newest first; kept over restarts."""
    records = await asyncio.to_thread(services.alarms.journal.newest, limit)
    return known_or_new(_RECORDS.dump_json(records), if_none_match)


@router.post("/acknowledge", responses=responses(409))
async def acknowledge_alarm(services: ServicesDep, asker: AskerDep, body: Acknowledgement) -> list[Alarm]:
    """Say that one alarm, or all, has been seen: it falls silent, and leaves the list once it is over."""
    services.alarms.board.acknowledge(body.alarm, asker, services.alarms.now)
    return await _told(services)


@router.post("/shelve", responses=responses(409))
async def shelve_alarm(services: ServicesDep, asker: AskerDep, body: Shelving) -> list[Alarm]:
    """Let an alarm say nothing for a while, whatever happens to it; it stays in the list."""
    until = (datetime.now(UTC) + timedelta(minutes=body.minutes)).isoformat(timespec="milliseconds")
    services.alarms.board.shelve(body.alarm, until, asker, services.alarms.now)
    return await _told(services)


@router.post("/unshelve", responses=responses(409))
async def unshelve_alarm(services: ServicesDep, asker: AskerDep, body: Unshelving) -> list[Alarm]:
    """Give a shelved alarm its voice again."""
    services.alarms.board.unshelve(body.alarm, asker, services.alarms.now)
    return await _told(services)


async def _told(services: Services) -> list[Alarm]:
    await services.alarms.tell()
    return list(services.alarms.board.alarms)


@router.get("/limits")
async def limits(services: ServicesDep) -> list[WatchedSignal]:
    """Everything that is watched, with its limits and their defaults."""
    chosen = await asyncio.to_thread(lambda: services.alarms.limits.chosen)
    return [_watched(signal, chosen.get(name)) for name, signal in SIGNALS.items()]


@router.put("/limits/{signal}", responses=responses(409, 503))
async def choose_limits(services: ServicesDep, asker: AskerDep, signal: SignalName, body: Limits) -> WatchedSignal:
    """Choose the limits of a signal, for everyone who uses this service."""
    await asyncio.to_thread(services.disk.require_folder)
    chosen = await asyncio.to_thread(lambda: services.alarms.limits.choose(signal, body, who=asker, at=wall_clock()))
    return _watched(signal_of(signal), chosen)


@router.delete("/limits/{signal}", status_code=204, responses=responses(409))
async def forget_limits(services: ServicesDep, signal: SignalName) -> Response:
    """Back to the default limits of a signal."""
    await asyncio.to_thread(services.alarms.limits.forget, signal)
    return Response(status_code=204)


def _watched(signal: Signal, chosen: ChosenLimits | None) -> WatchedSignal:
    return WatchedSignal(
        name=signal.name,
        title=signal.title,
        unit=signal.unit,
        side=signal.side,
        description=signal.description,
        default=signal.default,
        limits=signal.default if chosen is None else chosen.limits,
        chosen_by=None if chosen is None else chosen.who,
        chosen_at=None if chosen is None else chosen.at,
    )
