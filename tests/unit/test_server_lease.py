"""What began with a token ends with it."""

from __future__ import annotations

import asyncio

import pytest

from server.access import lease


class Connection:
    """The other end of a socket."""

    def __init__(self, *, takes: bool = True) -> None:
        self.sent: list[dict] = []
        self.takes = takes
        self.holds = True

    async def receive(self):
        await asyncio.Event().wait()

    async def send(self, message) -> None:
        if not self.takes:
            await asyncio.Event().wait()
        self.sent.append(message)


@pytest.fixture(autouse=True)
def _soon(monkeypatch):
    monkeypatch.setattr(lease, "LOOK_PERIOD", 0.01)
    monkeypatch.setattr(lease, "CLOSING_TIME", 0.01)


@pytest.mark.parametrize("takes", [True, False])
async def test_a_socket_ends_with_its_token(takes):
    ended, looked_at = asyncio.Event(), asyncio.Event()
    looks: list[bool] = []

    async def app(_scope, receive, _send):
        try:
            await receive()
        finally:
            ended.set()

    def holds() -> bool:
        looks.append(connection.holds)
        if len(looks) == 3:
            looked_at.set()
        return connection.holds

    connection = Connection(takes=takes)
    serving = asyncio.create_task(lease.run_socket(app, {}, connection.receive, connection.send, holds))
    await asyncio.wait_for(looked_at.wait(), 60)
    assert not ended.is_set()
    connection.holds = False
    await asyncio.wait_for(serving, 60)
    assert ended.is_set()
    closing = {"type": "websocket.close", "code": lease.NOT_SIGNED_IN, "reason": lease.REASON}
    assert connection.sent == ([closing] if takes else [])
    assert len(lease.REASON.encode()) <= 123  # what a close frame has room for


async def test_a_socket_that_fails_says_so_and_one_that_is_cancelled_ends():
    async def failing(_scope, _receive, _send):
        raise ZeroDivisionError

    connection = Connection()
    with pytest.raises(ZeroDivisionError):
        await lease.run_socket(failing, {}, connection.receive, connection.send, lambda: True)
    begun, ended = asyncio.Event(), asyncio.Event()

    async def waiting(_scope, receive, _send):
        begun.set()
        try:
            await receive()
        finally:
            ended.set()

    serving = asyncio.create_task(lease.run_socket(waiting, {}, connection.receive, connection.send, lambda: True))
    await asyncio.wait_for(begun.wait(), 60)
    serving.cancel()
    await asyncio.gather(serving, return_exceptions=True)
    assert ended.is_set()


async def test_an_answer_in_parts_ends_unfinished():
    connection = Connection()

    async def endless(_scope, _receive, send):
        await send({"type": "http.response.start", "status": 200})
        while True:
            await send({"type": "http.response.body", "body": b"x", "more_body": True})
            await asyncio.sleep(0.02)
            connection.holds = len(connection.sent) < 5

    await asyncio.wait_for(
        lease.run_answer(endless, {}, connection.receive, connection.send, lambda: connection.holds), 60
    )
    assert 5 <= len(connection.sent) < 10
    assert connection.sent[-1]["more_body"]
