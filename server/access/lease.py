"""What began with a token ends with it: sockets, and answers that are still being sent."""

from __future__ import annotations

import asyncio
import contextlib
import time
from collections.abc import Callable

from starlette.types import ASGIApp, Message, Receive, Scope, Send

LOOK_PERIOD = 1.0
"""Wall time between two looks whether a token still holds [s]."""

CLOSING_TIME = 0.5
"""How long a client may take to hear that it is over [s]."""

NOT_SIGNED_IN = 4401
"""Close code of a WebSocket whose token was revoked or has expired."""

REASON = "not signed in any more: the token was revoked or has expired"

Holds = Callable[[], bool]


class TokenEnded(Exception):
    """Ends the sending of an answer whose token is no longer valid."""


async def run_socket(app: ASGIApp, scope: Scope, receive: Receive, send: Send, holds: Holds) -> None:
    """Serve a WebSocket for as long as its token holds; then close it with `NOT_SIGNED_IN`."""
    serving = asyncio.ensure_future(app(scope, receive, send))
    try:
        while not serving.done():
            await asyncio.wait((serving,), timeout=LOOK_PERIOD)
            if not serving.done() and not holds():
                with contextlib.suppress(TimeoutError, RuntimeError, OSError):
                    message = {"type": "websocket.close", "code": NOT_SIGNED_IN, "reason": REASON}
                    await asyncio.wait_for(send(message), CLOSING_TIME)
                return
        serving.result()
    finally:
        await _cancelled(serving)


async def run_answer(app: ASGIApp, scope: Scope, receive: Receive, send: Send, holds: Holds) -> None:
    """Answer a request; what is sent in parts ends, unfinished, when the token is no longer valid."""
    looked = time.monotonic()

    async def while_it_holds(message: Message) -> None:
        nonlocal looked
        if message.get("more_body") and time.monotonic() - looked > LOOK_PERIOD:
            looked = time.monotonic()
            if not holds():
                raise TokenEnded
        await send(message)

    with contextlib.suppress(TokenEnded):
        await app(scope, receive, while_it_holds)


async def _cancelled(serving: asyncio.Future[None]) -> None:
    if not serving.done():
        serving.cancel()
        await asyncio.gather(serving, return_exceptions=True)
