"""`/runs`: scripted runs, the library of all runs, and their logs."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from pathlib import Path as FilePath
from typing import Annotated, Any, cast, get_args

import pydantic
from fastapi import APIRouter, Header, HTTPException, Path, Query, Response
from fastapi.responses import StreamingResponse
from pydantic import BaseModel, ConfigDict, Discriminator, Field, TypeAdapter

from server.api.reports import REPORT, FormatOfReport, report_response
from server.api.services import Services, ServicesDep
from server.edge.etags import IfNoneMatch, etag, known_or_new, tagged
from server.edge.problem_json import responses
from server.edge.streamed import Streamed
from server.edge.values import Changes, Flag, Instant, Integer, ShortText
from server.library.changes import ParameterChange, changes_of, display_name
from server.library.decimated import decimated
from server.library.export import MEDIA_TYPES, LogFormat, Span, exported
from server.library.index import RunIndex, RunQuery, SortKey
from server.library.plotted import History, HistoryColumn
from server.library.reader import RunReader
from server.library.record import Integrity, LoggedEvent, Note, Remarks, RunKind, RunName, RunRecord, RunStatus, Tag
from server.library.runs import RunStore, new_record
from server.library.sampled import SAMPLED, sampled
from server.reports.formats import ReportFormat, written
from sim.config import Engine, MissionConfig
from sim.configurations import DEFAULT_CONFIGURATION, named_configuration, revised
from sim.control.phases import Command, Phase, next_phase
from sim.errors import ConfigError, MissionRefused
from sim.method.method import method_of
from sim.rehearsal.rehearsal import RehearsalResult
from sim.snapshot import Outcome, OutcomeClass

router = APIRouter(prefix="/runs", tags=["runs"], responses=responses(422))

Since = Annotated[float | None, Query(alias="from", ge=0, allow_inf_nan=False, description="First mission time [s]")]
Until = Annotated[float | None, Query(alias="to", ge=0, allow_inf_nan=False, description="Last mission time [s]")]
RunId = Annotated[str, Path(description="Identifier of a run", examples=["20261122T113000123-4f9a2c"])]


class RunRequest(BaseModel):
    """A headless run to be flown."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={
            "examples": [
                {"configuration": "published", "changes": {"published": {"impedance": {"damping": 3.0}}}},
                {"direct": True, "seed": 7},
            ]
        },
    )

    configuration: ShortText = Field(DEFAULT_CONFIGURATION, description="A named configuration")
    changes: Changes = Field(default_factory=dict, description="Nested changes to it")
    direct: Flag = Field(False, description="Direct caging, without detumbling")
    seed: Integer | None = Field(None, ge=0, le=2**63 - 1, description="In place of `simulation.seed`")


OneRun = Annotated[RunRequest, pydantic.Tag("one")]
ManyRuns = Annotated[Annotated[list[RunRequest], Field(min_length=1, max_length=64)], pydantic.Tag("many")]


_EVENTS = TypeAdapter(list[LoggedEvent])


def _one_or_many(body: Any) -> str:
    return "many" if isinstance(body, list) else "one"


class RunFilter(BaseModel):
    """Which runs to list."""

    model_config = ConfigDict(extra="forbid")

    limit: int = Field(50, ge=1, le=200, description="Runs on a page")
    cursor: ShortText | None = Field(None, description="`next_cursor` of the page before")
    offset: int = Field(0, ge=0, le=2**31, description="Runs to skip; a cursor is surer while runs come and go")
    kind: RunKind | None = None
    status: RunStatus | None = None
    outcome: OutcomeClass | None = Field(None, description="The verdict: that at locked arms")
    at_first_closure: OutcomeClass | None = Field(None, description="The paper's verdict: that at first closure")
    tag: str | None = Field(None, max_length=40, description="A tag that the run bears, in any case")
    configuration: ShortText | None = Field(
        None, description="Name of a configuration; edited ones of it are listed, too"
    )
    parent: ShortText | None = None
    starred: bool | None = None
    text: str | None = Field(
        None,
        max_length=400,
        description="Words, in any case, that identifier, name, tags, notes, configuration and changed parameters hold",
    )
    started_from: Instant | None = Field(None, description="ISO 8601; UTC without a time zone")
    started_to: Instant | None = Field(None, description="ISO 8601; UTC without a time zone")
    sort: str = Field(
        "-started",
        pattern=f"^-?({'|'.join(get_args(SortKey))})$",
        description="By what; with a minus the largest or latest first. Runs without it come last",
    )


