"""Robot and console that know a router's endpoint only, as in docker-compose.yml."""

from __future__ import annotations

import subprocess
import sys
import threading
from pathlib import Path

from server.link import contract
from server.link.session import LinkSession, Transport

from .ends import PATIENCE, free_endpoint

ROUTER = Path(__file__).parents[2] / "deploy" / "container" / "router"


def test_two_ends_hear_each_other_through_a_router():
    endpoint = free_endpoint()
    with subprocess.Popen([sys.executable, str(ROUTER), endpoint], stdout=subprocess.PIPE, text=True) as router:
        try:
            assert router.stdout is not None
            assert "routing" in router.stdout.readline()
            robot, console = (LinkSession(Transport(connect=(endpoint,))) for _ in range(2))
            came = threading.Event()
            console.subscribe(contract.MODE, lambda _: came.set())
            for _ in range(round(PATIENCE / 0.05)):
                robot.publish(contract.MODE, b"mode")
                if came.wait(0.05):
                    break
            assert came.is_set()
            robot.close()
            console.close()
        finally:
            router.terminate()
