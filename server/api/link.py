"""`/link`: the robot at the other end of zenoh, how well it is heard, and the taring of its wrists."""

from __future__ import annotations

import asyncio

from fastapi import APIRouter
from pydantic import Field

from server.api.services import AskerDep, ServicesDep
from server.edge.problem_json import responses
from server.link.status import NO_LINK, LinkStatus, status_of
from sim.control.phases import Phase
from sim.errors import MissionRefused
from sim.snapshot import FrozenMessage

router = APIRouter(prefix="/link", tags=["link"])

MOVING = (Phase.DETUMBLING.label, Phase.CAGING.label, Phase.RELEASED.label)


class Tared(FrozenMessage):
    """The wrist sensors have been tared."""

    message: str = Field(examples=["what both wrists read now counts as zero"])


@router.get("")
async def link(services: ServicesDep) -> LinkStatus:
    """Streams, clocks, latency, the robot's mode and who holds it; in simulation `plant` says that there is no link."""
    return NO_LINK if services.link is None else status_of(services.link)


@router.post("/tare", responses=responses(409, 503, 504))
async def tare(services: ServicesDep, asker: AskerDep) -> Tared:
    """Take what both wrists read now as zero; refused while the arms move or touch."""
    robot, latest = services.link, services.feed.latest
    if robot is None:
        raise MissionRefused("there is no robot: the simulation's wrists need no taring")
    if latest is None:
        raise services.loop.not_ready()
    services.loop.desk.require(asker)
    if latest.phase in MOVING:
        raise MissionRefused(f"taring is refused in phase {latest.phase}", tip="hold the arms first")
    answer = await asyncio.to_thread(robot.tare)
    if not answer.granted:
        raise MissionRefused(f"the robot refuses to tare: {answer.reason}", tip="reset takes the robot, then tare")
    return Tared(message="what both wrists read now counts as zero")
