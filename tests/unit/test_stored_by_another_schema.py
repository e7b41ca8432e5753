"""What version 0.1.0 stored, read by copies of today's code whose schemas have changed.

In each copy a field of the tick, a measure, parameters and a field of the outcome are added, renamed or removed, with
the lines in `sim/schema_history.py` that this takes. Every value that was stored has to come out of it all the same.
"""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import sqlite3
import subprocess
import sys
import tarfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader

from sim.schema_history import PARAMETER_CHANGES, config_version, todays_name
from sim.stored import leaves

ROOT = Path(__file__).parents[2]
GOLDEN = Path(__file__).parent / "golden" / "data_folder_of_0_1_0.tar.xz"
STOPPED, TIMED_OUT = "20261130T011241700-531511", "20261130T011309033-9055c9"
RUNS = [STOPPED, TIMED_OUT, "20261130T011310723-e1e036"]

_KINDS = {"int64": "<i8", "float64": "<f8", "uint8": "u1", "uint16": "<u2", "uint32": "<u4"}

READ_ALL = """
import hashlib, json, sys
from pathlib import Path

import numpy as np

import sim
from server.library.export import Span, exported
from server.library.presets import PresetStore
from server.library.index import RunIndex, RunQuery
from server.library.runs import RunStore
from server.studies.store import StudyStore
from sim import configurations
from sim.capture.tick import column_values
from sim.stored import read_parameters_file

assert Path(sim.__file__).is_relative_to(Path(__file__).parent), sim.__file__
configurations.require_clear_start = lambda config: None  # would compile; nothing is flown from here


def digest(values):
    return hashlib.sha256(np.ascontiguousarray(values).tobytes()).hexdigest()


def run(reader):
    kept = list(reader.stored_chunks())
    ticks = np.concatenate([chunk.ticks for chunk in kept])
    layout = reader.layout()
    table = b"".join(exported(reader, "csv")).decode().splitlines()
    lines = [line for line in table if line[0] != "#"]
    span = b"".join(exported(reader, "mcap", Span(0.0, 0.01)))
    return {
        "count": len(ticks),
        "known": {stored.name: [column.name, digest(column_values(ticks, column))] for stored, column in layout.known},
        "absent": {each.name: column_values(ticks, each)[-1].item() for each in layout.absent},
        "further": {
            each.name: digest(np.concatenate([layout.values(chunk.payloads, each) for chunk in kept]))
            for each in layout.further
        },
        "csv": dict(zip(lines[0].split(","), lines[-1].split(","), strict=True)),
        "span": span.hex(),
        "outcome": reader.record.outcome and reader.record.outcome.model_dump(mode="json"),
        "config": reader.record.config.model_dump(mode="json"),
        "notices": [*reader.record.notices, *reader.log_notices],
        "interventions": [[each.tick, each.command, each.changes] for each in reader.history().interventions],
    }


data = Path(sys.argv[1])
store, studies = RunStore(data / "runs"), StudyStore(data / "studies")
index = RunIndex(store)
(study,) = studies.newest()
table = studies.rows(study)
(preset,) = PresetStore(data).presets()
file = read_parameters_file(data / "soft.toml")
found = {
    "ids": index.find(RunQuery(), 10).ids,
    "unreadable": index.unreadable(),
    "runs": {reader.record.id: run(reader) for reader in store.newest()},
    "study": {"count": study.study.count, "varied": study.study.varied, "notices": study.notices},
    "columns": [each.name for each in table.columns],
    "rows": list(table.rows()),
    "after": [each.row for each in table.rows_after(2, 1)],
    "preset": {"changes": preset.changes, "notices": preset.notices, "config": preset.config().model_dump(mode="json")},
    "file": {
        "values": file.values,
        "notices": file.notices,
        "config": configurations.revised(configurations.named_configuration("published"), file.values).model_dump(),
    },
}
print(json.dumps(found))
"""


