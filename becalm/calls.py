"""Every request that a client makes of the service, written once for the sync and the async client."""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from http import HTTPStatus
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar
from urllib.parse import quote

import httpx
import pyarrow.parquet
from pydantic import BaseModel

from server.api.atlases import AtlasDetail
from server.api.config import ConfigBody
from server.api.fits import FitDetail
from server.api.health import Health
from server.api.mission import Arming
from server.api.presets import KeptPreset
from server.api.rehearsals import RehearsalDetail
from server.api.runs import Run, RunPage
from server.api.studies import StudyDetail
from server.imports.library import Imported
from server.mission.arming import TO_BE_ARMED
from server.mission.control import ControlCommand
from server.mission.inbox import CommandAnswer
from server.published import MissionSnapshot
from server.rehearsals.look_ahead import LookAheadView
from server.reports.formats import ReportFormat
from sim.errors import CaptureError
from sim.rehearsal.rehearsal import RehearsalResult

if TYPE_CHECKING:
    from pandas import DataFrame

T = TypeVar("T")
M = TypeVar("M", bound=BaseModel)


class ServiceRefused(CaptureError):
    """The service answered with an error; `status`, and `errors` with the invalid fields, say which."""

    def __init__(self, status: int, body: bytes) -> None:
        try:
            problem: dict[str, Any] = json.loads(body)
        except ValueError:
            problem = {"detail": body[:200].decode(errors="replace") or HTTPStatus(status).phrase}
        super().__init__(str(problem.get("detail", HTTPStatus(status).phrase)), tip=str(problem.get("tip", "")))
        self.status = status
        self.errors: list[dict[str, Any]] = problem.get("errors") or []


class ServiceUnreachable(CaptureError):
    """Nothing answers at the service's address, or not in time."""

    def __init__(self, address: str, cause: Exception) -> None:
        what = f"no answer from {address} ({type(cause).__name__}: {cause})"
        super().__init__(what, tip="becalm serve starts a service; BECALM_ADDRESS says where it is")


class ProxyUnusable(CaptureError):
    """The environment names a proxy that the client cannot go through."""

    def __init__(self, cause: Exception) -> None:
        what = f"the proxy that the environment names cannot be used ({cause})"
        tip = "unset HTTP_PROXY, HTTPS_PROXY and ALL_PROXY, or name the service's host in NO_PROXY"
        super().__init__(what, tip=tip)


@dataclass(frozen=True)
class Call(Generic[T]):
    """One request, and how its answer is read."""

    method: str
    path: str
    read: Callable[[httpx.Response], T]
    body: Any = None
    """As JSON."""
    content: bytes | None = None
    """A file's, in place of JSON."""
    query: Mapping[str, Any] = field(default_factory=dict)
    headers: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class ArmedCall(Generic[T]):
    """A request that has to bring the token of an arming, if it is one that was armed first."""

    arming: Call[Arming] | None
    with_token: Callable[[str | None], Call[T]]


def read_answer(call: Call[T], answer: httpx.Response) -> T:
    """What the service said.

    Raises:
        ServiceRefused: it answered with an error.

    """
    if answer.is_error:
        raise ServiceRefused(answer.status_code, answer.content)
    return call.read(answer)


def _as(model: type[M]) -> Callable[[httpx.Response], M]:
    return lambda answer: model.model_validate_json(answer.content)


def _nothing(_: httpx.Response) -> None:
    return None


def _content(answer: httpx.Response) -> bytes:
    return answer.content


def _dataframe(answer: httpx.Response) -> DataFrame:
    """A Parquet file as a DataFrame.

    Raises:
        CaptureError: pandas is not installed.

    """
    table = pyarrow.parquet.read_table(io.BytesIO(answer.content))
    try:
        frame: DataFrame = table.to_pandas()
    except ImportError:
        raise CaptureError("pandas is not installed", tip="pip install 'becalm[dataframe]'") from None
    fields = ((field.name, (field.metadata or {}).get(b"unit")) for field in table.schema)
    frame.attrs["units"] = {name: unit.decode() for name, unit in fields if unit is not None}
    return frame


