"""The path of another site under which a reverse proxy shows the service, `https://lab.example/becalm/`."""

from __future__ import annotations

import re

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

_PREFIX = re.compile(r"(/[A-Za-z0-9_~-][A-Za-z0-9._~-]*)+")
"""Folders only: whatever else a request claims in that header is ignored."""


class ForwardedPrefix:
    """Takes `X-Forwarded-Prefix` as ASGI's `root_path`, and puts it before the paths that answers redirect to.

    The proxy takes the prefix off the path that it asks for; everything within here names paths without it.
    A request that claims a prefix of its own changes the answer to itself only, so it does not matter who sent it.
    """

    def __init__(self, app: ASGIApp) -> None:
        """Around `app`, and around all that looks at paths."""
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on one connection."""
        prefix = "" if scope["type"] == "lifespan" else Headers(scope=scope).get("x-forwarded-prefix", "").rstrip("/")
        if not _PREFIX.fullmatch(prefix):
            await self._app(scope, receive, send)
            return

        async def prefixed(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                if headers.get("location", "").startswith("/"):
                    headers["location"] = prefix + headers["location"]
            await send(message)

        await self._app({**scope, "root_path": prefix, "path": prefix + scope["path"]}, receive, prefixed)