PUBLISHED = "sim/method/published/parameters.py"


class Tree:
    """A copy of the code, to be changed."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for room in ("sim", "server"):
            shutil.copytree(ROOT / room, folder / room, ignore=shutil.ignore_patterns("static", "__pycache__"))

    def change(self, path: str, pattern: str, replacement: str) -> None:
        """Replace every match in a file; there has to be one."""
        file = self.folder / path
        text, count = re.subn(pattern, replacement, file.read_text(), flags=re.MULTILINE)
        assert count, f"{path} has no {pattern}"
        file.write_text(text)

    def note(self, table: str, *lines: str) -> None:
        """Add lines at the end of a table of `sim/schema_history.py`."""
        entries = "".join(f"\n    {line}," for line in lines)
        table = rf"(?s)^({table}: tuple\[Change, \.\.\.\] = \()(.*?)(\)\n\"\"\")"
        self.change("sim/schema_history.py", table, rf"\g<1>\g<2>{entries}\n\g<3>")

    def read(self, data: Path) -> Any:
        """What the copy reads in a data folder of its own."""
        own = self.folder / "data"
        shutil.copytree(data, own)
        script = self.folder / "read_all.py"
        script.write_text(READ_ALL)
        done = subprocess.run(
            [sys.executable, str(script), str(own)], capture_output=True, text=True, timeout=120, check=False
        )
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data_of_0_1_0")
    with tarfile.open(GOLDEN) as archive:
        archive.extractall(folder, filter="data")
    return folder


@pytest.fixture(scope="module")
def added(data: Path, tmp_path_factory: pytest.TempPathFactory) -> Any:
    tree = Tree(tmp_path_factory.mktemp("added"))
    tree.change(
        "sim/capture/tick.py",
        r'^    Quantity\("plan", .*$',
        r'\g<0>\n    Quantity("grasped", "mission", "u1"),'
        r'\n    Quantity("perceived_target_pose", "target", "f8", POSE_AXES),',
    )
    tree.change("sim/study/run.py", r"^MEASURES = \(", r'\g<0>\n    Column("wobble", float, "rad", "Of the target"),')
    tree.change(
        PUBLISHED,
        r"^class TouchConfig.*\n.*\n",
        r'\g<0>\n    patience: Number = parameter(0.5, "Longest wait", unit="s", source="chosen", gt=0, le=9)',
    )
    tree.change("sim/snapshot.py", r"^    caged: bool .*$", r"\g<0>\n    wobble: float | None = None")
    return tree.read(data)


@pytest.fixture(scope="module")
def renamed(data: Path, tmp_path_factory: pytest.TempPathFactory) -> Any:
    tree = Tree(tmp_path_factory.mktemp("renamed"))
    tree.change("sim/capture/tick.py", r'"hand_wrench"', '"true_hand_wrench"')
    for path in (tree.folder / "server").rglob("*.py"):  # wherever it is read
        path.write_text(path.read_text().replace('"hand_wrench"', '"true_hand_wrench"'))
    tree.change("sim/capture/tick.py", r'"closed"', '"truly_closed"')
    tree.note("TICK_CHANGES", 'renamed("hand_wrench", "true_hand_wrench")', 'renamed("closed", "truly_closed")')
    tree.change("sim/study/run.py", r'Column\("peak_tip_force",', 'Column("largest_tip_force",')
    tree.note("MEASURE_CHANGES", 'renamed("peak_tip_force", "largest_tip_force")')
    tree.change(PUBLISHED, r"^    impedance: ImpedanceConfig", "    compliance: ImpedanceConfig")
    tree.change(PUBLISHED, r"^    absorb_time: ", "    settling_time: ")
    tree.change("sim/configurations.py", r"impedance=ImpedanceConfig", "compliance=ImpedanceConfig")
    tree.change("sim/reproduction/published.py", r'"published\.impedance\.', '"published.compliance.')
    tree.note(
        "PARAMETER_CHANGES",
        'renamed("published.impedance", "published.compliance")',
        'renamed("published.touch.absorb_time", "published.touch.settling_time")',
    )
    tree.change("sim/snapshot.py", r"^    closed_at: ", "    first_closed_at: ")
    tree.note("RECORD_CHANGES", 'renamed("outcome.closed_at", "outcome.first_closed_at")')
    return tree.read(data)


@pytest.fixture(scope="module")
def removed(data: Path, tmp_path_factory: pytest.TempPathFactory) -> Any:
    tree = Tree(tmp_path_factory.mktemp("removed"))
    for name in ("base_contact", "mount_rate"):
        tree.change("sim/capture/tick.py", rf'^    Quantity\("{name}".*\n', "")
    tree.note("TICK_CHANGES", 'removed("mount_rate", "hands do not yield")')
    tree.change("sim/study/run.py", r'^    Column\("base_turn".*\n', "")
    tree.note("MEASURE_CHANGES", 'removed("base_turn", "the base is held")')
    tree.change(PUBLISHED, r"^    damping: Number = parameter\(\n        1\.5.*\n    \)\n", "")
    tree.change(PUBLISHED, r"^    absorb_time: Number = parameter\((\n        .*)+\n    \)\n", "")
    tree.change("sim/configurations.py", r", damping=[0-9.]+", "")
    tree.change("sim/reproduction/published.py", r"^ +DAMPING: .*\n", "")
    tree.note(
        "PARAMETER_CHANGES",
        'removed("published.impedance.damping", "hands have no damping")',
        'removed("published.touch.absorb_time", "plans follow at once")',
    )
    tree.change("sim/snapshot.py", r"^    momentum_error: float = Field\(\n.*\n    \)\n", "")
    tree.note("RECORD_CHANGES", 'removed("outcome.momentum_error", "it is always zero")')
    return tree.read(data)


def _stored_columns(data: Path, run_id: str) -> dict[str, np.ndarray[Any, np.dtype[Any]]]:
    """Every column of a run by its name in the log, read by the schema in the log itself."""
    with (data / "runs" / run_id / "log.mcap").open("rb") as file:
        found = [
            (schema, message.data)
            for schema, _, message in make_reader(file).iter_messages(topics=["/becalm/tick"])
            if schema is not None
        ]
    lines = [line.split("#")[0].split() for line in found[0][0].data.decode().splitlines()]
    fields = [(line[1], _KINDS[line[0]]) for line in lines if len(line) == 2]
    ticks = np.frombuffer(b"".join(data[4:] for _, data in found), np.dtype(fields, align=True))
    return {name: ticks[name] for name, _ in fields}


def _under_todays_names(stored: dict[str, Any]) -> dict[str, Any]:
    """By path of today, where it is a parameter's."""
    return {todays_name(name, PARAMETER_CHANGES) or name: value for name, value in stored.items()}


