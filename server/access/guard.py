"""The one check that every HTTP request and WebSocket passes: who is it, and may they."""

from __future__ import annotations

from functools import partial
from typing import Any, NamedTuple

from starlette.datastructures import Headers
from starlette.requests import HTTPConnection
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from server.access.attempts import Attempts
from server.access.audit import AuditLog
from server.access.cookie import SessionCookie
from server.access.lease import run_answer, run_socket
from server.access.roles import WEBSOCKET, Role, needed_role
from server.access.tokens import Holder, TokenStore
from server.edge.problem_json import ProblemDocument, problem_answer
from server.texts import shortened

ANYONE = Holder("operator", Role.ADMIN)
"""Who asks where no token is needed."""

SAFE_METHODS = ("GET", "HEAD", "OPTIONS")

STOP = ("POST", "/api/v1/mission/stop")


class Access(NamedTuple):
    """Whom the service lets in."""

    tokens: TokenStore
    required: bool
    """False: everyone who reaches the service is `ANYONE`."""
    attempts: Attempts
    audit: AuditLog
    cookie: SessionCookie

    @property
    def failure(self) -> str | None:
        """Why the tokens cannot be read, in words for anyone; None while they can, or where none is needed."""
        damaged = self.required and self.tokens.damage is not None
        return "the file of the tokens cannot be read; the service's log says why" if damaged else None


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
        method, path = method_and_path(scope)
        admitted, refusal = self._decide(scope, method, path)
        if refusal is not None:
            self._log(scope, admitted.holder, refusal.status)
            await _refuse(scope, receive, send, refusal)
            return
        scope.setdefault("state", {})["holder"] = admitted.holder

        async def logged(message: Message) -> None:
            if message["type"] == "http.response.start" and method not in SAFE_METHODS:
                self._log(scope, admitted.holder, message["status"])
            elif message["type"] == "websocket.accept":
                self._log(scope, admitted.holder, 101)
            await send(message)

        if admitted.secret is None:
            await self._app(scope, receive, logged)
        else:
            run = run_socket if method == WEBSOCKET else run_answer
            await run(self._app, scope, receive, logged, partial(self._holds, admitted.secret, method, path))

    def _decide(self, scope: Scope, method: str, path: str) -> tuple[_Admitted, Refusal | None]:
        if not self._access.required:
            return _Admitted(ANYONE), None
        needed = needed_role(method, path)
        secrets = presented(Headers(scope=scope), self._access.cookie)
        held = ((self._access.tokens.holder_of(secret), secret) for secret in secrets)
        holder, secret = next((each for each in held if each[0] is not None), (None, None))
        if needed is None:
            return _Admitted(holder), None
        if holder is None:
            return _Admitted(None), self._unknown(scope, method, path, secrets) if secrets else _no_token()
        if not holder.role.covers(needed):
            tip = f"ask for a token with the role {needed}"
            detail = f"{method} {shortened(path)} takes the role {needed}; {holder.name} is {holder.role}"
            return _Admitted(holder), Refusal(403, "Not allowed", detail, tip, {})
        return _Admitted(holder, secret), None

    def _unknown(self, scope: Scope, method: str, path: str, secrets: tuple[str, ...]) -> Refusal:
        """STOP is answered with why it is not obeyed, however often it is pressed; it is neither counted nor slowed."""
        return _NOT_A_TOKEN if (method, path) == STOP else unknown_token(self._access, scope, secrets[0])

    def _holds(self, secret: str, method: str, path: str) -> bool:
        """Whether what a token was admitted to would be granted again."""
        holder, needed = self._access.tokens.holder_of(secret), needed_role(method, path)
        return holder is not None and (needed is None or holder.role.covers(needed))

    def _log(self, scope: Scope, holder: Holder | None, status: int) -> None:
        self._access.audit.write(holder, **entry_of(scope, holder, status))


class _Admitted(NamedTuple):
    """Who asks, and by which token, where one was needed."""

    holder: Holder | None
    secret: str | None = None


def method_and_path(scope: Scope) -> tuple[str, str]:
    """What a connection asks for, by the names that roles are given for."""
    method = WEBSOCKET if scope["type"] == "websocket" else scope["method"]
    return method, scope["path"].removeprefix(scope.get("root_path", ""))


def entry_of(scope: Scope, holder: Holder | None, status: int) -> dict[str, Any]:
    """The audit log's line of a connection."""
    method, path = method_and_path(scope)
    return {
        "who": holder.name if holder else None,
        "role": holder.role.value if holder else None,
        "address": address_of(scope),
        "method": method,
        "path": path,
        "status": status,
    }


def presented(headers: Headers, cookie: SessionCookie) -> tuple[str, ...]:
    """The tokens that a request shows: the one in its `Authorization`, or those in the console's cookies."""
    scheme, _, secret = headers.get("authorization", "").partition(" ")
    if scheme.lower() == "bearer" and secret.strip():
        return (secret.strip(),)
    return cookie.secrets_in(headers)


def address_of(scope: Scope) -> str:
    """Where a request comes from."""
    return scope["client"][0] if scope.get("client") else "unknown"


def holder_of(connection: HTTPConnection) -> Holder | None:
    """Who asks; None only where no token is needed."""
    holder: Holder | None = connection.scope.get("state", {}).get("holder")
    return holder


def unknown_token(access: Access, scope: Scope, secret: str) -> Refusal:
    """Of a token that is none: 401, or 429 for an address that tries one after another. In the event loop only."""
    wait = access.attempts.failed(address_of(scope), secret)
    if wait is None:
        return _NOT_A_TOKEN
    seconds = str(max(1, round(wait)))
    detail = f"too many invalid tokens from this address; try again in {seconds} s"
    return Refusal(429, "Too many attempts", detail, "a valid token is still accepted", {"Retry-After": seconds})


_NOT_A_TOKEN = Refusal(
    401,
    "Not signed in",
    "this token is unknown, has expired or was revoked",
    "becalm token create makes one",
    _CHALLENGE,
)


def _no_token() -> Refusal:
    tip = "send it as `Authorization: Bearer TOKEN`, or sign in on the page"
    return Refusal(401, "Not signed in", "a token is needed", tip, _CHALLENGE)


async def _refuse(scope: Scope, receive: Receive, send: Send, refusal: Refusal) -> None:
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": 1008, "reason": refusal.detail})
    else:
        await refusal.answer(scope, receive, send)
