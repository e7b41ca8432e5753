"""The composition root: settings in, one ASGI application out. Nothing runs before its lifespan begins."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractAsyncContextManager, asynccontextmanager, suppress
from functools import partial
from typing import Any

from anyio.to_thread import current_default_thread_limiter
from fastapi import APIRouter, FastAPI
from fastapi.routing import APIRoute
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

from server.access.audit import AuditLog
from server.access.guard import Guard
from server.access.headers import SecurityHeaders
from server.access.origin import SameOrigin
from server.alarms.board import AlarmRecord
from server.alarms.limits import LimitStore
from server.alarms.watch import AlarmWatch
from server.api import (
    PREFIX,
    alarms,
    atlases,
    config,
    control,
    fits,
    health,
    imports,
    link,
    metrics,
    mission,
    playback,
    presets,
    rehearsals,
    runs,
    scene,
    session,
    shift_log,
    studies,
    telemetry,
)
from server.api.services import Services
from server.edge import problem_json
from server.edge.bodies import JsonBodies
from server.edge.compression import compress
from server.edge.methods import HeadAsGet
from server.edge.prefix import ForwardedPrefix
from server.edge.turns import Turns
from server.fits.jobs import NICENESS as FITS_NICENESS
from server.from_settings import access_from_settings, link_from_settings, workers_from_settings
from server.jobs.queue import JobQueue
from server.library.index import RunIndex
from server.library.journal import Journal
from server.library.presets import PresetStore
from server.library.recorder import Recorder
from server.library.replay_sessions import ReplaySessions
from server.library.retention import Expired, keep_removing
from server.library.runs import RunStore
from server.library.scripted import ScriptedRuns
from server.library.shift_log import ShiftEntry
from server.mission.cut_off import cut_off_run
from server.mission.feed import Feed
from server.mission.loop import MissionLoop
from server.mission.projector import Projector
from server.pages import scene_proxy
from server.pages.console import serve_console
from server.process.aside import Aside
from server.process.disk import GIGABYTE, DiskGuard
from server.process.realtime import shorten_switch_interval
from server.rehearsals.foreseen import Foreseen
from server.rehearsals.jobs import NICENESS as REHEARSALS_NICENESS
from server.rehearsals.jobs import WarmUpJob
from server.rehearsals.look_ahead import LookAhead
from server.scene import Scene
from server.settings import Settings
from server.studies.queue import StudyQueue
from server.studies.store import StudyStore
from server.versions import becalm_version

THREADS = 4
"""Requests that are answered by a thread at a time: each that computes has Python for a moment, in turn with all."""

WARM_UP_PERIOD = 1.0
"""Between two looks whether the mission flies [s]."""

DESCRIPTION = """Mission console for a dual-arm free-flying robot that detumbles and cages spinning debris.

