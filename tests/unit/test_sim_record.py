"""Configuration models as numeric records."""

from __future__ import annotations

import numpy as np
import pytest

from sim.config import PARAMETERS, HandMount, MissionConfig, OutcomeRule, value_at
from sim.configurations import NAMED_CONFIGURATIONS
from sim.parameters import Points
from sim.record import code_of, dtype_of, record_of


@pytest.mark.parametrize("name", list(NAMED_CONFIGURATIONS))
def test_record_holds_every_number_and_choice_under_its_path(name):
    config = NAMED_CONFIGURATIONS[name]
    record = record_of(config)
    for path in PARAMETERS:
        if PARAMETERS[path].annotation == Points:
            continue
        stored, value = record, value_at(config, path)
        for part in path.split("."):
            stored = stored[part]
        assert stored == (code_of(value) if hasattr(value, "name") else value), path


def test_choices_become_their_place_in_the_enumeration():
    assert code_of(HandMount.YIELDING) == 0
    assert code_of(OutcomeRule.LOCKED_ARMS) == 1


def test_type_of_a_record_depends_on_the_model_alone():
    assert record_of(MissionConfig()).dtype == dtype_of(MissionConfig)


def test_numbers_keep_their_kind():
    simulation = dtype_of(MissionConfig)["simulation"]
    assert simulation["seed"] == np.int64
    assert simulation["time_step"] == np.float64


def test_the_largest_seed_fits():
    simulation = MissionConfig().simulation.model_copy(update={"seed": 2**63 - 1})
    assert record_of(MissionConfig().model_copy(update={"simulation": simulation}))["simulation"]["seed"] == 2**63 - 1
