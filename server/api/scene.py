"""`/scene`: what of the live mission's scene is drawn, and from where it is looked at; for all browsers alike."""

from __future__ import annotations

import asyncio

from fastapi import APIRouter
from pydantic import BaseModel, ConfigDict, Field, field_validator

from server.api.services import ServicesDep
from server.edge.problem_json import responses
from server.edge.values import Flag
from server.scene import CAMERAS, LAYERS, CameraName, Scene

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


@router.get("")
async def scene(services: ServicesDep) -> SceneView:
    """Camera and layers of the live scene."""
    return _view(services.scene)


@router.patch("", responses=responses(422))
async def change_scene(services: ServicesDep, body: SceneChange) -> SceneView:
    """Take all browsers to a camera, and show or hide layers."""
    await asyncio.to_thread(services.scene.arrange, body.camera, body.layers)
    return _view(services.scene)


def _view(scene: Scene) -> SceneView:
    return SceneView(camera=scene.camera, cameras=list(CAMERAS), layers=scene.layers)
