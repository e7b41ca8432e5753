"""What a request may bring: text that is text, JSON, and not too much of it."""

from __future__ import annotations

import asyncio

from starlette.datastructures import Headers
from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from server.edge.problem_json import Finding, ProblemDocument, problem_answer
from server.edge.text_checks import Fault, fault_of_address, fault_of_body
from server.texts import shortened

LARGEST_BODY = 1_000_000
"""Bytes; the largest study definition that makes sense has some thousands."""

CHECKED_HERE = 16_384
"""Bytes of a body that is looked through at once; a larger one in a thread of its own."""


LOGS = "/imports"
"""How the address ends to which whole logs are sent, which are no JSON and bounded by who reads them."""


class JsonBodies:
    """Answers 413 to a larger body, also one whose length is not said beforehand, and 415 to one that is not JSON.

    And 422 to what no text can hold, or JSON can say in two ways, wherever in a request it stands: the operations
    behind need not think of it.
    """

    def __init__(self, app: ASGIApp) -> None:
        """In front of `app`."""
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on one request with its body, once all of that is there, or refuse it."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        fault = fault_of_address(scope)
        if fault is not None:
            await _say_fault(scope, receive, send, fault)
        elif scope["type"] != "http" or scope["method"] in ("GET", "HEAD", "OPTIONS") or _is_log(scope):
            await self._app(scope, receive, send)
        else:
            await self._with_body(scope, receive, send)

    async def _with_body(self, scope: Scope, receive: Receive, send: Send) -> None:
        headers = Headers(scope=scope)
        length = headers.get("content-length", "")
        try:
            body = None if length.isdigit() and int(length) > LARGEST_BODY else await _whole(receive)
        except ClientDisconnect:
            return  # in the middle of the body: nobody waits for an answer, and half a request is none
        if body is None:
            await _refuse(scope, receive, send, 413, f"a body has at most {LARGEST_BODY} bytes", "send less at a time")
        elif body and not _is_json(headers.get("content-type", "")):
            kind = shortened(headers.get("content-type", "no Content-Type"))
            await _refuse(scope, receive, send, 415, f"the body is said to be {kind}", "send application/json")
        elif (fault := await _fault_of(body)) is not None:
            await _say_fault(scope, receive, send, fault)
        else:
            await self._app(scope, _again(body, receive), send)


def _is_log(scope: Scope) -> bool:
    kind = Headers(scope=scope).get("content-type", "")
    return scope["path"].endswith(LOGS) and kind.partition(";")[0].strip().lower() == "application/octet-stream"


async def _whole(receive: Receive) -> bytes | None:
    """The body; None if it is too large.

    Raises:
        ClientDisconnect: it ends before it is whole.

    """
    parts: list[bytes] = []
    size = 0
    while True:
        message = await receive()
        if message["type"] != "http.request":
            raise ClientDisconnect
        parts.append(message.get("body", b""))
        size += len(parts[-1])
        if size > LARGEST_BODY:
            return None
        if not message.get("more_body", False):
            return b"".join(parts)


async def _fault_of(body: bytes) -> Fault | None:
    return fault_of_body(body) if len(body) <= CHECKED_HERE else await asyncio.to_thread(fault_of_body, body)


async def _say_fault(scope: Scope, receive: Receive, send: Send, fault: Fault) -> None:
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": 1008, "reason": f"{fault.field}: {fault.message}"[:100]})
        return
    detail = f"{fault.field}: {fault.message}" if fault.field else fault.message
    findings = [Finding(field=fault.field, message=fault.message)]
    tip = "send text in UTF-8 and JSON as RFC 8259 has it; /docs shows what is expected"
    document = ProblemDocument(title="Invalid value", status=422, detail=detail, tip=tip, errors=findings)
    await problem_answer(document)(scope, receive, send)


def _again(body: bytes, receive: Receive) -> Receive:
    """Gives the body that has been read, then whatever comes."""
    waiting = [body]

    async def replay() -> Message:
        if waiting:
            return {"type": "http.request", "body": waiting.pop(), "more_body": False}
        return await receive()

    return replay


def _is_json(content_type: str) -> bool:
    kind = content_type.partition(";")[0].strip().lower()
    return kind == "application/json" or kind.endswith("+json")


async def _refuse(scope: Scope, receive: Receive, send: Send, status: int, detail: str, tip: str) -> None:
    title = "Too large" if status == 413 else "Not JSON"
    await problem_answer(ProblemDocument(title=title, status=status, detail=detail, tip=tip))(scope, receive, send)
