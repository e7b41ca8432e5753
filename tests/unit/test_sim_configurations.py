"""The named configurations, files, and settings as the command line gives them."""

from __future__ import annotations

import json
import math

import pytest

from sim.config import MissionConfig, differences, value_at
from sim.configurations import (
    DEFAULT_CONFIGURATION,
    NAMED_CONFIGURATIONS,
    REFERENCE_CONFIGURATION,
    merged,
    named_configuration,
    nested,
    read_config_file,
    revised,
)
from sim.errors import ConfigError

COMPUTED_WITH = {
    "contact.friction": 0.3,
    "contact.stiffness": 800.0,
    "contact.damping": 2.0,
    "published.touch.contact_position": 0.75,
    "published.touch.hand_tilt": math.radians(5),
    "published.touch.target_tilt": math.radians(18),
    "published.touch.minimum_approach_time": 1.0,
    "published.touch.wait_margin": 1.03,
    "published.touch.contact_time_factor": 0.8,
    "published.touch.absorb_time": 0.35,
    "published.touch.admittance_fraction": 0.8,
    "published.touch.idle_arm_distance_factor": 1.2,
    "published.touch.idle_arm_joint_limit": math.radians(30),
    "published.caging.spin_threshold": 0.5,
    "published.caging.switching_delay": 0.5,
    "published.caging.slow_spin": 0.3,
    "published.caging.capture_margin": 1.05,
    "published.caging.capture_time": 0.6,
    "published.caging.direct_capture_time": 0.5,
    "published.impedance.mass": 0.1,
    "published.impedance.damping": 1.5,
    "published.impedance.stiffness": 10.0,
    "control.period": 1e-3,
    "robot.arm.link_1.centre_of_mass": 0.22098,
    "robot.arm.link_2.length": 0.180,
    "robot.servo.time_constant": 1e-3,
    "robot.servo.torque_limit": 10.0,
    "judging.force_bound": 1.12969,
    "judging.ejection_distance": 0.6,
    "judging.time_limit": 45.0,
    "judging.relative_spin_limit": 0.5,
    "judging.relative_speed_limit": 0.1,
    "target.initial_spin": 1.0,
    "target.initial_y": 0.350,
}
"""docs/method.md, "Constants: computed with, against printed"."""

PRINTED = {
    "contact.friction": 0.1,
    "published.touch.contact_position": 0.8,
    "published.touch.hand_tilt": 0.175,
    "published.touch.target_tilt": 0.175,
    "robot.arm.link_1.centre_of_mass": 0.229,
    "robot.arm.link_2.length": 0.175,
    "robot.base.mass": 8.31,
    "robot.base.inertia": 0.135,
    "target.mass": 2.35,
    "target.inertia": 9.33e-3,
}


def test_our_own_method_is_flown_unless_another_is_named():
    assert named_configuration(DEFAULT_CONFIGURATION).method.value == "co_moving_couple"


def test_published_is_the_reference_and_what_was_computed_with():
    assert REFERENCE_CONFIGURATION == "published"
    published = named_configuration("published")
    assert published == MissionConfig()
    assert {path: value_at(published, path) for path in COMPUTED_WITH} == COMPUTED_WITH


def test_as_printed_has_the_papers_tables():
    as_printed = named_configuration("as_printed")
    assert {path: value_at(as_printed, path) for path in PRINTED} == PRINTED


def test_as_printed_differs_in_nothing_but_the_tables():
    different = differences(named_configuration("published"), named_configuration("as_printed"))
    assert PRINTED.keys() <= different.keys()
    assert all(path.startswith(("robot.", "target.", "contact.", "published.touch.")) for path in different)


def test_published_figures_differs_in_the_impedance_alone():
    assert differences(named_configuration("published"), named_configuration("published_figures")) == {
        "published.impedance.mass": (0.1, 0.2),
        "published.impedance.damping": (1.5, 0.1),
        "published.impedance.stiffness": (10.0, 0.1),
    }


def test_an_unknown_name_is_refused_with_those_there_are():
    with pytest.raises(
        ConfigError, match="'gentle' is unknown; there are published, as_printed, published_figures, testbed"
    ):
        named_configuration("gentle")


@pytest.mark.parametrize("name", list(NAMED_CONFIGURATIONS))
def test_names_give_what_they_are_listed_with(name):
    assert named_configuration(name) is NAMED_CONFIGURATIONS[name]


