"""Which methods an address takes: HEAD wherever GET is, OPTIONS that say so, and 405 with `Allow` for all others."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence

from starlette.routing import BaseRoute, Match
from starlette.types import ASGIApp, Message, Receive, Scope, Send

KNOWN = ("GET", "POST", "PUT", "PATCH", "DELETE")


def allowed_methods(routes: Sequence[BaseRoute], scope: Scope) -> tuple[str, ...]:
    """The methods that this address takes, by these routes; empty if there is no such address."""
    asked = {"type": "http", "path": scope["path"], "root_path": scope.get("root_path", ""), "headers": []}
    found = tuple(
        method
        for method in KNOWN
        if any(route.matches({**asked, "method": method})[0] is Match.FULL for route in routes)
    )
    if not found:
        return ()
    return (*found, *(("HEAD",) if "GET" in found else ()), "OPTIONS")


class _HeadIsSent(Exception):
    """Ends the making of an answer of which only the head was asked for."""


class HeadAsGet:
    """Answers HEAD as it would answer GET, without the body; nothing more of a long answer is made than that takes."""

    def __init__(self, app: ASGIApp) -> None:
        """In front of `app`, which need not know of HEAD."""
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on one connection."""
        if scope["type"] != "http" or scope["method"] != "HEAD":
            await self._app(scope, receive, send)
            return
        ended = False

        async def head_only(message: Message) -> None:
            nonlocal ended
            if message["type"] == "http.response.start":
                await send(message)
            elif message["type"] == "http.response.body" and not ended:
                ended = True
                await send({"type": "http.response.body", "body": b"", "more_body": False})
                if message.get("more_body"):
                    raise _HeadIsSent

        with contextlib.suppress(_HeadIsSent):
            await self._app({**scope, "method": "GET"}, receive, head_only)
