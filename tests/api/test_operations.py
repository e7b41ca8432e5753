"""What an operations room needs of the service: metrics, a warning before the disk is full, an end in time."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import httpx
import pytest
import websockets
import websockets.sync.client
from prometheus_client.parser import text_string_to_metric_families

from server.library.runs import RunStore
from server.settings import Settings

PATIENCE = 180.0
"""Bound on every wait [s]."""

ENDING_TIME = 30.0
"""Where a busy machine takes longer than the 5 s that are promised [s]; the steps asked for would take minutes."""


def _samples(text: str) -> dict[tuple[str, ...], float]:
    """Every sample by its name and the values of its labels."""
    families = text_string_to_metric_families(text)
    return {(each.name, *each.labels.values()): each.value for family in families for each in family.samples}


async def test_metrics_tell_what_the_service_does(console):
    await console.granted("capture")
    await console.until(lambda snapshot: snapshot.time > 0.2)
    watcher = console.services.feed.subscribe(1)
    answer = await console.http.get("http://localhost/metrics")
    assert answer.headers["content-type"].startswith("text/plain; version=")
    found = _samples(answer.text)
    assert found["becalm_status", "ok"] == 1
    assert found["becalm_phase", "detumbling"] == 1
    assert found["becalm_telemetry_clients",] == 1
    assert found["becalm_queue_depth", "commands"] == 0
    assert found["becalm_recorder_failed",] == 0
    assert 0 <= found["becalm_recorder_lag_seconds",] < PATIENCE
    assert found["becalm_disk_free_bytes",] > 0
    assert found["becalm_runs", "live", "", "running"] == 1
    turns = found["becalm_tick_lateness_seconds_bucket", "+Inf"]
    assert turns == found["becalm_tick_lateness_seconds_count",] >= found["becalm_tick_lateness_seconds_bucket", "0.5"]
    assert turns > 0
    console.services.feed.unsubscribe(watcher)
    again = _samples((await console.http.get("http://localhost/metrics")).text)
    assert again["becalm_telemetry_clients",] == 0
    assert again["becalm_tick_lateness_seconds_count",] >= turns


async def test_runs_are_counted_by_their_outcome(console):
    run = (await console.http.post("/runs", json={"configuration": "published", "direct": True})).json()
    ended = await console.until_run(run["id"], "finished")
    found = _samples((await console.http.get("http://localhost/metrics")).text)
    assert found["becalm_runs", "scripted", ended["outcome"]["outcome"], "finished"] == 1


@pytest.fixture
def crowded(tmp_path):
    """A service that wants more room than any disk has."""
    return Settings(data_dir=tmp_path / "data", min_free_gb=1e9, configuration="published_figures")


class TestWithLittleRoom:
    @pytest.fixture
    def settings(self, crowded):
        return crowded

    async def test_the_operator_sees_it_and_nothing_more_is_queued(self, console):
        seen = await console.until(
            lambda snapshot: "The disk is nearly full" in [each.title for each in snapshot.problems]
        )
        assert [each.severity for each in seen.problems if each.title == "The disk is nearly full"] == ["warning"]
        for answer in (
            await console.http.post("/runs", json={}),
            await console.http.post("/studies", json={"study": "published"}),
        ):
            assert answer.status_code == 507
            assert "GB are free" in answer.json()["detail"]
            assert answer.json()["tip"]
        await console.granted("capture")  # who is flying flies on


@contextmanager
def _started(tmp_path, *options: str) -> Iterator[tuple[subprocess.Popen[str], httpx.Client]]:
    command = [sys.executable, "-m", "becalm", "serve", "--port", "0", "--no-open", *options]
    environment = {**os.environ, "BECALM_DATA_DIR": str(tmp_path / "data"), "PYTHONUNBUFFERED": "1"}
    with (
        (tmp_path / "log").open("w") as log,
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=log, text=True, env=environment) as process,
    ):
        try:
            url = re.search(r"http://\S+/", process.stdout.readline())[0]
            with httpx.Client(base_url=url + "api/v1", timeout=PATIENCE) as http:
                _wait(lambda: http.get("/health").json()["status"] == "ok")
                yield process, http
        finally:
            process.kill()


def _wait(fits) -> None:
    deadline = time.monotonic() + PATIENCE
    while not fits():
        assert time.monotonic() < deadline
        time.sleep(0.05)


def _read_to_the_end(socket) -> None:
    while True:
        socket.recv(PATIENCE)


STARTING = """
import os, signal, sys
from becalm import cli, serving

serving.create_app = lambda settings: os.kill(os.getpid(), int(sys.argv[1]))
cli.main(["serve", "--no-open", "--port", "0"])
"""
"""A service that is asked to end while it is being put together."""


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT])
def test_a_service_that_is_asked_to_end_while_it_starts_ends_well(tmp_path, number):
    environment = {**os.environ, "BECALM_DATA_DIR": str(tmp_path / "data")}
    command = [sys.executable, "-c", STARTING, str(int(number))]
    ended = subprocess.run(command, env=environment, timeout=PATIENCE, check=False, capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert not (tmp_path / "data").exists()


def test_sigterm_leaves_the_robot_at_rest_answers_everyone_and_closes_the_run(tmp_path):
    with _started(tmp_path, "--log-format", "json", "--log-level", "info") as (process, http):
        assert http.post("/runs", json={}).status_code == 202  # its worker takes seconds to start
        http.post("/mission/commands", json={"command": "capture"}).raise_for_status()
        http.post("/mission/commands", json={"command": "run", "speed": 0.1}).raise_for_status()
        http.post("/mission/commands", json={"command": "pause"}).raise_for_status()
        socket = websockets.sync.client.connect(f"ws://127.0.0.1:{http.base_url.port}/api/v1/telemetry", proxy=None)
        answers: list[httpx.Response] = []
        steps = {"command": "step", "ticks": 10_000}
        asker = threading.Thread(target=lambda: answers.append(http.post("/mission/commands", json=steps)))
        asker.start()
        run_id = http.get("/mission").json()["run_id"]
        process.send_signal(signal.SIGTERM)
        began = time.monotonic()
        process.wait(PATIENCE)
        taken = time.monotonic() - began
        asker.join(PATIENCE)
        with pytest.raises(websockets.ConnectionClosed):
            _read_to_the_end(socket)
    assert taken < ENDING_TIME
    assert process.returncode == 0
    assert answers[0].status_code in (200, 503)  # flown to some tick, or refused: but answered
    reader = RunStore(tmp_path / "data" / "runs").read(run_id)
    assert (reader.record.status, reader.record.integrity) == ("cancelled", "complete")
    stop = [event for event in reader.events() if event.get("command") == "stop"]
    assert [(each["who"], each["message"]) for each in stop] == [("service", "the service ends")]
    lines = [json.loads(line) for line in (tmp_path / "log").read_text().splitlines()]
    assert any(line["message"] == "the service ends" and line["run"] == run_id for line in lines)
