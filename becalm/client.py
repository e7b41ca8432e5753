"""A Becalm service from Python: `Client`, and `AsyncClient` with the same names to be awaited.

import becalm

with becalm.Client() as service:
    service.command("capture")
    for snapshot in service.watch():
        print(snapshot.time, snapshot.target.twist.angle)
"""

from __future__ import annotations

import asyncio
import contextlib
import ipaddress
import json
import os
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from functools import update_wrapper
from pathlib import Path
from types import TracebackType
from typing import Any, Concatenate, Literal, ParamSpec, Protocol, Self, TypeVar
from urllib.parse import urlencode

import httpx
from websockets.asyncio.client import connect as connect_async
from websockets.exceptions import InvalidProxy, InvalidStatus, WebSocketException
from websockets.sync.client import connect

from becalm import calls
from becalm.calls import ArmedCall, Call, ProxyUnusable, ServiceRefused, ServiceUnreachable, read_answer
from server.api.atlases import AtlasDetail
from server.api.fits import FitDetail
from server.api.rehearsals import RehearsalDetail
from server.api.runs import Run, RunSummary
from server.api.studies import StudyDetail
from server.published import MissionSnapshot
from sim.errors import CaptureError

P = ParamSpec("P")
T = TypeVar("T")
E = TypeVar("E", bound="_Ending")

DEFAULT_ADDRESS = "http://127.0.0.1:8000"

PATIENCE = 120.0
"""For one answer [s]: a log of a long run takes a while."""

UNDER_WAY = ("queued", "running")

LOOK_PERIOD = 0.2
"""Between two looks whether a run or study has ended [s]."""


class _Ending(Protocol):
    """What is under way until it has ended."""

    @property
    def status(self) -> str: ...


class _ServiceAddress:
    """Where the service is, and by which token it is asked."""

    def __init__(self, address: str | None, token: str | None) -> None:
        self.address = (address or os.environ.get("BECALM_ADDRESS") or DEFAULT_ADDRESS).rstrip("/")
        token = token or os.environ.get("BECALM_TOKEN")
        self.headers = {"Authorization": f"Bearer {token}"} if token else {}

    @property
    def api(self) -> str:
        return f"{self.address}/api/v1/"

    @property
    def is_here(self) -> bool:
        """Whether the service is on this machine, so that no proxy leads there."""
        host = httpx.URL(self.address).host
        try:
            return ipaddress.ip_address(host).is_loopback
        except ValueError:
            return host == "localhost" or host.endswith(".localhost")

    @property
    def proxy(self) -> Literal[True] | None:
        """Of telemetry: the environment's, or none."""
        return None if self.is_here else True

    def telemetry(self, rate: float) -> str:
        return f"ws{self.api.removeprefix('http')}telemetry?{urlencode({'rate': rate})}"


@contextlib.contextmanager
def _usable_proxy() -> Iterator[None]:
    """Says what is wrong with a proxy, which the libraries do in words about packages and schemes.

    Raises:
        ProxyUnusable: the environment names one that cannot be used.

    """
    try:
        yield
    except (ImportError, ValueError, httpx.InvalidURL, InvalidProxy) as error:
        raise ProxyUnusable(error) from None


def _snapshot(frame: str | bytes) -> MissionSnapshot | None:
    """The snapshot in a frame of telemetry; None for any other frame."""
    message = json.loads(frame)
    if message.pop("type") != "snapshot":
        return None
    return MissionSnapshot.model_validate_json(json.dumps(message))


def _acknowledgement(snapshot: MissionSnapshot) -> str:
    """That a snapshot has been dealt with: the next one is then the newest there is, however long that took."""
    return json.dumps({"type": "ack", "tick": snapshot.tick})


def _failure(place: _ServiceAddress, error: Exception) -> CaptureError:
    """Why there is no telemetry."""
    if isinstance(error, ImportError | InvalidProxy):
        return ProxyUnusable(error)
    if isinstance(error, InvalidStatus):
        return ServiceRefused(error.response.status_code, bytes(error.response.body))
    return ServiceUnreachable(place.address, error)


def _rest(deadline: float) -> float:
    """How long to wait before the next look [s].

    Raises:
        TimeoutError: there is no time left.

    """
    if time.monotonic() > deadline:
        raise TimeoutError("it has not ended in time")
    return LOOK_PERIOD


