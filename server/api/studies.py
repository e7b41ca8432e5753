"""`/studies`: many captures that differ in chosen parameters, their rows as they come, and each cell as a run."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from itertools import islice
from pathlib import Path as FilePath
from typing import Annotated

from fastapi import APIRouter, Path, Query, Response
from fastapi.responses import StreamingResponse
from pydantic import BaseModel, ConfigDict, Field, JsonValue
from starlette.convertors import StringConvertor, register_url_convertor

from server.api.reports import REPORT, FormatOfReport, report_response
from server.api.runs import Run, Unreadable, run_of
from server.api.services import Services, ServicesDep
from server.edge.etags import IfNoneMatch, known_or_new, tagged
from server.edge.problem_json import responses
from server.edge.streamed import Streamed
from server.edge.values import Changes, Flag, Integer, ShortText
from server.errors import StudyNotFound
from server.library.changes import display_name
from server.library.runs import new_record
from server.reports.formats import ReportFormat, written
from server.studies.store import StudyRecord, StudyStatus, StudyStore
from sim.reproduction.published import (
    DAMPING,
    MASS,
    STIFFNESS,
    Agreement,
    agreement,
    is_comparable,
    named_study,
    published_classes,
)
from sim.study.axes import Distribution, SampleMethod, Value, parameter_words
from sim.study.design import Study, altered, configured, study_of
from sim.study.export import TableFormat, export
from sim.study.flight import MANY_CELLS, Progress
from sim.study.outcome_frequencies import OutcomeFrequency, outcome_frequencies
from sim.study.summaries import SUMMARIZED, MeasureSummary, measure_summaries

router = APIRouter(prefix="/studies", tags=["studies"], responses=responses(422))

StudyId = Annotated[str, Path(description="Identifier of a study", examples=["20261125T103000123-4f9a2c"])]
CellIndex = Annotated[int, Path(ge=0, description="Place of a cell in the study, from 0")]

PIECE = 2**18
"""Bytes of a table that are sent at once."""

LONG_AXIS = 200
"""Values of an axis that an estimate lists; of more it lists the first and the last."""

MEDIA_TYPES: dict[TableFormat, str] = {
    TableFormat.CSV: "text/csv; charset=utf-8",
    TableFormat.PARQUET: "application/vnd.apache.parquet",
    TableFormat.JSON: "application/json",
}


class _StudyConvertor(StringConvertor):
    """No study is called as the address beside them all: `GET` of that is a wrong method (405), not a lost study."""

    regex = "(?!estimate$)[^/]+"


register_url_convertor("study", _StudyConvertor())


class StudyRequest(BaseModel):
    """A study to be flown: a named one, or one that is defined here."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={
            "examples": [
                {"study": "published"},
                {
                    "study": {
                        "name": "spins",
                        "configuration": "published",
                        "grid": {"target.initial_spin": {"from": 0.5, "to": 1.5, "count": 5}},
                        "samples": {
                            "count": 8,
                            "method": "sobol",
                            "over": {"target.mass": {"mean": 2.35, "deviation": 0.1}},
                        },
                    },
                    "seed": 1,
                },
            ]
        },
    )

    study: ShortText | dict[str, JsonValue] = Field(
        description="A named study, or a definition as a study file holds it"
    )
    changes: Changes = Field(default_factory=dict, description="Nested changes to what all cells share")
    seed: Integer | None = Field(None, ge=0, le=2**63 - 1, description="In place of the study's own")
    confirm: Flag = Field(False, description="A study of very many cells is meant")


class StudySummary(BaseModel):
    """A study of the service."""

    id: str
    name: str
    status: StudyStatus
    created: str = Field(description="ISO 8601, UTC")
    ended: str | None
    note: str | None = Field(description="Why it failed")
    notices: tuple[str, ...] = Field(description="What this version ignores of what an earlier one stored, and why")
    progress: Progress
    versions: dict[str, str]


