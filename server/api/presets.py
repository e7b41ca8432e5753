"""`/presets`: parameters kept by name, the same for everyone who uses this service."""

from __future__ import annotations

import asyncio
from typing import Annotated

from fastapi import APIRouter, Response
from fastapi import Path as InPath
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from server.api.services import AskerDep, ServicesDep
from server.edge.etags import IfNoneMatch, known_or_new
from server.edge.problem_json import responses
from server.edge.values import Changes, ShortText
from server.instants import wall_clock
from server.library.presets import NAME, Preset, UnreadablePreset
from sim.config import MissionConfig
from sim.errors import ConfigError

router = APIRouter(prefix="/presets", tags=["configuration"])

PresetName = Annotated[str, InPath(pattern=f"^{NAME}$", examples=["soft hands"])]


class PresetBody(BaseModel):
    """What to keep."""

    model_config = ConfigDict(extra="forbid")

    configuration: ShortText = Field(
        description="The named configuration that it changes", examples=["published_figures"]
    )
    changes: Changes = Field(description="Nested, SI", examples=[{"published": {"impedance": {"damping": 3.0}}}])


class KeptPreset(BaseModel):
    """A preset, and what it comes to."""

    name: str = Field(description="Its own, or where it stands in the file if it has none")
    preset: Preset | None = Field(description="Null if it is damaged, or of another version")
    config: MissionConfig | None = Field(description="Null if this version of Becalm cannot fly it")
    refusal: str | None = Field(description="Why not")
    notices: tuple[str, ...] = Field(description="What this version ignores of it, and why")


_PRESETS = TypeAdapter(list[KeptPreset])


@router.get("", response_model=list[KeptPreset], responses=responses(409, 422))
async def presets(services: ServicesDep, if_none_match: IfNoneMatch = None) -> Response:
    """All of them, by name."""
    kept = [kept_preset(preset) for preset in await asyncio.to_thread(services.presets.presets)]
    return known_or_new(_PRESETS.dump_json(kept), if_none_match)


@router.put("/{name}", responses=responses(409, 422, 503))
async def keep_preset(services: ServicesDep, asker: AskerDep, name: PresetName, body: PresetBody) -> KeptPreset:
    """Keep parameters by that name, in place of what it named before."""
    await asyncio.to_thread(services.disk.require_folder)
    preset = Preset(name=name, configuration=body.configuration, changes=body.changes, who=asker, at=wall_clock())
    await asyncio.to_thread(services.presets.keep, preset)
    return kept_preset(preset)


@router.delete("/{name}", status_code=204, responses=responses(404, 409, 422))
async def remove_preset(services: ServicesDep, name: PresetName) -> Response:
    """Keep that one no longer."""
    await asyncio.to_thread(services.presets.remove, name)
    return Response(status_code=204)


def kept_preset(preset: Preset | UnreadablePreset) -> KeptPreset:
    """A preset, and what it comes to."""
    if isinstance(preset, UnreadablePreset):
        return KeptPreset(name=preset.name, preset=None, config=None, refusal=preset.reason, notices=())
    config, refusal = None, None
    try:
        config = preset.config()
    except ConfigError as error:
        refusal = str(error)
    return KeptPreset(name=preset.name, preset=preset, config=config, refusal=refusal, notices=preset.notices)
