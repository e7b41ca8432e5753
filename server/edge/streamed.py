"""An answer made piece by piece in another process (`server.process.aside`), for as long as somebody takes it."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Mapping

from fastapi.responses import StreamingResponse
from starlette.types import Receive, Scope, Send

from server.process.aside import PiecesLost, PieceStream

log = logging.getLogger(__name__)

SEND_TIME = 20.0
"""A client that takes nothing for this long is let go [s]: a few have all places there are."""


class Streamed(StreamingResponse):
    """Ends its process when all is sent, when the client goes, and when it takes nothing any more."""

    def __init__(self, stream: PieceStream, media_type: str, headers: Mapping[str, str]) -> None:
        super().__init__(stream, media_type=media_type, headers=headers)
        self._stream = stream

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer."""
        sending = asyncio.create_task(self._send(send))
        leaving = asyncio.create_task(_left(receive))
        try:
            await asyncio.wait((sending, leaving), return_when=asyncio.FIRST_COMPLETED)
        finally:
            self._stream.close()
            for task in (sending, leaving):
                task.cancel()
            outcome, _ = await asyncio.gather(sending, leaving, return_exceptions=True)
        if isinstance(outcome, PiecesLost):
            log.warning("%s ended before it was whole: %s", scope["path"], outcome)
        elif isinstance(outcome, Exception) and not isinstance(outcome, TimeoutError):
            raise outcome

    async def _send(self, send: Send) -> None:
        start = {"type": "http.response.start", "status": self.status_code, "headers": self.raw_headers}
        await send(start)
        async for piece in self._stream:
            await asyncio.wait_for(send({"type": "http.response.body", "body": piece, "more_body": True}), SEND_TIME)
        await send({"type": "http.response.body", "body": b"", "more_body": False})


async def _left(receive: Receive) -> None:
    """Wait until the client has gone."""
    while (await receive())["type"] != "http.disconnect":
        continue
