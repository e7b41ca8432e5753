"""Sockets read at a pace: what is sent is all heard, but no faster than allowed, and others have their turns."""

from __future__ import annotations

import asyncio
import contextlib

import pytest
import uvicorn
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed

from server.edge import paced_sockets
from server.edge.paced_sockets import LARGEST_MESSAGE, SOCKET_OPTIONS, Allowance


class TestAllowance:
    def test_is_free_until_all_that_is_allowed_at_once_is_spent(self):
        allowance = Allowance(rate=10.0, at_once=5.0)
        assert [allowance.spend(1.0, now=100.0) for _ in range(5)] == [0.0] * 5

    def test_then_waits_as_long_as_what_was_spent_takes(self):
        allowance = Allowance(rate=10.0, at_once=5.0)
        assert allowance.spend(8.0, now=100.0) == pytest.approx(0.3)
        assert allowance.spend(0.0, now=100.2) == pytest.approx(0.1)
        assert allowance.spend(0.0, now=100.31) == 0.0

    def test_saves_no_more_than_is_allowed_at_once(self):
        allowance = Allowance(rate=10.0, at_once=5.0)
        allowance.spend(5.0, now=0.0)
        assert allowance.spend(6.0, now=1e6) == pytest.approx(0.1)


class Listener:
    """An application that hears."""

    def __init__(self):
        self.heard = []
        self.news = asyncio.Event()

    async def __call__(self, scope, receive, send):
        if scope["type"] != "websocket":
            return
        await receive()
        await send({"type": "websocket.accept"})
        while (message := await receive())["type"] == "websocket.receive":
            self.heard.append(message.get("text") or message.get("bytes"))
            self.news.set()

    async def until(self, count):
        async with asyncio.timeout(60):
            while len(self.heard) < count:
                self.news.clear()
                await self.news.wait()


@contextlib.asynccontextmanager
async def serving(app):
    server = uvicorn.Server(uvicorn.Config(app, port=0, log_level="error", lifespan="off", **SOCKET_OPTIONS))
    server.config.load()
    server.lifespan = server.config.lifespan_class(server.config)
    await server.startup()
    try:
        yield f"ws://127.0.0.1:{server.servers[0].sockets[0].getsockname()[1]}/"
    finally:
        await server.shutdown()


async def test_every_message_is_heard_in_its_order_though_there_are_more_than_allowed_at_once(monkeypatch):
    monkeypatch.setattr(paced_sockets, "MESSAGES", 2000.0)  # the rate itself is the allowance's, and tested there
    listener = Listener()
    async with serving(listener) as address, connect(address, proxy=None) as socket:
        sent = [f"message {number}" for number in range(800)]
        for message in sent:
            await socket.send(message)
        await listener.until(len(sent))
    assert listener.heard == sent


async def test_a_flood_is_held_up_at_who_sends_it_and_others_are_heard(monkeypatch):
    """Not in the service's memory: what it has not read is in the sender's hands."""
    monkeypatch.setattr(paced_sockets, "MESSAGES", 1e-3)
    monkeypatch.setattr(paced_sockets, "MESSAGES_AT_ONCE", 10.0)
    listener = Listener()
    async with serving(listener) as address, connect(address, proxy=None) as flooding:

        async def flood():
            with contextlib.suppress(ConnectionClosed):
                while True:
                    await flooding.send("rubbish" * 100)

        task = asyncio.create_task(flood())
        await listener.until(10)
        async with connect(address, proxy=None) as other:
            await other.send("a word")
            while "a word" not in listener.heard:
                await listener.until(len(listener.heard) + 1)
        assert len(listener.heard) < 20
        assert not task.done()
        task.cancel()
        flooding.transport.abort()


async def test_a_message_that_is_too_large_ends_its_connection():
    listener = Listener()
    async with serving(listener) as address, connect(address, proxy=None) as socket:
        await socket.send(b"x" * LARGEST_MESSAGE)
        await listener.until(1)
        await socket.send(b"x" * (LARGEST_MESSAGE + 1))
        with pytest.raises(ConnectionClosed) as closed:
            await socket.recv()
    assert closed.value.rcvd.code == 1009
    assert len(listener.heard) == 1
