"""A whole service for a test: in the test's own event loop, or behind a real port."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Any, NamedTuple

import httpx
import pytest
import uvicorn

from becalm.serving import server_config
from becalm.sockets import bound_socket
from server.api.services import Services
from server.app import create_app
from server.published import MissionSnapshot
from server.settings import Settings
from sim.capture.mission import prepare
from sim.config import MissionConfig

PATIENCE = 180.0
"""Bound on every wait [s]: far beyond any of them, so that only a hang reaches it."""


@pytest.fixture(scope="session", autouse=True)
def _prepared() -> None:
    prepare(MissionConfig())


class Console:
    """A client of a service that runs in the test's own event loop."""

    def __init__(self, http: httpx.AsyncClient, services: Services) -> None:
        self.http = http
        self.services = services

    async def command(self, command: str, **fields: Any) -> httpx.Response:
        return await self.http.post("/mission/commands", json={"command": command, **fields})

    async def granted(self, command: str, **fields: Any) -> dict[str, Any]:
        answer = await self.command(command, **fields)
        assert answer.status_code == 200, answer.text
        return answer.json()

    async def snapshot(self) -> dict[str, Any]:
        return (await self.http.get("/mission")).json()

    async def until(self, fits: Callable[[MissionSnapshot], bool]) -> MissionSnapshot:
        """The first published snapshot that fits."""
        feed = self.services.feed
        watcher = feed.subscribe(60)
        try:
            async with asyncio.timeout(PATIENCE):
                while feed.latest is None or not fits(feed.latest.snapshot):
                    await watcher.next()
                return feed.latest.snapshot
        finally:
            feed.unsubscribe(watcher)

    async def until_run(self, run_id: str, *statuses: str) -> dict[str, Any]:
        """The run, once the process or thread that writes it has given it one of these statuses."""
        return await self.until_kept(run_id, lambda run: run.get("status") in statuses)

    async def until_kept(self, run_id: str, fits: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        """The run, once what the process or thread that writes it has kept of it fits."""
        async with asyncio.timeout(PATIENCE):
            while True:
                run: dict[str, Any] = (await self.http.get(f"/runs/{run_id}")).json()
                if fits(run):
                    return run
                await asyncio.sleep(0.02)

    async def until_events(self, run_id: str, fits: Callable[[list[dict[str, Any]]], bool]) -> list[dict[str, Any]]:
        """The events of a run, once the thread that writes them has kept those that fit."""
        async with asyncio.timeout(PATIENCE):
            while True:
                events: list[dict[str, Any]] = (await self.http.get(f"/runs/{run_id}/events")).json()
                if fits(events):
                    return events
                await asyncio.sleep(0.02)


@pytest.fixture
def settings(tmp_path) -> Settings:
    return Settings(data_dir=tmp_path / "data", configuration="published_figures", prepare_rehearsals=False)


@pytest.fixture
async def console(settings):
    app = create_app(settings)
    transport = httpx.ASGITransport(app)
    async with (
        app.router.lifespan_context(app),
        httpx.AsyncClient(transport=transport, base_url="http://localhost/api/v1") as http,
    ):
        console = Console(http, app.state.services)
        await console.until(lambda _: True)
        yield console


class Served(NamedTuple):
    """A service behind a real port."""

    port: int
    services: Services

    @property
    def telemetry(self) -> str:
        return f"ws://127.0.0.1:{self.port}/api/v1/telemetry"

    @property
    def api(self) -> str:
        return f"http://127.0.0.1:{self.port}/api/v1"


@contextmanager
def _serving(settings: Settings) -> Iterator[Served]:
    """A service behind a real port, with its mission (but a robot's: that one may never answer)."""
    app = create_app(settings)
    with bound_socket("127.0.0.1", 0) as bound:
        server = uvicorn.Server(server_config(app))
        thread = threading.Thread(target=lambda: server.run(sockets=[bound]))
        thread.start()
        deadline = time.monotonic() + PATIENCE
        while not server.started and thread.is_alive() and time.monotonic() < deadline:
            time.sleep(0.01)
        services: Services = app.state.services
        while services.link is None and services.loop.status == "preparing" and time.monotonic() < deadline:
            time.sleep(0.01)
        yield Served(bound.getsockname()[1], services)
        server.should_exit = True
        thread.join(PATIENCE)
        assert not thread.is_alive()


@pytest.fixture(scope="session")
def serving() -> Callable[[Settings], AbstractContextManager[Served]]:
    """Starts a service with other settings."""
    return _serving


@pytest.fixture
def served(settings) -> Iterator[Served]:
    with _serving(settings) as running:
        yield running
