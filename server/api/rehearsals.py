"""`/rehearsals`: what a request or an edit would do, with odds, from the live mission's state or a recorded one."""

from __future__ import annotations

import pickle
from functools import partial
from pathlib import Path as FilePath
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Path, Query, Response
from pydantic import BaseModel, ConfigDict, Field
from starlette.convertors import StringConvertor, register_url_convertor

from server.api.runs import Run, run_of
from server.api.services import AskerDep, Patience, PatienceDep, Services, ServicesDep
from server.edge.problem_json import responses
from server.edge.values import Changes, Integer, Number, ShortText
from server.errors import JobNotFound, JobRefused
from server.jobs.job import Job, JobStatus
from server.library.changes import display_name
from server.library.run_state import RunState
from server.library.runs import RunStore, new_record
from server.rehearsals.jobs import AtlasJob, RehearsalJob
from server.rehearsals.look_ahead import LookAheadView
from server.rehearsals.recorded import recorded_situation
from sim.capture.beginning import Beginning
from sim.config import MissionConfig
from sim.control.phases import Command
from sim.rehearsal.futures import begun
from sim.rehearsal.rehearsal import FUTURES, HORIZON, RehearsalResult, planned
from sim.rehearsal.situation import Situation
from sim.rehearsal.uncertainty import UncertaintyModel, draw, uncertainty_of

router = APIRouter(prefix="/rehearsals", tags=["rehearsals"], responses=responses(422))

JobId = Annotated[str, Path(description="Identifier", examples=["20261125T103000123-4f9a2c"])]

_NO_RESULT = b'"result":null}'

FutureNumber = Annotated[int, Path(ge=0, le=2**31, description="Of a future, from 0")]

Case = Literal["as_it_is", "as_changed"]

ResultFormat = Literal["json", "parquet"]


class _RehearsalConvertor(StringConvertor):
    """No rehearsal is called as the addresses beside them all."""

    regex = "(?!look-ahead$|uncertainty$)[^/]+"


register_url_convertor("rehearsal", _RehearsalConvertor())


class RecordedState(BaseModel):
    """A state of a run of the library."""

    model_config = ConfigDict(extra="forbid")

    run: ShortText = Field(description="Identifier of the run", examples=["20261125T103000123-4f9a2c"])
    at: Number = Field(ge=0, description="Mission time of the state [s]")


class FromState(BaseModel):
    """What rehearsals and atlases begin in, and what they draw."""

    model_config = ConfigDict(extra="forbid")

    source: Literal["live"] | RecordedState = Field("live", description="The live mission's state now, or a recorded")
    changes: Changes = Field(
        default_factory=dict, description="Nested changes to the configuration in force there, staged ones for example"
    )
    request: Literal["capture", "cage", "direct_cage"] | None = Field(
        "capture", description="What each future begins with; null: what is under way goes on"
    )
    seed: Integer = Field(0, ge=0, le=2**63 - 1, description="The same seed gives the same futures")
    horizon: Number = Field(HORIZON, description="Mission time after which a future is unresolved [s]")
    uncertainty: dict[str, Any] = Field(
        default_factory=dict, description="Fields of the uncertainty model that differ from its defaults"
    )
    asker: Annotated[str, Field(max_length=64)] = Field(
        "", description="Which of your pages or scripts asks: the newest request of one takes the place of its older"
    )