def _digest(values: np.ndarray[Any, np.dtype[Any]]) -> str:
    return hashlib.sha256(np.ascontiguousarray(values).tobytes()).hexdigest()


def _require_same_ticks(data: Path, run_id: str, run: Any) -> None:
    """Every stored column is read to the last bit: as one of today, or as one that only the log has."""
    stored = _stored_columns(data, run_id)
    for name, values in stored.items():
        if name in run["further"]:
            assert run["further"][name] == _digest(values), name
            assert float(run["csv"][name]) == values[-1], name
        else:
            column, digest = run["known"][name]
            assert digest == _digest(values), name
            assert float(run["csv"][column]) == values[-1], name
    assert run["count"] == len(stored["tick"])


def _stored_rows(data: Path) -> list[dict[str, Any]]:
    (path,) = data.glob("studies/*/rows.sqlite")
    with sqlite3.connect(path) as connection:
        connection.row_factory = sqlite3.Row
        rows = [dict(row) for row in connection.execute("SELECT * FROM cells ORDER BY cell")]
    for row in rows:
        row["caged"] = None if row["caged"] is None else bool(row["caged"])
        del row["sequence"]
    assert len(rows) == 4
    return rows


def _stored_record(data: Path, run_id: str) -> Any:
    return json.loads((data / "runs" / run_id / "run.json").read_text())


