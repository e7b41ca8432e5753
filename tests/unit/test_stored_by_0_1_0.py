"""What version 0.1.0 stored, read by this one: runs, a study, a preset and a configuration file, as it left them.

The numbers to compare with come from the files themselves, by ways that are not Becalm's: the ticks by their schema as
ROS 2 lays it out, the table by SQLite.
"""

from __future__ import annotations

import json
import sqlite3
import tarfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader

from server.library.index import RunIndex, RunQuery
from server.library.presets import PresetStore
from server.library.runs import RunStore
from server.studies.store import StudyStore
from sim.capture.tick import column_values
from sim.configurations import named_configuration, revised
from sim.schema_history import PARAMETER_CHANGES, todays_name
from sim.stored import read_parameters_file

GOLDEN = Path(__file__).parent / "golden" / "data_folder_of_0_1_0.tar.xz"
STOPPED = "20261130T011241700-531511"
"""A live mission with edited parameters, granted a capture, edited in flight and stopped; with a star and a note."""
TIMED_OUT = "20261130T011309033-9055c9"
"""A headless one with an outcome."""
RUNS = [STOPPED, TIMED_OUT, "20261130T011310723-e1e036"]

_KINDS = {"int64": "<i8", "float64": "<f8", "uint8": "u1", "uint16": "<u2", "uint32": "<u4"}


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data_of_0_1_0")
    with tarfile.open(GOLDEN) as archive:
        archive.extractall(folder, filter="data")
    return folder


def _columns_by_schema(log: Path) -> dict[str, np.ndarray[Any, np.dtype[Any]]]:
    """Every field of every tick, by the schema in the log itself (CDR: each value at a multiple of its size)."""
    with log.open("rb") as file:
        found = [
            (schema, message.data)
            for schema, _, message in make_reader(file).iter_messages(topics=["/becalm/tick"])
            if schema is not None
        ]
    lines = [line.split("#")[0].split() for line in found[0][0].data.decode().splitlines()]
    fields = [(line[1], _KINDS[line[0]]) for line in lines if len(line) == 2]
    layout = np.dtype(fields, align=True)
    ticks = np.frombuffer(b"".join(data[4:].ljust(layout.itemsize, b"\0") for _, data in found), layout)
    return {name: ticks[name] for name, _ in fields}


@pytest.mark.parametrize("run_id", RUNS)
def test_every_tick_of_a_run_is_read_to_the_last_bit(data: Path, run_id: str) -> None:
    reader = RunStore(data / "runs").read(run_id)
    stored = _columns_by_schema(reader.log_path)
    ticks = np.concatenate(list(reader.chunks()))
    assert len(ticks) == reader.tick_count == reader.record.ticks == len(stored["tick"])
    layout = reader.layout()
    read = {each.name: column_values(ticks, column) for each, column in layout.known}
    kept = [chunk.payloads for chunk in reader.stored_chunks()]
    read |= {each.name: np.concatenate([layout.values(chunk, each) for chunk in kept]) for each in layout.further}
    for name, values in stored.items():
        assert read[name].tobytes() == values.tobytes(), name


def test_a_live_mission_keeps_its_story(data: Path) -> None:
    reader = RunStore(data / "runs").read(STOPPED)
    assert (reader.record.status, reader.record.configuration) == ("cancelled", "published_figures (edited)")
    assert reader.record.config.published.impedance.damping == 3.0
    history = reader.history()
    assert [(each.tick, each.command, each.changes) for each in history.interventions] == [
        (1, "capture", {}),
        (121, None, {"published.impedance.damping": 1.5}),
        (201, "stop", {}),
    ]
    assert reader.remarks.starred
    assert [(note.time, note.text) for note in reader.remarks.notes] == [(0.1, "the first soft touch")]


def test_an_outcome_is_read_whole(data: Path) -> None:
    folder = data / "runs" / TIMED_OUT
    stored = json.loads((folder / "run.json").read_text())["outcome"]
    outcome = RunStore(data / "runs").read(TIMED_OUT).record.outcome
    assert outcome is not None
    read = outcome.model_dump(mode="json")
    assert {name: read[name] for name in stored} == stored
    assert stored["outcome"] == "unresolved"
    assert stored["duration"] == 0.3


def test_the_library_lists_all_of_them(data: Path) -> None:
    index = RunIndex(RunStore(data / "runs"))
    assert sorted(index.find(RunQuery(), 10).ids) == RUNS
    assert index.unreadable() == {}


def test_every_value_of_a_study_is_read(data: Path) -> None:
    store = StudyStore(data / "studies")
    (record,) = store.newest()
    assert (record.name, record.status, record.study.count) == ("two spins", "finished", 4)
    with sqlite3.connect(store.table_path(record.id)) as connection:
        connection.row_factory = sqlite3.Row
        stored = [dict(row) for row in connection.execute("SELECT * FROM cells ORDER BY cell")]
    rows = list(store.rows(record).rows())
    assert len(rows) == len(stored) == 4
    for row, kept in zip(rows, stored, strict=True):
        kept.pop("sequence")
        today = {todays_name(name, PARAMETER_CHANGES) or name: value for name, value in kept.items()}
        assert {name: row[name] for name in today} == today


def test_a_preset_is_read_and_can_be_flown(data: Path) -> None:
    (preset,) = PresetStore(data).presets()
    assert (preset.name, preset.who) == ("soft hands", "operator")
    impedance = preset.config().published.impedance
    assert (impedance.mass, impedance.damping, impedance.stiffness) == (0.2, 3.0, 5.0)


def test_a_configuration_file_is_read(data: Path) -> None:
    config = revised(named_configuration("published"), read_parameters_file(data / "soft.toml").values)
    assert config.published.impedance.mass == 0.05
    assert config.published.touch.absorb_time == 0.4
    assert config.target.initial_spin == 0.8
    assert config.perception.noise.position == 5e-4