def _sync(make: Callable[P, Call[T]]) -> Callable[Concatenate[Client, P], T]:
    """A method of `Client` that makes this call."""

    def method(self: Client, /, *args: P.args, **kwargs: P.kwargs) -> T:
        return self.done(make(*args, **kwargs))

    update_wrapper(method, make)
    return method


def _async(make: Callable[P, Call[T]]) -> Callable[Concatenate[AsyncClient, P], Awaitable[T]]:
    """A method of `AsyncClient` that makes this call."""

    async def method(self: AsyncClient, /, *args: P.args, **kwargs: P.kwargs) -> T:
        return await self.done(make(*args, **kwargs))

    update_wrapper(method, make)
    return method


def _sync_armed(make: Callable[P, ArmedCall[T]]) -> Callable[Concatenate[Client, P], T]:
    """A method of `Client` that arms this call first, if that is asked for."""

    def method(self: Client, /, *args: P.args, **kwargs: P.kwargs) -> T:
        asked = make(*args, **kwargs)
        return self.done(asked.with_token(None if asked.arming is None else self.done(asked.arming).token))

    update_wrapper(method, make)
    return method


def _async_armed(make: Callable[P, ArmedCall[T]]) -> Callable[Concatenate[AsyncClient, P], Awaitable[T]]:
    """A method of `AsyncClient` that arms this call first, if that is asked for."""

    async def method(self: AsyncClient, /, *args: P.args, **kwargs: P.kwargs) -> T:
        asked = make(*args, **kwargs)
        return await self.done(
            asked.with_token(None if asked.arming is None else (await self.done(asked.arming)).token)
        )

    update_wrapper(method, make)
    return method


