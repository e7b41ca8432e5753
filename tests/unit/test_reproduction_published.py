"""The published study and its tables; agreement beyond chance."""

from __future__ import annotations

from collections import Counter

import pytest

from sim.config import value_at
from sim.configurations import named_configuration
from sim.errors import ConfigError
from sim.reproduction.published import (
    DAMPING,
    MASS,
    STIFFNESS,
    PublishedImpedance,
    agreement,
    cohens_kappa,
    is_comparable,
    named_study,
    published_classes,
    published_study,
)
from sim.snapshot import OutcomeClass
from sim.study.design import study_of


def rows_as_printed():
    """Rows of a study that gives just what the paper prints."""
    return [
        {MASS: cell.mass, DAMPING: cell.damping, STIFFNESS: cell.stiffness, "at_first_closure": printed}
        for cell, printed in published_classes().items()
    ]


class TestStudy:
    def test_has_the_papers_484_cells(self):
        values = {tuple(cell.values.values()) for cell in published_study().cells()}
        assert published_study().count == len(values) == 484
        assert published_study().shape == (4, 11, 11, 1)
        assert set(published_classes()) < {PublishedImpedance(*map(float, cell)) for cell in values}

    def test_flies_the_published_configuration_at_its_spin(self):
        assert published_study().base == named_configuration("published")
        assert value_at(published_study().base, "target.initial_spin") == 1.0

    def test_is_found_by_its_name(self):
        assert named_study("published") is published_study()
        with pytest.raises(ConfigError, match=r"publishd.*published"):
            named_study("publishd")

    def test_can_be_compared_under_other_settings_but_not_over_other_cells(self):
        definition = published_study().definition()
        assert is_comparable(study_of({**definition, "configuration": "as_printed"}))
        assert not is_comparable(study_of({**definition, "direct": True}))
        assert not is_comparable(study_of({"grid": {MASS: [0.1]}}))


class TestTables:
    def test_hold_two_tables_of_121_cells_in_five_classes(self):
        classes = published_classes()
        assert Counter(cell.mass for cell in classes) == {0.01: 121, 0.1: 121}
        assert set(classes.values()) < {str(outcome) for outcome in OutcomeClass}

    def test_rows_are_stiffness_and_columns_damping(self):
        """d matters more than k: without damping some cells cage, at the largest none does."""
        classes = published_classes()
        assert classes[PublishedImpedance(0.01, 0.0, 0.0)] == "caged_unplanned_contact"
        assert classes[PublishedImpedance(0.01, 15.0, 0.0)] == "base_collision"
        assert classes[PublishedImpedance(0.01, 0.0, 100.0)] == "base_collision"
        assert classes[PublishedImpedance(0.1, 1.5, 10.0)] == "caged_force_reduced"


class TestAgreement:
    def test_of_the_tables_with_themselves_is_whole(self):
        for table in agreement(rows_as_printed()):
            assert (table.cells, table.agreeing, table.success_agreeing) == (121, 121, 121)
            assert (table.share, table.kappa, table.success_share, table.success_kappa) == (1.0, 1.0, 1.0, 1.0)

    def test_of_the_majority_class_is_no_better_than_chance(self):
        rows = [{**row, "at_first_closure": "base_collision"} for row in rows_as_printed()]
        tables = agreement(rows)
        assert [table.mass for table in tables] == [0.01, 0.1]
        assert all(0.4 < table.share < 0.6 and table.kappa == pytest.approx(0.0) for table in tables)

    def test_another_class_of_success_agrees_by_success_only(self):
        rows = rows_as_printed()
        changed = next(row for row in rows if row["at_first_closure"] == "caged_force_reduced")
        changed["at_first_closure"] = "caged_force_not_reduced"
        table = agreement(rows)[0]
        assert (table.agreeing, table.success_agreeing) == (120, 121)
        assert table.kappa < 1.0
        assert table.success_kappa == 1.0

    def test_a_failed_cell_agrees_with_nothing(self):
        rows = rows_as_printed()
        rows[0]["at_first_closure"] = None
        table = agreement(rows)[0]
        assert (table.agreeing, table.success_agreeing) == (120, 120)

    def test_cells_that_no_table_has_do_not_count(self):
        rows = [{**row, MASS: 0.5} for row in rows_as_printed()]
        assert agreement(rows) == []
        assert [table.cells for table in agreement([*rows, *rows_as_printed()[:7]])] == [7]


class TestKappa:
    def test_of_a_textbook_example(self):
        """Two readers of 50 grants: 20 and 15 in agreement, kappa 0.4."""
        pairs = [("yes", "yes")] * 20 + [("yes", "no")] * 5 + [("no", "yes")] * 10 + [("no", "no")] * 15
        assert cohens_kappa(pairs) == pytest.approx(0.4)

    def test_of_two_that_always_say_the_same_one_thing(self):
        assert cohens_kappa([("a", "a")] * 3) == 1.0

    def test_of_opposites_is_negative(self):
        assert cohens_kappa([("a", "b"), ("b", "a")]) == -1.0
