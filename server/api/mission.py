"""`/mission`: the live mission, what it is doing and what is asked of it."""

from __future__ import annotations

import asyncio
import secrets
from dataclasses import replace
from typing import Annotated, Any, Literal, Self

from fastapi import APIRouter, Query, Response
from pydantic import BaseModel, ConfigDict, Field, model_validator

from server.api.services import AskerDep, PatienceDep, Services, ServicesDep
from server.edge.problem_json import responses
from server.edge.values import Changes, Integer, Number, ShortText
from server.errors import LoopSilent
from server.library.changes import base_name
from server.library.plotted import History
from server.library.record import LoggedEvent
from server.library.run_state import RunState
from server.mission.arming import ARMED_TIME
from server.mission.fork import Fork, ForkParent, forked
from server.mission.inbox import CommandAnswer, Request, Revision, arguments_of
from server.published import ArmedCommand, MissionSnapshot
from server.versions import versions
from sim.configurations import NAMED_CONFIGURATIONS, REFERENCE_CONFIGURATION, revised
from sim.errors import MissionRefused, RunNotFound

ANSWER_TIME = 2.0
"""How long the mission thread may take to answer [s]."""

STEP_TIME = 1e-3
"""How much longer it may take for each tick of a step [s]."""

router = APIRouter(prefix="/mission", tags=["mission"], responses=responses(503))


class CommandRequest(BaseModel):
    """What an operator asks of the mission or, for the simulation, of its clock."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={
            "examples": [
                {"command": "capture"},
                {"command": "run", "speed": 0},
                {"command": "step", "ticks": 10},
                {"command": "reset", "configuration": "published_figures"},
                {"command": "reset", "configuration": "published", "changes": {"target": {"initial_spin": 0.8}}},
                {"command": "fork", "tick": 3000},
            ]
        },
    )

    command: Literal[
        "capture", "detumble", "cage", "direct_cage", "hold", "release", "reset", "pause", "run", "step", "fork"
    ]
    speed: Number | None = Field(
        None,
        ge=0,
        le=100,
        description="With `run`: multiple of real time, 0.1 to 100; 0 as fast as it goes",
    )
    ticks: Integer | None = Field(None, ge=1, le=100_000, description="With `step`: ticks to fly; 1 if left out")
    configuration: ShortText | None = Field(
        None, description="With `reset`: a named configuration; the present one if left out"
    )
    changes: Changes | None = Field(
        None, description="With `reset`: parameters that differ from that configuration, nested"
    )
    run: ShortText | None = Field(
        None, description="With `fork`: a run of the library; the present mission if left out"
    )
    tick: Integer | None = Field(None, ge=1, description="With `fork`: the first tick that is flown again")
    arming: str | None = Field(
        None, max_length=100, description="Token of `POST /mission/arming`; a robot is moved by no command without one"
    )

    @model_validator(mode="after")
    def _fields_belong_to_the_command(self) -> Self:
        owners = {
            "speed": "run",
            "ticks": "step",
            "configuration": "reset",
            "changes": "reset",
            "run": "fork",
            "tick": "fork",
        }
        for field, command in owners.items():
            if getattr(self, field) is not None and self.command != command:
                value = getattr(self, field)
                raise ValueError(f"{field} = {value}: it belongs to the command {command}, not to {self.command}")
        if self.command == "fork" and self.tick is None:
            raise ValueError("tick = None: fork says from which tick on the mission is flown again")
        if self.speed is not None and 0 < self.speed < 0.1:
            raise ValueError(f"speed = {self.speed:g}: it is 0 (as fast as it goes) or 0.1 to 100")
        return self


class ArmingRequest(BaseModel):
    """What will be asked of the mission next."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"command": "capture"}]})

    command: ArmedCommand
    configuration: str | None = Field(None, description="With `reset`: as the command will name it")
    changes: dict[str, Any] = Field(
        default_factory=dict,
        description="With `reset`: as the command will name them; with `configure`: the body of the PATCH of "
        "`/mission/config` that follows",
    )

    @model_validator(mode="after")
    def _fields_belong_to_the_command(self) -> Self:
        if self.configuration is not None and self.command != "reset":
            raise ValueError(f"configuration = {self.configuration!r}: it belongs to reset, not to {self.command}")
        if self.changes and self.command not in ("reset", "configure"):
            raise ValueError(f"changes = {self.changes!r}: they belong to reset and configure, not to {self.command}")
        return self


class Arming(BaseModel):
    """What the command that was armed has to bring."""

    token: str = Field(description="Good once, for who asked, for this command with these arguments, in this phase")
    command: ArmedCommand
    expires_in: float = Field(description="For how long it is good [s]")
    message: str


@router.get("", responses={200: {"model": MissionSnapshot}, **responses(422)})
async def mission(services: ServicesDep, patience: PatienceDep) -> Response:
    """The latest snapshot; its `outcome` is null until the mission has one."""
    await patience.until_ready()
    latest = services.feed.latest
    if latest is None:
        raise services.loop.not_ready()
    return Response(latest.encoded, media_type="application/json")


