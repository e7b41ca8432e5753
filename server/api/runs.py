"""`/runs`: scripted runs, the library of all runs, and their logs."""

from __future__ import annotations

from itertools import islice
from typing import Annotated, Any

from fastapi import APIRouter, Path, Query, Response
from fastapi.responses import StreamingResponse
from pydantic import BaseModel, ConfigDict, Field

from server.api.problem_json import responses
from server.api.services import Services, ServicesDep
from server.export import MEDIA_TYPES, LogFormat, Span, exported
from server.run_folder import Integrity, LoggedEvent, RunKind, RunReader, RunStatus
from sim.capture.snapshot import Outcome
from sim.config import MissionConfig
from sim.configurations import DEFAULT_CONFIGURATION, named_configuration, revised
from sim.errors import ConfigError, MissionRefused

router = APIRouter(prefix="/runs", tags=["runs"], responses=responses(422))

RunId = Annotated[str, Path(description="Identifier of a run", examples=["20261122T113000123-4f9a2c"])]


class RunRequest(BaseModel):
    """A headless run to be flown."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={
            "examples": [
                {"configuration": "published", "changes": {"control": {"impedance": {"damping": 3.0}}}},
                {"direct": True, "seed": 7},
            ]
        },
    )

    configuration: str = Field(DEFAULT_CONFIGURATION, description="A named configuration")
    changes: dict[str, Any] = Field(default_factory=dict, description="Nested changes to it")
    direct: bool = Field(False, description="Direct caging, without detumbling")
    seed: int | None = Field(None, ge=0, le=2**63 - 1, description="In place of `simulation.seed`")


class RunSummary(BaseModel):
    """A run in the library."""

    id: str
    kind: RunKind
    status: RunStatus
    configuration: str
    direct: bool
    seed: int
    started: str = Field(description="ISO 8601, UTC")
    duration: float = Field(description="Mission time of the last tick [s]")
    ticks: int = Field(description="Recorded until now")
    outcome: Outcome | None
    real_time_factor: float | None = Field(description="Simulated seconds a second; null of a live run")
    note: str | None
    versions: dict[str, str]
    integrity: Integrity | None
    lost_at_most: float | None = Field(description="Of a recovered run: wall time that may be missing [s]")
    parent: str | None
    forked_at: int | None
    size_bytes: int


class Run(RunSummary):
    """A run with the configuration that it was flown with."""

    config: MissionConfig


class Unreadable(BaseModel):
    """A folder in the library that holds no run this version can read."""

    id: str
    reason: str


class RunPage(BaseModel):
    """Runs, newest first."""

    runs: list[RunSummary]
    unreadable: list[Unreadable] = Field(description="Runs of other versions, and damaged ones; on the first page")
    next_cursor: str | None = Field(description="For the next page; null on the last one")


@router.post("", status_code=202, responses=responses(503))
def start_run(services: ServicesDep, body: RunRequest, response: Response) -> Run:
    """Queue a headless run."""
    config = revised(named_configuration(body.configuration), body.changes)
    if body.seed is not None:
        config = revised(config, {"simulation": {"seed": body.seed}})
    edited = config != named_configuration(body.configuration)
    name = f"{body.configuration} (edited)" if edited else body.configuration
    record = services.scripted.queue(name, config, direct=body.direct)
    response.headers["Location"] = f"/api/v1/runs/{record.id}"
    return _run(services.store.read(record.id))


@router.get("")
def runs(
    services: ServicesDep,
    limit: Annotated[int, Query(ge=1, le=200, description="Runs on a page")] = 50,
    cursor: Annotated[str | None, Query(description="`next_cursor` of the page before")] = None,
) -> RunPage:
    """The library, newest first."""
    found = [_summary(reader) for reader in islice(services.store.newest(before=cursor), limit + 1)]
    strange = [] if cursor else [Unreadable(id=name, reason=why) for name, why in services.store.unreadable()]
    following = found[limit - 1].id if len(found) > limit else None
    return RunPage(runs=found[:limit], unreadable=strange, next_cursor=following)


@router.get("/{run_id}", responses=responses(404))
def run(services: ServicesDep, run_id: RunId) -> Run:
    """One run."""
    return _run(services.store.read(run_id))


@router.delete("/{run_id}", status_code=204, responses={202: {"model": Run}, **responses(404, 409)})
def delete_run(services: ServicesDep, run_id: RunId, response: Response) -> Response:
    """Remove a run that has ended (204), or cancel a scripted one that has not (202)."""
    _require_not_live(services, run_id)
    record = services.store.record(run_id)
    if record.ended:
        services.store.delete(run_id)
        return Response(status_code=204)
    services.scripted.cancel(run_id)
    body = _run(services.store.read(run_id))
    return Response(body.model_dump_json(), status_code=202, media_type="application/json")


@router.get(
    "/{run_id}/log",
    response_class=StreamingResponse,
    responses={200: {"content": {kind: {} for kind in MEDIA_TYPES.values()}}, **responses(404, 409)},
)
def log(
    services: ServicesDep,
    run_id: RunId,
    log_format: Annotated[LogFormat, Query(alias="format", description="csv, parquet or mcap")] = "csv",
    since: Annotated[float | None, Query(alias="from", ge=0, description="First mission time [s]")] = None,
    until: Annotated[float | None, Query(alias="to", ge=0, description="Last mission time [s]")] = None,
) -> StreamingResponse:
    """Every recorded tick, one row each, streamed; of a run in progress what is on disk by now."""
    reader = services.store.read(run_id)
    _require_log(reader, since, until)
    disposition = f'attachment; filename="becalm-{run_id}.{log_format}"'
    return StreamingResponse(
        exported(reader, log_format, Span(since, until)),
        media_type=MEDIA_TYPES[log_format],
        headers={"Content-Disposition": disposition},
    )


@router.get("/{run_id}/events", responses=responses(404))
def events(services: ServicesDep, run_id: RunId) -> list[LoggedEvent]:
    """What happened in a run: events, commands with their answers, parameter changes."""
    return [LoggedEvent.model_validate(event) for event in services.store.read(run_id).events()]


def _require_log(reader: RunReader, since: float | None, until: float | None) -> None:
    """Refuse a log that there is not, or not in that span of mission time [s].

    Raises:
        MissionRefused: nothing has been recorded yet.
        ConfigError: the span lies outside the run.

    """
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
    if latest is not None and latest.snapshot.run_id == run_id:
        raise MissionRefused(f"run {run_id} is the live mission's", tip="reset the mission first")


def _summary(reader: RunReader) -> RunSummary:
    return RunSummary(**_fields(reader))


def _run(reader: RunReader) -> Run:
    return Run(**_fields(reader), config=reader.record.config)


def _fields(reader: RunReader) -> dict[str, Any]:
    record = reader.record
    open_now = record.integrity is None
    last = reader.last_tick() if open_now else None
    return {
        "id": record.id,
        "kind": record.kind,
        "status": record.status,
        "configuration": record.configuration,
        "direct": record.direct,
        "seed": record.config.simulation.seed,
        "started": record.started,
        "duration": record.duration if last is None else float(last["time"][0]),
        "ticks": reader.tick_count,
        "outcome": record.outcome,
        "real_time_factor": record.real_time_factor,
        "note": record.note,
        "integrity": record.integrity,
        "lost_at_most": record.lost_at_most,
        "parent": record.parent,
        "forked_at": record.forked_at,
        "versions": record.versions,
        "size_bytes": reader.size,
    }