def _at(*parts: str) -> str:
    return "/".join(quote(part, safe="") for part in parts)


def health() -> Call[Health]:
    """Whether the service is there and ready."""
    return Call("GET", "health", _as(Health))


def mission() -> Call[MissionSnapshot]:
    """The latest snapshot of the live mission; its `outcome` is None until the mission has one."""
    return Call("GET", "mission", _as(MissionSnapshot))


def arm(command: str, *, configuration: str | None = None, changes: Mapping[str, Any] | None = None) -> Call[Arming]:
    """Arm what moves a robot or takes it again: its token is good once, for a few seconds, for exactly that request."""
    given = {"configuration": configuration, "changes": dict(changes or {})}
    return Call("POST", "mission/arming", _as(Arming), {"command": command, **given})


def command(
    name: str,
    *,
    armed: bool = False,
    speed: float | None = None,
    ticks: int | None = None,
    configuration: str | None = None,
    changes: Mapping[str, Any] | None = None,
) -> ArmedCall[CommandAnswer]:
    """Ask something of the mission: capture, detumble, cage, direct_cage, hold, release, reset, pause, run or step.

    A robot is moved or taken again by no command that was not armed: `armed` says that it is meant, and arms it first;
    without it the service refuses. In simulation it makes no difference.
    """
    fields = {"speed": speed, "ticks": ticks, "configuration": configuration, "changes": changes}
    first = arm(name, configuration=configuration, changes=changes) if armed and name in TO_BE_ARMED else None

    def with_token(token: str | None) -> Call[CommandAnswer]:
        given = {key: value for key, value in (fields | {"arming": token}).items() if value is not None}
        return Call("POST", "mission/commands", _as(CommandAnswer), {"command": name, **given})

    return ArmedCall(first, with_token)


def stop() -> Call[CommandAnswer]:
    """Stop: joint rates zero, in every phase, before everything else that waits."""
    return Call("POST", "mission/stop", _as(CommandAnswer))


def control(action: ControlCommand, to: str | None = None) -> Call[CommandAnswer]:
    """Take control of the live mission, relieve who has it, hand it over to another operator, or release it."""
    return Call("POST", "mission/control", _as(CommandAnswer), {"action": action, "to": to})


def config() -> Call[ConfigBody]:
    """The configuration in force, and how it differs from the named one it began as."""
    return Call("GET", "mission/config", _as(ConfigBody))


def change(changes: Mapping[str, Any], *, armed: bool = False) -> ArmedCall[ConfigBody]:
    """Change parameters (nested, SI), all or none: live ones from the next tick on, without a jump of the hands.

    What takes a robot again has to be `armed`, as with `command`.
    """

    def with_token(token: str | None) -> Call[ConfigBody]:
        headers = {} if token is None else {"Becalm-Arming": token}
        return Call("PATCH", "mission/config", _as(ConfigBody), dict(changes), headers=headers)

    return ArmedCall(arm("configure", changes=changes) if armed else None, with_token)


def start_run(
    configuration: str | None = None,
    changes: Mapping[str, Any] | None = None,
    *,
    direct: bool = False,
    seed: int | None = None,
    idempotency_key: str | None = None,
) -> Call[Run]:
    """Queue a headless run; sent again with the same key, it queues nothing and gives the same run."""
    body: dict[str, Any] = {"changes": dict(changes or {}), "direct": direct, "seed": seed}
    if configuration is not None:
        body["configuration"] = configuration
    headers = {} if idempotency_key is None else {"Idempotency-Key": idempotency_key}
    return Call("POST", "runs", _as(Run), body, headers=headers)


def run(run_id: str) -> Call[Run]:
    """One run of the library."""
    return Call("GET", _at("runs", run_id), _as(Run))


def runs(cursor: str | None, filters: Mapping[str, Any]) -> Call[RunPage]:
    """A page of the library."""
    wanted = {**filters, "cursor": cursor}
    return Call("GET", "runs", _as(RunPage), query={key: value for key, value in wanted.items() if value is not None})