class RemarksChange(BaseModel):
    """What to change of what people added; the rest stays."""

    model_config = ConfigDict(extra="forbid")

    starred: Flag | None = None
    name: RunName | None = Field(None, description="In place of its name; empty takes it away")
    tags: tuple[Tag, ...] | None = Field(None, max_length=20, description="In place of all tags")
    notes: tuple[Note, ...] | None = Field(None, max_length=500, description="In place of all notes")


class RunSummary(BaseModel):
    """A run in the library."""

    id: str
    kind: RunKind
    status: RunStatus
    name: str = Field(description="What people call it; empty without a name")
    tags: tuple[str, ...]
    configuration: str
    changes: tuple[ParameterChange, ...] = Field(description="To the named configuration, the seed left out")
    direct: bool
    seed: int
    engine: Engine = Field(description="`simulation.engine`: what simulated it; of no meaning in a robot's run")
    initial_spin: float = Field(description="Of the target, as configured [rad/s]")
    started: str = Field(description="ISO 8601, UTC")
    duration: float = Field(description="Mission time of the last tick [s]")
    ticks: int = Field(description="Recorded until now")
    outcome: Outcome | None
    real_time_factor: float | None = Field(description="Simulated seconds a second; null of a live run")
    note: str | None
    notices: tuple[str, ...] = Field(description="What this version ignores of what an earlier one stored, and why")
    versions: dict[str, str]
    time_limit: float = Field(description="Mission time at which it ends without a verdict [s]; of progress the end")
    starred: bool
    notes: tuple[Note, ...]
    integrity: Integrity | None
    lost_at_most: float | None = Field(description="Of a recovered run: wall time that may be missing [s]")
    parent: str | None
    forked_at: int | None
    size_bytes: int


class Run(RunSummary):
    """A run with the configuration that it was flown with."""

    earlier_outcomes: tuple[Outcome, ...] = Field(
        description="How the sequences ended that reached a verdict before the last one, in order"
    )
    config: MissionConfig
    damaged_events: int | None = Field(
        description="Lines of its events that cannot be read, and are left out of `/events`; null: none can be read. "
        "Unless it is 0 the run cannot be forked or flown again"
    )


class Unreadable(BaseModel):
    """A folder in the library that holds no run this version can read."""

    id: str
    reason: str


class RunPage(BaseModel):
    """Runs, newest first."""

    runs: list[RunSummary]
    total: int = Field(description="How many fit, on all pages")
    unreadable: list[Unreadable] = Field(description="Runs of other versions, and damaged ones; on the first page")
    next_cursor: str | None = Field(description="For the next page; null on the last one")


@router.post("", status_code=202, responses=responses(409, 503, 507))
def start_runs(
    services: ServicesDep,
    body: Annotated[OneRun | ManyRuns, Discriminator(_one_or_many)],
    response: Response,
    key: Annotated[str | None, Header(alias="Idempotency-Key", min_length=1, max_length=200)] = None,
) -> Run | list[Run]:
    """Queue a headless run, or up to 64 in one list: all or none.

    With an `Idempotency-Key` the same request sent again queues nothing and answers with the same runs.
    """
    requests = body if isinstance(body, list) else [body]
    content = json.dumps([each.model_dump(mode="json") for each in requests], sort_keys=True)
    digest = hashlib.sha256(content.encode()).hexdigest()
    records = [_queued(each, key, digest) for each in requests]
    found = services.scripted.queue(records, services.disk.require_room)
    queued = [run_of(services.store.read(run_id)) for run_id in found]
    if isinstance(body, list):
        return queued
    response.headers["Location"] = f"/api/v1/runs/{queued[0].id}"
    return queued[0]


