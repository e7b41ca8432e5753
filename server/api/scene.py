"""`/scene`: what of the live mission's scene is drawn, and from where it is looked at; for all browsers alike."""

from __future__ import annotations

import asyncio
from typing import Literal

from fastapi import APIRouter
from pydantic import BaseModel, ConfigDict, Field, field_validator

from server.api.services import ServicesDep
from server.edge.problem_json import responses
from server.edge.values import Flag, ShortText
from server.errors import JobRefused
from server.rehearsals.jobs import RehearsalJob
from server.scene import CAMERAS, LAYERS, CameraName, Scene
from sim.rehearsal.rehearsal import RehearsalResult
from sim.rehearsal.summary import CaseResult

router = APIRouter(prefix="/scene", tags=["mission"])


class SceneView(BaseModel):
    """How the live scene is shown."""

    camera: CameraName = Field(description="The preset that all browsers were taken to last")
    cameras: list[CameraName] = Field(description="The presets that there are")
    layers: dict[str, bool] = Field(description="Whether each layer is drawn", examples=[{"trails": True}])


class SceneChange(BaseModel):
    """What to change of it; the rest stays."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"camera": "top"}]})

    camera: CameraName | None = None
    layers: dict[str, Flag] = Field(default_factory=dict, examples=[{"trails": False, "frames": True}])

    @field_validator("layers")
    @classmethod
    def _layers_are_known(cls, layers: dict[str, bool]) -> dict[str, bool]:
        unknown = sorted(set(layers) - set(LAYERS))
        if unknown:
            raise ValueError(f"{unknown[0]!r} is no layer; there are {', '.join(LAYERS)}")
        return layers


class FuturesChoice(BaseModel):
    """Of which rehearsal the futures are drawn."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"examples": [{"rehearsal": "20261125T103000123-4f9a2c", "case": "as_it_is"}]}
    )

    rehearsal: ShortText = Field(description="Identifier of one that has finished")
    case: Literal["as_it_is", "as_changed"] = "as_it_is"


@router.get("")
async def scene(services: ServicesDep) -> SceneView:
    """Camera and layers of the live scene."""
    return _view(services.scene)


@router.patch("", responses=responses(422))
async def change_scene(services: ServicesDep, body: SceneChange) -> SceneView:
    """Take all browsers to a camera, and show or hide layers."""
    await asyncio.to_thread(services.scene.arrange, body.camera, body.layers)
    return _view(services.scene)


@router.put("/futures", status_code=204, responses=responses(404, 409, 422))
async def show_futures(services: ServicesDep, body: FuturesChoice) -> None:
    """Draw the futures of a rehearsal of the live mission, for all browsers: the most likely one, the worst, others.

    They stay until the mission begins again, or others take their place.
    """
    job = services.rehearsals.job(body.rehearsal, RehearsalJob)
    await asyncio.to_thread(services.scene.foretell, _case(job, body.case))


@router.delete("/futures", status_code=204)
async def hide_futures(services: ServicesDep) -> None:
    """Draw no futures any more."""
    await asyncio.to_thread(services.scene.foretell, None)


def _case(job: RehearsalJob, name: str) -> CaseResult:
    if job.run is not None:
        raise JobRefused(f"rehearsal {job.id} is of run {job.run}, and the live scene shows the live mission")
    if job.concluded is None:
        raise JobRefused(f"rehearsal {job.id} is {job.status}: it has no futures to draw")
    case: CaseResult | None = getattr(RehearsalResult.model_validate_json(job.concluded.json), name)
    if case is None:
        raise JobRefused(f"rehearsal {job.id} was made without changes: it has the case as_it_is only")
    return case


def _view(scene: Scene) -> SceneView:
    return SceneView(camera=scene.camera, cameras=list(CAMERAS), layers=scene.layers)
