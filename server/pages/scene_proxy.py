"""The viser scenes under `/scene`, on the service's own port: their page, and the websocket that feeds it.

`/scene/` shows the live mission, `/scene/playback/KEY/` a recorded run (`server.library.replay_sessions`).

viser knows no login and takes any origin, so it listens on no port (`server.scene.doorway`). Everything comes through
here, behind the same checks as the rest of the service (`SameOrigin`), and no word of a browser's but what
`server.pages.scene_words` lets pass. The page at `/scene/` opens its websocket at `/scene`, without the slash: both are
routed.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import quote

import httpx
from fastapi import APIRouter, HTTPException, Request, Response, WebSocket, WebSocketDisconnect
from fastapi.responses import RedirectResponse
from starlette.requests import HTTPConnection
from websockets.asyncio.client import ClientConnection, unix_connect
from websockets.exceptions import ConnectionClosed, WebSocketException
from websockets.typing import Subprotocol

from server.access.headers import content_policy, inline_scripts
from server.library.replay_sessions import ReplaySessions
from server.pages.scene_light import lightened
from server.pages.scene_page import page_with_head
from server.pages.scene_words import accepted_camera

router = APIRouter(include_in_schema=False)

ANSWER_TIMEOUT = 5.0
"""How long viser may take to answer [s]."""
CAMERA_PERIOD = 1 / 30
"""Between two messages of one browser that are passed on [s]; of those between, the last counts."""
MAX_VIEWERS = 48
"""Sockets of scenes that may be open; each has everything drawn for it."""
TRY_AGAIN_LATER = 1013
"""WebSocket close code for a scene that is not there (yet)."""

GONE = (ConnectionClosed, WebSocketDisconnect, RuntimeError)
"""How a side that went away shows itself: websockets' word for it, and Starlette's two."""

SCENE_SOURCES = (
    # viser's page is one file: its script unpacks the real one, which evaluates strings and starts workers.
    "script-src 'strict-dynamic' 'unsafe-eval' {scripts}",
    "worker-src 'self' blob:",
    "connect-src 'self' data: blob:",
)


@dataclass
class Traffic:
    """What goes through here."""

    open: int = 0
    """Sockets now."""
    dropped: int = 0
    """Messages of browsers that were not passed on (`server.pages.scene_words`)."""


class _Newest:
    """The newest word, until it is taken."""

    def __init__(self) -> None:
        self._word: bytes | None = None
        self._news = asyncio.Event()

    def put(self, word: bytes) -> None:
        """In place of one that was not taken."""
        self._word = word
        self._news.set()

    async def taken(self) -> bytes:
        """Waits for one if there is none."""
        while self._word is None:
            self._news.clear()
            await self._news.wait()
        word, self._word = self._word, None
        return word


@router.get("/scene")
async def scene_without_slash() -> RedirectResponse:
    """To the page, whose own links are relative to the slash."""
    return RedirectResponse("/scene/")


@router.get("/scene/playback/{key}")
async def playback_without_slash(key: str) -> RedirectResponse:
    """To the page, whose own links are relative to the slash."""
    return RedirectResponse(f"/scene/playback/{quote(key, safe='')}/")


@router.get("/scene/playback/{key}/{path:path}")
async def playback_page(request: Request, key: str, path: str) -> Response:
    """The page of a recorded run's scene."""
    return await _page(request, _playback_doorway(request, key), path)


@router.get("/scene/{path:path}")
async def scene_page(request: Request, path: str) -> Response:
    """The page of the live mission's scene."""
    return await _page(request, _live_doorway(request), path)


async def _page(request: Request, doorway: Path, path: str) -> Response:
    """The page of viser, with the console's head, or another of its files."""
    url = httpx.URL(scheme="http", host="viser", path=f"/{path}")
    transport = httpx.AsyncHTTPTransport(uds=str(doorway))
    try:
        async with httpx.AsyncClient(transport=transport, trust_env=False, timeout=ANSWER_TIMEOUT) as client:
            answer = await client.get(url)
    except httpx.HTTPError as error:
        raise HTTPException(503, f"the 3D scene does not answer: {error}") from None
    kind = answer.headers.get("content-type", "application/octet-stream")
    if path:
        return Response(answer.content, answer.status_code, _page_headers(b""), kind)
    page = page_with_head(answer.content)
    headers = _page_headers(page.body) | {"ETag": page.etag}
    # 0.8 MB that are the same until viser is another: a browser that has them asks only whether they still hold.
    if page.etag in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    return Response(page.body, answer.status_code, headers, kind)