class StudyAxis(BaseModel):
    """One varied parameter."""

    path: str
    unit: str
    description: str
    count: int | None = Field(description="How many values it has on the grid; null if it is drawn")
    values: list[Value] | None = Field(description="On the grid, in their order; null if it is drawn")
    drawn_from: Distribution | None = Field(description="Of a sample; null on the grid")

    def shortened(self) -> StudyAxis:
        """The same, of a long axis the first and the last values only."""
        if self.values is None or len(self.values) <= LONG_AXIS:
            return self
        half = LONG_AXIS // 2
        return self.model_copy(update={"values": [*self.values[:half], *self.values[-half:]]})


class StudyEstimate(BaseModel):
    """What a study would be, if it were started now."""

    cells: int
    axes: list[StudyAxis] = Field(description="What varies, with every value of the grid's axes that are not too long")
    seconds: float | None = Field(description="To fly it, wall time [s]; null while that is measured, or cannot be")
    measuring: bool = Field(description="The time is being measured: ask again in a second")
    basis: str = Field(description="What the time follows from, or why there is none")
    age: float | None = Field(description="How long ago that was measured [s]")
    studies_before: int = Field(description="Studies that fly or wait now, and come first")
    confirmation_needed: bool = Field(description="So many cells are flown only if that is confirmed")


class StudyColumn(BaseModel):
    """One column of the rows."""

    name: str
    kind: str = Field(description="float, int, bool or str")
    unit: str
    description: str


class StudyDetail(StudySummary):
    """A study with its definition and what came out until now."""

    definition: dict[str, JsonValue]
    axes: list[StudyAxis]
    sample_method: SampleMethod | None
    columns: list[StudyColumn]
    outcomes: list[OutcomeFrequency]
    measures: list[MeasureSummary] = Field(description="Of a study that is a sample; empty with a grid")
    agreement: list[Agreement] | None = Field(description="With the paper's tables, where they can be laid beside")


class StudyPage(BaseModel):
    """Studies, newest first."""

    studies: list[StudySummary]
    unreadable: list[Unreadable] = Field(description="Studies of other versions, and damaged ones; on the first page")
    next_cursor: str | None = Field(description="For the next page; null on the last one")


class StudyRowPage(BaseModel):
    """Rows in the order in which their cells ended."""

    rows: list[dict[str, JsonValue]]
    last: int = Field(description="Give it as `after` to get what came later")


class PublishedCell(BaseModel):
    """What the paper prints for one cell."""

    mass: float = Field(description="published.impedance.mass [kg]")
    damping: float = Field(description="published.impedance.damping [N s/m]")
    stiffness: float = Field(description="published.impedance.stiffness [N/m]")
    outcome: str = Field(description="Judged at the first closure")


class PublishedTables(BaseModel):
    """The tables of the paper's parametric study that Becalm has."""

    source: str
    paths: list[str] = Field(description="Parameters of mass, damping and stiffness, in this order")
    cells: list[PublishedCell]


@router.post("", status_code=202, responses=responses(409, 503, 507))
def start_study(services: ServicesDep, body: StudyRequest, response: Response) -> StudyDetail:
    """Queue a study. One of more than 10 000 cells is refused (409) with the time it takes until it is confirmed."""
    of = _requested(body)
    services.disk.require_room()
    record = services.study_queue.add(of, confirmed=body.confirm)
    response.headers["Location"] = f"/api/v1/studies/{record.id}"
    return _detail(services, record)


@router.post("/estimate")
def estimate_study(services: ServicesDep, body: StudyRequest) -> StudyEstimate:
    """How many cells a study has and how long it would take, by some of its cells flown now; nothing is started.

    Answered at once: while the time is measured it is null. One study is measured at a time, the one asked for last.
    """
    of = _requested(body)
    return StudyEstimate(
        cells=of.count,
        axes=[axis.shortened() for axis in _axes(of)],
        **services.study_queue.estimate(of)._asdict(),
        confirmation_needed=of.count > MANY_CELLS,
    )


