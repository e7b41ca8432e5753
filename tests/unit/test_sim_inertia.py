"""The largest moment of inertia of a body: against mass that is put where it may be, and against known shapes."""

from __future__ import annotations

import numpy as np
import pytest

from sim.config import MissionConfig
from sim.configurations import NAMED_CONFIGURATIONS
from sim.model.inertia import Outline, outlines


def _outline(behind: float, ahead: float, half_width: float) -> Outline:
    return Outline("base", "robot.base", "", (), behind, ahead, half_width, 2.0, 0.1, 0.03)


@pytest.mark.parametrize(
    ("target", "most", "even_plate"),
    [
        ({"side": 0.3}, 0.3**2 / 2, 0.3**2 / 6),
        ({"shape": "rectangle", "width": 0.3, "depth": 0.2}, 0.13 / 4, 0.13 / 12),
        ({"shape": "circle", "radius": 0.2}, 0.2**2, 0.2**2 / 2),
        ({"shape": "regular_polygon", "sides": 6, "side": 0.2}, 0.2**2, 0.2**2 * 5 / 12),
        ({"shape": "regular_polygon", "sides": 3, "side": 0.2}, 0.2**2 / 3, 0.2**2 / 12),
        ({"shape": "polygon", "vertices": [[1.0, 2.0], [1.3, 2.0], [1.0, 2.3]]}, 0.05, 0.01),
    ],
)
def test_a_kilogram_of_target_has_that_much_at_most_and_if_it_is_even(target, most, even_plate):
    found = outlines(MissionConfig.model_validate({"target": {"mass": 2.0, **target}}))[0]
    assert (found.most, found.even_plate) == pytest.approx((2.0 * most, 2.0 * even_plate))


def test_an_even_base():
    base = outlines(MissionConfig())[1]
    assert base.even_plate == pytest.approx(8.3084 * (0.32**2 + 0.16**2) / 12.0)


def test_two_masses_at_the_ends_of_a_thin_rod_reach_the_most():
    behind, ahead = 0.05, 0.2
    masses = 2.0 * np.array([ahead, behind]) / (behind + ahead)
    assert masses @ np.array([-behind, ahead]) == pytest.approx(0.0)
    assert _outline(behind, ahead, 0.0).most == pytest.approx(masses @ np.array([behind, ahead]) ** 2)


@pytest.mark.parametrize("seed", range(20))
def test_no_masses_within_it_have_more(seed):
    draws = np.random.default_rng(seed)
    masses = draws.dirichlet(np.full(5, 0.5)) * 2.0
    x, y = draws.uniform(-0.1, 0.1, 5), draws.uniform(0.0, 0.4, 5)
    centre_x, centre = masses @ x / 2.0, masses @ y / 2.0
    inertia = masses @ ((x - centre_x) ** 2 + (y - centre) ** 2)
    assert inertia <= _outline(float(centre), 0.4 - float(centre), 0.1).most


@pytest.mark.parametrize("name", NAMED_CONFIGURATIONS)
def test_all_bodies_of_the_named_configurations_can_be(name):
    for body in outlines(NAMED_CONFIGURATIONS[name]):
        assert body.inertia <= body.most, body
