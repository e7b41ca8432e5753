"""`/atlases`: a map over two parameters around a state, its cells as they come."""

from __future__ import annotations

from functools import partial
from typing import Annotated

from fastapi import APIRouter, Path, Query, Response
from pydantic import BaseModel, ConfigDict, Field

from server.api.rehearsals import (
    FromState,
    JobDetail,
    JobId,
    asker_of,
    job_fields,
    queued_future,
    require_future,
    run_in,
    state_of,
)
from server.api.runs import Run
from server.api.services import AskerDep, PatienceDep, ServicesDep
from server.edge.problem_json import responses
from server.edge.values import Integer, Number, ShortText
from server.errors import JobNotFound
from server.rehearsals.jobs import AtlasJob
from sim.control.phases import Command
from sim.rehearsal.atlas import Atlas, AtlasAxis, AtlasCell, axis_between, planned_atlas
from sim.rehearsal.futures import begun
from sim.rehearsal.summary import BANDED, MEASURE_WORDS
from sim.rehearsal.uncertainty import draw, uncertainty_of
from sim.study.axes import parameter_words

router = APIRouter(prefix="/atlases", tags=["rehearsals"], responses=responses(422))


class AxisRequest(BaseModel):
    """One of the two parameters, evenly spaced, both ends included."""

    model_config = ConfigDict(extra="forbid", populate_by_name=True)

    path: ShortText = Field(description="Full path", examples=["published.impedance.damping"])
    start: Number = Field(alias="from")
    stop: Number = Field(alias="to")
    count: Integer = Field(11, description="Values, at most 21")


class AtlasRequest(FromState):
    """An atlas to be flown."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "source": "live",
                    "request": "capture",
                    "x": {"path": "published.impedance.damping", "from": 0, "to": 15, "count": 11},
                    "y": {"path": "published.impedance.stiffness", "from": 0, "to": 100, "count": 11},
                    "futures": 3,
                }
            ]
        }
    )

    x: AxisRequest
    y: AxisRequest
    futures: Integer = Field(3, description="Of each cell, at most 10")


class AtlasAxisDetail(BaseModel):
    """One of the two parameters."""

    path: str
    unit: str
    description: str
    values: list[float]
    present: float = Field(description="Its value in the configuration that the map is around")


class AtlasMeasure(BaseModel):
    """What a cell has a median of."""

    measure: str
    unit: str
    description: str


class AtlasDetail(JobDetail):
    """An atlas, and the cells that came since."""

    revision: int = Field(description="Give it as `after` to get what came later")
    x: AtlasAxisDetail
    y: AtlasAxisDetail
    measures: list[AtlasMeasure]
    cells: list[AtlasCell]


CellPlace = Annotated[int, Path(ge=0, le=2**31, description="On that axis, from 0")]

After = Annotated[int, Query(ge=0, le=2**31, description="`revision` of the last answer")]


@router.post("", status_code=202, responses=responses(404, 409, 503, 504))
async def start_atlas(
    services: ServicesDep, asker: AskerDep, patience: PatienceDep, body: AtlasRequest, response: Response
) -> AtlasDetail:
    """Fly a map over two parameters from a state, coarse first; nothing moves."""
    situation = (await state_of(services, patience, body.source)).situation
    plan = partial(
        planned_atlas,
        situation,
        body.changes,
        _axis(body.x, "x"),
        _axis(body.y, "y"),
        request=None if body.request is None else Command(body.request),
        uncertainty=uncertainty_of(body.uncertainty),
        futures=body.futures,
        seed=body.seed,
        horizon=body.horizon,
    )
    job = AtlasJob(asker_of(asker, body), await services.aside.wait_for(plan), run_in(body.source))
    services.rehearsals.add(job)
    response.headers["Location"] = f"/api/v1/atlases/{job.id}"
    return _detail(job, 0)


@router.get("/{atlas_id}", responses=responses(404))
def atlas(services: ServicesDep, atlas_id: JobId, after: After = 0) -> AtlasDetail:
    """One atlas, with the cells that came after that revision."""
    return _detail(services.rehearsals.job(atlas_id, AtlasJob), after)


@router.post("/{atlas_id}/cancel", responses=responses(404, 409))
def cancel_atlas(services: ServicesDep, atlas_id: JobId) -> AtlasDetail:
    """End an atlas; the cells that are there stay."""
    job: AtlasJob = services.rehearsals.job(atlas_id, AtlasJob)
    services.rehearsals.cancel(job)
    return _detail(job, len(job.cells))


@router.post("/{atlas_id}/cells/{x}/{y}/run", status_code=202, responses=responses(404, 503, 507))
def run_cell_future(
    services: ServicesDep,
    atlas_id: JobId,
    x: CellPlace,
    y: CellPlace,
    response: Response,
    future: Annotated[int, Query(ge=0, le=2**31, description="Of the cell, from 0")] = 0,
) -> Run:
    """Fly one future of a cell again, recording every tick, as a run of the library."""
    job: AtlasJob = services.rehearsals.job(atlas_id, AtlasJob)
    of = job.atlas
    if x >= len(of.x.values) or y >= len(of.y.values):
        raise JobNotFound(f"atlas {job.id} has {len(of.x.values)} x {len(of.y.values)} cells; none at {x}, {y}")
    require_future(future, of.futures, job)
    config = of.config_at(x, y)
    drawn = draw(of.situation, config, of.uncertainty, of.seed, future)
    told = f"future {future} of cell {x}, {y} of atlas {job.id}"
    opened = begun(of.situation, config, of.request, drawn, of.horizon)
    return queued_future(services, job, told, opened, response)


@router.delete("/{atlas_id}", status_code=204, responses=responses(404))
def delete_atlas(services: ServicesDep, atlas_id: JobId) -> Response:
    """Forget an atlas; one that waits or flies is cancelled."""
    services.rehearsals.remove(services.rehearsals.job(atlas_id, AtlasJob))
    return Response(status_code=204)


def _axis(asked: AxisRequest, name: str) -> AtlasAxis:
    return axis_between(asked.path, asked.start, asked.stop, asked.count, name)


def _detail(job: AtlasJob, after: int) -> AtlasDetail:
    of, cells = job.atlas, tuple(job.cells)
    return AtlasDetail(
        **job_fields(job, of.situation),
        run=job.run,
        request=None if of.request is None else of.request.value,
        futures=of.futures,
        seed=of.seed,
        revision=len(cells),
        x=_axis_detail(of, of.x),
        y=_axis_detail(of, of.y),
        measures=[
            AtlasMeasure(measure=name, unit=MEASURE_WORDS[name][0], description=MEASURE_WORDS[name][1])
            for name in BANDED
        ],
        cells=list(cells[after:]),
    )


def _axis_detail(of: Atlas, axis: AtlasAxis) -> AtlasAxisDetail:
    unit, description = parameter_words(axis.path)
    return AtlasAxisDetail(
        path=axis.path, unit=unit, description=description, values=list(axis.values), present=of.present(axis)
    )
