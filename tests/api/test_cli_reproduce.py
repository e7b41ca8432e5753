"""`becalm reproduce` on a coarse study: a report that stands by itself, whose numbers are those of its tables."""

from __future__ import annotations

import csv
import json
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from click.testing import CliRunner

from becalm.cli import main
from sim.reproduction.experiments import impedance_of
from sim.reproduction.published import agreement, published_classes

COARSE = ("--every", "10", "--workers", "2", "--json")
SECTIONS = ("answer", "figures", "maps", "truth", "mechanism", "failures", "printed", "method")


def reproduce(out: Path, *arguments: str):
    return CliRunner().invoke(main, ["reproduce", "--out", str(out), *arguments])


@pytest.fixture(scope="module")
def coarse(tmp_path_factory):
    out = tmp_path_factory.mktemp("reproduction")
    result = reproduce(out, *COARSE)
    assert result.exit_code == 0, result.stderr
    return out, json.loads(result.stdout)


def table(out: Path, name: str) -> list[dict[str, str]]:
    with (out / "tables" / f"{name}.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def cells(out: Path, name: str):
    """Rows of a study's table with what the analysis reads as numbers."""
    numbers = ("mass", "damping", "stiffness")
    rows = table(out, f"cells_{name}")
    return [
        {**row, **{f"published.impedance.{n}": float(row[f"published.impedance.{n}"]) for n in numbers}} for row in rows
    ]


def test_report_needs_nothing_else(coarse):
    out, _ = coarse
    page = (out / "report.html").read_text()
    assert all(source.startswith("data:image/svg+xml;base64,") for source in re.findall(r'src="([^"]*)', page))
    assert all(link.startswith("#") for link in re.findall(r'href="([^"]*)', page))
    assert not re.search(r"<script|<link|@import|url\(", page)
    assert len(page) < 8e6


def test_report_has_every_section_and_figure(coarse):
    out, _ = coarse
    page = (out / "report.html").read_text()
    for section in SECTIONS:
        assert f'<section id="{section}">' in page
    drawn = sorted(path.stem for path in (out / "figures").glob("*.svg"))
    assert drawn == sorted(path.stem for path in (out / "figures").glob("*.png"))
    assert sorted(re.findall(r'id="figure-([^"]*)', page)) == drawn
    for path in (out / "figures").glob("*.svg"):
        assert ET.parse(path).getroot().tag.endswith("svg")


def test_numbers_of_the_report_are_those_of_the_tables(coarse):
    out, document = coarse
    page = (out / "report.html").read_text()
    for name in ("published", "as_printed"):
        rows = cells(out, name)
        assert len(rows) == document["cells"] == 16
        assert [one.model_dump() for one in agreement(rows)] == document["agreement"][name]
        successes = sum(row["at_first_closure"].startswith("caged") for row in rows)
        assert document["outcomes"][name]["success"] == successes
    compared = [row for row in cells(out, "published") if impedance_of(row) in published_classes()]
    same = sum(row["at_first_closure"] == published_classes()[impedance_of(row)] for row in compared)
    assert f"{same} of the {len(compared)} published cells at hand" in re.sub(r"\s+", " ", page)
    assert len(document["differing"]) == len(compared) - same


def test_summary_is_what_json_prints(coarse):
    out, document = coarse
    summary = json.loads((out / "summary.json").read_text())
    assert {name: document[name] for name in summary} == summary
    assert len(table(out, "first_touch")) == document["first_touch"]["cells"]
    assert document["ablations"] == []


def test_the_first_touch_alone_predicts_most_cells(coarse):
    """Without rings and bounces: the collision model knows neither robot nor planner."""
    out, _ = coarse
    rows = [row for row in table(out, "first_touch") if float(row["damping"]) > 0.0 and float(row["mass"]) < 0.5]
    errors = sorted(abs(float(row["measured_spin"]) - float(row["planar_spin"])) for row in rows)
    assert errors[len(errors) // 2] < 0.05


def test_second_time_flies_nothing_and_writes_the_same(coarse):
    out, _ = coarse
    pages = {path: path.read_bytes() for path in out.rglob("*") if path.suffix in (".html", ".svg", ".csv", ".json")}
    again = reproduce(out, *COARSE)
    assert again.exit_code == 0
    assert "published: all cells kept" in again.stderr
    assert "to fly" not in again.stderr
    for path, before in pages.items():
        assert path.read_bytes() == before or path.name == "report.html"


def test_nothing_else_loads_what_draws():
    """A run and the service start without matplotlib."""
    code = "import sys, becalm.cli, becalm.running, becalm.serving; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False, timeout=120).returncode == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--every", "0"), "--every"),
        (("--workers", "0"), "--workers"),
        (("--evry", "2"), "--evry"),
        (("--seeds", "3"), "add --experiment"),
        (("--experiment", "--seeds", "0"), "--seeds"),
        (("--experiment", "--every", "2"), "--every is of the parametric study"),
        (("--experiment", "--ablations"), "--ablations is of the parametric study"),
    ],
)
def test_bad_arguments_are_refused(tmp_path, arguments, words):
    result = reproduce(tmp_path / "out", *arguments)
    assert result.exit_code == 2
    assert words in result.stderr
    assert not (tmp_path / "out").exists()


def test_a_file_is_no_folder(tmp_path):
    (tmp_path / "taken").write_text("")
    result = reproduce(tmp_path / "taken")
    assert result.exit_code == 2
    assert "is a file; give the name of a folder" in result.stderr


def test_a_file_is_no_folder_for_the_experiment_either(tmp_path):
    (tmp_path / "taken").write_text("")
    result = reproduce(tmp_path / "taken", "--experiment")
    assert result.exit_code == 2
    assert "is a file; give the name of a folder" in result.stderr


@pytest.mark.slow
def test_the_experiment_is_flown_again_on_a_page_that_needs_nothing_else(tmp_path):
    result = reproduce(tmp_path, "--experiment", "--seeds", "1", "--workers", "1", "--json")
    assert result.exit_code == 0, result.stderr
    document = json.loads(result.stdout)
    assert "Captures: 3 of 3" in result.stderr
    rows = table(tmp_path, "experiment")
    assert [row["trial"] for row in rows] == list(document["trials"]) == ["direct", "published", "becalm"]
    ours = document["trials"]["becalm"]
    assert ours["caged"] == 1
    assert ours["peak_force"]["largest"] == pytest.approx(float(rows[2]["peak_force"]))
    assert ours["peak_force"]["largest"] < 0.6
    assert ours["singular"] == 0
    page = (tmp_path / "experiment.html").read_text()
    drawn = sorted(path.stem.removeprefix("experiment_") for path in (tmp_path / "figures").glob("*.svg"))
    assert sorted(re.findall(r'id="figure-([^"]*)', page)) == drawn
    assert {"forces", "velocities", "stability", "snapshots_published", "manipulability"} <= set(drawn)
    assert all(source.startswith("data:image/svg+xml;base64,") for source in re.findall(r'src="([^"]*)', page))
    assert not re.search(r"<script|<link|@import|url\(", page)
