"""The one check that every HTTP request and WebSocket passes: who is it, and may they."""

from __future__ import annotations

from http.cookies import CookieError, SimpleCookie
from typing import NamedTuple

from starlette.datastructures import Headers
from starlette.requests import HTTPConnection
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from server.access.attempts import Attempts
from server.access.audit import AuditLog
from server.access.roles import WEBSOCKET, Role, needed_role
from server.access.tokens import Holder, TokenStore
from server.api.problem_json import ProblemDocument, problem_answer

COOKIE = "becalm_token"
ANYONE = Holder("operator", Role.ADMIN)
"""Who asks where no token is needed."""

SAFE_METHODS = ("GET", "HEAD", "OPTIONS")


class Access(NamedTuple):
    """Whom the service lets in."""

    tokens: TokenStore
    required: bool
    """False: everyone who reaches the service is `ANYONE`."""
    attempts: Attempts
    audit: AuditLog


_CHALLENGE = {"WWW-Authenticate": 'Bearer realm="Becalm"'}


class Refusal(NamedTuple):
    """Why a request is not let pass."""

    status: int
    title: str
    detail: str
    tip: str
    headers: dict[str, str]

    @property
    def answer(self) -> Response:
        """As a problem document."""
        status, title, detail, tip, headers = self
        return problem_answer(ProblemDocument(title=title, status=status, detail=detail, tip=tip), headers)


class Guard:
    """Lets a request pass whose token has the role that it takes; puts the holder into the scope's state."""

    def __init__(self, app: ASGIApp, access: Access) -> None:
        """Guard `app`."""
        self._app = app
        self._access = access

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on or refuse one connection, and log it if it changes something or is refused."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        method = WEBSOCKET if scope["type"] == "websocket" else scope["method"]
        path = scope["path"].removeprefix(scope.get("root_path", ""))
        holder, refusal = self._decide(scope, method, path)
        if refusal is not None:
            self._log(scope, holder, method, path, refusal.status)
            await _refuse(scope, receive, send, refusal)
            return
        scope.setdefault("state", {})["holder"] = holder
        if method in SAFE_METHODS:
            await self._app(scope, receive, send)
            return

        async def logged(message: Message) -> None:
            if message["type"] == "http.response.start":
                self._log(scope, holder, method, path, message["status"])
            elif message["type"] == "websocket.accept":
                self._log(scope, holder, method, path, 101)
            await send(message)

        await self._app(scope, receive, logged)

    def _decide(self, scope: Scope, method: str, path: str) -> tuple[Holder | None, Refusal | None]:
        if not self._access.required:
            return ANYONE, None
        needed = needed_role(method, path)
        secret = presented(Headers(scope=scope))
        holder = self._access.tokens.holder_of(secret) if secret else None
        if needed is None:
            return holder, None
        if holder is None:
            return None, _no_token() if secret is None else unknown_token(self._access, scope)
        if not holder.role.covers(needed):
            tip = f"ask for a token with the role {needed}"
            detail = f"{method} {path} takes the role {needed}; {holder.name} is {holder.role}"
            return holder, Refusal(403, "Not allowed", detail, tip, {})
        return holder, None

    def _log(self, scope: Scope, holder: Holder | None, method: str, path: str, status: int) -> None:
        self._access.audit.write(
            who=holder.name if holder else None,
            role=holder.role.value if holder else None,
            address=address_of(scope),
            method=method,
            path=path,
            status=status,
        )


def presented(headers: Headers) -> str | None:
    """The token that a request shows: in its `Authorization`, or in the console's cookie."""
    scheme, _, secret = headers.get("authorization", "").partition(" ")
    if scheme.lower() == "bearer" and secret.strip():
        return secret.strip()
    try:
        cookie = SimpleCookie(headers.get("cookie", "")).get(COOKIE)
    except CookieError:
        return None
    return cookie.value if cookie is not None and cookie.value else None


def address_of(scope: Scope) -> str:
    """Where a request comes from."""
    return scope["client"][0] if scope.get("client") else "unknown"


def holder_of(connection: HTTPConnection) -> Holder | None:
    """Who asks; None only where no token is needed."""
    holder: Holder | None = connection.scope.get("state", {}).get("holder")
    return holder


def unknown_token(access: Access, scope: Scope) -> Refusal:
    """Of a token that is none: 401, or 429 for an address that tries one after another. In the event loop only."""
    wait = access.attempts.failed(address_of(scope))
    if wait is None:
        detail = "that token is not known, has expired or was revoked"
        return Refusal(401, "Not signed in", detail, "becalm token create makes one", _CHALLENGE)
    seconds = str(max(1, round(wait)))
    detail = f"too many tokens that are none from this address; try again in {seconds} s"
    return Refusal(429, "Too many attempts", detail, "one that holds is still let in", {"Retry-After": seconds})


def _no_token() -> Refusal:
    tip = "send it as `Authorization: Bearer TOKEN`, or sign in on the page"
    return Refusal(401, "Not signed in", "a token is needed", tip, _CHALLENGE)


async def _refuse(scope: Scope, receive: Receive, send: Send, refusal: Refusal) -> None:
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": 1008, "reason": refusal.detail})
    else:
        await refusal.answer(scope, receive, send)
