"""What no robot can be flown with is refused before anything moves."""

from __future__ import annotations

import pytest

from server.link.robot_link import LinkSettings, RobotLink
from server.link.session import Transport
from server.link.zenoh_plant import ZenohPlant, require_robot_config
from sim.configurations import named_configuration, nested, revised
from sim.errors import ConfigError, MissionRefused

TESTBED = named_configuration("testbed")


def test_the_testbed_is_flown() -> None:
    require_robot_config(TESTBED)


def test_another_period_is_refused_by_name() -> None:
    with pytest.raises(ConfigError, match=r"control\.period = 0\.001 s") as refused:
        require_robot_config(revised(TESTBED, nested({"control.period": 1e-3})))
    assert refused.value.tip


def test_simulated_sensors_are_those_of_rehearsals_and_refused_no_robot() -> None:
    """A robot's readings come perceived: whatever is simulated of sensors is added to none of them."""
    require_robot_config(named_configuration("testbed_becalm"))


def test_a_mission_that_is_refused_changes_nothing_of_how_the_present_one_perceives() -> None:
    link = RobotLink(LinkSettings(transport=Transport(connect=("tcp/127.0.0.1:1",))), TESTBED)
    other = revised(TESTBED, {"perception": {"contact_threshold": 0.7}})
    with pytest.raises(MissionRefused, match="no robot is heard"):
        ZenohPlant(link, other)
    assert link.contact_threshold == TESTBED.perception.contact_threshold != 0.7
