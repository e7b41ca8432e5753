"""`/fits`: which numbers of contact, servos, target, table and sensors explain recorded runs."""

from __future__ import annotations

import asyncio
import pickle
from collections.abc import Sequence
from pathlib import Path as FilePath
from typing import Annotated, Literal

from fastapi import APIRouter, Query, Response
from pydantic import BaseModel, ConfigDict, Field
from starlette.convertors import StringConvertor, register_url_convertor

from server.api.presets import KeptPreset, kept_preset
from server.api.rehearsals import JobId, JobProgress
from server.api.reports import REPORT, report_response
from server.api.services import AskerDep, ServicesDep
from server.edge.problem_json import responses
from server.edge.values import ShortText
from server.errors import JobRefused
from server.fits.jobs import FitJob
from server.fits.recorded import preset_of, recorded_plan
from server.instants import wall_clock
from server.jobs.job import JobStatus
from server.library.presets import NAME
from server.library.runs import RunStore
from server.reports.formats import ReportFormat, written
from sim.config import MissionConfig
from sim.identification.fit import MOST_RUNS, FitPlan
from sim.identification.parameters import ALL, DEFAULT, parameter_of
from sim.identification.result import FitResult

router = APIRouter(prefix="/fits", tags=["fits"], responses=responses(422))


class _FitConvertor(StringConvertor):
    """No fit is called as the address beside them all."""

    regex = "(?!parameters$)[^/]+"


register_url_convertor("fit", _FitConvertor())

RunIds = Annotated[list[ShortText], Field(max_length=MOST_RUNS)]


