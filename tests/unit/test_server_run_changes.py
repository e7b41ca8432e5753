"""Changes of parameters as an operator is told of them: the whole path, both values, the unit."""

from __future__ import annotations

from server.library.changes import MOST_CHANGES_TOLD, change_words, changed_words


def test_a_change_has_its_path_both_values_and_its_unit():
    assert change_words("published.impedance.damping", 1.5, 3.0) == "published.impedance.damping 1.5 → 3 N s/m"


def test_what_has_no_unit_is_told_without():
    assert change_words("contact.friction", 0.1, 0.25) == "contact.friction 0.1 → 0.25"
    assert change_words("simulation.seed", 0, 12345678901) == "simulation.seed 0 → 12345678901"


def test_many_changes_stay_one_readable_line():
    few = {"target.mass": (2.35, 2.5), "contact.friction": (0.1, 0.2)}
    assert changed_words(few) == "target.mass 2.35 → 2.5 kg; contact.friction 0.1 → 0.2"
    many = dict.fromkeys(["simulation.seed", *(f"target.{name}" for name in ("mass", "inertia", "side"))], (1, 2))
    many |= dict.fromkeys([f"published.impedance.{name}" for name in ("mass", "damping", "stiffness")], (1, 2))
    assert len(many) == MOST_CHANGES_TOLD + 1
    assert changed_words(many).endswith("; and 1 more")


def test_without_changes_there_is_nothing_to_tell():
    assert changed_words({}) == ""
