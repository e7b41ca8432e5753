"""Connections that nobody can use up: so many in all and of one address, and none that keeps the service waiting.

uvicorn waits for the head of a request for as long as somebody likes, and takes as many connections as there are file
descriptors; a thousand that say nothing would leave none for STOP. Here a head and a body have their time, and where
there is no room left the connection that has been idle for longest gives way to the one that comes.
"""

from __future__ import annotations

import asyncio
import ipaddress
import logging
import resource
from collections import OrderedDict
from collections.abc import Collection
from typing import Any, ClassVar, Literal, cast

from uvicorn.protocols.http.h11_impl import H11Protocol

from server.edge.authority import network_of

MOST = 1000
"""Connections in all, if there are file descriptors for them."""

MOST_OF_ONE = 200
"""Connections of one address; of a proxy that is trusted as many as in all."""

RESERVE = 256
"""File descriptors for everything else: logs, runs, the index, the robot, the scenes."""

DESCRIPTORS = 16_384
"""As many as are asked for, if the system lets this process have more than it begins with."""

HEAD_TIME = 10.0
"""How long the head of a request may take, from the connection's beginning or from its first byte [s]."""

BODY_TIME = 30.0
"""How long its body may take [s]; the largest has a megabyte."""

STALL_TIME = 60.0
"""How long a client may take nothing of an answer that waits for it [s]."""

ConnectionStage = Literal["head", "body", "answer", "rest", "socket"]
"""What a connection waits for: a request's head or body, the service, the next request; or it is a WebSocket."""

_TIMES: dict[ConnectionStage, float] = {"head": HEAD_TIME, "body": BODY_TIME}

log = logging.getLogger(__name__)


def raise_descriptor_limit() -> int:
    """Let this process have many file descriptors; how many it has then."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = DESCRIPTORS if hard == resource.RLIM_INFINITY else min(DESCRIPTORS, hard)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        try:
            resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))
            soft = wanted
        except (OSError, ValueError):
            log.warning("this process may have %d file descriptors only", soft)
    return DESCRIPTORS if soft == resource.RLIM_INFINITY else soft


class Connections:
    """Who is connected, by address; in the event loop only."""

    def __init__(self, descriptors: int, proxies: Collection[str] = (), most_of_one: int = MOST_OF_ONE) -> None:
        """Room for connections.

        Args:
            descriptors: file descriptors that this process may have.
            proxies: addresses or networks through which others come.
            most_of_one: connections of any other address.

        """
        self._most = max(16, min(MOST, descriptors - RESERVE))
        self._proxies = tuple(map(ipaddress.ip_network, proxies))
        self._most_of_one = most_of_one
        self._open: OrderedDict[BoundedHttp, str] = OrderedDict()

    def __len__(self) -> int:
        """How many there are, but for those that have just gone."""
        return len(self._open)

    def admit(self, connection: BoundedHttp, address: str) -> bool:
        """Take a connection, in place of an idle one if need be; False if nobody gives way."""
        bounded = not self._is_proxy(address)
        address = network_of(address)
        if len(self._open) >= self._most and not self._make_room(None):
            return False
        if bounded and self._count(address) >= self._most_of_one and not self._make_room(address):
            return False
        self._open[connection] = address
        return True

    def release(self, connection: BoundedHttp) -> None:
        """Forget one that has ended."""
        self._open.pop(connection, None)

    def _is_proxy(self, address: str) -> bool:
        try:
            found = ipaddress.ip_address(address)
        except ValueError:
            return False
        return any(found in each for each in self._proxies)

    def _count(self, address: str) -> int:
        return sum(each == address for each in self._open.values())

    def _make_room(self, address: str | None) -> bool:
        """End what has been idle for longest, of that address or of all, those first that never asked for anything.

        WebSockets that have ended are forgotten before that.
        """
        candidates = [each for each, whose in self._open.items() if address in (None, whose)]
        gone = [each for each in candidates if each.has_ended]
        for each in gone:
            self.release(each)
        if gone:
            return True
        idle = [each for each in candidates if each.is_idle]
        if not idle:
            return False
        least = next((each for each in idle if each.has_asked_nothing), idle[0])
        self.release(least)
        least.transport.abort()
        return True


class BoundedHttp(H11Protocol):
    """uvicorn's HTTP connection, of which there is room for a number, and which has its time for everything."""

    room: ClassVar[Connections]

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Begin, if there is room."""
        self._stage: ConnectionStage = "rest"
        self._has_asked = False
        self._timer: asyncio.TimerHandle | None = None
        self._stalled: asyncio.TimerHandle | None = None
        super().connection_made(cast("asyncio.Transport", transport))
        address = self.client[0] if self.client else "unknown"
        if self.room.admit(self, address):
            self._enter("head")
        else:
            self.transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """End."""
        self.room.release(self)
        self._enter("rest")
        self.resume_writing()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Take what has come, within the time of what it is part of."""
        super().data_received(data)
        if self._stage != "socket":
            self._enter(self._waiting_for())

    def handle_websocket_upgrade(self, event: Any) -> None:
        """Hand the connection on; it counts as before."""
        self._enter("socket")
        super().handle_websocket_upgrade(event)

    def on_response_complete(self) -> None:
        """Wait for the next request."""
        self._has_asked = True
        super().on_response_complete()
        self._enter(self._waiting_for() if self.conn.trailing_data[0] else "rest")

    def pause_writing(self) -> None:
        """The client does not take what is sent."""
        super().pause_writing()
        if self._stalled is None:
            self._stalled = self.loop.call_later(STALL_TIME, self.transport.abort)

    def resume_writing(self) -> None:
        """It does."""
        if self._stalled is not None:
            self._stalled.cancel()
            self._stalled = None
        super().resume_writing()

    @property
    def is_idle(self) -> bool:
        """Whether no whole request of it is under way."""
        return self._stage in ("head", "body", "rest")

    @property
    def has_asked_nothing(self) -> bool:
        """Whether no request of it has been heard: what a browser keeps open for its next one is not that."""
        return not self._has_asked

    @property
    def has_ended(self) -> bool:
        """Whether it is closed, or about to be."""
        return self.transport.is_closing()

    def _waiting_for(self) -> ConnectionStage:
        if self.cycle is None or self.cycle.response_complete:
            return "head"
        return "body" if self.cycle.more_body else "answer"

    def _enter(self, stage: ConnectionStage) -> None:
        """Begin a stage's time, unless it has begun: bytes that trickle in do not make it longer."""
        if stage == self._stage:
            return
        self._stage = stage
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        if stage in _TIMES:
            self._timer = self.loop.call_later(_TIMES[stage], self.transport.close)


def bounded_http(room: Connections) -> type[BoundedHttp]:
    """The class of connections that share this room, for `uvicorn.Config`."""
    return type("BoundedHttp", (BoundedHttp,), {"room": room})