class TestAdded:
    def test_runs_are_found_and_their_ticks_are_those_that_were_stored(self, data: Path, added: Any) -> None:
        assert (sorted(added["ids"]), added["unreadable"]) == (RUNS, {})
        for run_id in RUNS:
            _require_same_ticks(data, run_id, added["runs"][run_id])

    def test_what_the_log_lacks_is_no_number_and_is_said(self, added: Any) -> None:
        for run in added["runs"].values():
            missing = [f"target.perceived_target_pose.{axis}" for axis in ("x", "y", "angle")]
            assert run["absent"]["mission.grasped"] == 0
            assert all(np.isnan(run["absent"][name]) for name in missing)
            assert run["csv"]["mission.grasped"] == run["csv"][missing[0]] == ""
            assert "its log, of another version, has no " in run["notices"][-1]
            assert ", ".join(["mission.grasped", *missing]) in run["notices"][-1]

    def test_a_measure_that_a_table_lacks_is_absent_not_its_own_name(self, data: Path, added: Any) -> None:
        assert "wobble" in added["columns"]
        rows = [{**_under_todays_names(row), "wobble": None} for row in _stored_rows(data)]
        assert [{name: read[name] for name in rows[0]} for read in added["rows"]] == rows

    def test_a_parameter_and_a_field_of_the_outcome_have_their_defaults(self, data: Path, added: Any) -> None:
        run, stored = added["runs"][TIMED_OUT], _stored_record(data, TIMED_OUT)
        assert run["config"]["published"]["touch"].pop("patience") == 0.5
        assert run["config"].pop("version") == config_version()
        read = leaves(run["config"])
        chosen = _under_todays_names(leaves(stored["config"]))
        assert {path: read[path] for path in chosen} == chosen
        assert {name: run["outcome"][name] for name in stored["outcome"]} == stored["outcome"]
        assert run["outcome"]["wobble"] is None
        assert added["preset"]["config"]["published"]["impedance"]["damping"] == 3.0


