"""`WS /runs/{id}/playback`: a recorded run at any moment, in a scene of its own.

The client names moments, and for each gets the snapshot that was published then; meanwhile asked moments are left out
but for the last. The connection is the session: when it ends, so does the scene.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import Callable
from functools import partial
from typing import Annotated, Any, Literal

from fastapi import APIRouter, WebSocket, WebSocketDisconnect
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from server.api.runs import RunId
from server.api.scene import SceneChange
from server.api.services import ServicesDep
from server.edge.problem_json import document_of
from server.errors import ServiceBusy
from server.library.replay_session import Opened, ReplaySession
from server.library.replay_sessions import ReplaySessions
from server.mission.feed import snapshot_text
from server.scene import CAMERAS, Picture
from sim.errors import CaptureError

TRY_AGAIN_LATER, POLICY = 1013, 1008
"""WebSocket close codes: no room now; not this run."""

LARGEST_MESSAGE = 4096

LARGEST_SIDE = 8192
"""Of a picture [pixels]: more than what draws in browsers can."""

router = APIRouter()


class Show(BaseModel):
    """Draw and describe the run at a moment."""

    model_config = ConfigDict(extra="forbid")

    type: Literal["show"]
    time: float = Field(ge=0, allow_inf_nan=False, description="Mission time [s]")


class TakePicture(BaseModel):
    """Draw and describe the run at a moment, and have the browser that shows the scene draw a picture of it."""

    model_config = ConfigDict(extra="forbid")

    type: Literal["picture"]
    name: str = Field(pattern=r"^[\w-]{1,64}$", description="By which the page knows it again")
    time: float = Field(ge=0, allow_inf_nan=False, description="Mission time [s]")
    width: int = Field(ge=16, le=LARGEST_SIDE, description="[pixels]")
    height: int = Field(ge=16, le=LARGEST_SIDE, description="[pixels]")


class Arrange(SceneChange):
    """Look at the scene in another way."""

    type: Literal["arrange"]

    def then(self, later: Arrange) -> Arrange:
        """Both in one, the later one's choices before this one's."""
        camera = self.camera if later.camera is None else later.camera
        return Arrange(type="arrange", camera=camera, layers={**self.layers, **later.layers})


Message = Show | TakePicture | Arrange
_MESSAGE: TypeAdapter[Message] = TypeAdapter(Annotated[Message, Field(discriminator="type")])


@router.websocket("/runs/{run_id}/playback")
async def playback(websocket: WebSocket, services: ServicesDep, run_id: RunId) -> None:
    """Screen the run until the client leaves."""
    await websocket.accept()
    replay_sessions = services.replay_sessions
    try:
        key, session = await replay_sessions.open(services.store.root, run_id)
    except CaptureError as refusal:
        code = TRY_AGAIN_LATER if isinstance(refusal, ServiceBusy) else POLICY
        await websocket.send_text(_refused(refusal))
        await websocket.close(code, str(refusal)[:100])
        return
    try:
        with contextlib.suppress(WebSocketDisconnect):  # the client may have left while the run was read
            await websocket.send_text(_opened(key, session.opened))
            await _Connection(websocket, replay_sessions, session).serve()
    finally:
        replay_sessions.close(key)


def _opened(key: str, opened: Opened) -> str:
    message = {
        "type": "opened",
        "scene": f"/scene/playback/{key}/",
        "end": opened.end,
        "camera": opened.camera,
        "cameras": list(CAMERAS),
        "layers": opened.layers,
    }
    return json.dumps(message)


def _refused(refusal: CaptureError) -> str:
    return '{"type":"refused","problem":' + document_of(refusal).model_dump_json(exclude_none=True) + "}"


class _Connection:
    """One client and its session: the last moment asked for is shown as soon as the one before is."""

    def __init__(self, websocket: WebSocket, replay_sessions: ReplaySessions, session: ReplaySession) -> None:
        self._websocket = websocket
        self._sessions = replay_sessions
        self._session = session
        self._wanted: Show | None = None
        self._picture: TakePicture | None = None
        self._arrangement: Arrange | None = None
        self._news = asyncio.Event()

    async def serve(self) -> None:
        """Until the client leaves."""
        tasks = [asyncio.create_task(self._listen()), asyncio.create_task(self._project())]
        try:
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
        with contextlib.suppress(RuntimeError, WebSocketDisconnect):
            await self._websocket.close()

    async def _listen(self) -> None:
        while (received := await self._websocket.receive())["type"] == "websocket.receive":
            message = await self._understood(received)
            if isinstance(message, Show):
                self._wanted = message
            elif isinstance(message, TakePicture):
                self._picture = message
            elif message is not None:
                self._arrangement = message if self._arrangement is None else self._arrangement.then(message)
            self._news.set()

    async def _understood(self, received: Any) -> Message | None:
        """The client's message; one that is none is answered with what would be right."""
        try:
            return _MESSAGE.validate_json((received.get("text") or "")[:LARGEST_MESSAGE])
        except ValidationError as error:
            findings = [f"{'.'.join(map(str, each['loc']))}: {each['msg']}" for each in error.errors()]
            await self._websocket.send_text(json.dumps({"type": "invalid", "detail": "; ".join(findings)}))
            return None

    async def _project(self) -> None:
        while True:
            await self._news.wait()
            self._news.clear()
            arrangement, self._arrangement = self._arrangement, None
            if arrangement is not None:
                arrange = self._session.arrange
                await self._sessions.aside(arrange, arrangement.camera, arrangement.layers)
            wanted, self._wanted = self._wanted, None
            if wanted is not None:
                await self._answer(partial(self._session.show, wanted.time))
            taken, self._picture = self._picture, None
            if taken is not None:
                picture = Picture(taken.name, taken.width, taken.height)
                await self._answer(partial(self._session.picture, taken.time, picture))

    async def _answer(self, shown: Callable[[], str]) -> None:
        """Say what was published at the moment that is shown now."""
        try:
            snapshot = await self._sessions.aside(shown)
        except CaptureError as refusal:
            await self._websocket.send_text(_refused(refusal))
            return
        await self._websocket.send_text(snapshot_text(snapshot))
