"""Requests are begun one by one, and STOP before all that wait."""

from __future__ import annotations

import asyncio

from starlette.types import ASGIApp, Receive, Scope, Send

STOP = "/api/v1/mission/stop"


class Turns:
    """Begins one request with each turn of the event loop; what others send at once waits for its own, but STOP never.

    An event loop begins all that has come since its last turn before it looks for more. A request takes it a
    millisecond or two, so that a STOP would wait for every request that came at the same moment, or just before.
    """

    def __init__(self, app: ASGIApp) -> None:
        """Outermost of all, around `app`."""
        self._app = app
        self._turn = asyncio.Lock()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on one connection when it is its turn."""
        if scope["type"] in ("http", "websocket") and not _is_stop(scope):
            async with self._turn:
                await asyncio.sleep(0)
        await self._app(scope, receive, send)


def _is_stop(scope: Scope) -> bool:
    """Also under the path of another site: what is none is not answered as one further in."""
    return bool(scope["type"] == "http" and scope["method"] == "POST" and scope["path"].endswith(STOP))
