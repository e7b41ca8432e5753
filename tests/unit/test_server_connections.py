"""Connections that nobody can use up, with a real uvicorn."""

from __future__ import annotations

import contextlib
import socket
import threading
import time
from collections.abc import Iterator

import httpx
import pytest
import uvicorn

from server.edge import connections
from server.edge.connections import Connections, bounded_http, raise_descriptor_limit

PATIENCE = 120.0


async def application(scope, receive, send) -> None:
    """Answers once the body is there; under /much with more than any socket takes at once."""
    while (message := await receive())["type"] == "http.request" and message["more_body"]:
        pass
    await send({"type": "http.response.start", "status": 200, "headers": []})
    for _ in range(500 if scope["path"] == "/much" else 1):
        await send({"type": "http.response.body", "body": b"x" * 100_000, "more_body": True})
    await send({"type": "http.response.body", "body": b""})


@contextlib.contextmanager
def served(room: Connections) -> Iterator[int]:
    config = uvicorn.Config(application, log_level="error", lifespan="off", http=bounded_http(room))
    server = uvicorn.Server(config)
    with socket.create_server(("127.0.0.1", 0), backlog=2048) as listener:
        thread = threading.Thread(target=server.run, args=([listener],))
        thread.start()
        deadline = time.monotonic() + PATIENCE
        while not server.started and time.monotonic() < deadline:
            time.sleep(0.01)
        try:
            yield listener.getsockname()[1]
        finally:
            server.should_exit = True
            server.force_exit = True
            thread.join(PATIENCE)


def connected(port: int, first: bytes = b"") -> socket.socket:
    made = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE)
    made.sendall(first)
    return made


def ended(made: socket.socket) -> bool:
    """Whether the other side has closed; waits for it."""
    try:
        return made.recv(1) == b""
    except ConnectionResetError:
        return True


def stopped(port: int) -> int:
    with httpx.Client(trust_env=False, timeout=PATIENCE) as client:
        return client.post(f"http://127.0.0.1:{port}/stop", content=b"{}").status_code


HALF_A_HEAD = b"POST /stop HTTP/1.1\r\nHost: a\r\n"
HALF_A_BODY = HALF_A_HEAD + b"Content-Length: 9\r\n\r\n{"


@pytest.mark.parametrize("first", [b"", HALF_A_HEAD, HALF_A_BODY])
def test_a_thousand_connections_that_say_nothing_leave_room(first):
    room = Connections(raise_descriptor_limit())
    with served(room) as port, contextlib.ExitStack() as stack:
        for _ in range(1000):
            stack.enter_context(connected(port, first))
        assert stopped(port) == 200
        assert len(room) <= connections.MOST_OF_ONE


def test_who_has_asked_before_goes_last():
    with (
        served(Connections(1000, most_of_one=20)) as port,
        httpx.Client(trust_env=False, timeout=PATIENCE) as client,
        contextlib.ExitStack() as stack,
    ):
        for _ in range(3):
            assert client.post(f"http://127.0.0.1:{port}/stop", content=b"{}").status_code == 200
            for _ in range(60):
                stack.enter_context(connected(port, HALF_A_BODY))


def test_a_trusted_proxy_has_room_for_all_who_come_through_it():
    room = Connections(connections.RESERVE + 40, proxies=("127.0.0.0/8",), most_of_one=5)
    with served(room) as port, contextlib.ExitStack() as stack:
        for _ in range(100):
            stack.enter_context(connected(port))
        assert stopped(port) == 200
        assert 30 <= len(room) <= 40


@pytest.mark.parametrize("first", [b"", HALF_A_HEAD, HALF_A_BODY])
def test_heads_and_bodies_have_their_time(monkeypatch, first):
    monkeypatch.setattr(connections, "_TIMES", {"head": 0.2, "body": 0.2})
    with served(Connections(1000)) as port, connected(port, first) as slow:
        assert ended(slow)


def test_bytes_that_trickle_in_make_it_no_longer(monkeypatch):
    monkeypatch.setattr(connections, "_TIMES", {"head": 0.3, "body": 0.3})
    with (
        served(Connections(1000)) as port,
        connected(port) as slow,
        contextlib.suppress(BrokenPipeError, ConnectionResetError),
    ):
        for _ in range(1200):
            slow.sendall(b"G")
            time.sleep(0.05)
        pytest.fail("it was let go on for a minute")


def test_a_client_that_takes_nothing_is_let_go(monkeypatch):
    monkeypatch.setattr(connections, "STALL_TIME", 0.2)
    room = Connections(1000)
    with served(room) as port, connected(port, b"GET /much HTTP/1.1\r\nHost: a\r\n\r\n"):
        deadline = time.monotonic() + PATIENCE
        while len(room) != 1 and time.monotonic() < deadline:
            time.sleep(0.01)
        while len(room) and time.monotonic() < deadline:
            time.sleep(0.01)
        assert len(room) == 0


def test_one_connection_serves_many_requests(monkeypatch):
    monkeypatch.setattr(connections, "_TIMES", {"head": 60.0, "body": 60.0})
    with served(Connections(1000)) as port, httpx.Client(trust_env=False, timeout=PATIENCE) as client:
        for _ in range(20):
            assert client.get(f"http://127.0.0.1:{port}/").status_code == 200
