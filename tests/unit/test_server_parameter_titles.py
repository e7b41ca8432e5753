"""Every parameter says of what it is."""

from __future__ import annotations

from collections import Counter

import pytest

from server.api.parameter_titles import group_title, parameter_title
from sim.config import PARAMETERS


@pytest.mark.parametrize(
    ("path", "title"),
    [
        ("published.impedance.mass", "Virtual mass of the hand"),
        ("robot.base.mass", "Mass of the base"),
        ("robot.arm.link_2.centre_of_mass", "Centre of mass of link 2"),
        ("target.initial_spin", "Initial spin"),
        ("perception.noise.joint_rate", "Noise of the joint rate"),
        ("contact.stiffness", "Stiffness of the contact"),
        ("some.new_group.fresh_name", "Fresh name"),
    ],
)
def test_a_title_says_of_what_it_is(path, title):
    assert parameter_title(path) == title


def test_no_two_parameters_that_mean_different_things_have_one_title():
    titles = Counter(parameter_title(path) for path in PARAMETERS)
    same = {title for title, count in titles.items() if count > 1}
    # The shortest times of touching and caging, and each method's release, stand under their own headings.
    assert same == {"Minimum approach time", "Release distance", "Release time"}


def test_groups_have_headings():
    assert group_title("published.impedance") == "Impedance of the hands"
    assert group_title("some.new_group") == "Some · new group"
    assert group_title("co_moving_couple.search") == "Co-moving couple · search"
    assert len({group_title(path.rpartition(".")[0]) for path in PARAMETERS}) == len(
        {path.rpartition(".")[0] for path in PARAMETERS}
    )
