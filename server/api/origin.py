"""Refuses what another site's page asks of us in a visitor's name."""

from __future__ import annotations

from collections.abc import Collection
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from server.api.problem_json import ProblemDocument, problem_answer

SAFE_METHODS = ("GET", "HEAD", "OPTIONS")


class SameOrigin:
    """Answers 403 what is not addressed to this service by its own pages, or by no page at all.

    The host name must be one of ours: a page elsewhere can make its own name lead here. And WebSockets, and
    requests that change something, must have no `Origin` but this host.
    """

    def __init__(self, app: ASGIApp, hosts: Collection[str]) -> None:
        """Guard `app`; it answers to these host names, or to any if they are empty."""
        self._app = app
        self._hosts = hosts

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on or refuse one connection."""
        refusal = None if scope["type"] == "lifespan" else self._refusal(scope)
        if refusal is None:
            await self._app(scope, receive, send)
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008, "reason": refusal})
        else:
            document = ProblemDocument(
                title="Forbidden", status=403, detail=refusal, tip="use this service by its own address"
            )
            await problem_answer(document)(scope, receive, send)

    def _refusal(self, scope: Scope) -> str | None:
        headers = Headers(scope=scope)
        host, origin = headers.get("host", ""), headers.get("origin")
        if self._hosts and urlsplit(f"//{host}").hostname not in self._hosts:
            return f"host {host!r} is not one of this service; BECALM_ALLOWED_HOSTS may add it"
        if scope["type"] == "http" and scope["method"] in SAFE_METHODS:
            return None
        if origin is None or urlsplit(origin).netloc == host:
            return None
        return f"the request comes from a page of {origin}"
