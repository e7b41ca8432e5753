"""`becalm study`: the table and the report, progress, Ctrl-C and going on, and what it refuses."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys

import pyarrow.parquet
import pytest
from click.testing import CliRunner

from becalm import studying
from becalm.cli import main
from becalm.studying import chosen_workers
from sim.reproduction.published import published_study
from sim.snapshot import OutcomeClass
from sim.study import flight
from sim.study.design import study_of
from sim.study.run import CellTask, fly_cell

MASS, SPIN = "published.impedance.mass", "target.initial_spin"
SMALL = """
direct = true
[grid]
published.impedance.mass = [0.05, 0.1]
[samples]
count = 2
[samples.over]
target.initial_spin = { from = 0.8, to = 1.2 }
"""
SLOW = """
direct = true
[grid]
published.impedance.mass = { from = 0.1, to = 0.6, count = 24 }
"""


def _invoke(*arguments: object, **options):
    return CliRunner().invoke(main, ["study", *map(str, arguments)], **options)


@pytest.fixture
def small(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(SMALL)
    return path


@pytest.fixture
def in_this_process(monkeypatch):
    """No workers: what the command does around them."""

    def fly(tasks, keep, _open_executor, **_options):
        for task in tasks:
            keep(fly_cell(task))

    monkeypatch.setattr(flight, "fly_cells", fly)


def test_table_and_report(small, tmp_path):
    out = tmp_path / "small.csv"
    result = _invoke(small, "--out", out, "--json", "--workers", "2", "--seed", "5")
    document = json.loads(result.stdout)
    assert result.exit_code == 0
    assert "Cells: 4 of 4" in result.stderr
    with out.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["cell"] for row in rows] == ["0", "1", "2", "3"]
    assert [float(row[MASS]) for row in rows] == [0.05, 0.05, 0.1, 0.1]
    assert {row["outcome"] for row in rows} <= {str(outcome) for outcome in OutcomeClass}
    assert 0.8 <= float(rows[0][SPIN]) <= 1.2
    assert document["study"]["seed"] == 5
    assert (document["cells"], document["resumed"], document["failed"]) == (4, 0, 0)
    assert sum(share["cells"] for share in document["outcomes"]) == 4
    assert (document["workers"], document["format"], document["agreement"]) == (2, "csv", None)
    assert document["cells_per_second"] > 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["small.csv", "small.toml"]


@pytest.mark.usefixtures("in_this_process")
def test_the_same_seed_gives_the_same_table(small, tmp_path):
    tables = []
    for name, seed in (("a.json", 5), ("b.json", 5), ("c.json", 6)):
        assert _invoke(small, "--out", tmp_path / name, "--seed", seed).exit_code == 0
        tables.append(json.loads((tmp_path / name).read_text()))
    assert tables[0] == tables[1]
    assert tables[0] != tables[2]


@pytest.mark.usefixtures("in_this_process")
def test_format_and_changes(small, tmp_path):
    out = tmp_path / "table"
    config = tmp_path / "soft.toml"
    config.write_text("[contact]\nfriction = 0.2\nstiffness = 700.0\n")
    result = _invoke(small, "--out", out, "--format", "parquet", "--config", config, "--set", "contact.friction=0.25")
    assert result.exit_code == 0
    metadata = pyarrow.parquet.read_schema(out).metadata
    assert json.loads(metadata[b"config"])["contact"]["friction"] == 0.25
    assert json.loads(metadata[b"config"])["contact"]["stiffness"] == 700.0
    assert "Study small: 4 cells" in result.stdout
    assert "Wrote" in result.stdout


@pytest.mark.slow  # writes and reads two tables of 484 cells
@pytest.mark.usefixtures("in_this_process")
def test_agreement_is_told_of_the_published_study(tmp_path, monkeypatch):
    flown = fly_cell(CellTask(published_study().base, False, published_study().cell(0)))
    monkeypatch.setattr(flight, "fly_cell", lambda task: {**flown, "cell": task.cell.index, **task.cell.values})
    out = tmp_path / "published.csv"
    document = json.loads(_invoke("published", "--out", out, "--json").stdout)
    assert [(table["mass"], table["cells"]) for table in document["agreement"]] == [(0.01, 121), (0.1, 121)]
    assert len(out.read_text().splitlines()) == 485
    told = _invoke("published", "--out", out, "--force").stdout
    assert "m = 0.01 kg" in told
    assert "of 121 cells in the same class" in told


@pytest.mark.usefixtures("in_this_process")
def test_cells_that_fail_are_reported(tmp_path):
    study = tmp_path / "steps.toml"
    study.write_text("direct = true\n[grid]\nsimulation.time_step = [0.001, 0.0003]\n")
    result = _invoke(study, "--out", tmp_path / "steps.csv")
    assert result.exit_code == 0
    assert "failed" in result.stdout
    assert "0.0003 s does not divide" in result.stdout


def begun(study, out):
    """`becalm study` in a process of its own, when its first cells have come."""
    command = [sys.executable, "-m", "becalm", "study", str(study), "--out", str(out), "--workers", "1"]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ}, start_new_session=True
    )
    for line in process.stderr:
        if line.startswith("Cells: "):
            return process
    pytest.fail(f"becalm study ended with {process.wait(180)}")


def test_kill_9_costs_no_cell_and_counts_none_twice(tmp_path):
    study, out = tmp_path / "slow.toml", tmp_path / "slow.json"
    study.write_text(SLOW)
    with begun(study, out) as process:
        process.kill()
    assert not out.exists()
    document = json.loads(_invoke(study, "--out", out, "--json").stdout)
    assert 0 < document["resumed"] < 24
    undisturbed = tmp_path / "undisturbed.json"
    assert _invoke(study, "--out", undisturbed).exit_code == 0
    assert json.loads(out.read_text()) == json.loads(undisturbed.read_text())


@pytest.mark.usefixtures("in_this_process")
def test_a_table_is_overwritten_only_if_that_is_wanted(small, tmp_path):
    out = tmp_path / "small.csv"
    out.write_text("of another day")
    result = _invoke(small, "--out", out)
    assert result.exit_code == 2
    assert "exists already" in result.stderr
    assert out.read_text() == "of another day"
    assert _invoke(small, "--out", out, "--force").exit_code == 0
    assert len(out.read_text().splitlines()) > 4


def test_ctrl_c_stops_and_the_same_command_goes_on(tmp_path):
    study, out = tmp_path / "slow.toml", tmp_path / "slow.json"
    study.write_text(SLOW)
    with begun(study, out) as process:
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to the workers as well
        stdout, stderr = process.communicate(timeout=180)
    assert process.returncode == 130
    assert stdout == ""
    assert "the same command resumes it" in stderr
    assert "Traceback" not in stderr
    assert not out.exists()
    document = json.loads(_invoke(study, "--out", out, "--json").stdout)
    assert 0 < document["resumed"] < 24
    assert [row["cell"] for row in json.loads(out.read_text())] == list(range(24))


@pytest.mark.usefixtures("in_this_process")
def test_many_cells_are_asked_for(tmp_path):
    study, out = tmp_path / "many.toml", tmp_path / "many.csv"
    study.write_text("direct = true\n[grid]\ncontrol.impedance.mass = { from = 0.1, to = 1.0, count = 10001 }\n")
    for answer in ("n\n", ""):
        result = _invoke(study, "--out", out, "--workers", 2, input=answer)
        assert result.exit_code == 1
        assert "10001 cells take about" in result.stderr
        assert "--yes" in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["many.toml"]


@pytest.mark.usefixtures("in_this_process")
def test_many_cells_are_flown_without_asking_if_told_so(tmp_path, monkeypatch, small):
    monkeypatch.setattr(studying, "MANY_CELLS", 3)
    assert _invoke(small, "--out", tmp_path / "a.csv", input="y\n").exit_code == 0
    result = _invoke(small, "--out", tmp_path / "b.csv", "--yes")
    assert result.exit_code == 0
    assert "Start?" not in result.stderr


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[grid]\ncontrol.impedance.dampin = [1.0]", ["published.impedance.dampin", "published.impedance.damping?"]),
        ("[grid]\ncontrol.impedance.mass = { from = 2.0, to = 1.0, step = 0.1 }", ["impedance.mass", "empty"]),
        ("[grid]\ncontrol.impedance.mass = [0.1, -1.0]", ["published.impedance.mass = -1.0", "greater than 0", "kg"]),
        ("[grid", ["study.toml", "does not parse"]),
        ("", ["varies nothing"]),
    ],
)
def test_a_bad_study_exits_2_and_leaves_nothing(tmp_path, text, words):
    study = tmp_path / "study.toml"
    study.write_text(text)
    result = _invoke(study, "--out", tmp_path / "out.csv", "--json")
    assert (result.exit_code, result.stdout) == (2, "")
    for word in words:
        assert word in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["study.toml"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["publishd", "--out", "a.csv"], ["publishd", "published"]),
        (["published"], ["--out"]),
        (["published", "--out", "a.xlsx"], ["a.xlsx", "csv, parquet, json"]),
        (["published", "--out", "a"], ["--format"]),
        (["published", "--out", "nonesuch/a.csv"], ["nonesuch"]),
        (["published", "--out", ".", "--format", "csv"], ["folder"]),
        (["published", "--out", "a.csv", "--format", "xlsx"], ["--format", "xlsx"]),
        (["published", "--out", "a.csv", "--workers", "0"], ["--workers"]),
        (["published", "--out", "a.csv", "--seed", "-1"], ["--seed"]),
        (
            ["published", "--out", "a.csv", "--set", "published.impedance.mass=1"],
            ["published.impedance.mass", "varied"],
        ),
        (["published", "--out", "a.csv", "--set", "target.mass=-1"], ["target.mass = -1", "greater than 0", "kg"]),
        (["published", "--out", "a.csv", "--set", "target.masss=1"], ["target.masss", "target.mass?"]),
    ],
)
def test_a_bad_argument_exits_2(arguments, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = _invoke(*arguments)
    assert result.exit_code == 2
    for word in words:
        assert word in result.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("in_this_process")
def test_another_unfinished_study_in_the_way_exits_1(small, tmp_path, monkeypatch):
    out = tmp_path / "small.csv"
    monkeypatch.setattr(studying, "export", lambda *_: (_ for _ in ()).throw(OSError(28, "No space left", str(out))))
    assert _invoke(small, "--out", out).exit_code == 1
    result = _invoke(small, "--out", out, "--seed", "9")
    assert result.exit_code == 1
    assert "is not this one" in result.stderr
    monkeypatch.undo()
    document = json.loads(_invoke(small, "--out", out, "--json").stdout)  # nothing that was flown is lost
    assert document["resumed"] == 4


def test_help_has_examples():
    result = _invoke("--help")
    assert result.exit_code == 0
    assert "becalm study published --out" in result.stdout
    assert "[samples.over]" in result.stdout


@pytest.mark.parametrize(
    ("made_of", "count", "words"),
    [
        ({}, 2, "2 threads of this process"),
        ({}, 5, "5 processes on this machine"),
        ({"changes": {"simulation.engine": "pymunk"}}, 2, "2 processes on this machine"),
        ({"grid": {"simulation.engine": ["pymunk", "reduced"]}}, 1, "1 process on this machine"),
    ],
)
def test_few_workers_are_threads_where_no_library_can_end_the_process(made_of, count, words):
    study = study_of({"grid": {"target.initial_spin": [0.9, 1.0]}, **made_of})
    assert chosen_workers(study, count, None).words == words
