"""`/mission/control`: which operator is in control of the live mission, and how that changes."""

from __future__ import annotations

from collections import Counter
from typing import Self

from fastapi import APIRouter
from pydantic import BaseModel, ConfigDict, Field, model_validator

from server.api.mission import answered
from server.api.services import AskerDep, PatienceDep, Services, ServicesDep
from server.edge.problem_json import responses
from server.mission.control import ControlCommand
from server.mission.inbox import CommandAnswer, Request
from server.published import Control
from sim.errors import MissionRefused

router = APIRouter(prefix="/mission/control", tags=["mission"])


class ControlStatus(BaseModel):
    """Who is in control, who could be, and who watches."""

    control: Control
    watching: dict[str, int] = Field(description="Who watches the live mission now, and on how many pages")
    operators: list[str] = Field(description="Names that may be in control; empty where no tokens are needed")


class ControlRequest(BaseModel):
    """A change of hands."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={"examples": [{"action": "take_control"}, {"action": "hand_over", "to": "ben"}]},
    )

    action: ControlCommand = Field(
        description="Take what is free or offered, relieve who has it, hand it over to who then takes it, release it"
    )
    to: str | None = Field(None, max_length=40, description="With `hand_over`: the name of the other operator")

    @model_validator(mode="after")
    def _to_belongs_to_handing_over(self) -> Self:
        if (self.to is not None) != (self.action == "hand_over"):
            raise ValueError(f"to = {self.to!r}: hand_over, and only that, says to whom; this is {self.action}")
        return self


def _operators(services: Services) -> tuple[str, ...]:
    """Who may be in control; nobody where all are the same operator."""
    return services.access.tokens.operators() if services.access.required else ()


@router.get("")
async def control(services: ServicesDep) -> ControlStatus:
    """Who is in control; every snapshot says that, too."""
    watching = dict(Counter(subscriber.name for subscriber in services.feed.subscribers))
    return ControlStatus(control=services.loop.desk.control, watching=watching, operators=list(_operators(services)))


@router.post("", responses=responses(409, 422, 503, 504))
async def change_control(
    services: ServicesDep, asker: AskerDep, patience: PatienceDep, body: ControlRequest
) -> CommandAnswer:
    """Take control, hand it over, release it, or relieve who has it; the mission's log says who did so."""
    operators = _operators(services)
    if body.to is not None and body.to not in operators:
        known = ", ".join(operators) or "nobody: no tokens are needed here, so there is one operator only"
        raise MissionRefused(f"to = {body.to!r} is no operator; known: {known}")
    await patience.until_ready()
    return await answered(services, Request(body.action, who=asker, to=body.to or ""))