@router.get("/history", responses={200: {"model": History}, **responses(422)})
async def history(
    services: ServicesDep,
    since: Annotated[int, Query(description="Only ticks after this one")] = -1,
) -> Response:
    """The mission so far in under 1600 rows of the plotted columns, for a browser that comes late."""
    return Response("{" + services.feed.history.encoded(since) + "}", media_type="application/json")


@router.post("/commands", responses=responses(409, 422, 504))
async def command(services: ServicesDep, asker: AskerDep, patience: PatienceDep, body: CommandRequest) -> CommandAnswer:
    """Ask something of the mission; the answer says what the mission thread did."""
    await patience.until_ready()
    if body.command == "fork":
        services.loop.desk.require(asker)  # before it is flown again; the mission thread decides and logs all others
    ticks = body.ticks or 1
    # With a robot the mission thread refuses every fork: none is flown again before.
    wanted = body.tick if services.link is None else None
    fork = None if wanted is None else await asyncio.to_thread(_forked, services, body.run, wanted)
    request = Request(
        body.command,
        who=asker,
        speed=body.speed,
        ticks=ticks,
        configuration=body.configuration,
        revision=await _revision(services, body),
        arguments=arguments_of(body.configuration, body.changes),
        fork=fork,
        arming=body.arming,
    )
    before = await _state_before(services, body.command)
    answer = await answered(services, request, ANSWER_TIME + (STEP_TIME * ticks if body.command == "step" else 0.0))
    if before is None:
        services.foreseen.begun(services.loop.flight.run_id, body.command, services.loop.view.config)
    else:
        await asyncio.to_thread(services.foreseen.begun_unforeseen, before, body.command)
    return answer


async def _state_before(services: Services, command: str) -> RunState | None:
    """The state at the press of a command that somebody would have looked ahead of, had there been the time."""
    if services.loop.status != "ok":
        return None
    if not services.foreseen.is_wanted(services.loop.flight.run_id, command, services.loop.view.config):
        return None
    return await asyncio.to_thread(services.foreseen.state)


@router.post("/arming", responses=responses(409, 422, 504))
async def arm(services: ServicesDep, asker: AskerDep, patience: PatienceDep, body: ArmingRequest) -> Arming:
    """Arm a command: with a robot, all that move it or take it again are refused without the token that this gives."""
    await patience.until_ready()
    token = secrets.token_urlsafe(16)
    arguments = arguments_of(body.configuration, body.changes)
    request = Request("arm", who=asker, arms=body.command, arguments=arguments, arming=token)
    answer = await answered(services, request)
    return Arming(token=token, command=body.command, expires_in=ARMED_TIME, message=answer.message)


@router.post("/stop", responses=responses(504))
async def stop(services: ServicesDep, asker: AskerDep) -> CommandAnswer:
    """Stop: joint rates zero, in every phase, before everything else that waits."""
    return await answered(services, Request("stop", who=asker))


async def _revision(services: Services, body: CommandRequest) -> Revision | None:
    """The configuration that a reset with changes asks for, checked by who asks; None without changes."""
    if body.changes is None:
        return None
    named = NAMED_CONFIGURATIONS.get(body.configuration or "")
    base = services.loop.view.config if named is None else named
    return Revision(base, await asyncio.to_thread(revised, base, body.changes))


def _forked(services: Services, run_id: str | None, tick: int) -> Fork:
    """The present mission, or a run of the library, flown again to that tick.

    Raises:
        RunNotFound: there is no such run.
        MissionRefused: it has no such tick, or was flown by other versions, which may not fly it to the last bit.

    """
    flight = services.loop.flight
    parent = flight if run_id in (None, flight.run_id) else _kept_flight(services, run_id or "")
    return replace(forked(parent, tick), events=_events_before(services, parent.run_id, tick))


def _events_before(services: Services, run_id: str, tick: int) -> tuple[LoggedEvent, ...]:
    """What happened in that run before that tick; nothing of a run that was never put on disk."""
    try:
        logged = map(LoggedEvent.model_validate, services.store.read(run_id).events())
        return tuple(event for event in logged if event.tick < tick and event.takes_effect is None)
    except RunNotFound:
        return ()


def _kept_flight(services: Services, run_id: str) -> ForkParent:
    reader = services.store.read(run_id)
    if (ended := services.loop.ended_flights.find(run_id)) is not None:
        return ended
    if reader.record.versions != versions():
        what = f"run {run_id} was flown by {reader.record.versions}, this is {versions()}"
        raise MissionRefused(what, tip="fly it again with these versions, then fork that run")
    name = base_name(reader.record.configuration)
    known = name if name in NAMED_CONFIGURATIONS else REFERENCE_CONFIGURATION
    last = reader.last_tick()
    return ForkParent(run_id, known, reader.history(), 0 if last is None else int(last["tick"][0]) + 1)


async def answered(services: Services, request: Request, patience: float = ANSWER_TIME) -> CommandAnswer:
    """The mission thread's answer.

    Raises:
        CaptureError: what it refused the request with.
        LoopSilent: it did not answer within `patience` [s].

    """
    answer = asyncio.wrap_future(services.loop.ask(request))
    try:
        return await asyncio.wait_for(answer, patience)
    except TimeoutError:
        raise LoopSilent(
            f"the mission thread did not answer {request.command} within {patience:g} s",
            tip="GET /api/v1/mission shows whether it was done after all",
        ) from None