SI units and radians; poses are (x, y, angle), twists (vx, vy, angular velocity), wrenches (fx, fy, torque),
all in world axes. Errors are problem documents (RFC 9457). Telemetry is a WebSocket at `/api/v1/telemetry`."""


class Service(FastAPI):
    """FastAPI, but for the media type of errors in its OpenAPI document."""

    def openapi(self) -> dict[str, Any]:
        """The OpenAPI document."""
        document = super().openapi()
        problem_json.complete(document)
        return document


def create_app(settings: Settings) -> FastAPI:
    """The service with these settings.

    Raises:
        ConfigError: the configuration that it should open with is invalid, or nobody could sign in.

    """
    services = _compose(settings)
    projector = Projector(services.scene, services.feed, services.loop)
    app = Service(
        title="Becalm",
        version=becalm_version(),
        description=DESCRIPTION,
        docs_url=None,
        redoc_url=None,
        lifespan=_lifespan(services, projector),
        generate_unique_id_function=_operation_id,
    )
    app.state.services = services
    app.state.replay_sessions = services.replay_sessions
    problem_json.install(app)
    _add_middleware(app, services)
    _route(app)
    return app


def _compose(settings: Settings) -> Services:
    """One of each, of which none has started.

    Raises:
        ConfigError: the configuration that the service should open with is invalid, or nobody could sign in.

    """
    initial = settings.initial_config()
    feed = Feed()
    store = RunStore(settings.data_dir / "runs", settings.log_topic_rate)
    recorder = Recorder(store)
    studies = StudyStore(settings.data_dir / "studies")
    disk = DiskGuard(settings.data_dir, settings.min_free_gb * GIGABYTE, (store.root, studies.root))
    link = link_from_settings(settings, initial)
    loop = MissionLoop(settings.configuration, initial, feed, recorder, disk, link)
    rehearsal_queue = JobQueue("rehearsals", REHEARSALS_NICENESS)
    look_ahead = LookAhead(
        rehearsal_queue,
        loop.situation,
        lambda: None if feed.latest is None else feed.latest.phase,
        settings.go_odds,
        settings.go_peak_force,
    )
    return Services(
        settings=settings,
        access=access_from_settings(settings),
        feed=feed,
        loop=loop,
        link=link,
        recorder=recorder,
        disk=disk,
        store=store,
        index=RunIndex(store),
        scripted=ScriptedRuns(store),
        presets=PresetStore(settings.data_dir),
        studies=studies,
        study_queue=StudyQueue(studies, partial(workers_from_settings, settings)),
        rehearsals=rehearsal_queue,
        fits=JobQueue("fits", FITS_NICENESS),
        look_ahead=look_ahead,
        foreseen=Foreseen(recorder, look_ahead, rehearsal_queue, loop.situation),
        aside=Aside(),
        alarms=AlarmWatch(
            feed,
            LimitStore(settings.data_dir),
            Journal(settings.data_dir, "alarms", AlarmRecord, disk.require_folder),
        ),
        shift_log=Journal(settings.data_dir, "shift-log", ShiftEntry, disk.require_folder),
        scene=Scene(initial),
        replay_sessions=ReplaySessions(),
    )


def _add_middleware(app: FastAPI, services: Services) -> None:
    """The layers of a request, the innermost first."""
    settings, access = services.settings, services.access
    compress(app)
    app.add_middleware(HeadAsGet)
    app.add_middleware(JsonBodies)
    app.add_middleware(Guard, access=access)
    app.add_middleware(SameOrigin, hosts=settings.own_hosts(), audit=access.audit)
    app.add_middleware(SecurityHeaders)
    app.add_middleware(ForwardedPrefix)
    app.add_middleware(ProxyHeadersMiddleware, trusted_hosts=list(settings.trusted_proxies))
    app.add_middleware(Turns)


def _lifespan(services: Services, projector: Projector) -> Callable[[FastAPI], AbstractAsyncContextManager[None]]:
    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        shorten_switch_interval()
        current_default_thread_limiter().total_tokens = THREADS
        services.access.audit.start()
        services.feed.attach(asyncio.get_running_loop())
        for store in (services.store, services.studies):
            with suppress(OSError):  # reported by whoever needs it: the mission does not
                store.make_root()
        services.disk.look()
        services.recorder.start()
        if services.link is not None:
            services.link.start()
        services.loop.start()
        app.state.scene_doorway = projector.start()
        services.store.recover()
        services.feed.cut_off = cut_off_run(services.store)
        services.scripted.resume()
        services.study_queue.start()
        services.rehearsals.start()
        services.fits.start()
        settings = services.settings
        watching = (
            asyncio.create_task(
                keep_removing(
                    services.store, settings.keep_days, settings.keep_gb, partial(_note_removed, services.access.audit)
                )
            ),
            asyncio.create_task(services.disk.keep_looking()),
            asyncio.create_task(_warm_up(services)),
            asyncio.create_task(services.alarms.keep_looking()),
        )
        try:
            yield
        finally:
            for task in watching:
                task.cancel()
            services.feed.detach()
            await _end(services, projector)

    return lifespan


def _note_removed(audit: AuditLog, gone: Expired) -> None:
    audit.note("retention", method="DELETE", path=f"{PREFIX}/runs/{gone.run_id}", status=204, why=gone.why)


async def _warm_up(services: Services) -> None:
    """Have the first reader served at once, but not before the mission flies: to load all they need takes a core."""
    while services.feed.latest is None:
        await asyncio.sleep(WARM_UP_PERIOD)
    await services.aside.warm_up()
    if services.settings.prepare_rehearsals:  # the first page that opens asks for a look-ahead
        services.rehearsals.add(WarmUpJob(services.loop.view.config))


async def _end(services: Services, projector: Projector) -> None:
    """End everything at once: each within its own patience, and all within the longest of them."""
    ends: tuple[Callable[[], None], ...] = (
        services.replay_sessions.shutdown,
        services.aside.shutdown,
        projector.shutdown,
        partial(_end_mission, services),
        services.scripted.shutdown,
        services.study_queue.shutdown,
        services.rehearsals.shutdown,
        services.fits.shutdown,
    )
    threads = ThreadPoolExecutor(len(ends), "becalm-end")  # of their own: others may all be taken
    loop = asyncio.get_running_loop()
    await asyncio.gather(*(loop.run_in_executor(threads, end) for end in ends))
    threads.shutdown(wait=False)
    services.access.audit.shutdown()


def _end_mission(services: Services) -> None:
    services.loop.shutdown()
    if services.link is not None:
        services.link.shutdown()
    services.recorder.shutdown()


def _route(app: FastAPI) -> None:
    api = APIRouter(prefix=PREFIX)
    for resource in (
        health,
        session,
        mission,
        control,
        config,
        presets,
        alarms,
        shift_log,
        link,
        scene,
        runs,
        playback,
        studies,
        rehearsals,
        fits,
        imports,
        atlases,
        telemetry,
    ):
        api.include_router(resource.router)
    app.include_router(api)
    app.include_router(metrics.router)
    app.include_router(scene_proxy.router)
    serve_console(app)


def _operation_id(route: APIRoute) -> str:
    return route.name
