"""A scripted run in the process that flies it."""

from __future__ import annotations

import sys

import pytest

from server.library import scripted
from server.library.runs import RunStore, new_record
from server.process.realtime import SWITCH_INTERVAL
from sim.config import Engine, MissionConfig
from sim.configurations import revised
from sim.errors import PlantDiverged


def test_what_it_runs_is_compiled_before_its_time_is_taken(tmp_path, monkeypatch: pytest.MonkeyPatch):
    config = revised(MissionConfig(), {"method": "co_moving_couple", "simulation": {"engine": Engine.REDUCED}})
    seen = []

    def flown(mission, **_):
        seen.append(("flown", mission.config))
        raise PlantDiverged("enough")

    monkeypatch.setattr(scripted, "prepare", lambda config: seen.append(("prepared", config)))
    monkeypatch.setattr(scripted, "fly_to_verdict", flown)
    store = RunStore(tmp_path)
    record = new_record("scripted", "becalm", config)
    store.create(record)
    assert scripted.fly(store, record).status == "failed"
    assert seen == [("prepared", config), ("flown", config)]


def test_whose_process_it_is_decides_how_its_threads_take_turns(tmp_path, monkeypatch: pytest.MonkeyPatch):
    def flown(_mission, **_):
        raise PlantDiverged("enough")

    monkeypatch.setattr(scripted, "prepare", lambda _: None)
    monkeypatch.setattr(scripted, "fly_to_verdict", flown)
    before = sys.getswitchinterval()
    store = RunStore(tmp_path)
    record = new_record("scripted", "becalm", MissionConfig())
    store.create(record)
    sys.setswitchinterval(2 * SWITCH_INTERVAL)
    try:
        scripted.fly(store, record)
        assert sys.getswitchinterval() == pytest.approx(2 * SWITCH_INTERVAL)
    finally:
        sys.setswitchinterval(before)