class RehearsalRequest(FromState):
    """A rehearsal to be flown; with changes, as it is and as changed."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {"source": "live", "request": "capture"},
                {
                    "source": {"run": "20261125T103000123-4f9a2c", "at": 2.5},
                    "changes": {"published": {"impedance": {"damping": 6.0}}},
                    "request": None,
                    "futures": 200,
                    "seed": 1,
                    "uncertainty": {"target_inertia": 0.3},
                },
            ]
        }
    )

    futures: Integer = Field(FUTURES, description="Of each configuration, at most 2000")


class JobProgress(BaseModel):
    """How far a rehearsal or an atlas has come."""

    done: int = Field(description="Futures, or cells of an atlas")
    total: int
    wall_time: float = Field(description="Since it was begun, to its end [s]")


class JobDetail(BaseModel):
    """What is said of rehearsals and atlases alike."""

    id: str
    status: JobStatus
    created: str = Field(description="ISO 8601, UTC")
    asker: str = Field(description="Whose newest request takes the place of an older one")
    note: str | None = Field(description="Why it failed or was superseded, or what it waits for")
    progress: JobProgress
    run: str | None = Field(description="The run that the state is of; null of the live mission")
    time: float = Field(description="Mission time of the state [s]")
    tick: int = Field(description="The first one that futures fly")
    phase: str = Field(description="Of the state")
    request: str | None
    futures: int = Field(description="Of each configuration, or of each cell")
    seed: int


class RehearsalDetail(JobDetail):
    """A rehearsal, and what came out once it has finished."""

    result: RehearsalResult | None = Field(description="Null until it has finished")


class UncertaintyField(BaseModel):
    """One field of the uncertainty model."""

    name: str
    unit: str
    description: str
    source: str = Field(description="Where the default comes from")
    default: float
    minimum: float
    maximum: float


class UncertaintyFields(BaseModel):
    """The uncertainty model: what is not known for sure, and how unsure it is taken to be."""

    fields: list[UncertaintyField]


@router.post("", status_code=202, responses=responses(404, 409, 503, 504))
async def start_rehearsal(
    services: ServicesDep, asker: AskerDep, patience: PatienceDep, body: RehearsalRequest, response: Response
) -> RehearsalDetail:
    """Rehearse: fly many futures from a state, each with its own draw of what is not known for sure.

    Nothing moves, and nothing is kept but the result, until the service ends. The live mission's state is what its
    controller believes, copied between two ticks.
    """
    seen = await state_of(services, patience, body.source)
    plan = partial(
        planned,
        seen.situation,
        body.changes,
        request=None if body.request is None else Command(body.request),
        uncertainty=uncertainty_of(body.uncertainty),
        futures=body.futures,
        seed=body.seed,
        horizon=body.horizon,
    )
    rehearsal = await services.aside.wait_for(plan)
    if body.source == "live":
        keep = partial(services.foreseen.rehearsed, seen.run)
        job = RehearsalJob(asker_of(asker, body), rehearsal, None, keep)
    else:
        job = RehearsalJob(asker_of(asker, body), rehearsal, seen.run)
    services.rehearsals.add(job)
    response.headers["Location"] = f"/api/v1/rehearsals/{job.id}"
    return _detail(job)


@router.get("/look-ahead", responses=responses(503))
def look_ahead(services: ServicesDep) -> LookAheadView:
    """Go or no-go for the request that would come next, by what 100 futures say.

    Asking is looking: it is made again every two seconds while somebody asks, and for nobody.
    """
    return services.look_ahead.now()


@router.get("/uncertainty")
def uncertainty_fields() -> UncertaintyFields:
    """What the uncertainty model has, with units, bounds, defaults and sources."""
    return UncertaintyFields(fields=[_field(name) for name in UncertaintyModel.model_fields])


def _field(name: str) -> UncertaintyField:
    field = UncertaintyModel.model_fields[name]
    extra: Any = field.json_schema_extra
    bounds: dict[str, Any] = {key: value for each in field.metadata for key, value in vars_of(each)}
    return UncertaintyField(
        name=name,
        unit=extra["unit"],
        description=str(field.description),
        source=extra["source"],
        default=field.default,
        minimum=bounds["ge"],
        maximum=bounds["le"],
    )


def vars_of(bound: Any) -> list[tuple[str, Any]]:
    """The bounds that an annotation sets, by name."""
    return [(name, getattr(bound, name)) for name in ("ge", "le") if hasattr(bound, name)]


@router.get("/{rehearsal_id:rehearsal}", response_model=RehearsalDetail, responses=responses(404))
def rehearsal(services: ServicesDep, rehearsal_id: JobId) -> Response:
    """One rehearsal: its progress, and its result once it has finished."""
    job: RehearsalJob = services.rehearsals.job(rehearsal_id, RehearsalJob)
    content = _detail(job).model_dump_json().encode()
    if job.concluded is not None:  # half a megabyte that the worker has written: it is not read to be written again
        content = content.removesuffix(_NO_RESULT) + b'"result":' + job.concluded.json + b"}"
    return Response(content, media_type="application/json")


@router.get(
    "/{rehearsal_id}/result",
    response_model=RehearsalResult,
    responses={
        200: {"content": {"application/vnd.apache.parquet": {}}},
        **responses(404, 409),
    },
)
def rehearsal_result(
    services: ServicesDep,
    rehearsal_id: JobId,
    result_format: Annotated[ResultFormat, Query(alias="format", description="json or parquet")] = "json",
) -> Response:
    """What its futures say; as Parquet a table with a row for each future."""
    job: RehearsalJob = services.rehearsals.job(rehearsal_id, RehearsalJob)
    if job.concluded is None:
        raise JobRefused(f"rehearsal {job.id} is {job.status}: it has no result", tip="wait until it has finished")
    if result_format == "json":
        return Response(job.concluded.json, media_type="application/json")
    disposition = f'attachment; filename="becalm-rehearsal-{job.id}.parquet"'
    return Response(
        job.concluded.parquet,
        media_type="application/vnd.apache.parquet",
        headers={"Content-Disposition": disposition},
    )


@router.post("/{rehearsal_id}/cancel", responses=responses(404, 409))
def cancel_rehearsal(services: ServicesDep, rehearsal_id: JobId) -> RehearsalDetail:
    """End a rehearsal that waits or flies."""
    job: RehearsalJob = services.rehearsals.job(rehearsal_id, RehearsalJob)
    services.rehearsals.cancel(job)
    return _detail(job)


@router.post("/{rehearsal_id}/futures/{future}/run", status_code=202, responses=responses(404, 409, 503, 507))
def run_future(
    services: ServicesDep,
    rehearsal_id: JobId,
    future: FutureNumber,
    response: Response,
    case: Annotated[Case, Query(description="Which of the two")] = "as_it_is",
) -> Run:
    """Fly one future again, recording every tick, as a run of the library; it ends bit for bit as was rehearsed."""
    job: RehearsalJob = services.rehearsals.job(rehearsal_id, RehearsalJob)
    of = job.rehearsal
    if case not in of.cases:
        raise JobNotFound(f"rehearsal {job.id} changes nothing: it has no case {case}", tip="take as_it_is")
    require_future(future, of.futures, job)
    drawn = draw(of.situation, of.cases[case], of.uncertainty, of.seed, future)
    told = f"future {future} of rehearsal {job.id}, {case.replace('_', ' ')}"
    opened = begun(of.situation, of.cases[case], of.request, drawn, of.horizon)
    return queued_future(services, job, told, opened, response)


@router.delete("/{rehearsal_id:rehearsal}", status_code=204, responses=responses(404))
def delete_rehearsal(services: ServicesDep, rehearsal_id: JobId) -> Response:
    """Forget a rehearsal; one that waits or flies is cancelled."""
    services.rehearsals.remove(services.rehearsals.job(rehearsal_id, RehearsalJob))
    return Response(status_code=204)


def require_future(future: int, futures: int, job: Job) -> None:
    """Refuse a future that was not flown.

    Raises:
        JobNotFound: it was not.

    """
    if future >= futures:
        what = f"{job.kind} {job.id} has {futures} futures, numbered from 0; there is none at {future}"
        raise JobNotFound(what)


def queued_future(
    services: Services,
    job: RehearsalJob | AtlasJob,
    told: str,
    opened: tuple[MissionConfig, Beginning],
    response: Response,
) -> Run:
    """A future as a run that waits to be flown."""
    config, beginning = opened
    name = display_name(services.loop.view.configuration, config)
    record = new_record("scripted", name, config, parent=job.run, note=told)
    services.scripted.queue([record], services.disk.require_room, beginning)
    response.headers["Location"] = f"/api/v1/runs/{record.id}"
    return run_of(services.store.read(record.id))


async def state_of(services: Services, patience: Patience, source: Literal["live"] | RecordedState) -> RunState:
    """The state that is asked for.

    Raises:
        MissionRefused: no future begins in it.
        RunNotFound: there is no such run.
        ServiceBusy: there is no mission yet.

    """
    if source == "live":
        await patience.until_ready()
        return await services.aside.wait_for(services.loop.situation)
    pickled = await services.aside.answer(_recorded, services.store.root, source.run, source.at)
    return RunState(source.run, pickle.loads(pickled))


def _recorded(root: FilePath, run_id: str, at: float) -> bytes:
    reader = RunStore(root).read(run_id)
    return pickle.dumps(recorded_situation(reader, at))


def run_in(source: Literal["live"] | RecordedState) -> str | None:
    """The run that a state is of; None of the live mission."""
    return None if source == "live" else source.run


def asker_of(asker: str, body: FromState) -> str:
    """Whose newest request takes the place of an older one."""
    return f"{asker}/{body.asker}" if body.asker else asker


def job_fields(job: Job, situation: Situation) -> dict[str, Any]:
    """What a detail says of any job."""
    return {
        "id": job.id,
        "status": job.status,
        "created": job.created,
        "asker": job.asker,
        "note": job.note,
        "progress": JobProgress(done=job.done, total=job.total, wall_time=job.wall_time),
        "time": situation.time,
        "tick": situation.tick,
        "phase": situation.phase.label,
    }


def _detail(job: RehearsalJob) -> RehearsalDetail:
    """Without what came out."""
    rehearsal = job.rehearsal
    return RehearsalDetail(
        **job_fields(job, rehearsal.situation),
        run=job.run,
        request=None if rehearsal.request is None else rehearsal.request.value,
        futures=rehearsal.futures,
        seed=rehearsal.seed,
        result=None,
    )