class FitRequest(BaseModel):
    """A fit to be made."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={
            "examples": [
                {"runs": ["20261125T103000123-4f9a2c"]},
                {
                    "runs": ["20261125T103000123-4f9a2c"],
                    "parameters": ["contact.stiffness", "contact.damping", "table.drag"],
                    "held_out": ["20261125T104500456-81b0e2"],
                },
            ]
        },
    )

    runs: RunIds = Field(min_length=1, description="Identifiers of the runs that are explained together")
    parameters: list[ShortText] | None = Field(
        None, max_length=len(ALL), description="What is fitted, by name; null: what usually is"
    )
    held_out: RunIds = Field(default_factory=list, description="Runs whose peak forces are only foretold")
    asker: Annotated[str, Field(max_length=64)] = Field(
        "", description="Which of your pages or scripts asks: the newest request of one takes the place of its older"
    )


class FitDetail(BaseModel):
    """A fit, and what it found once it has finished."""

    id: str
    status: JobStatus
    created: str = Field(description="ISO 8601, UTC")
    asker: str
    note: str | None = Field(description="What is being done, or why it failed or was superseded")
    progress: JobProgress = Field(description="In thousandths")
    runs: list[str]
    held_out: list[str]
    parameters: list[str]
    result: FitResult | None = Field(description="Null until it has finished")


class FittableParameter(BaseModel):
    """Something that can be fitted."""

    name: str
    unit: str
    description: str
    usual: bool = Field(description="Whether it is fitted where nothing is chosen")
    in_configuration: bool = Field(description="Whether a preset can keep it")


class PresetName(BaseModel):
    """The name of a preset."""

    model_config = ConfigDict(extra="forbid")

    name: str = Field(pattern=f"^{NAME}$", examples=["as the lab's robot is"])


@router.post("", status_code=202, responses=responses(404, 409, 503))
async def start_fit(services: ServicesDep, asker: AskerDep, body: FitRequest, response: Response) -> FitDetail:
    """Find which numbers explain runs: rollouts under their recorded commands, by least squares.

    What a run cannot tell is said, and stays nominal. Nothing is kept but the result, until the service ends.
    """
    root = services.store.root
    pickled = await services.aside.answer(_planned, root, body.runs, body.parameters, body.held_out)
    plan: FitPlan = pickle.loads(pickled)
    job = FitJob(f"{asker}/{body.asker}" if body.asker else asker, plan)
    services.fits.add(job)
    response.headers["Location"] = f"/api/v1/fits/{job.id}"
    return _detail(job)


def _planned(root: FilePath, runs: Sequence[str], names: Sequence[str] | None, held_out: Sequence[str]) -> bytes:
    store = RunStore(root)
    return pickle.dumps(
        recorded_plan([store.read(each) for each in runs], names, [store.read(each) for each in held_out])
    )


@router.get("/parameters")
def fittable_parameters() -> list[FittableParameter]:
    """What can be fitted, with units."""
    return [
        FittableParameter(
            name=each.name,
            unit=each.unit,
            description=each.description,
            usual=each.name in DEFAULT,
            in_configuration=each.in_configuration,
        )
        for each in (parameter_of(MissionConfig(), name) for name in ALL)
    ]


@router.get("/{fit_id:fit}", responses=responses(404))
def fit(services: ServicesDep, fit_id: JobId) -> FitDetail:
    """One fit: its progress, and its result once it has finished."""
    return _detail(services.fits.job(fit_id, FitJob))


@router.get(
    "/{fit_id}/report",
    response_model=FitResult,
    responses={**REPORT, **responses(404, 409, 503)},
)
async def fit_report(
    services: ServicesDep,
    fit_id: JobId,
    report_format: Annotated[
        Literal["json"] | ReportFormat, Query(alias="format", description="json, html or pdf")
    ] = "html",
) -> Response:
    """What it found as one self-contained page, or PDF."""
    result = _result(services.fits.job(fit_id, FitJob))
    if report_format == "json":
        return Response(result.model_dump_json(), media_type="application/json")
    content = await services.aside.answer(_report, result, report_format)
    return report_response(content, report_format, f"fit-{fit_id}")


def _report(result: FitResult, report_format: ReportFormat) -> bytes:
    from server.fits.report import fit_document  # noqa: PLC0415 - what draws takes a second to load

    return written(fit_document(result), report_format)


@router.post("/{fit_id}/preset", responses=responses(404, 409, 503))
async def keep_fit_as_preset(services: ServicesDep, asker: AskerDep, fit_id: JobId, body: PresetName) -> KeptPreset:
    """Keep the first run's configuration with the fitted values as a preset."""
    job: FitJob = services.fits.job(fit_id, FitJob)
    result = _result(job)
    record = await asyncio.to_thread(services.store.record, result.runs[0])
    preset = preset_of(body.name, record, result.preset, asker, wall_clock())
    await asyncio.to_thread(services.disk.require_folder)
    await asyncio.to_thread(services.presets.keep, preset)
    return kept_preset(preset)


@router.post("/{fit_id}/cancel", responses=responses(404, 409))
def cancel_fit(services: ServicesDep, fit_id: JobId) -> FitDetail:
    """End a fit that waits or goes on."""
    job: FitJob = services.fits.job(fit_id, FitJob)
    services.fits.cancel(job)
    return _detail(job)


@router.delete("/{fit_id:fit}", status_code=204, responses=responses(404))
def delete_fit(services: ServicesDep, fit_id: JobId) -> Response:
    """Forget a fit; one that waits or goes on is cancelled."""
    services.fits.remove(services.fits.job(fit_id, FitJob))
    return Response(status_code=204)


def _result(job: FitJob) -> FitResult:
    if job.result is None:
        raise JobRefused(f"fit {job.id} is {job.status}: it has found nothing yet", tip="wait until it has finished")
    return job.result


def _detail(job: FitJob) -> FitDetail:
    plan = job.plan
    return FitDetail(
        id=job.id,
        status=job.status,
        created=job.created,
        asker=job.asker,
        note=job.note,
        progress=JobProgress(done=job.done, total=job.total, wall_time=job.wall_time),
        runs=[each.name for each in plan.recordings],
        held_out=[each.name for each in plan.held_out],
        parameters=[each.name for each in plan.parameters],
        result=job.result if job.status == "finished" else None,
    )