def _queued(body: RunRequest, key: str | None, digest: str) -> RunRecord:
    """The record of a run so requested.

    Raises:
        ConfigError: its configuration cannot be.
        MissionRefused: its method knows no direct caging, if that is asked for.

    """
    config = revised(named_configuration(body.configuration), body.changes)
    if body.seed is not None:
        config = revised(config, {"simulation": {"seed": body.seed}})
    next_phase(Phase.IDLE, Command.DIRECT_CAGE if body.direct else Command.CAPTURE, method_of(config).commands)
    name = display_name(body.configuration, config)
    marks = {"idempotency_key": key, "request_digest": digest if key else None}
    return new_record("scripted", name, config, direct=body.direct, **marks)


@router.get("", response_model=RunPage, responses=responses(503))
async def runs(
    services: ServicesDep,
    wanted: Annotated[RunFilter, Query()],
    if_none_match: IfNoneMatch = None,
) -> Response:
    """The library, newest first."""
    return known_or_new(await services.aside.answer(_page, services.store.root, wanted), if_none_match)


def _page(root: FilePath, wanted: RunFilter) -> bytes:
    store = RunStore(root)
    index = RunIndex(store)
    found = index.find(_query(wanted), wanted.limit, wanted.cursor, wanted.offset)
    readers = [reader for reader in map(store.find, found.ids) if reader is not None]
    strange = {} if wanted.cursor or wanted.offset else index.unreadable()
    page = RunPage(
        runs=[_summary(reader) for reader in readers],
        total=found.total,
        unreadable=[Unreadable(id=name, reason=why) for name, why in strange.items()],
        next_cursor=found.following,
    )
    return page.model_dump_json(by_alias=True).encode()


def _query(wanted: RunFilter) -> RunQuery:
    order = wanted.sort.removeprefix("-")
    chosen = wanted.model_dump(exclude={"limit", "cursor", "offset", "sort"})
    return RunQuery(**chosen, sort=cast(SortKey, order), ascending=not wanted.sort.startswith("-"))


@router.get("/{run_id}", responses=responses(404, 409))
def run(services: ServicesDep, run_id: RunId, response: Response, if_none_match: IfNoneMatch = None) -> Run:
    """One run."""
    return tagged(run_of(services.store.read(run_id)), response, if_none_match)


@router.patch("/{run_id}", responses=responses(404, 409, 412))
def remark(
    services: ServicesDep,
    run_id: RunId,
    body: RemarksChange,
    response: Response,
    if_match: Annotated[str | None, Header(alias="If-Match")] = None,
) -> Run:
    """Star or name a run, or put these notes or tags in place of its own; with `If-Match`, only if unchanged since."""
    with services.store.remarks_lock:
        reader = services.store.read(run_id)
        if if_match is not None and if_match != etag(run_of(reader)):
            raise HTTPException(412, f"run {run_id} has changed since; read it again")
        services.store.remark(run_id, Remarks.model_validate(dict(reader.remarks) | body.model_dump(exclude_none=True)))
    return tagged(run_of(services.store.read(run_id)), response, None)


@router.post("/{run_id}/cancel", status_code=202, responses=responses(404, 409))
def cancel_run(services: ServicesDep, run_id: RunId) -> Run:
    """End a scripted run that waits or flies; what it has recorded stays."""
    _require_not_live(services, run_id)
    if services.store.record(run_id).ended:
        raise MissionRefused(f"run {run_id} has ended already", tip="DELETE removes it")
    services.scripted.cancel(run_id)
    return run_of(services.store.read(run_id))


