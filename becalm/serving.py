"""`becalm serve`: the service on one port, announced when it is ready."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import socket
import threading
import webbrowser
from collections.abc import Callable, Iterator
from functools import partial

import click
import uvicorn
from fastapi import FastAPI
from starlette.types import ASGIApp, Receive, Scope, Send

from becalm.ending import ENDING_SIGNALS
from becalm.sockets import bound_socket
from server.api.services import Services
from server.app import create_app
from server.edge.connections import Connections, bounded_http, raise_descriptor_limit
from server.edge.paced_sockets import SOCKET_OPTIONS
from server.mission.feed import Feed
from server.process.data_folder import owned
from server.process.realtime import schedule_realtime
from server.process.service_log import Moment, ServiceLog
from server.settings import Settings

ANY_ADDRESS = ("0.0.0.0", "::", "")

LONGEST_END = 4.5
"""After which the service ends whatever still waits for whom [s]."""

SHUTDOWN_TIME = 2
"""How long open connections may take to end [s]; the whole service has 5 s."""

UNHEEDED_SIGNALS = (signal.SIGUSR1, signal.SIGUSR2)
"""What other programs take as a wish that this one does not know; it would end it at once, without a stop."""


def serve(settings: Settings, *, open_page: bool) -> None:
    """Serve until the process is asked to end.

    Raises:
        ConfigError: the configuration that the mission should open with is invalid, or real time is not available.
        AddressInUse: the address is taken.
        DataFolderInUse: another service has the data folder.

    """
    if settings.realtime:
        schedule_realtime()
    app = create_app(settings)
    services: Services = app.state.services
    with bound_socket(settings.host, settings.port) as bound:
        url = address(settings.host, bound.getsockname()[1])
        with owned(settings.data_dir, url), _logging(services):
            announce = partial(_announce, url, open_page=open_page)
            server = _Server(server_config(app), announce, partial(_end_soon, services))
            with contextlib.suppress(KeyboardInterrupt):  # Ctrl-C has been obeyed by then: everything is closed
                server.run(sockets=[bound])


def _end_soon(services: Services) -> None:
    """Leave the robot at rest, and keep nobody waiting for what would still take long."""
    services.loop.end_soon()
    services.aside.end_soon()


def server_config(app: FastAPI) -> uvicorn.Config:
    """How the service is served."""
    services: Services = app.state.services
    room = Connections(raise_descriptor_limit(), services.settings.trusted_proxies)
    return uvicorn.Config(
        _cut_off_quietly(app),
        http=bounded_http(room),
        log_config=None,
        log_level="warning",
        proxy_headers=False,  # the application itself knows which proxies it trusts
        **SOCKET_OPTIONS,
        timeout_graceful_shutdown=SHUTDOWN_TIME,
    )


def _cut_off_quietly(app: ASGIApp) -> ASGIApp:
    """The application, whose connections uvicorn cancels at the end if they last too long: that is no failure."""

    async def cut_off(scope: Scope, receive: Receive, send: Send) -> None:
        try:
            await app(scope, receive, send)
        except asyncio.CancelledError:
            if scope["type"] == "lifespan":
                raise

    return cut_off


@contextlib.contextmanager
def _logging(services: Services) -> Iterator[None]:
    """The service's log, for as long as it runs."""
    settings = services.settings
    lines = ServiceLog(settings.log_level, settings.log_format, lambda: _moment(services.feed))
    lines.start()
    try:
        yield
    finally:
        lines.shutdown()


def _moment(feed: Feed) -> Moment:
    latest = feed.latest
    return Moment(None, None) if latest is None else Moment(latest.run_id, latest.tick)


def address(host: str, port: int) -> str:
    """Where the page is; port 0 stands for any."""
    name = "127.0.0.1" if host in ANY_ADDRESS else f"[{host}]" if ":" in host else host
    return f"http://{name}:{port}/"


def _announce(url: str, *, open_page: bool) -> None:
    click.echo(f"Becalm is ready at {url}  (end it with Ctrl-C)")
    if open_page:
        webbrowser.open(url)


def end_surely(patience: float) -> None:
    """End the process after that time [s], if anything then still keeps it: mission and run are closed long before."""
    last_resort = threading.Timer(patience, os._exit, (0,))
    last_resort.daemon = True
    last_resort.start()


class _Server(uvicorn.Server):
    """Says once that it is ready; leaves the robot at rest before it waits for anyone."""

    def __init__(self, config: uvicorn.Config, announce: Callable[[], None], end_soon: Callable[[], None]) -> None:
        super().__init__(config)
        self._announce = announce
        self._end_soon = end_soon

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Handle more signals than uvicorn does, but none that whoever started this has it ignore (`nohup`)."""
        if threading.current_thread() is not threading.main_thread():
            yield
            return
        before = {number: signal.getsignal(number) for number in (*ENDING_SIGNALS, *UNHEEDED_SIGNALS)}
        for number, handler in before.items():
            if handler != signal.SIG_IGN:
                signal.signal(number, self.handle_exit if number in ENDING_SIGNALS else signal.SIG_IGN)
        with super().capture_signals():
            yield

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        if self.started:
            self._announce()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        end_surely(LONGEST_END)
        try:
            self._end_soon()
        finally:  # the mission and its run are closed behind it
            await super().shutdown(sockets)
