"""The commands: what they print where, and how they end."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import numpy as np
import pyarrow.parquet
import pytest
from click.testing import CliRunner

from becalm.cli import main
from becalm.sockets import bound_socket
from server.library.runs import RunStore
from server.settings import Settings

PROMISED = {
    "outcome", "caged", "cage_margin", "peak_tip_force", "peak_tip_force_to_closure", "closed_at", "contacts",
    "duration", "final_target_spin", "min_manipulability", "momentum_error", "real_time_factor", "seed", "run_id",
    "config", "engine", "at_first_closure", "at_locked_arms",
}  # fmt: skip


def _invoke(*arguments: str):
    return CliRunner().invoke(main, list(arguments))


def test_json_is_one_document_and_nothing_else():
    result = _invoke("run", "--configuration", "published", "--direct", "--json", "--seed", "3")
    document = json.loads(result.stdout)
    assert result.exit_code == 0
    assert set(document) >= PROMISED
    assert document["seed"] == 3
    assert document["config"]["simulation"]["seed"] == 3
    assert document["contacts"]
    assert "Preparing" in result.stderr


def test_run_is_kept_in_the_library_and_logged():
    document = json.loads(_invoke("run", "--configuration", "published", "--direct", "--json").stdout)
    store = RunStore(Settings.from_environment().data_dir / "runs")
    reader = store.read(document["run_id"])
    assert reader.record.status == "finished"
    assert reader.record.outcome.peak_tip_force == document["peak_tip_force"]
    events = [event["kind"] for event in reader.events()]
    assert "verdict" in events


def test_summary_for_a_person():
    result = _invoke("run", "--direct", "--configuration", "published_figures")
    assert result.exit_code == 0
    assert "peak tip force" in result.stdout
    assert "published_figures" in result.stdout


def test_log_file(tmp_path):
    path = tmp_path / "capture.parquet"
    document = json.loads(
        _invoke("run", "--configuration", "published", "--direct", "--json", "--log", str(path)).stdout
    )
    table = pyarrow.parquet.read_table(path)
    assert table.column("mission.time")[-1].as_py() == pytest.approx(document["duration"], abs=0.01)
    assert np.abs(table.column("right.hand_wrench.x").to_numpy()).max() > 0
    assert list(tmp_path.glob(".*.draft")) == []


def test_config_file(tmp_path):
    path = tmp_path / "soft.toml"
    path.write_text("[published.impedance]\ndamping = 3.0\nmass = 0.05\n")
    published = ("--configuration", "published", "--direct")
    changes = ("--config", str(path), "--set", "published.impedance.mass=0.07")
    document = json.loads(_invoke("run", *published, *changes, "--json").stdout)
    assert document["config"]["published"]["impedance"]["damping"] == 3.0
    assert document["config"]["published"]["impedance"]["mass"] == 0.07  # what is set wins over the file
    assert document["configuration"] == "published (edited)"


@pytest.mark.parametrize("command", [["run", "--json"], ["serve", "--no-open", "--port", "0"]])
@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("target.mass=-1", ["target.mass", "-1", "greater than 0", "kg"]),
        ("target.mass=NaN", ["target.mass", "finite"]),
        ("target.masss=1", ["target.masss", "target.mass?"]),
        ("simulation.time_step=0.0003", ["simulation.time_step", "0.0003", "control.period"]),
        ("target.initial_y=0.1", ["target.initial_y", "0.1", "overlaps"]),
        ("target.mass", ["target.mass", "PATH=VALUE"]),
    ],
)
def test_bad_parameter_exits_2_and_starts_nothing(command, setting, words, tmp_path):
    result = _invoke(*command, "--set", setting)
    assert result.exit_code == 2
    assert result.stdout == ""
    for word in words:
        assert word in result.stderr
    assert not (tmp_path / "data").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["run", "--configuration", "nonesuch"], ["nonesuch", "published_figures"]),
        (["run", "--log", "capture.xlsx"], [".csv", ".parquet"]),
        (["run", "--log", "nonesuch/capture.csv"], ["nonesuch"]),
        (["run", "--config", "nonesuch.toml"], ["nonesuch.toml"]),
        (["run", "--seed", "-1"], ["--seed"]),
        (["serve", "--plant", "robot"], ["plant", "robot", "simulation", "zenoh"]),
        (["serve", "--plant", "zenoh"], ["connect", "tcp/127.0.0.1:7447"]),
        (["serve", "--plant", "zenoh", "--connect", "127.0.0.1"], ["connect", "'127.0.0.1'"]),
        (["serve", "--plant", "zenoh", "--connect", "tcp/h:1", "--configuration", "published"], ["control.period"]),
        (["robot"], ["--listen"]),
        (["robot", "--listen", "nowhere"], ["listen", "nowhere"]),
        (["robot", "--listen", "tcp/127.0.0.1:0", "--fault", "loss=2"], ["loss", "2"]),
        (["robot", "--listen", "tcp/127.0.0.1:0", "--fault", "fire=1"], ["fire", "sensor_freeze"]),
        (["robot", "--listen", "tcp/127.0.0.1:0", "--imperfection", "smell=1"], ["smell", "force_noise"]),
        (["serve", "--port", "70000"], ["--port", "65535"]),
        (["serve", "--check", "--keep-days", "-1"], ["keep_days", "-1", "--keep-days"]),
        (["serve", "--check", "--host", "0.0.0.0"], ["host", "token create"]),
        (["serve", "--json"], ["--check"]),
        (["serve", "--configuration", "nonesuch"], ["nonesuch"]),
    ],
)
def test_bad_argument_exits_2(arguments, words):
    result = _invoke(*arguments)
    assert result.exit_code == 2
    for word in words:
        assert word in result.stderr


def test_port_in_use_exits_1_and_starts_nothing(tmp_path):
    with bound_socket("127.0.0.1", 0) as taken:
        port = taken.getsockname()[1]
        result = _invoke("serve", "--no-open", "--port", str(port))
    assert result.exit_code == 1
    assert f"port {port}" in result.stderr
    assert f"--port {port + 1}" in result.stderr
    assert result.stdout == ""
    assert not (tmp_path / "data").exists()


def test_data_folder_that_cannot_be_written_exits_1(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("BECALM_DATA_DIR", str(tmp_path / "file"))
    result = _invoke("run", "--configuration", "published", "--direct", "--json")
    assert result.exit_code == 1
    assert str(tmp_path / "file") in result.stderr
    assert result.stdout == ""


@pytest.mark.parametrize("arguments", [["--help"], ["serve", "--help"], ["run", "--help"], ["--version"]])
def test_help_and_version(arguments):
    result = _invoke(*arguments)
    assert result.exit_code == 0
    assert "becalm" in result.stdout


def test_serve_says_where_and_ends_on_a_signal():
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    command = [sys.executable, "-m", "becalm", "serve", "--port", "0", "--no-open"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        assert "http://127.0.0.1:" in process.stdout.readline()
        process.terminate()
        process.wait(180)


def test_replay_finds_no_difference_and_names_the_first_there_is():
    run_id = json.loads(_invoke("run", "--configuration", "published", "--direct", "--json").stdout)["run_id"]
    result = _invoke("replay", run_id, "--json")
    report = json.loads(result.stdout)
    assert result.exit_code == 0
    assert report["controller"] == report["rerun"] == {
        "same": True, "compared": report["ticks"], "first_difference": None,
    }  # fmt: skip
    folder = Settings.from_environment().data_dir / "runs" / run_id
    record = json.loads((folder / "run.json").read_text())
    record["config"]["published"]["caging"]["close_margin"] *= 1.1
    (folder / "run.json").write_text(json.dumps(record))
    result = _invoke("replay", "latest", "--json")
    assert result.exit_code == 1
    first = json.loads(result.stdout)["rerun"]["first_difference"]
    assert first["recorded"] != first["now"]
    assert "differs from tick" in _invoke("replay", run_id).stdout


def test_replay_of_an_unknown_run_says_so():
    result = _invoke("replay", "20200101T000000000-abcdef")
    assert result.exit_code == 1
    assert "does not exist" in result.stderr


@pytest.mark.parametrize("days", ["1e300", "inf", "nan", "-1", "0", "1e-300", "36526"])
def test_a_token_that_holds_no_time_or_beyond_the_calendar_is_not_made(days, tmp_path, monkeypatch):
    monkeypatch.setenv("BECALM_DATA_DIR", str(tmp_path))
    result = _invoke("token", "create", "ana", "--role", "viewer", "--days", days)
    assert (result.exit_code, "--days" in result.stderr, "36525" in result.stderr) == (2, True, True)
    assert json.loads(_invoke("token", "list", "--json").stdout) == []


def test_check_says_what_would_be_started_and_starts_nothing(tmp_path, monkeypatch):
    monkeypatch.setenv("BECALM_KEEP_GB", "20")
    arguments = ("serve", "--check", "--port", "0", "--set", "target.initial_spin=0.6")
    found = json.loads(_invoke(*arguments, "--json").stdout)
    assert found["settings"]["keep_gb"] == 20
    assert found["settings"]["changes"] == {"target": {"initial_spin": 0.6}}
    assert found["sources"]["keep_gb"] == "BECALM_KEEP_GB"
    assert (found["sources"]["port"], found["sources"]["host"]) == ("--port", "default")
    assert found["tokens_required"] is False
    text = _invoke(*arguments).stdout
    assert "http://127.0.0.1:0/" in text
    assert "opening with becalm" in text
    assert not (tmp_path / "data").exists()


def test_check_of_a_data_folder_that_cannot_be_made_exits_1(tmp_path):
    (tmp_path / "file").write_text("")
    result = _invoke("serve", "--check", "--port", "0", "--data-dir", str(tmp_path / "file" / "runs"))
    assert result.exit_code == 1
    assert str(tmp_path / "file") in result.stderr
