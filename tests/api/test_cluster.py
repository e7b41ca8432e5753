"""Studies on a real Dask cluster: a scheduler and two workers in processes of their own, one of them killed at last."""

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
from concurrent.futures import BrokenExecutor
from contextlib import ExitStack

import pytest
from click.testing import CliRunner

from becalm.cli import main
from server.studies import cluster
from sim.study.design import Study, study_of
from sim.study.executors import WorkersUnavailable
from sim.study.flight import StudyFlight
from sim.study.run import CellTask, fly_cell
from sim.study.table import StudyTable

CELLS = 12
STUDY: Study = study_of(
    {"name": "masses", "direct": True, "grid": {"published.impedance.mass": {"from": 0.1, "to": 0.6, "count": CELLS}}}
)
PATIENCE = 180.0
"""For a process of Dask to be ready [s]: bounds a hang."""

QUIET = ("--no-dashboard", "--host", "127.0.0.1")


def _started(stack: ExitStack, program: str, *arguments: str, says: str) -> tuple[subprocess.Popen[str], str]:
    """A process of Dask, and what its log names when it is ready."""
    command = [sys.executable, "-m", f"distributed.cli.dask_{program}", *arguments, *QUIET]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    stack.callback(_ended, process)
    assert process.stderr is not None
    patience = threading.Timer(PATIENCE, process.kill)
    patience.start()
    try:
        for line in process.stderr:
            if found := re.search(says, line):
                return process, found[1]
    finally:
        patience.cancel()
    pytest.fail(f"dask {program} ended with {process.wait(PATIENCE)}")


def _ended(process: subprocess.Popen[str]) -> None:
    process.kill()
    process.wait(PATIENCE)
    assert process.stderr is not None
    process.stderr.close()


@pytest.fixture(scope="module")
def scheduler() -> Iterator[str]:
    with ExitStack() as stack:
        yield _started(stack, "scheduler", "--port", "0", says=r"Scheduler at:\s+(tcp://\S+)")[1]


@pytest.fixture(scope="module")
def workers(scheduler: str) -> Iterator[list[subprocess.Popen[str]]]:
    with ExitStack() as stack:
        one_thread = (scheduler, "--nthreads", "1", "--no-nanny")
        yield [_started(stack, "worker", *one_thread, says=r"Registered to:\s+(\S+)")[0] for _ in range(2)]


def test_a_scheduler_without_workers_is_said(scheduler, monkeypatch):
    monkeypatch.setattr(cluster, "CONNECTING_TIME", 1.0)
    with pytest.raises(WorkersUnavailable, match="has no worker"):
        cluster.cluster_workers(scheduler)


@pytest.mark.usefixtures("workers")
def test_the_command_flies_on_the_cluster(scheduler, tmp_path):
    file = tmp_path / "masses.json"
    file.write_text(json.dumps({"direct": True, "grid": {"published.impedance.mass": [0.1, 0.2]}}))
    out = tmp_path / "masses.csv"
    result = CliRunner().invoke(main, ["study", str(file), "--out", str(out), "--scheduler", scheduler, "--json"])
    assert result.exit_code == 0, result.output
    assert json.loads(result.stdout)["workers"] == 2
    assert len(out.read_text().splitlines()) == 3


@pytest.mark.usefixtures("workers")
def test_workers_with_other_code_are_refused(scheduler, monkeypatch):
    monkeypatch.setattr(cluster, "code_fingerprint", lambda: ("another version",))
    with pytest.raises(WorkersUnavailable, match="has other code"):
        cluster.cluster_workers(scheduler)


def test_a_scheduler_that_is_not_there_is_said(tmp_path, monkeypatch):
    monkeypatch.setattr(cluster, "CONNECTING_TIME", 1.0)
    out = tmp_path / "published.csv"
    result = CliRunner().invoke(main, ["study", "published", "--out", str(out), "--scheduler", "tcp://127.0.0.1:9"])
    assert result.exit_code == 1
    assert "no Dask scheduler answers at tcp://127.0.0.1:9" in result.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("address", ["127.0.0.1:8786", "http://there:1", "tcp://there"])
def test_an_address_that_cannot_be_one_names_what_would_be_right(address, tmp_path):
    out = str(tmp_path / "t.csv")
    result = CliRunner().invoke(main, ["study", "published", "--out", out, "--scheduler", address])
    assert result.exit_code == 2
    assert "tcp://HOST:8786" in result.stderr


def test_a_worker_that_is_killed_costs_no_cell(scheduler, workers, tmp_path):
    flown: list[int] = []

    def kill_one(row) -> None:
        flown.append(row["cell"])
        if len(flown) == 3:
            workers[0].send_signal(signal.SIGKILL)

    with StudyTable(tmp_path / "table", STUDY) as table:
        StudyFlight(table).fly(cluster.cluster_workers(scheduler), on_row=kill_one)
        rows = list(table.rows())
    assert workers[0].wait(PATIENCE) == -signal.SIGKILL
    assert sorted(flown) == list(range(CELLS))
    here = [fly_cell(CellTask(STUDY.base, STUDY.direct, STUDY.cell(index))) for index in (0, CELLS - 1)]
    assert [rows[0], rows[-1]] == here
    assert all(row["error"] is None for row in rows)


def test_a_scheduler_that_is_killed_ends_the_study_and_costs_no_row(tmp_path, monkeypatch):
    flown: list[int] = []
    with ExitStack() as stack:
        process, address = _started(stack, "scheduler", "--port", "0", says=r"Scheduler at:\s+(tcp://\S+)")
        _started(stack, "worker", address, "--nthreads", "1", "--no-nanny", says=r"Registered to:\s+(\S+)")
        bystander = cluster.ClusterExecutor(address)

        def kill_it(row) -> None:
            flown.append(row["cell"])
            if len(flown) == 3:
                monkeypatch.setattr(cluster, "CONNECTING_TIME", 1.0)
                process.kill()

        with StudyTable(tmp_path / "table", STUDY) as table:
            with pytest.raises(WorkersUnavailable, match=f"no Dask scheduler answers at {address}"):
                StudyFlight(table).fly(cluster.cluster_workers(address), on_row=kill_it)
            assert [row["cell"] for row in table.rows()] == sorted(flown)
        with pytest.raises(BrokenExecutor, match=f"the Dask scheduler at {address} is lost"):
            _submit_until_refused(bystander)
        bystander.shutdown(wait=False)


def _submit_until_refused(executor: cluster.ClusterExecutor) -> None:
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        executor.submit(os.getpid)
        time.sleep(0.1)