def test_nested_gathers_paths_by_group():
    assert nested({"a.b": 1, "a.c.d": 2, "e": 3}) == {"a": {"b": 1, "c": {"d": 2}}, "e": 3}


def test_merged_lays_changes_over_and_leaves_the_first_alone():
    tree = {"a": {"b": 1, "c": 2}, "d": 3}
    assert merged(tree, {"a": {"c": 5}, "d": 4}) == {"a": {"b": 1, "c": 5}, "d": 4}
    assert tree == {"a": {"b": 1, "c": 2}, "d": 3}


class TestFiles:
    def test_toml(self, tmp_path):
        file = tmp_path / "gentle.toml"
        file.write_text("[published.impedance]\ndamping = 3.0\n", encoding="utf-8")
        assert revised(MissionConfig(), read_config_file(file)).published.impedance.damping == 3.0

    def test_json(self, tmp_path):
        file = tmp_path / "whole.json"
        file.write_text(named_configuration("as_printed").model_dump_json(), encoding="utf-8")
        assert revised(MissionConfig(), read_config_file(file)) == named_configuration("as_printed")

    def test_that_is_missing(self, tmp_path):
        with pytest.raises(ConfigError, match=r"none\.toml.*No such file"):
            read_config_file(tmp_path / "none.toml")

    @pytest.mark.parametrize(("name", "text"), [("bad.toml", "a = = 1"), ("bad.json", "{"), ("binary.toml", "\x00")])
    def test_that_does_not_parse(self, tmp_path, name, text):
        file = tmp_path / name
        file.write_text(text, encoding="utf-8")
        with pytest.raises(ConfigError, match="does not parse"):
            read_config_file(file)

    def test_that_is_not_text(self, tmp_path):
        file = tmp_path / "noise.toml"
        file.write_bytes(b"\xff\xfe\x00\x9f")
        with pytest.raises(ConfigError, match="does not parse"):
            read_config_file(file)

    def test_that_holds_no_table(self, tmp_path):
        file = tmp_path / "list.json"
        file.write_text(json.dumps([1, 2]), encoding="utf-8")
        with pytest.raises(ConfigError, match="holds no table"):
            read_config_file(file)


def deep(innermost, levels):
    """So many groups, or lists, one within another."""
    for _ in range(levels):
        innermost = [innermost] if isinstance(innermost, list) else {"group": innermost}
    return innermost


class TestBounds:
    """Whatever is asked, to refuse it takes a moment, and a few words."""

    def test_as_many_names_as_there_are_parameters_pass(self):
        config = MissionConfig()
        assert revised(config, config.model_dump(mode="json")) == config

    @pytest.mark.parametrize(
        ("changes", "bound"),
        [
            ({f"stranger_{number}": 1.0 for number in range(2000)}, "names"),
            ({"control": {f"stranger_{number}": 1.0 for number in range(2000)}}, "names"),
            ({"target": {"mass": [0.0] * 2000}}, "names"),
            (deep({}, 900), "levels"),
            ({"target": deep([], 900)}, "levels"),
        ],
    )
    def test_more_than_there_can_be_is_refused_as_such(self, changes, bound):
        with pytest.raises(ConfigError, match=f"changes = more than [0-9]+ {bound}"):
            revised(MissionConfig(), changes)

    def test_a_path_in_one_piece_is_told_how_it_is_nested(self):
        nested_path = r'"simulation\.engine": groups are nested here, \{"simulation": \{"engine": \.\.\.\}\}'
        with pytest.raises(ConfigError, match=nested_path):
            revised(MissionConfig(), {"simulation.engine": "reduced"})

    def test_a_message_tells_of_some_and_how_many_more(self):
        with pytest.raises(ConfigError, match=r"stranger_0 is not a parameter.*; and 12 more$") as refused:
            revised(MissionConfig(), {f"stranger_{number}": 1.0 for number in range(20)})
        assert len(str(refused.value)) < 2000

    @pytest.mark.parametrize("changes", [{"x" * 900_000: 1.0}, {"target": {"mass": "x" * 900_000}}])
    def test_a_message_does_not_repeat_what_is_long(self, changes):
        with pytest.raises(ConfigError, match=r"x\.\.\.") as refused:
            revised(MissionConfig(), changes)
        assert len(str(refused.value)) < 500
