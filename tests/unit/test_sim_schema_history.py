"""Names that stored things may have and today's version has not, and how values are read under those of today."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from server.library.record import RunRecord
from sim import configurations
from sim.capture.tick import QUANTITIES
from sim.config import PARAMETERS, MissionConfig
from sim.configurations import revised, unknown_parameter
from sim.errors import ConfigError
from sim.schema_history import (
    MEASURE_CHANGES,
    PARAMETER_CHANGES,
    RECORD_CHANGES,
    TICK_CHANGES,
    Change,
    config_version,
    former_names,
    removed,
    renamed,
    todays_name,
    under_todays_names,
)
from sim.snapshot import Outcome
from sim.stored import read_parameters, read_parameters_file, read_tree
from sim.study.run import MEASURES

CHANGES = (
    renamed("control.touch", "published.touch"),
    renamed("published.touch.absorb_time", "published.touch.settling_time"),
    removed("simulation.slop", "pymunk's own is taken"),
    renamed("side", "width"),
    removed("published.touch.old", "it did nothing"),
)


def _record_fields() -> set[str]:
    return {*RunRecord.model_fields, *(f"outcome.{name}" for name in Outcome.model_fields)}


@pytest.mark.parametrize(
    ("changes", "todays"),
    [
        (PARAMETER_CHANGES, set(PARAMETERS)),
        (TICK_CHANGES, {quantity.name for quantity in QUANTITIES}),
        (MEASURE_CHANGES, {column.name for column in MEASURES}),
        (RECORD_CHANGES, _record_fields()),
    ],
)
def test_no_old_name_is_used_again_and_every_new_one_leads_to_one_of_today(
    changes: Sequence[Change], todays: set[str]
) -> None:
    for change in changes:
        assert not [name for name in todays if name == change.old or name.startswith(change.old + ".")], change
        if change.new is None:
            assert change.why, change
        else:
            led = todays_name(change.new, changes)
            assert led is None or [name for name in todays if name == led or name.startswith(led + ".")], change


@pytest.mark.parametrize(
    ("old", "today"),
    [
        ("control.touch.absorb_time", "published.touch.settling_time"),
        ("control.touch.hand_tilt", "published.touch.hand_tilt"),
        ("published.touch.absorb_time", "published.touch.settling_time"),
        ("control.touch.old", None),
        ("simulation.slop", None),
        ("simulation.slope", "simulation.slope"),
        ("control.touchy", "control.touchy"),
        ("target.side", "target.side"),
        ("side", "width"),
    ],
)
def test_a_name_is_followed_through_all_that_changed(old: str, today: str | None) -> None:
    assert todays_name(old, CHANGES) == today


def test_former_names_are_found_the_latest_first() -> None:
    assert former_names("published.touch.settling_time", CHANGES) == (
        "published.touch.absorb_time",
        "control.touch.absorb_time",
    )
    assert former_names("target.side", CHANGES) == ()


def test_values_keep_their_order_and_what_is_gone_is_said() -> None:
    read = under_todays_names({"side": 1, "control.touch.absorb_time": 2, "simulation.slop": 3, "x.y": 4}, CHANGES)
    assert list(read.values.items()) == [("width", 1), ("published.touch.settling_time", 2), ("x.y", 4)]
    assert read.notices == ("simulation.slop is ignored: pymunk's own is taken",)


def test_a_group_moves_with_all_that_is_in_it() -> None:
    stored = {"control": {"touch": {"absorb_time": 0.4, "hand_tilt": 0.1}, "period": 1e-3}, "empty": {}}
    assert read_tree(stored, CHANGES).values == {
        "published": {"touch": {"settling_time": 0.4, "hand_tilt": 0.1}},
        "control": {"period": 1e-3},
        "empty": {},
    }


@pytest.mark.parametrize(
    ("stored", "message"),
    [
        ({"side": 1, "width": 2}, "side is the former name of width, and both are given"),
        ({"published": 3, "control": {"touch": {"hand_tilt": 0.1}}}, "published is a group"),
    ],
)
def test_two_values_for_one_parameter_are_refused(stored: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        read_tree(stored, CHANGES)


@pytest.mark.parametrize(
    ("version", "message"),
    [
        (config_version() + 1, "those of a later version of Becalm; this one reads up to"),
        ("1", "not a whole number"),
        (True, "not a whole number"),
        (0, "not a whole number"),
    ],
)
def test_a_version_that_cannot_be_read_is_said(version: object, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        read_parameters({"version": version, "target": {"mass": 2.0}})


def test_a_file_may_tell_its_version_and_one_that_cannot_be_is_named(tmp_path: Path) -> None:
    file = tmp_path / "soft.toml"
    file.write_text("version = 1\n[target]\nmass = 2.0\n")
    assert read_parameters_file(file) == ({"target": {"mass": 2.0}}, ())
    file.write_text("version = 99\n")
    with pytest.raises(ConfigError, match=r"soft\.toml': version = 99"):
        read_parameters_file(file)


def test_a_configuration_tells_its_version_and_takes_no_other() -> None:
    config = MissionConfig()
    assert config.model_dump()["version"] == config_version()
    assert revised(config, config.model_dump(mode="json")) == config
    with pytest.raises(ConfigError, match=f"version = 7: .*version {config_version()}"):
        revised(config, {"version": 7})


def test_a_request_with_a_former_name_is_told_the_one_of_today(monkeypatch: pytest.MonkeyPatch) -> None:
    changes = (renamed("control.softness", "control.impedance"), removed("target.colour", "nobody sees it"))
    monkeypatch.setattr(configurations, "PARAMETER_CHANGES", changes)
    assert unknown_parameter("target.colour") == "target.colour is no longer a parameter: nobody sees it"
    with pytest.raises(ConfigError, match=r"control\.softness is no longer a parameter: it is control\.impedance now"):
        revised(MissionConfig(), {"control": {"softness": {"damping": 3.0}}})
