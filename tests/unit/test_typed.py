"""What people type: the command line reads numbers as the console's fields do."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from becalm.typed import parse_setting, read_number, read_points
from sim.config import MissionConfig
from sim.configurations import nested, revised
from sim.errors import ConfigError

UNITS = Path(__file__).parents[2] / "web/src/units"
CASES = json.loads((UNITS / "numbers.cases.json").read_text())["numbers"]
POINT_CASES = json.loads((UNITS / "points.cases.json").read_text())


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["text"])
def test_a_number_is_read_or_refused_as_on_the_page(case):
    if "error" in case:
        with pytest.raises(ConfigError) as refused:
            read_number(case["text"])
        assert str(refused.value) == case["error"]
    else:
        assert read_number(case["text"]) == case["value"]


@pytest.mark.parametrize("case", POINT_CASES, ids=lambda case: case["text"])
def test_points_are_read_or_refused_as_on_the_page(case):
    if "error" in case:
        with pytest.raises(ConfigError) as refused:
            read_points(case["text"])
        assert str(refused.value) == case["error"]
    else:
        assert read_points(case["text"]) == case["points"]


def test_a_whole_number_is_exact_on_the_command_line():
    assert parse_setting("simulation.seed=9223372036854775807") == nested({"simulation.seed": 2**63 - 1})


@pytest.mark.parametrize(
    ("setting", "path", "value"),
    [
        ("published.impedance.damping=3.0", "published.impedance.damping", 3.0),
        ("published.impedance.damping=.5", "published.impedance.damping", 0.5),
        ("published.impedance.damping = 3.", "published.impedance.damping", 3.0),
        ("target.initial_spin=\u22120.5", "target.initial_spin", -0.5),
        ("simulation.seed=1e3", "simulation.seed", 1000),
        ("contact.corner=radial", "contact.corner", "radial"),
        ('contact.corner="radial"', "contact.corner", "radial"),
        ("target.vertices=0,0; .2,0; 0,.1", "target.vertices", [[0.0, 0.0], [0.2, 0.0], [0.0, 0.1]]),
        ("target.vertices=[[0, 0], [0.2, 0], [0, 0.1]]", "target.vertices", [[0.0, 0.0], [0.2, 0.0], [0.0, 0.1]]),
    ],
)
def test_a_setting_is_what_its_parameter_takes(setting, path, value):
    change = parse_setting(setting)
    assert change == nested({path: value})
    revised(MissionConfig(), change)


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("published.impedance.damping", "PATH=VALUE"),
        ("control.impedence.damping=3", "did you mean published.impedance.damping?"),
        ("published.impedance.damping=1,000", "write 1000 or 1.000"),
        ("published.impedance.damping=0,5", r"write 0\.5: the decimal sign is a point \[N s/m\]"),
        ("published.impedance.damping=", "a number is missing"),
        ("target.mass=true", '"true" is not a number'),
        ("target.mass=[1]", "not a number"),
        ("target.mass=NaN", "not a finite number"),
        ("target.vertices=0 0; 1", r"--set target\.vertices = .*point 2, \"1\", is not two numbers.*\[m\]"),
    ],
)
def test_a_setting_that_cannot_be_names_path_and_what_to_write(setting, words):
    with pytest.raises(ConfigError, match=words):
        parse_setting(setting)


def test_bounds_are_the_configurations_own():
    with pytest.raises(ConfigError, match=r"target\.mass = -1"):
        revised(MissionConfig(), parse_setting("target.mass=-1"))
