"""Every command and Python sample of README and docs runs, beside a running service, in a folder of its own.

A sample that is not run says why in a comment of the page before it, `<!-- not run: why -->`; one that runs until it
is interrupted says so, `<!-- runs on -->`. Files that samples use are those that the pages show by name.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import NamedTuple

import httpx
import pytest
import uvicorn

from becalm.sockets import bound_socket
from server.access.roles import Role
from server.access.tokens import TokenStore
from server.app import create_app
from server.settings import Settings

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
PATIENCE = 600.0

RUN_BY_THE_CLIENTS_TESTS = {
    ("README.md", "From a script"),
    ("docs/api.md", "From Python"),
    ("docs/rehearsal.md", "From a script"),
    ("docs/rehearsal.md", "Atlas"),
}
"""Page and heading of the samples that tests/api/test_client.py runs, and looks at what they print."""

_SAMPLE = re.compile(r"^(?:<!-- (?P<mark>[^\n]*) -->\n)?```(?P<language>sh|python)\n(?P<text>.*?)^```$", re.M | re.S)
_FILE = re.compile(r"^```toml\n# (?P<name>\S+\.toml)\n(?P<text>.*?)^```$", re.M | re.S)
_RUN_ID = re.compile(r"\d{8}T\d{9}-[0-9a-f]{6}")
_REFUSED = re.compile(r'"status": (\d{3})')

CURL = """#!/bin/sh
# The real one, which also notes the status of the answer.
exec {curl} --write-out '%{{stderr}}status %{{http_code}}\\n' "$@"
"""


class Sample(NamedTuple):
    """A block of commands or Python of a page."""

    where: str
    language: str
    text: str
    mark: str
    refusals: set[str]
    """The statuses of refusals that the page shows right after it."""
    under: tuple[str, str]
    """Page and last heading before it."""

    @property
    def is_run_elsewhere(self) -> bool:
        return self.language == "python" and self.under in RUN_BY_THE_CLIENTS_TESTS


def _samples() -> list[Sample]:
    found = []
    for page in PAGES:
        text = page.read_text()
        for block in _SAMPLE.finditer(text):
            line = text[: block.start("text")].count("\n")
            shown = text[block.end() :].split("```sh")[0][:400]
            name = str(page.relative_to(ROOT))
            heading = re.findall(r"^## (.*)$", text[: block.start("text")], re.M)[-1:]
            refusals, under = {*_REFUSED.findall(shown)}, (name, "".join(heading))
            found.append(
                Sample(f"{name}:{line}", block["language"], block["text"], block["mark"] or "", refusals, under)
            )
    return found


SAMPLES = _samples()


class Bench(NamedTuple):
    """Where samples run."""

    folder: Path
    environment: dict[str, str]
    address: str
    run_id: str

    def adapted(self, text: str) -> str:
        """The sample with the addresses and identifiers that are true here."""
        text = re.sub(r"(http|ws)://(127\.0\.0\.1|robot-lab):8000", rf"\1://{self.address}", text)
        if re.search(r"^\$ ", text, re.M):  # beside commands it shows what they print
            text = "\n".join(re.findall(r"^\$ ((?:.*\\\n)*.*)$", text, re.M)) + "\n"
        text = re.sub(r"^(becalm serve(?!.*--check)[^#\n]*)", r"\1 --check ", text, flags=re.M)  # else it never ends
        return _RUN_ID.sub(self.run_id, text)

    def reset_if_stopped(self) -> None:
        """What a sample of STOP has left, none can begin with."""
        with httpx.Client(base_url=f"http://{self.address}/api/v1", timeout=PATIENCE) as http:
            if http.get("/mission").json()["phase"] == "stopped":
                http.post("/mission/commands", json={"command": "reset"}).raise_for_status()

    def flying_study(self) -> str:
        """A study that will not have finished when the sample cancels it."""
        grid = {"published.impedance.mass": {"from": 0.01, "to": 0.5, "count": 500}}
        return httpx.post(
            f"http://{self.address}/api/v1/studies", json={"study": {"grid": grid}}, timeout=PATIENCE
        ).json()["id"]


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    """A service with one flown capture, and a folder with every file that the samples read."""
    folder = tmp_path_factory.mktemp("samples")
    settings = Settings(data_dir=folder / "data", configuration="published_figures")
    TokenStore(folder / "data" / "access").create("somebody", Role.ADMIN)
    with bound_socket("127.0.0.1", 0) as bound:
        server = uvicorn.Server(uvicorn.Config(create_app(settings), log_config=None, timeout_graceful_shutdown=1))
        thread = threading.Thread(target=lambda: server.run(sockets=[bound]))
        thread.start()
        address = f"127.0.0.1:{bound.getsockname()[1]}"
        try:
            yield _furnished(folder, address)
        finally:
            server.should_exit = True
            thread.join(PATIENCE)


def _furnished(folder: Path, address: str) -> Bench:
    with httpx.Client(base_url=f"http://{address}/api/v1", timeout=PATIENCE) as http:
        _wait(lambda: http.get("/health").json()["status"] == "ok")
        run_id = http.post("/runs", json={}).json()["id"]
        _wait(lambda: http.get(f"/runs/{run_id}").json()["status"] == "finished")
        for kind in ("mcap", "parquet", "csv"):
            log = http.get(f"/runs/{run_id}/log", params={"format": kind}).content
            (folder / f"capture.{kind}").write_bytes(log)
        shutil.copy(folder / "capture.csv", folder / f"becalm-{run_id}.csv")
    for page in PAGES:
        for file in _FILE.finditer(page.read_text()):
            (folder / file["name"]).write_text(file["text"])
    (folder / ".venv" / "bin").mkdir(parents=True)
    (folder / ".venv" / "bin" / "activate").touch()
    (folder / "bin").mkdir()
    curl = folder / "bin" / "curl"
    curl.write_text(CURL.format(curl=shutil.which("curl")))
    curl.chmod(0o755)
    environment = {
        **os.environ, "PATH": f"{folder / 'bin'}:{Path(sys.executable).parent}:{os.environ['PATH']}",
        "BECALM_DATA_DIR": str(folder / "data"), "BECALM_ADDRESS": f"http://{address}", "MPLBACKEND": "Agg",
        "B": f"http://{address}/api/v1", "J": "content-type: application/json", "TOKEN": "none",
        "BECALM_PORT": "0", "PYTHONUNBUFFERED": "1",
    }  # fmt: skip
    return Bench(folder, environment, address, run_id)


def _wait(fits) -> None:
    deadline = time.monotonic() + PATIENCE
    while not fits():
        assert time.monotonic() < deadline
        time.sleep(0.05)


RUN_HERE = [sample for sample in SAMPLES if not sample.is_run_elsewhere]


@pytest.mark.parametrize("sample", RUN_HERE, ids=[sample.where for sample in RUN_HERE])
def test_sample(sample, bench):
    bench.reset_if_stopped()
    if sample.mark.startswith("not run: "):
        pytest.skip(sample.mark)
    if sample.language == "sh" and "curl" in sample.text and shutil.which("curl") is None:
        pytest.skip("needs curl")
    script = bench.folder / "sample"
    script.write_text(bench.adapted(sample.text))
    environment = bench.environment | ({"ID": bench.flying_study()} if "$ID" in sample.text else {})
    interpreter = [sys.executable] if sample.language == "python" else ["bash", "-e"]
    command = [*interpreter, str(script)]
    if sample.mark == "runs on":
        assert _first_line(command, bench.folder, environment)
        return
    done = subprocess.run(
        command, cwd=bench.folder, env=environment, capture_output=True, text=True, timeout=PATIENCE, check=False
    )
    assert done.returncode == 0, done.stdout[-1000:] + done.stderr[-3000:]
    refused = {status for status in re.findall(r"^status (\d{3})$", done.stderr, re.M) if status >= "400"}
    assert refused <= sample.refusals, done.stdout[-2000:]


def _first_line(command: list[str], folder: Path, environment: dict[str, str]) -> str:
    """Of what a sample prints that runs until it is interrupted."""
    with subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.PIPE, text=True) as process:
        hang = threading.Timer(PATIENCE, process.kill)
        hang.start()
        try:
            return process.stdout.readline()
        finally:
            hang.cancel()
            process.kill()


def test_what_the_clients_tests_run_is_there():
    assert {sample.under for sample in SAMPLES if sample.is_run_elsewhere} == RUN_BY_THE_CLIENTS_TESTS


def test_marks_are_known_and_say_why():
    marks = {sample.mark for sample in SAMPLES} - {"", "runs on"}
    assert all(mark.startswith("not run: ") and len(mark) > len("not run: ") + 5 for mark in marks)
    assert len(SAMPLES) > 30
    assert sum(not sample.mark for sample in SAMPLES) > 20
