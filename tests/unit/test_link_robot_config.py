"""What no robot can be flown with is refused before anything moves."""

from __future__ import annotations

import pytest

from server.link.zenoh_plant import require_robot_config
from sim.configurations import named_configuration, nested, revised
from sim.errors import ConfigError

TESTBED = named_configuration("testbed")


def test_the_testbed_is_flown() -> None:
    require_robot_config(TESTBED)


@pytest.mark.parametrize(
    ("path", "value"),
    [("control.period", 1e-3), ("perception.noise.force", 0.02), ("perception.source", "motion_capture")],
)
def test_another_period_and_simulated_sensors_are_refused_by_name(path: str, value: object) -> None:
    """A robot's readings are perceived already: noise or the filter on top would be a second time."""
    with pytest.raises(ConfigError, match=path.replace(".", r"\.")) as refused:
        require_robot_config(revised(TESTBED, nested({path: value})))
    assert refused.value.tip