def _page_headers(page: bytes) -> dict[str, str]:
    sources = (source.format(scripts=inline_scripts(page)) for source in SCENE_SOURCES)
    return {"Cache-Control": "no-cache", "Content-Security-Policy": content_policy(*sources)}


@router.websocket("/scene")
@router.websocket("/scene/")
async def scene_socket(browser: WebSocket) -> None:
    """The websocket of the live mission's scene."""
    await _pump(browser, _live_doorway)


@router.websocket("/scene/light")
async def light_scene_socket(browser: WebSocket) -> None:
    """The same for a browser without a graphics card."""
    await _pump(browser, _live_doorway, light=True)


@router.websocket("/scene/playback/{key}")
@router.websocket("/scene/playback/{key}/")
async def playback_socket(browser: WebSocket, key: str) -> None:
    """The websocket of a recorded run's scene."""
    await _pump(browser, partial(_playback_doorway, key=key))


@router.websocket("/scene/playback/{key}/light")
async def light_playback_socket(browser: WebSocket, key: str) -> None:
    """The same for a browser without a graphics card."""
    await _pump(browser, partial(_playback_doorway, key=key), light=True)


async def _pump(browser: WebSocket, doorway: Callable[[HTTPConnection], Path], *, light: bool = False) -> None:
    """Pumps frames both ways until either side ends; viser's subprotocol names its version and must pass."""
    through = traffic(browser)
    if through.open >= MAX_VIEWERS:
        await browser.close(TRY_AGAIN_LATER, f"{MAX_VIEWERS} scenes are being watched already")
        return
    through.open += 1
    try:
        await _pump_between(browser, doorway, through, light=light)
    finally:
        through.open -= 1


async def _pump_between(
    browser: WebSocket, doorway: Callable[[HTTPConnection], Path], through: Traffic, *, light: bool
) -> None:
    offered = [Subprotocol(name) for name in browser.scope["subprotocols"]]
    try:
        viser = await unix_connect(
            str(doorway(browser)),
            "ws://viser/",
            subprotocols=offered or None,
            compression=None,
            max_size=None,
            ping_interval=None,
            open_timeout=ANSWER_TIMEOUT,
        )
    except (OSError, TimeoutError, WebSocketException, HTTPException):
        await browser.close(TRY_AGAIN_LATER, "the 3D scene does not answer")
        return
    async with viser:
        await browser.accept(viser.subprotocol)
        camera = _Newest()
        await _first_to_end(
            _listen(browser, camera, through), _pass_on(camera, viser), _to_browser(viser, browser, light=light)
        )
        with contextlib.suppress(*GONE):
            await browser.close(viser.close_code or 1001, viser.close_reason or "")


def traffic(connection: HTTPConnection) -> Traffic:
    """The application's own."""
    state = connection.app.state
    if not hasattr(state, "scene_traffic"):
        state.scene_traffic = Traffic()
    found: Traffic = state.scene_traffic
    return found


def _live_doorway(connection: HTTPConnection) -> Path:
    """The socket of the viser server, kept by the application once the scene has started."""
    doorway: Path | None = getattr(connection.app.state, "scene_doorway", None)
    if doorway is None:
        raise HTTPException(503, "the 3D scene has not started yet")
    return doorway


def _playback_doorway(connection: HTTPConnection, key: str) -> Path:
    """The socket of a recorded run's scene."""
    replay_sessions: ReplaySessions | None = getattr(connection.app.state, "replay_sessions", None)
    doorway = None if replay_sessions is None else replay_sessions.doorway(key)
    if doorway is None:
        raise HTTPException(404, "no recorded run is watched under that key")
    return doorway


async def _listen(browser: WebSocket, camera: _Newest, through: Traffic) -> None:
    while (message := await browser.receive())["type"] == "websocket.receive":
        word = accepted_camera(message.get("bytes"))
        if word is None:
            through.dropped += 1
        else:
            camera.put(word)


async def _pass_on(camera: _Newest, viser: ClientConnection) -> None:
    while True:
        await viser.send(await camera.taken())
        await asyncio.sleep(CAMERA_PERIOD)


async def _to_browser(viser: ClientConnection, browser: WebSocket, *, light: bool) -> None:
    async for frame in viser:
        if isinstance(frame, bytes):
            await browser.send_bytes(lightened(frame) if light else frame)
        else:
            await browser.send_text(frame)


async def _first_to_end(*pumps: Coroutine[Any, Any, None]) -> None:
    """Runs the pumps until one ends, by either side's going; then ends the others."""
    tasks = [asyncio.create_task(pump) for pump in pumps]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
    for ending in await asyncio.gather(*tasks, return_exceptions=True):
        if isinstance(ending, Exception) and not isinstance(ending, GONE):
            raise ending