@router.delete("/{run_id}", status_code=204, responses=responses(404, 409))
def delete_run(services: ServicesDep, run_id: RunId) -> Response:
    """Remove a run that has ended."""
    _require_not_live(services, run_id)
    services.store.delete(run_id)
    return Response(status_code=204)


@router.get(
    "/{run_id}/log",
    response_class=StreamingResponse,
    responses={200: {"content": {kind: {} for kind in MEDIA_TYPES.values()}}, **responses(404, 409, 503)},
)
async def log(
    services: ServicesDep,
    run_id: RunId,
    log_format: Annotated[LogFormat, Query(alias="format", description="csv, parquet or mcap")] = "csv",
    since: Since = None,
    until: Until = None,
) -> StreamingResponse:
    """Every recorded tick, one row each, streamed; of a run in progress what is on disk by now."""
    pieces = await services.aside.stream(_log, services.store.root, run_id, log_format, Span(since, until))
    disposition = f'attachment; filename="becalm-{run_id}.{log_format}"'
    return Streamed(pieces, MEDIA_TYPES[log_format], {"Content-Disposition": disposition})


def _log(root: FilePath, run_id: str, log_format: LogFormat, span: Span) -> Iterator[bytes]:
    reader = RunStore(root).read(run_id)
    _require_log(reader, span)
    return exported(reader, log_format, span)


@router.get("/{run_id}/report", response_class=Response, responses={**REPORT, **responses(404, 409, 503)})
async def run_report(services: ServicesDep, run_id: RunId, report_format: FormatOfReport = "html") -> Response:
    """The run for an appendix: what was flown, the verdict, its figures, drawings, plots, touches and events."""
    content = await services.aside.answer(_report, services.store.root, run_id, report_format)
    return report_response(content, report_format, run_id)


def _report(root: FilePath, run_id: str, report_format: ReportFormat) -> bytes:
    from server.reports.run_report import run_document  # noqa: PLC0415 - what draws takes a second to load

    return written(run_document(RunStore(root).read(run_id)), report_format)


@router.get("/{run_id}/ticks", response_model=History, responses=responses(404, 409, 503))
async def ticks(
    services: ServicesDep,
    run_id: RunId,
    since: Since = None,
    until: Until = None,
    points: Annotated[int, Query(ge=2, le=20_000, description="Rows at most")] = 2000,
    if_none_match: IfNoneMatch = None,
) -> Response:
    """A run for plots, in the form of the live mission's history, with the extremes of every piece of time."""
    content = await services.aside.answer(_ticks, services.store.root, run_id, points, Span(since, until))
    return known_or_new(content, if_none_match)


def _ticks(root: FilePath, run_id: str, points: int, span: Span) -> bytes:
    reader = RunStore(root).read(run_id)
    _require_log(reader, span)
    return decimated(reader, points, span).model_dump_json(by_alias=True).encode()


@router.get("/{run_id}/columns", responses=responses(404, 409))
def columns(services: ServicesDep, run_id: RunId) -> list[HistoryColumn]:
    """What may be asked of the samples of a run: every column of its log, and what plots show beside them."""
    services.store.read(run_id)
    return [HistoryColumn(name=column.name, unit=column.unit) for column in SAMPLED.values()]


@router.get("/{run_id}/samples", response_model=History, responses=responses(404, 409, 503))
async def samples(
    services: ServicesDep,
    run_id: RunId,
    names: Annotated[
        str, Query(alias="columns", min_length=1, max_length=2000, description="Names, with commas between")
    ],
    since: Since = None,
    until: Until = None,
    points: Annotated[int, Query(ge=2, le=20_000, description="Rows at most")] = 20_000,
    if_none_match: IfNoneMatch = None,
) -> Response:
    """Those columns at every tick, or every n-th of a long run: what stands in a row was so at one instant."""
    asked = tuple(name.strip() for name in names.split(","))[:64]
    content = await services.aside.answer(_samples, services.store.root, run_id, asked, points, Span(since, until))
    return known_or_new(content, if_none_match)