@router.get("")
def studies(
    services: ServicesDep,
    response: Response,
    limit: Annotated[int, Query(ge=1, le=200, description="Studies on a page")] = 50,
    cursor: Annotated[ShortText | None, Query(description="`next_cursor` of the page before")] = None,
    if_none_match: IfNoneMatch = None,
) -> StudyPage:
    """The studies, newest first; with an `ETag`, so that who asks again and again is sent only what has changed."""
    found = list(islice(services.studies.newest(before=cursor), limit + 1))
    shown = [_summary(services, record) for record in found[:limit]]
    strange = {} if cursor else services.studies.unreadable()
    unreadable = [Unreadable(id=name, reason=why) for name, why in strange.items()]
    page = StudyPage(
        studies=shown, unreadable=unreadable, next_cursor=found[limit - 1].id if len(found) > limit else None
    )
    return tagged(page, response, if_none_match)


@router.get("/published/tables")
def published_tables(response: Response, if_none_match: IfNoneMatch = None) -> PublishedTables:
    """The paper's own tables, cell by cell (m = 0.01 and 0.1 kg)."""
    tables = PublishedTables(
        source="Uchida, Uno, Yoshida: Space Debris Reliable Capturing by a Dual-Arm Orbital Robot, iSpaRo 2024",
        paths=[MASS, DAMPING, STIFFNESS],
        cells=[PublishedCell(**cell._asdict(), outcome=outcome) for cell, outcome in published_classes().items()],
    )
    return tagged(tables, response, if_none_match)


@router.get("/{study_id:study}", response_model=StudyDetail, responses=responses(404, 409, 503))
async def study(services: ServicesDep, study_id: StudyId, if_none_match: IfNoneMatch = None) -> Response:
    """One study, and what came out until now; with an `ETag`."""
    summary = _summary(services, services.studies.record(study_id))
    content = await services.aside.answer(_detail_aside, services.studies.root, summary)
    return known_or_new(content, if_none_match)


def _detail_aside(root: FilePath, summary: StudySummary) -> bytes:
    studies = StudyStore(root)
    return _detailed(studies, studies.record(summary.id), summary).model_dump_json(by_alias=True).encode()


@router.delete("/{study_id:study}", status_code=204, responses=responses(404, 409))
def delete_study(services: ServicesDep, study_id: StudyId) -> Response:
    """Remove a study that has ended, with all its rows."""
    services.study_queue.delete(study_id)
    return Response(status_code=204)


@router.post("/{study_id}/cancel", responses=responses(404, 409))
def cancel_study(services: ServicesDep, study_id: StudyId) -> StudyDetail:
    """End a study; it ends after the cells in flight, and its rows stay."""
    return _detail(services, services.study_queue.cancel(study_id))


@router.post("/{study_id}/resume", status_code=202, responses=responses(404, 409, 503, 507))
def resume_study(services: ServicesDep, study_id: StudyId) -> StudyDetail:
    """Go on with a study that was cancelled or has failed, from the rows that it has."""
    services.disk.require_room()
    return _detail(services, services.study_queue.resume(study_id))


@router.get("/{study_id}/rows", response_model=StudyRowPage, responses=responses(404, 503))
async def rows(
    services: ServicesDep,
    study_id: StudyId,
    after: Annotated[int, Query(ge=0, le=2**63 - 1, description="`last` of the page before")] = 0,
    limit: Annotated[int, Query(ge=1, le=10_000, description="Rows on a page")] = 2_000,
    if_none_match: IfNoneMatch = None,
) -> Response:
    """The rows that came after a row: what a map that fills asks for."""
    content = await services.aside.answer(_rows, services.studies.root, study_id, after, limit)
    return known_or_new(content, if_none_match)


def _rows(root: FilePath, study_id: str, after: int, limit: int) -> bytes:
    studies = StudyStore(root)
    kept = studies.rows(studies.record(study_id)).rows_after(after, limit)
    page = StudyRowPage(rows=[each.row for each in kept], last=kept[-1].sequence if kept else after)
    return page.model_dump_json(by_alias=True).encode()


@router.get(
    "/{study_id}/results",
    response_class=StreamingResponse,
    responses={200: {"content": {kind: {} for kind in MEDIA_TYPES.values()}}, **responses(404, 503)},
)
async def results(
    services: ServicesDep,
    study_id: StudyId,
    table_format: Annotated[TableFormat, Query(alias="format", description="csv, parquet or json")] = TableFormat.CSV,
) -> StreamingResponse:
    """The table, ordered by cell, with the rows that are there now."""
    pieces = await services.aside.stream(_results, services.studies.root, study_id, table_format)
    disposition = f'attachment; filename="becalm-study-{study_id}.{table_format}"'
    return Streamed(pieces, MEDIA_TYPES[table_format], {"Content-Disposition": disposition})