def cancel_run(run_id: str) -> Call[Run]:
    """End a headless run that waits or flies."""
    return Call("POST", _at("runs", run_id, "cancel"), _as(Run))


def delete_run(run_id: str) -> Call[None]:
    """Remove a run that has ended."""
    return Call("DELETE", _at("runs", run_id), _nothing)


def events(run_id: str) -> Call[list[dict[str, Any]]]:
    """What happened in a run, in order: phases, touches, verdicts, commands with who asked."""
    return Call("GET", _at("runs", run_id, "events"), lambda answer: answer.json())


def log(run_id: str) -> Call[DataFrame]:
    """Every tick of a run, a row each; the columns' units are in `attrs["units"]`. Needs pandas."""
    return Call("GET", _at("runs", run_id, "log"), _dataframe, query={"format": "parquet"})


def log_file(run_id: str, log_format: str) -> Call[bytes]:
    """Every tick of a run as the content of a mcap, parquet or csv file."""
    return Call("GET", _at("runs", run_id, "log"), _content, query={"format": log_format})


def run_report(run_id: str, report_format: ReportFormat = "html") -> Call[bytes]:
    """The report of a run, as the content of a html or pdf file."""
    return Call("GET", _at("runs", run_id, "report"), _content, query={"format": report_format})


def start_study(
    study: str | Mapping[str, Any],
    changes: Mapping[str, Any] | None = None,
    *,
    seed: int | None = None,
    confirm: bool = False,
) -> Call[StudyDetail]:
    """Queue a study, a named one or a definition as a study file holds it."""
    chosen = study if isinstance(study, str) else dict(study)
    body = {"study": chosen, "changes": dict(changes or {}), "seed": seed, "confirm": confirm}
    return Call("POST", "studies", _as(StudyDetail), body)


def study(study_id: str) -> Call[StudyDetail]:
    """A study, and what came out until now."""
    return Call("GET", _at("studies", study_id), _as(StudyDetail))


def cancel_study(study_id: str) -> Call[StudyDetail]:
    """End a study; its rows stay."""
    return Call("POST", _at("studies", study_id, "cancel"), _as(StudyDetail))


def results(study_id: str) -> Call[DataFrame]:
    """The table of a study, a row a cell. Needs pandas."""
    return Call("GET", _at("studies", study_id, "results"), _dataframe, query={"format": "parquet"})


def study_report(study_id: str, report_format: ReportFormat = "html") -> Call[bytes]:
    """The report of a study, as the content of a html or pdf file."""
    return Call("GET", _at("studies", study_id, "report"), _content, query={"format": report_format})


def start_rehearsal(
    changes: Mapping[str, Any] | None = None,
    *,
    run: str | None = None,
    at: float | None = None,
    request: str | None = "capture",
    futures: int = 100,
    seed: int = 0,
    **further: Any,
) -> Call[RehearsalDetail]:
    """Rehearse from the live mission's state now, or from that of a run `at` a mission time [s].

    Args:
        changes: nested, to the configuration in force there; with them it is flown as it is and as changed.
        run: of the library.
        at: mission time in that run [s]; its start without one.
        request: capture, cage or direct_cage; None goes on with what is under way.
        futures: of each configuration.
        seed: the same gives the same futures.
        further: `horizon` [s], `uncertainty` (a mapping), `asker`.

    """
    body = {**_from_state(changes, run, at, request, seed), "futures": futures, **further}
    return Call("POST", "rehearsals", _as(RehearsalDetail), body)


def _from_state(
    changes: Mapping[str, Any] | None, run: str | None, at: float | None, request: str | None, seed: int
) -> dict[str, Any]:
    source: Any = "live" if run is None else {"run": run, "at": 0.0 if at is None else float(at)}
    return {"source": source, "changes": dict(changes or {}), "request": request, "seed": seed}


def rehearsal(rehearsal_id: str) -> Call[RehearsalDetail]:
    """A rehearsal: how far it is, and its `result` once it has finished."""
    return Call("GET", _at("rehearsals", rehearsal_id), _as(RehearsalDetail))


