"""docker-compose.yml run by a container engine, in a project of its own that touches no other."""

from __future__ import annotations

import json
import os
import secrets
import shutil
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import becalm
from becalm.calls import ServiceRefused, ServiceUnreachable
from tests.deploy.ports import free_port

ROOT = Path(__file__).parents[2]
PROFILES = ("simulation", "cluster")
PATIENCE = 90.0
"""For what the engine or a service does [s]; a busy machine stops for seconds."""

LOOK_PERIOD = 0.2
"""Between two looks at what another process brings about [s]."""


def why_no_engine() -> str | None:
    """Why the tests cannot run on an engine here; None if they can."""
    if not os.environ.get("BECALM_TEST_TAG"):
        return "needs BECALM_TEST_TAG, the tag of the image that an engine has: make image-test sets it"
    if not shutil.which("docker"):
        return "needs docker"
    asked = subprocess.run(["docker", "info"], capture_output=True, text=True, timeout=PATIENCE, check=False)
    return None if asked.returncode == 0 else f"no engine answers: {asked.stderr.strip()[-200:]}"


def eventually(look: Callable[[], Any], what: str, patience: float = PATIENCE) -> Any:
    """What `look` gives as soon as that is true; fails after `patience` [s]."""
    deadline = time.monotonic() + patience
    while not (found := look()):
        assert time.monotonic() < deadline, f"not within {patience:.0f} s: {what}"
        time.sleep(LOOK_PERIOD)
    return found


def engine(*arguments: str) -> str:
    """What a command of the engine prints."""
    done = subprocess.run(["docker", *arguments], capture_output=True, text=True, timeout=PATIENCE, check=False)
    assert done.returncode == 0, f"docker {' '.join(arguments)}: {done.stderr[-2000:]}"
    return done.stdout.strip()


class ComposeProject:
    """The compose file under a name, ports and a token of its own."""

    def __init__(self, folder: Path) -> None:
        self.name = f"becalm-test-{secrets.token_hex(4)}"
        self.token = secrets.token_urlsafe(32)
        token_file = folder / "admin.token"
        token_file.write_text(self.token)
        token_file.chmod(0o644)
        self.ports = {"console": free_port(), "simulation": free_port()}
        kept = {key: value for key, value in os.environ.items() if not key.startswith(("BECALM_", "COMPOSE_"))}
        self._environment = kept | {
            "BECALM_TAG": os.environ["BECALM_TEST_TAG"],
            "BECALM_PORT": str(self.ports["console"]),
            "BECALM_SIMULATION_PORT": str(self.ports["simulation"]),
            "BECALM_ADMIN_TOKEN": str(token_file),
            "BECALM_SCHEDULER": "tcp://scheduler:8786",
        }

    def compose(self, *arguments: str, check: bool = True) -> str:
        """What `docker compose` prints, whatever .env says."""
        profiles = [word for profile in PROFILES for word in ("--profile", profile)]
        command = ["docker", "compose", "--project-name", self.name, "--env-file", os.devnull, *profiles, *arguments]
        done = subprocess.run(
            command, cwd=ROOT, env=self._environment, capture_output=True, text=True, timeout=3 * PATIENCE, check=False
        )
        assert done.returncode == 0 or not check, f"{' '.join(arguments)}: {done.stderr[-2000:]}"
        return done.stdout.strip()

    def up(self, *services: str) -> None:
        """Start services and whatever they wait for; never builds."""
        self.compose("up", "--detach", "--no-build", *services)

    def down(self) -> None:
        """End and remove everything, volumes included."""
        self.compose("down", "--volumes", "--timeout", "10")

    def inside(self, service: str, *command: str) -> str:
        """What a command prints that runs in the container of a service."""
        return self.compose("exec", "--no-TTY", service, *command)

    def container(self, service: str) -> str:
        """The identity of the first container of a service."""
        return self.compose("ps", "--all", "--quiet", service).splitlines()[0]

    def inspected(self, service: str) -> dict[str, Any]:
        """What the engine knows of that container."""
        return json.loads(engine("inspect", self.container(service)))[0]

    def address(self, service: str) -> str:
        """Where a console is reached from this machine."""
        return f"http://127.0.0.1:{self.ports[service]}"

    def client(self, service: str) -> becalm.Client:
        """A client of a console, with the administrator's token."""
        return becalm.Client(self.address(service), self.token)

    def healthy(self, service: str) -> bool:
        """Whether the engine holds a service for healthy."""
        return self.inspected(service)["State"]["Health"]["Status"] == "healthy"


def status(client: becalm.Client) -> str | None:
    """What a console says of itself; None while it does not answer."""
    try:
        return client.health().status
    except ServiceUnreachable:
        return None


def flies(client: becalm.Client) -> bool:
    """Whether a console has its mission ready; on a busy machine the link may be late, which is a fault."""
    return status(client) in ("ok", "faulted")


def resets(client: becalm.Client) -> bool:
    """Whether the mission starts over; it is refused while the robot cannot be flown."""
    try:
        return client.command("reset", armed=True).phase == "idle"
    except ServiceRefused:
        return False