def _results(root: FilePath, study_id: str, table_format: TableFormat) -> Iterator[bytes]:
    studies = StudyStore(root)
    table = studies.rows(studies.record(study_id))
    with tempfile.TemporaryDirectory(prefix="becalm-results-") as folder:
        path = FilePath(folder, f"study.{table_format}")
        export(table, path, table_format)
        with path.open("rb") as file:
            while piece := file.read(PIECE):
                yield piece


@router.get("/{study_id}/report", response_class=Response, responses={**REPORT, **responses(404, 503)})
async def study_report(services: ServicesDep, study_id: StudyId, report_format: FormatOfReport = "html") -> Response:
    """The study for an appendix: what varied, how often each class came, maps and measures of the rows there are."""
    content = await services.aside.answer(_report, services.studies.root, study_id, report_format)
    return report_response(content, report_format, f"study-{study_id}")


def _report(root: FilePath, study_id: str, report_format: ReportFormat) -> bytes:
    from server.reports.study_report import study_document  # noqa: PLC0415 - what draws takes a second to load

    studies = StudyStore(root)
    record = studies.record(study_id)
    return written(study_document(record, studies.rows(record)), report_format)


@router.post("/{study_id}/cells/{index}/run", status_code=202, responses=responses(404, 503, 507))
def run_cell(services: ServicesDep, study_id: StudyId, index: CellIndex, response: Response) -> Run:
    """Fly one cell again, recording every tick, as a run of the library; it ends bit for bit as its row says."""
    of = services.studies.record(study_id).study
    if index >= of.count:
        raise StudyNotFound(f"study {study_id} has {of.count} cells, numbered from 0; there is none at {index}")
    config = configured(of.base, of.cell(index))
    name = display_name(of.configuration, config)
    record = new_record("study", name, config, direct=of.direct, status="queued", parent=study_id)
    services.scripted.queue([record], services.disk.require_room)
    response.headers["Location"] = f"/api/v1/runs/{record.id}"
    return run_of(services.store.read(record.id))


def _requested(body: StudyRequest) -> Study:
    """The study that somebody asks for."""
    chosen = named_study(body.study) if isinstance(body.study, str) else study_of(body.study)
    return altered(chosen, body.changes, body.seed)


def _summary(services: Services, record: StudyRecord) -> StudySummary:
    shared = record.model_dump(include=set(StudySummary.model_fields))
    return StudySummary(**shared, notices=record.notices, progress=services.study_queue.progress(record))


def _detail(services: Services, record: StudyRecord) -> StudyDetail:
    return _detailed(services.studies, record, _summary(services, record))


def _detailed(studies: StudyStore, record: StudyRecord, summary: StudySummary) -> StudyDetail:
    of, table = record.study, studies.rows(record)
    impedances = table.rows("cell", MASS, DAMPING, STIFFNESS, "at_first_closure")
    return StudyDetail(
        **dict(summary),
        definition=record.definition,
        axes=_axes(of),
        sample_method=of.samples.method if of.samples else None,
        columns=[
            StudyColumn(name=each.name, kind=each.kind.__name__, unit=each.unit, description=each.description)
            for each in table.columns
        ],
        outcomes=outcome_frequencies(of, table.rows("outcome")),
        measures=measure_summaries(of, table.rows(*(column.name for column in SUMMARIZED))),
        agreement=agreement(impedances) if is_comparable(of) else None,
    )


def _axes(of: Study) -> list[StudyAxis]:
    drawn = of.samples.over if of.samples else {}
    return [
        StudyAxis(
            path=path,
            unit=parameter_words(path)[0],
            description=parameter_words(path)[1],
            count=len(of.levels[path]) if path in of.levels else None,
            values=list(of.levels[path]) if path in of.levels else None,
            drawn_from=drawn.get(path),
        )
        for path in of.varied
    ]
