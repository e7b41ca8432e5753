"""`becalm rehearse`: what it prints where, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from becalm.cli import main


def _invoke(*arguments: str) -> Result:
    return CliRunner().invoke(main, list(arguments))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A data folder with a run of direct caging."""
    path = tmp_path_factory.mktemp("data")
    runner = CliRunner(env={"BECALM_DATA_DIR": str(path)})
    return path, str(
        json.loads(runner.invoke(main, ["run", "--configuration", "published", "--direct", "--json"]).stdout)["run_id"]
    )


@pytest.fixture
def recorded(folder: tuple[Path, str], monkeypatch: pytest.MonkeyPatch) -> str:
    """That run, in the data folder of this test."""
    monkeypatch.setenv("BECALM_DATA_DIR", str(folder[0]))
    return folder[1]


def test_json_is_one_document_with_odds_bands_and_deciders(recorded: str) -> None:
    arguments = ("rehearse", recorded, "--at", "0", "--futures", "10", "--horizon", "6")
    result = _invoke(*arguments, "--json")
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    assert document["as_it_is"]["futures"] == sum(each["futures"] for each in document["as_it_is"]["odds"]) == 10
    assert document["request"] is None, "the sequence was under way in its first tick already"
    assert document["engine"] == "reduced"
    assert document["as_changed"] is None
    assert "Futures: 10 of 10" in result.stderr
    assert json.loads(_invoke(*arguments, "--json").stdout) == document, "the same seed gives the same futures"


def test_changes_are_shown_beside_what_is(recorded: str) -> None:
    arguments = ("rehearse", recorded, "--at", "0.5", "--futures", "8", "--horizon", "8")
    result = _invoke(*arguments, "--set", "robot.servo.time_constant=0.03")
    assert result.exit_code == 0, result.output
    assert "as it is" in result.stdout
    assert "as changed" in result.stdout
    assert "robot.servo.time_constant = 0.03" in result.stdout
    assert "caged " in result.stdout
    assert "peak_tip_force [N]" in result.stdout


def test_an_uncertainty_file_is_read(recorded: str, tmp_path: Path) -> None:
    file = tmp_path / "lab.toml"
    file.write_text("friction = 0.0\ntarget_mass = 0.0\n")
    arguments = ("rehearse", recorded, "--at", "0.5", "--futures", "3", "--horizon", "1", "--uncertainty", str(file))
    document = json.loads(_invoke(*arguments, "--json").stdout)
    assert len({each["draw"]["values"]["friction"] for each in document["as_it_is"]["each"]}) == 1
    file.write_text("friction = -0.1\n")
    refused = _invoke(*arguments)
    assert refused.exit_code == 2
    assert "uncertainty.friction = -0.1" in refused.stderr


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--at", "99"), "at = 99 s"),
        (("--futures", "0"), "futures = 0"),
        (("--futures", "10000000"), "so many would take about"),
        (("--set", "published.impedance.damping=-1"), "published.impedance.damping = -1"),
        (("--request", "capture", "--at", "0.5"), "capture is refused in phase caging"),
        (("--horizon", "0"), "horizon = 0 s"),
    ],
)
def test_what_cannot_be_is_refused(recorded: str, arguments: tuple[str, ...], words: str) -> None:
    result = _invoke("rehearse", recorded, *arguments)
    assert result.exit_code in (1, 2)
    assert words in result.stderr
    assert result.stdout == ""
