"""Refuses what another site's page asks of us in a visitor's name."""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from server.access.audit import AuditLog
from server.access.guard import SAFE_METHODS, entry_of
from server.edge.authority import Authority, is_same, read_authority, read_origin
from server.edge.problem_json import ProblemDocument, problem_answer
from server.texts import shortened

_MALFORMED, _FORBIDDEN = 400, 403


class _Refusal(NamedTuple):
    status: int
    detail: str


class SameOrigin:
    """Answers 403 what is not addressed to this service by its own pages, or by no page at all; 400 what is no address.

    The host name must be one of ours: a page elsewhere can make its own name lead here. And WebSockets, and
    requests that change something, must have no `Origin` but this host.
    """

    def __init__(self, app: ASGIApp, hosts: Collection[str], audit: AuditLog | None = None) -> None:
        """Guard `app`; it answers to these host names as `host_name` gives them, or to any if they are empty."""
        self._app = app
        self._hosts = hosts
        self._audit = audit

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on or refuse one connection."""
        refusal = None if scope["type"] == "lifespan" else self._refusal(scope)
        if refusal is None:
            await self._app(scope, receive, send)
            return
        if self._audit is not None:
            self._audit.write(None, **entry_of(scope, None, refusal.status))
        if scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008, "reason": refusal.detail})
        else:
            title = "Not an address" if refusal.status == _MALFORMED else "Forbidden"
            document = ProblemDocument(
                title=title, status=refusal.status, detail=refusal.detail, tip="use this service by its own address"
            )
            await problem_answer(document)(scope, receive, send)

    def _refusal(self, scope: Scope) -> _Refusal | None:
        headers = Headers(scope=scope)
        host = self._host(headers.getlist("host"))
        if isinstance(host, _Refusal):
            return host
        return _foreign(scope, headers.getlist("origin"), host)

    def _host(self, hosts: list[str]) -> Authority | _Refusal | None:
        """What the request is addressed to, or why not; None if it does not say so, where any name will do."""
        if not hosts and not self._hosts:
            return None
        if len(hosts) != 1:
            return _Refusal(_MALFORMED, f"{len(hosts)} Host headers; there is to be one")
        host = read_authority(hosts[0])
        if host is None:
            return _Refusal(_MALFORMED, f"Host: {shortened(hosts[0])!r} is no host")
        if self._hosts and host.host not in self._hosts:
            what = f"host {shortened(hosts[0])!r} is not one of this service; BECALM_ALLOWED_HOSTS may add it"
            return _Refusal(_FORBIDDEN, what)
        return host


def _foreign(scope: Scope, origins: list[str], host: Authority | None) -> _Refusal | None:
    """Why a request of that origin is refused, if it is."""
    if not origins:
        return None
    if len(origins) > 1:
        return _Refusal(_MALFORMED, f"{len(origins)} Origin headers; there is to be one at most")
    shown = shortened(origins[0])
    origin = read_origin(origins[0])
    if origins[0] == "null":
        return _Refusal(_FORBIDDEN, "the request comes from a page that hides where it is from (Origin: null)")
    if origin is None:
        return _Refusal(_MALFORMED, f"Origin: {shown!r} is no origin")
    changes_nothing = scope["type"] == "http" and scope["method"] in SAFE_METHODS
    own = host is not None and is_same(origin, host, scope.get("scheme", "http"))
    return None if own or changes_nothing else _Refusal(_FORBIDDEN, f"the request comes from a page of {shown}")
