"""What the containers run besides Becalm itself: the router, and the check of health."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.deploy.ports import free_port

CONTAINER = Path(__file__).parents[2] / "deploy" / "container"
PATIENCE = 180.0


def _healthy(what: object, **environment: str) -> int:
    command = [sys.executable, str(CONTAINER / "healthy"), str(what)]
    return subprocess.run(
        command, env={**os.environ, **environment}, timeout=PATIENCE, capture_output=True, check=False
    ).returncode


@pytest.fixture
def router():
    """A router, and the port that it listens on."""
    port = free_port()
    command = [sys.executable, str(CONTAINER / "router"), f"tcp/127.0.0.1:{port}"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert "routing" in process.stdout.readline()
            yield process, port
        finally:
            process.kill()


def test_the_router_routes_between_two_that_only_know_it(router):
    process, port = router
    passes = f"""
import zenoh, json, threading
def session():
    config = zenoh.Config()
    for path, value in {{"mode": "client", "connect/endpoints": ["tcp/127.0.0.1:{port}"],
                        "scouting/multicast/enabled": False}}.items():
        config.insert_json5(path, json.dumps(value))
    return zenoh.open(config)
heard = threading.Event()
with session() as listener, session() as speaker:
    subscriber = listener.declare_subscriber("becalm/test", lambda sample: heard.set())
    for _ in range(600):
        speaker.put("becalm/test", b"x")
        if heard.wait(0.1):
            break
assert heard.is_set()
"""
    subprocess.run([sys.executable, "-c", passes], check=True, timeout=2 * PATIENCE)
    assert _healthy(port) == 0
    process.send_signal(signal.SIGTERM)
    assert process.wait(PATIENCE) == 0
    assert _healthy(port) == 1


def test_a_console_that_does_not_answer_is_not_healthy():
    assert _healthy("console", BECALM_PORT=str(free_port())) == 1
