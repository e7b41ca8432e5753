"""The image: built with buildah where it and a base image are at hand, and its command started.

`BECALM_TEST_BASE_IMAGE` names an image of Debian or of python:3.11-slim that buildah has, `BECALM_TEST_CA` a file of
certificate authorities, where registries are behind a private one. Without them it is the Dockerfile that is read.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import time
from importlib.metadata import version
from pathlib import Path

import pytest

from tests.deploy.ports import free_port

ROOT = Path(__file__).parents[2]
DOCKERFILE = (ROOT / "Dockerfile").read_text()
BUILDAH = ("buildah", "--storage-driver", "vfs")
BASE = os.environ.get("BECALM_TEST_BASE_IMAGE", "")
PATIENCE = 180.0
BUILD_PATIENCE = 1800.0
ENDING_TIME = 30.0

builds = pytest.mark.skipif(
    not (shutil.which("buildah") and BASE), reason="needs buildah, and BECALM_TEST_BASE_IMAGE to build upon"
)


def _stages() -> list[str]:
    return DOCKERFILE.split("\nFROM ")[1:]


def _last_stage() -> str:
    return _stages()[-1]


def test_the_last_stage_runs_as_nobody_special_and_compiles_nothing():
    stage = _last_stage()
    assert re.search(r"^USER 10001:10001$", stage, re.M)
    assert re.search(r"^HEALTHCHECK .*healthy", stage, re.M)
    for word in ("apt", "pip ", "npm", "gcc", "curl"):
        assert word not in stage


def test_nothing_is_fetched_but_by_the_lock():
    installs = re.findall(r"pip (?:--python \S+ )?(?:install|wheel)[^&]*?(?=\n[A-Z#]|&&)", DOCKERFILE, re.S)
    assert len(installs) == 3
    for install in installs:
        assert "--no-deps" in install or "--constraint /src/requirements.lock" in install


def test_no_change_of_the_sources_sends_the_dependencies_again():
    """Their layer comes before Becalm's, from stages that see nothing else of this tree."""
    layers = re.findall(r"^COPY --from=(\w+) (\S+)", _last_stage(), re.M)
    assert layers[:2] == [("dependencies", "/opt/python"), ("installed", "/opt/becalm")]
    stages = {stage.split()[2]: stage for stage in _stages()[:-1]}
    assert stages["dependencies"].startswith("tools ")
    copied = re.findall(r"^COPY (.*) \S+$", stages["tools"] + stages["dependencies"], re.M)
    assert {word for line in copied for word in line.split()} == {
        "requirements.lock", "pyproject.toml", "deploy/container/requirements.py", "deploy/container/with-secrets"
    }  # fmt: skip


def test_every_file_that_is_copied_reaches_the_builder():
    let_in = [line[1:] for line in (ROOT / ".dockerignore").read_text().splitlines() if line.startswith("!")]
    copied = [word for line in re.findall(r"^COPY (?!--from)(.*) \S+$", DOCKERFILE, re.M) for word in line.split()]
    assert copied
    for path in copied:
        assert (ROOT / path).exists()
        assert any(path == each or path.startswith(each + "/") for each in let_in)


def _buildah(*arguments: str, patience: float = PATIENCE) -> str:
    done = subprocess.run(
        [*BUILDAH, *arguments], cwd=ROOT, capture_output=True, text=True, timeout=patience, check=False
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return done.stdout.strip()


@pytest.fixture(scope="module")
def container():
    """A container of the image, built from this tree."""
    authority = os.environ.get("BECALM_TEST_CA")
    secrets = ("--secret", f"id=ca,src={authority}") if authority else ()
    tag = "localhost/becalm-test"
    _buildah(
        "build", "--isolation", "chroot", "--format", "docker", "--layers",
        "--build-arg", f"PYTHON_IMAGE={BASE}", *secrets, "--tag", tag, ".", patience=BUILD_PATIENCE,
    )  # fmt: skip
    name = _buildah("from", tag)
    yield name
    _buildah("rm", name)


def _inside(container: str, *command: str, **environment: str) -> list[str]:
    variables = [word for name, value in environment.items() for word in ("--env", f"{name}={value}")]
    return [*BUILDAH, "run", "--isolation", "chroot", *variables, container, "--", *command]


def _end(process: subprocess.Popen[str]) -> None:
    process.terminate()
    try:
        process.wait(ENDING_TIME)
    except subprocess.TimeoutExpired:  # it shares its group with nobody: what it started goes with it
        os.killpg(process.pid, signal.SIGKILL)
        process.wait(ENDING_TIME)


@builds
def test_the_image_holds_no_compiler_node_or_root(container):
    looks = "id -u; for each in gcc cc node npm pip curl; do command -v $each; done; true"
    found = subprocess.run(_inside(container, "sh", "-c", looks), capture_output=True, text=True, check=True)
    assert found.stdout.split() == ["10001"]
    known = json.loads(_buildah("inspect", container))  # not by a template: its function json is not in every buildah
    assert known["Docker"]["config"]["Healthcheck"]["Test"] == ["CMD", "healthy", "console"]


@builds
def test_becalm_and_its_commands_are_found_beside_their_dependencies(container):
    looks = "for each in becalm start healthy router dask; do command -v $each; done; becalm --version"
    found = subprocess.run(_inside(container, "sh", "-c", looks), capture_output=True, text=True, check=True)
    *commands, told = found.stdout.splitlines()
    assert [Path(each).name for each in commands] == ["becalm", "start", "healthy", "router", "dask"]
    assert told.endswith(f" {version('becalm')}")


@builds
def test_the_command_of_the_image_serves_and_becomes_healthy(container):
    environment = {"BECALM_HOST": "127.0.0.1", "BECALM_PORT": str(free_port())}
    command = _inside(container, "start", "becalm", "serve", "--no-open", **environment)
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, start_new_session=True) as process:
        try:
            assert "Becalm is ready" in process.stdout.readline()
            deadline = time.monotonic() + PATIENCE
            while subprocess.run(_inside(container, "healthy", "console", **environment), check=False).returncode:
                assert time.monotonic() < deadline
                time.sleep(0.5)
        finally:
            _end(process)