class TestRenamed:
    def test_ticks_are_found_under_their_names_of_today(self, data: Path, renamed: Any) -> None:
        assert (sorted(renamed["ids"]), renamed["unreadable"]) == (RUNS, {})
        for run_id in RUNS:
            run = renamed["runs"][run_id]
            _require_same_ticks(data, run_id, run)
            assert run["known"]["closed"][0] == "mission.truly_closed"
            assert run["known"]["right_hand_wrench_torque"][0] == "right.true_hand_wrench.torque"
            assert not {"mission.truly_closed", "left.true_hand_wrench.x"} & run["absent"].keys()
            assert not {"closed", "left_hand_wrench_x"} & run["further"].keys()

    def test_a_part_of_a_log_keeps_the_schema_of_its_ticks(self, data: Path, renamed: Any, tmp_path: Path) -> None:
        part = tmp_path / "runs" / STOPPED / "log.mcap"
        part.parent.mkdir(parents=True)
        part.write_bytes(bytes.fromhex(renamed["runs"][STOPPED]["span"]))
        whole = _stored_columns(data, STOPPED)
        wanted = whole["time"] <= 0.01 + 1e-6
        assert wanted.any()
        for name, values in _stored_columns(tmp_path, STOPPED).items():
            assert values.tobytes() == whole[name][wanted].tobytes(), name

    def test_measures_and_varied_parameters_too(self, data: Path, renamed: Any) -> None:
        names = {
            "peak_tip_force": "largest_tip_force",
            "control.impedance.damping": "published.compliance.damping",
        }
        expected = [{names.get(name, name): value for name, value in row.items()} for row in _stored_rows(data)]
        assert [{name: read[name] for name in expected[0]} for read in renamed["rows"]] == expected
        assert renamed["study"]["varied"] == ["target.initial_spin", "published.compliance.damping"]
        assert len(renamed["after"]) == 1

    def test_parameters_are_where_they_are_today(self, data: Path, renamed: Any) -> None:
        stored = _stored_record(data, STOPPED)["config"]["control"]
        run = renamed["runs"][STOPPED]
        assert run["config"]["published"]["compliance"] == stored["impedance"]
        assert run["config"]["published"]["touch"]["settling_time"] == stored["touch"]["absorb_time"]
        assert run["config"]["version"] == config_version() + 2
        assert [121, None, {"published.compliance.damping": 1.5}] in run["interventions"]
        assert renamed["preset"]["changes"] == {"published": {"compliance": {"damping": 3.0, "stiffness": 5.0}}}
        assert renamed["preset"]["config"]["published"]["compliance"] == {"mass": 0.2, "damping": 3.0, "stiffness": 5.0}
        assert renamed["file"]["config"]["published"]["touch"]["settling_time"] == 0.4
        assert renamed["file"]["config"]["published"]["compliance"]["mass"] == 0.05

    def test_the_outcome_is_whole(self, data: Path, renamed: Any) -> None:
        stored = _stored_record(data, TIMED_OUT)["outcome"]
        stored["first_closed_at"] = stored.pop("closed_at")
        outcome = renamed["runs"][TIMED_OUT]["outcome"]
        assert {name: outcome[name] for name in stored} == stored
        assert "closed_at" not in outcome


class TestRemoved:
    def test_columns_that_are_gone_stay_in_the_log_and_its_exports(self, data: Path, removed: Any) -> None:
        assert (sorted(removed["ids"]), removed["unreadable"]) == (RUNS, {})
        gone = ("base_contact", "left_mount_rate", "right_mount_rate")
        for run_id in RUNS:
            _require_same_ticks(data, run_id, removed["runs"][run_id])
            assert set(gone) <= removed["runs"][run_id]["further"].keys()

    def test_a_table_keeps_its_measures_and_what_it_varied(self, data: Path, removed: Any) -> None:
        rows = [_under_todays_names(row) for row in _stored_rows(data)]
        assert [{name: read[name] for name in rows[0]} for read in removed["rows"]] == rows
        assert "base_turn" in removed["columns"]
        assert removed["study"] == {
            "count": 4,
            "varied": ["target.initial_spin", "published.impedance.damping"],
            "notices": [],
        }

    def test_parameters_are_ignored_and_whoever_reads_is_told_why(self, removed: Any) -> None:
        damping = "control.impedance.damping is ignored: hands have no damping"
        absorbing = "control.touch.absorb_time is ignored: plans follow at once"
        run = removed["runs"][STOPPED]
        assert {damping, absorbing} <= set(run["notices"])
        assert run["config"]["published"]["impedance"] == {"mass": 0.2, "stiffness": 0.1}
        assert run["interventions"][1] == [121, None, {}]
        assert removed["preset"]["notices"] == [damping]
        assert removed["preset"]["config"]["published"]["impedance"] == {"mass": 0.2, "stiffness": 5.0}
        assert [notice.split(": ", 1)[1] for notice in removed["file"]["notices"]] == [damping, absorbing]
        assert removed["file"]["config"]["published"]["impedance"]["mass"] == 0.05

    def test_the_rest_of_the_outcome_is_whole(self, data: Path, removed: Any) -> None:
        run, stored = removed["runs"][TIMED_OUT], _stored_record(data, TIMED_OUT)["outcome"]
        del stored["momentum_error"]
        assert {name: run["outcome"][name] for name in stored} == stored
        assert "momentum_error" not in run["outcome"]
        assert "outcome.momentum_error is ignored: it is always zero" in run["notices"]
