"""What listens at a scheduler's address but is none: told in bounded time, with the address, in bounded memory."""

from __future__ import annotations

import socket
import threading
from contextlib import contextmanager

import pytest

from server.studies import cluster
from server.studies.cluster import cluster_workers
from sim.study.executors import WorkersUnavailable


@contextmanager
def listening(serve):
    """Something that does this with each connection; its address."""
    kept = []
    with socket.create_server(("127.0.0.1", 0)) as server:

        def accept():
            while True:
                try:
                    connection, _ = server.accept()
                except OSError:
                    return
                kept.append(connection)
                serve(connection)

        threading.Thread(target=accept, daemon=True).start()
        yield f"tcp://127.0.0.1:{server.getsockname()[1]}"
    for connection in kept:
        connection.close()


@pytest.mark.parametrize(
    ("serve", "says"),
    [
        (lambda _connection: None, "has said nothing for 0.3 s"),
        (lambda connection: connection.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n"), "something else answers there"),
        (lambda connection: connection.sendall(b"\xff" * 64), "something else answers there"),
        (lambda connection: connection.close(), "closes the connection without a word"),
        (lambda connection: connection.sendall(b"abc"), "has said nothing"),
    ],
    ids=["silent", "web server", "rubbish", "closing", "half a word"],
)
def test_what_is_no_scheduler_is_reported(monkeypatch, serve, says):
    monkeypatch.setattr(cluster, "CONNECTING_TIME", 0.3)
    with listening(serve) as address, pytest.raises(WorkersUnavailable, match=says) as told:
        cluster_workers(address)
    assert address in str(told.value)
    assert told.value.tip


def test_a_cluster_that_falls_silent_on_the_way_is_given_up(monkeypatch):
    silent = threading.Event()
    monkeypatch.setattr(cluster, "CONNECTING_TIME", 0.1)
    monkeypatch.setattr(cluster, "_threads", lambda _: silent.wait(60))
    with pytest.raises(WorkersUnavailable, match="has fallen silent"):
        cluster_workers("tcp://127.0.0.1:8786")
    silent.set()