def cancel_rehearsal(rehearsal_id: str) -> Call[RehearsalDetail]:
    """End a rehearsal that waits or flies."""
    return Call("POST", _at("rehearsals", rehearsal_id, "cancel"), _as(RehearsalDetail))


def futures(rehearsal_id: str) -> Call[DataFrame]:
    """The futures of a rehearsal that has finished, a row each: what was drawn, and how it ended. Needs pandas."""
    return Call("GET", _at("rehearsals", rehearsal_id, "result"), _dataframe, query={"format": "parquet"})


def foreseen(run_id: str) -> Call[RehearsalResult | None]:
    """What was foreseen of a live run when its sequence began, without the single futures; None if nothing was."""
    return Call("GET", _at("runs", run_id, "foreseen"), _result_or_none)


def _result_or_none(answer: httpx.Response) -> RehearsalResult | None:
    return None if answer.content == b"null" else RehearsalResult.model_validate_json(answer.content)


def look_ahead() -> Call[LookAheadView]:
    """Go or no-go for the request that would come next; it is made while somebody asks."""
    return Call("GET", "rehearsals/look-ahead", _as(LookAheadView))


def start_atlas(
    x: Mapping[str, Any],
    y: Mapping[str, Any],
    changes: Mapping[str, Any] | None = None,
    *,
    run: str | None = None,
    at: float | None = None,
    request: str | None = "capture",
    futures: int = 3,
    seed: int = 0,
    **further: Any,
) -> Call[AtlasDetail]:
    """Fly a map over two parameters, each such as {"path": "target.mass", "from": 1, "to": 4, "count": 11}.

    The other arguments are those of `start_rehearsal`; `futures` are of each cell.
    """
    body = {**_from_state(changes, run, at, request, seed), "x": dict(x), "y": dict(y), "futures": futures, **further}
    return Call("POST", "atlases", _as(AtlasDetail), body)


def atlas(atlas_id: str, after: int = 0) -> Call[AtlasDetail]:
    """An atlas, with the cells that came after that revision."""
    return Call("GET", _at("atlases", atlas_id), _as(AtlasDetail), query={"after": after})


def cancel_atlas(atlas_id: str) -> Call[AtlasDetail]:
    """End an atlas; the cells that are there stay."""
    return Call("POST", _at("atlases", atlas_id, "cancel"), _as(AtlasDetail))


def import_log(file: Path, log_map: str) -> Call[Imported]:
    """Import a log from elsewhere: it becomes a run, with what was found wrong in its note.

    Args:
        file: a .csv or .mcap file.
        log_map: TOML that says which column or topic is what.

    """
    query, headers = {"name": file.name, "map": log_map}, {"Content-Type": "application/octet-stream"}
    return Call("POST", "imports", _as(Imported), content=file.read_bytes(), query=query, headers=headers)


def start_fit(
    *runs: str, parameters: Sequence[str] | None = None, held_out: Sequence[str] = (), **further: Any
) -> Call[FitDetail]:
    """Find which numbers explain these runs of the library together.

    Args:
        runs: identifiers.
        parameters: names of what is fitted; without them what usually is.
        held_out: runs whose peak forces are only foretold.
        further: `asker`.

    """
    chosen = None if parameters is None else list(parameters)
    body = {"runs": list(runs), "parameters": chosen, "held_out": list(held_out), **further}
    return Call("POST", "fits", _as(FitDetail), body)


def fit(fit_id: str) -> Call[FitDetail]:
    """A fit: how far it is, and its `result` once it has finished."""
    return Call("GET", _at("fits", fit_id), _as(FitDetail))


def cancel_fit(fit_id: str) -> Call[FitDetail]:
    """End a fit that waits or goes on."""
    return Call("POST", _at("fits", fit_id, "cancel"), _as(FitDetail))


def keep_fit(fit_id: str, name: str) -> Call[KeptPreset]:
    """Keep the first run's configuration with the fitted values as a preset of that name."""
    return Call("POST", _at("fits", fit_id, "preset"), _as(KeptPreset), {"name": name})
