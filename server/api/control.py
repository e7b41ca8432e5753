"""`/mission/control`: which operator is in control of the live mission, and how that changes."""

from __future__ import annotations

from typing import Literal, Self

from fastapi import APIRouter
from pydantic import BaseModel, ConfigDict, Field, model_validator

from server.api.mission import answered
from server.api.problem_json import responses
from server.api.services import AskerDep, ServicesDep
from server.control import Control
from server.inbox import CommandAnswer, CommandName, Request
from sim.errors import MissionRefused

router = APIRouter(prefix="/mission/control", tags=["mission"])


class ControlStatus(BaseModel):
    """Who is in control, and who could be."""

    control: Control
    operators: list[str] = Field(description="Names that may be in control; empty where no tokens are needed")


class ControlRequest(BaseModel):
    """A change of hands."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"examples": [{"action": "take"}, {"action": "hand_over", "to": "ben"}]}
    )

    action: Literal["take", "relieve", "hand_over", "release"] = Field(
        description="`take` what is free or offered; `relieve` who has it; `hand_over` to who then takes it; `release`"
    )
    to: str | None = Field(None, max_length=40, description="With `hand_over`: the name of the other operator")

    @model_validator(mode="after")
    def _to_belongs_to_handing_over(self) -> Self:
        if (self.to is not None) != (self.action == "hand_over"):
            raise ValueError(f"to = {self.to!r}: hand_over, and only that, says to whom; this is {self.action}")
        return self


_COMMANDS: dict[str, CommandName] = {
    "take": "take_control",
    "relieve": "relieve",
    "hand_over": "hand_over",
    "release": "release_control",
}


@router.get("")
async def control(services: ServicesDep) -> ControlStatus:
    """Who is in control; every snapshot tells that too."""
    operators = services.access.tokens.operators() if services.access.required else ()
    return ControlStatus(control=services.loop.control, operators=list(operators))


@router.post("", responses=responses(409, 422, 503, 504))
async def change_control(services: ServicesDep, asker: AskerDep, body: ControlRequest) -> CommandAnswer:
    """Take control, hand it over, release it, or relieve who has it; the mission's log tells who did so."""
    operators = services.access.tokens.operators() if services.access.required else ()
    if body.to is not None and body.to not in operators:
        known = ", ".join(operators) or "nobody: no tokens are needed here, so there is one operator only"
        raise MissionRefused(f"to = {body.to!r} is no operator; known: {known}")
    return await answered(services, Request(_COMMANDS[body.action], who=asker, to=body.to or ""))