def _samples(root: FilePath, run_id: str, names: tuple[str, ...], points: int, span: Span) -> bytes:
    reader = RunStore(root).read(run_id)
    _require_log(reader, span)
    return sampled(reader, names, points, span).model_dump_json(by_alias=True).encode()


@router.get("/{run_id}/events", response_model=list[LoggedEvent], responses=responses(404, 409, 503))
async def events(services: ServicesDep, run_id: RunId, if_none_match: IfNoneMatch = None) -> Response:
    """What happened in a run: events, commands with their answers, parameter changes."""
    content = await services.aside.answer(_events, services.store.root, run_id)
    return known_or_new(content, if_none_match)


def _events(root: FilePath, run_id: str) -> bytes:
    return _EVENTS.dump_json([LoggedEvent.model_validate(event) for event in RunStore(root).read(run_id).events()])


@router.get("/{run_id}/foreseen", response_model=RehearsalResult | None, responses=responses(404, 409))
def foreseen(services: ServicesDep, run_id: RunId) -> RehearsalResult | None:
    """What was foreseen of a live run when its sequence began, without the single futures; null if nothing was.

    It is the last rehearsal of that request with the configuration that was then in force, else the look-ahead.
    """
    return services.store.read(run_id).foreseen()


def _require_log(reader: RunReader, span: Span) -> None:
    """Refuse a log that there is not, or not in that span of mission time [s].

    Raises:
        MissionRefused: nothing has been recorded yet.
        ConfigError: the span lies outside the run.

    """
    since, until = span
    if not reader.has_log:
        what = f"run {reader.record.id} has no log: it is {reader.record.status}"
        raise MissionRefused(what, tip="ask again when it flies")
    if since is not None and until is not None and until < since:
        raise ConfigError(f"to = {until:g} s is before from = {since:g} s", tip="give the earlier time as from")
    last = reader.last_tick() if since is not None else None
    if since is not None and (last is None or since > float(last["time"][0])):
        end = 0.0 if last is None else float(last["time"][0])
        what = f"from = {since:g} s is after the run's last tick at {end:g} s"
        raise ConfigError(what, tip="choose a time in the run")


def _require_not_live(services: Services, run_id: str) -> None:
    latest = services.feed.latest
    if latest is not None and latest.run_id == run_id:
        raise MissionRefused(f"run {run_id} is the live mission's", tip="reset the mission first")


def _summary(reader: RunReader) -> RunSummary:
    return RunSummary(**_fields(reader))


def run_of(reader: RunReader) -> Run:
    """The run as it is shown."""
    fields = _fields(reader)
    fields["notices"] += reader.log_notices
    record = reader.record
    earlier = record.earlier_outcomes
    return Run(**fields, earlier_outcomes=earlier, config=record.config, damaged_events=reader.damaged_events)


def _fields(reader: RunReader) -> dict[str, Any]:
    record = reader.record
    remarks = reader.remarks
    open_now = record.integrity is None
    last = reader.last_tick() if open_now else None
    return {
        "id": record.id,
        "kind": record.kind,
        "status": record.status,
        "name": remarks.name,
        "tags": remarks.tags,
        "configuration": record.configuration,
        "changes": changes_of(record),
        "direct": record.direct,
        "seed": record.config.simulation.seed,
        "engine": record.config.simulation.engine,
        "initial_spin": record.config.target.initial_spin,
        "started": record.started,
        "duration": record.duration if last is None else float(last["time"][0]),
        "ticks": reader.tick_count,
        "outcome": record.outcome,
        "real_time_factor": record.real_time_factor,
        "note": record.note,
        "notices": record.notices,
        "time_limit": record.config.judging.time_limit,
        "starred": remarks.starred,
        "notes": remarks.notes,
        "integrity": record.integrity,
        "lost_at_most": record.lost_at_most,
        "parent": record.parent,
        "forked_at": record.forked_at,
        "versions": record.versions,
        "size_bytes": reader.size,
    }
