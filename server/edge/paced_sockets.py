"""WebSockets that are read no faster than the service can handle them, so that nobody who sends keeps others waiting.

uvicorn reads all that a connection has sent, as soon as it comes: a quarter of a megabyte at once, which are twenty
thousand small messages, in one go of the event loop. Here a connection is read in small pieces, with the others' turns
between them, and only while it is within its allowance. What it sends beyond that waits, in the end at the sender
(TCP): nothing is lost, nothing piles up, and a flood is slow for who sends it.
"""

from __future__ import annotations

import asyncio
from typing import Any, TypedDict, cast

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

PIECE = 1024
"""Bytes that are read in one go: 170 messages at most."""

LARGEST_MESSAGE = 64 * 1024
"""Bytes of a message; of a larger one the connection is closed (1009)."""

MESSAGES, MESSAGES_AT_ONCE = 150.0, 300.0
"""Of one connection: a second in the long run, and at once. A console acknowledges 60 snapshots a second."""

BYTES, BYTES_AT_ONCE = 256e3, 512e3
"""Of one connection, likewise."""

ALL_MESSAGES, ALL_MESSAGES_AT_ONCE = 2000.0, 2000.0
"""Of all connections together, likewise."""

LOOK_AGAIN = 0.1
"""Between two looks at a client that takes no answers [s]: while it does not, it is not read."""


class Allowance:
    """So much a second in the long run, and so much at once."""

    def __init__(self, rate: float, at_once: float) -> None:
        self._rate, self._at_once = rate, at_once
        self._left, self._at = at_once, 0.0

    def spend(self, amount: float, now: float) -> float:
        """Spend that, on credit if need be; how long to wait before anything more is spent [s]."""
        self._left = min(self._at_once, self._left + (now - self._at) * self._rate) - amount
        self._at = now
        return max(0.0, -self._left / self._rate)


_everyone = Allowance(ALL_MESSAGES, ALL_MESSAGES_AT_ONCE)


class _Held:
    """The transport as uvicorn sees it: when to go on reading is decided by who paces it."""

    def __init__(self, transport: asyncio.Transport, paced: PacedSocket) -> None:
        self._transport = transport
        self._paced = paced

    def __getattr__(self, name: str) -> Any:
        return getattr(self._transport, name)

    def resume_reading(self) -> None:
        """The application has taken all messages."""
        self._paced.read_on()


class PacedSocket(WebSocketsSansIOProtocol):
    """uvicorn's WebSocket connection, read at a pace."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Begin."""
        self._wire = cast("asyncio.Transport", transport)
        self._unread = bytearray()
        self._timer: asyncio.TimerHandle | None = None
        self._messages = Allowance(MESSAGES, MESSAGES_AT_ONCE)
        self._bytes = Allowance(BYTES, BYTES_AT_ONCE)
        super().connection_made(cast("asyncio.Transport", _Held(self._wire, self)))

    def data_received(self, data: bytes) -> None:
        """Take what has come, but handle it piece by piece."""
        self._unread += data
        self.read_on()

    def connection_lost(self, exc: Exception | None) -> None:
        """End."""
        self._unread.clear()
        if self._timer is not None:
            self._timer.cancel()
        super().connection_lost(exc)

    def read_on(self) -> None:
        """Heed the next piece, unless it is too early, or the application has not taken the one before."""
        if self._timer is not None or self.read_paused:
            return
        if not self._unread:
            self._wire.resume_reading()
            return
        self._wire.pause_reading()
        piece = bytes(self._unread[:PIECE])
        del self._unread[:PIECE]
        before = len(self.conn.events)
        self.conn.receive_data(piece)
        heard = len(self.conn.events) - before
        if self.conn.parser_exc is None:
            self.handle_events()
        else:
            self.handle_parser_exception()
        self._timer = self.loop.call_later(self._spend(heard, len(piece)), self._go_on)

    def _spend(self, messages: int, size: int) -> float:
        now = self.loop.time()
        allowances = (self._messages.spend(messages, now), self._bytes.spend(size, now), _everyone.spend(messages, now))
        return max(allowances)

    def _go_on(self) -> None:
        self._timer = None
        if self.writable.is_set() or self.disconnected:
            self.read_on()
        else:
            self._timer = self.loop.call_later(LOOK_AGAIN, self._go_on)


class SocketOptions(TypedDict):
    """How uvicorn serves sockets."""

    ws: type[PacedSocket]
    ws_max_size: int
    ws_per_message_deflate: bool


SOCKET_OPTIONS = SocketOptions(ws=PacedSocket, ws_max_size=LARGEST_MESSAGE, ws_per_message_deflate=False)
"""For `uvicorn.Config`."""