class Client:
    """A service, asked one thing after another; close it, or use it as a context manager.

    Every method raises `ServiceRefused` for what the service refuses, and `ServiceUnreachable` without an answer.
    """

    health = _sync(calls.health)
    mission = _sync(calls.mission)
    arm = _sync(calls.arm)
    command = _sync_armed(calls.command)
    change = _sync_armed(calls.change)
    stop = _sync(calls.stop)
    control = _sync(calls.control)
    config = _sync(calls.config)
    start_run = _sync(calls.start_run)
    run = _sync(calls.run)
    cancel_run = _sync(calls.cancel_run)
    delete_run = _sync(calls.delete_run)
    events = _sync(calls.events)
    log = _sync(calls.log)
    run_report = _sync(calls.run_report)
    start_study = _sync(calls.start_study)
    study = _sync(calls.study)
    cancel_study = _sync(calls.cancel_study)
    results = _sync(calls.results)
    study_report = _sync(calls.study_report)
    start_rehearsal = _sync(calls.start_rehearsal)
    rehearsal = _sync(calls.rehearsal)
    cancel_rehearsal = _sync(calls.cancel_rehearsal)
    import_log = _sync(calls.import_log)
    start_fit = _sync(calls.start_fit)
    fit = _sync(calls.fit)
    cancel_fit = _sync(calls.cancel_fit)
    keep_fit = _sync(calls.keep_fit)
    futures = _sync(calls.futures)
    look_ahead = _sync(calls.look_ahead)
    foreseen = _sync(calls.foreseen)
    start_atlas = _sync(calls.start_atlas)
    atlas = _sync(calls.atlas)
    cancel_atlas = _sync(calls.cancel_atlas)

    def __init__(self, address: str | None = None, token: str | None = None) -> None:
        """Connect to nothing yet.

        Args:
            address: such as http://robot-lab:8000; by default $BECALM_ADDRESS, or a service on this machine.
            token: an access token; by default $BECALM_TOKEN, or none.

        """
        self._place = _ServiceAddress(address, token)
        # A client with a transport of its own asks no proxy, but keeps the environment's certificates.
        transport = httpx.HTTPTransport() if self._place.is_here else None
        with _usable_proxy():
            self._http = httpx.Client(
                base_url=self._place.api, headers=self._place.headers, timeout=PATIENCE, transport=transport
            )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the connection."""
        self._http.close()

    def done(self, call: Call[T]) -> T:
        """The answer to one of `becalm.calls`."""
        try:
            answer = self._http.request(
                call.method,
                call.path,
                json=call.body,
                content=call.content,
                params=call.query,
                headers=call.headers,
            )
        except httpx.TransportError as error:
            raise ServiceUnreachable(self._place.address, error) from None
        return read_answer(call, answer)

    def _ended(self, look: Callable[[], E], patience: float) -> E:
        """What a look finds as soon as it has ended."""
        deadline = time.monotonic() + patience
        while (found := look()).status in UNDER_WAY:
            time.sleep(_rest(deadline))
        return found

    def watch(self, rate: float = 10.0) -> Iterator[MissionSnapshot]:
        """Snapshots of the live mission as they come, `rate` a second, to the one with the outcome."""
        try:
            with connect(
                self._place.telemetry(rate),
                additional_headers=self._place.headers,
                max_size=None,
                proxy=self._place.proxy,
            ) as telemetry:
                for frame in telemetry:
                    snapshot = _snapshot(frame)
                    if snapshot is not None:
                        yield snapshot
                        if snapshot.outcome is not None:
                            return
                        telemetry.send(_acknowledgement(snapshot))
        except (OSError, ImportError, WebSocketException) as error:
            raise _failure(self._place, error) from None

    def runs(self, **filters: Any) -> Iterator[RunSummary]:
        """The library, newest first; filters as `GET /runs` has them: `status="finished"`, `text="slips"`, ..."""
        cursor = None
        while True:
            page = self.done(calls.runs(cursor, filters))
            yield from page.runs
            if page.next_cursor is None:
                return
            cursor = page.next_cursor

    def download(self, run_id: str, path: Path) -> None:
        """Write the log of a run to a .mcap, .parquet or .csv file."""
        content = self.done(calls.log_file(run_id, path.suffix.removeprefix(".")))
        path.write_bytes(content)

    def finished_run(self, run_id: str, patience: float = 600.0) -> Run:
        """The run when it has ended; waits for it.

        Raises:
            TimeoutError: it has not within `patience` [s].

        """
        return self._ended(lambda: self.run(run_id), patience)

    def finished_study(self, study_id: str, patience: float = 86_400.0) -> StudyDetail:
        """The study when it has ended; waits for it.

        Raises:
            TimeoutError: it has not within `patience` [s].

        """
        return self._ended(lambda: self.study(study_id), patience)

    def finished_rehearsal(self, rehearsal_id: str, patience: float = 600.0) -> RehearsalDetail:
        """The rehearsal when it has ended; waits for it.

        Raises:
            TimeoutError: it has not within `patience` [s].

        """
        return self._ended(lambda: self.rehearsal(rehearsal_id), patience)

    def finished_fit(self, fit_id: str, patience: float = 600.0) -> FitDetail:
        """The fit when it has ended; waits for it.

        Raises:
            TimeoutError: it has not within `patience` [s].

        """
        return self._ended(lambda: self.fit(fit_id), patience)

    def finished_atlas(self, atlas_id: str, patience: float = 600.0) -> AtlasDetail:
        """The atlas when it has ended, with all its cells; waits for it.

        Raises:
            TimeoutError: it has not within `patience` [s].

        """
        return self._ended(lambda: self.atlas(atlas_id), patience)


class AsyncClient:
    """As `Client`, for `asyncio`."""

    health = _async(calls.health)
    mission = _async(calls.mission)
    arm = _async(calls.arm)
    command = _async_armed(calls.command)
    change = _async_armed(calls.change)
    stop = _async(calls.stop)
    control = _async(calls.control)
    config = _async(calls.config)
    start_run = _async(calls.start_run)
    run = _async(calls.run)
    cancel_run = _async(calls.cancel_run)
    delete_run = _async(calls.delete_run)
    events = _async(calls.events)
    log = _async(calls.log)
    run_report = _async(calls.run_report)
    start_study = _async(calls.start_study)
    study = _async(calls.study)
    cancel_study = _async(calls.cancel_study)
    results = _async(calls.results)
    study_report = _async(calls.study_report)
    start_rehearsal = _async(calls.start_rehearsal)
    rehearsal = _async(calls.rehearsal)
    cancel_rehearsal = _async(calls.cancel_rehearsal)
    import_log = _async(calls.import_log)
    start_fit = _async(calls.start_fit)
    fit = _async(calls.fit)
    cancel_fit = _async(calls.cancel_fit)
    keep_fit = _async(calls.keep_fit)
    futures = _async(calls.futures)
    look_ahead = _async(calls.look_ahead)
    foreseen = _async(calls.foreseen)
    start_atlas = _async(calls.start_atlas)
    atlas = _async(calls.atlas)
    cancel_atlas = _async(calls.cancel_atlas)

    def __init__(self, address: str | None = None, token: str | None = None) -> None:
        """Connect to nothing yet; see `Client`."""
        self._place = _ServiceAddress(address, token)
        transport = httpx.AsyncHTTPTransport() if self._place.is_here else None
        with _usable_proxy():
            self._http = httpx.AsyncClient(
                base_url=self._place.api, headers=self._place.headers, timeout=PATIENCE, transport=transport
            )

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()

    async def close(self) -> None:
        """Let go of the connections."""
        await self._http.aclose()

    async def done(self, call: Call[T]) -> T:
        """The answer to one of `becalm.calls`."""
        try:
            answer = await self._http.request(
                call.method,
                call.path,
                json=call.body,
                content=call.content,
                params=call.query,
                headers=call.headers,
            )
        except httpx.TransportError as error:
            raise ServiceUnreachable(self._place.address, error) from None
        return read_answer(call, answer)

    async def _ended(self, look: Callable[[], Awaitable[E]], patience: float) -> E:
        """What a look finds as soon as it has ended."""
        deadline = time.monotonic() + patience
        while (found := await look()).status in UNDER_WAY:
            await asyncio.sleep(_rest(deadline))
        return found

    async def watch(self, rate: float = 10.0) -> AsyncIterator[MissionSnapshot]:
        """Snapshots of the live mission as they come, `rate` a second, to the one with the outcome."""
        try:
            async with connect_async(
                self._place.telemetry(rate),
                additional_headers=self._place.headers,
                max_size=None,
                proxy=self._place.proxy,
            ) as telemetry:
                async for frame in telemetry:
                    snapshot = _snapshot(frame)
                    if snapshot is not None:
                        yield snapshot
                        if snapshot.outcome is not None:
                            return
                        await telemetry.send(_acknowledgement(snapshot))
        except (OSError, ImportError, WebSocketException) as error:
            raise _failure(self._place, error) from None

    async def runs(self, **filters: Any) -> AsyncIterator[RunSummary]:
        """The library, newest first; filters as `GET /runs` has them: `status="finished"`, `text="slips"`, ..."""
        cursor = None
        while True:
            page = await self.done(calls.runs(cursor, filters))
            for each in page.runs:
                yield each
            if page.next_cursor is None:
                return
            cursor = page.next_cursor

    async def download(self, run_id: str, path: Path) -> None:
        """Write the log of a run to a .mcap, .parquet or .csv file."""
        content = await self.done(calls.log_file(run_id, path.suffix.removeprefix(".")))
        path.write_bytes(content)

    async def finished_run(self, run_id: str, patience: float = 600.0) -> Run:
        """The run when it has ended; waits for it.

        Raises:
            TimeoutError: it has not within `patience` [s].

        """
        return await self._ended(lambda: self.run(run_id), patience)

    async def finished_study(self, study_id: str, patience: float = 86_400.0) -> StudyDetail:
        """The study when it has ended; waits for it.

        Raises:
            TimeoutError: it has not within `patience` [s].

        """
        return await self._ended(lambda: self.study(study_id), patience)

    async def finished_rehearsal(self, rehearsal_id: str, patience: float = 600.0) -> RehearsalDetail:
        """The rehearsal when it has ended; waits for it.

        Raises:
            TimeoutError: it has not within `patience` [s].

        """
        return await self._ended(lambda: self.rehearsal(rehearsal_id), patience)

    async def finished_fit(self, fit_id: str, patience: float = 600.0) -> FitDetail:
        """The fit when it has ended; waits for it.

        Raises:
            TimeoutError: it has not within `patience` [s].

        """
        return await self._ended(lambda: self.fit(fit_id), patience)

    async def finished_atlas(self, atlas_id: str, patience: float = 600.0) -> AtlasDetail:
        """The atlas when it has ended, with all its cells; waits for it.

        Raises:
            TimeoutError: it has not within `patience` [s].

        """
        return await self._ended(lambda: self.atlas(atlas_id), patience)
