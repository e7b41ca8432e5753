"""`/shift-log`: what people of one shift tell those of the next, with the run and the moment that it is about."""

from __future__ import annotations

import asyncio
from typing import Annotated

from fastapi import APIRouter, Query, Response
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, field_validator

from server.api.services import AskerDep, ServicesDep
from server.edge.etags import IfNoneMatch, known_or_new
from server.edge.problem_json import responses
from server.library.journal import AT_HAND
from server.library.shift_log import LONGEST_TEXT, ShiftEntry

router = APIRouter(prefix="/shift-log", tags=["shift log"], responses=responses(422))


class ShiftEntryBody(BaseModel):
    """What to note."""

    model_config = ConfigDict(extra="forbid")

    text: str = Field(max_length=LONGEST_TEXT, examples=["Left wrist tared after warming up; reads 0.02 N at rest."])

    @field_validator("text")
    @classmethod
    def _says_something(cls, text: str) -> str:
        if not text.strip():
            raise ValueError("text is empty: an entry says something")
        return text.strip()


_ENTRIES = TypeAdapter(list[ShiftEntry])


@router.get("", response_model=list[ShiftEntry])
async def shift_log(
    services: ServicesDep,
    limit: Annotated[int, Query(ge=1, le=AT_HAND)] = 100,
    if_none_match: IfNoneMatch = None,
) -> Response:
    """The newest entries, the newest first."""
    entries = await asyncio.to_thread(services.shift_log.newest, limit)
    return known_or_new(_ENTRIES.dump_json(entries), if_none_match)


@router.post("", status_code=201, responses=responses(503))
async def note_shift(services: ServicesDep, asker: AskerDep, body: ShiftEntryBody) -> ShiftEntry:
    """Note something; an entry is never changed afterwards."""
    await asyncio.to_thread(services.disk.require_folder)
    now = services.alarms.now
    entry = ShiftEntry(at=now.at, who=asker, text=body.text, run_id=now.run_id, time=now.time)
    await asyncio.to_thread(services.shift_log.keep, entry)
    return entry
