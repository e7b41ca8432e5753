"""Runs: recorded every tick, downloaded to the last bit, scripted, listed, removed."""

from __future__ import annotations

import io
import json

import numpy as np
import pyarrow.csv
import pyarrow.parquet
import pytest
from click.testing import CliRunner
from mcap.reader import make_reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from becalm.cli import main
from server.library.record import RunRecord
from sim.capture.replay import controlled, first_difference, rerun
from sim.capture.run import run_capture
from sim.capture.tick import COLUMNS, TICK, column_values
from sim.config import MissionConfig
from sim.configurations import named_configuration, revised


async def _captured(console) -> str:
    await console.granted("run", speed=0)
    await console.granted("direct_cage")
    snapshot = await console.until(lambda snapshot: snapshot.outcome is not None)
    await console.until_run(snapshot.run_id, "finished")
    return snapshot.run_id


def _same_bits(table, ticks) -> None:
    assert table.num_rows == len(ticks)
    for column in COLUMNS:
        read = np.asarray(table.column(column.name).to_numpy(), dtype=ticks[column.quantity].dtype)
        assert read.tobytes() == np.ascontiguousarray(column_values(ticks, column)).tobytes(), column.name


def _same_numbers(log, ticks) -> None:
    """By the reference reader, and as ROS 2 decodes them."""
    types = get_typestore(Stores.ROS2_HUMBLE)
    reader = make_reader(log, validate_crcs=True)
    seen, topics = 0, set()
    for schema, channel, message in reader.iter_messages():
        topics.add(channel.topic)
        if schema.name not in types.types:
            types.register(get_types_from_msg(schema.data.decode(), schema.name))
        decoded = types.deserialize_cdr(message.data, schema.name)
        if channel.topic == "/becalm/tick":
            for column in COLUMNS:
                name = column.name.removeprefix("mission.").replace(".", "_")
                assert getattr(decoded, name) == column_values(ticks[seen : seen + 1], column)[0]
            seen += 1
    assert seen == len(ticks)
    assert topics >= {"/tf", "/joint_states", "/left_hand/wrench", "/target/pose", "/scene", "/rosout"}
    assert {"becalm.run", "becalm.outcome"} <= {record.name for record in reader.iter_metadata()}
    (attached, *_) = reader.iter_attachments()
    MissionConfig.model_validate_json(attached.data)


async def test_part_of_a_log_and_what_lies_outside(console):
    run_id = await _captured(console)
    for log_format in ("parquet", "mcap", "csv"):
        part = {"format": log_format, "from": 3.2, "to": 3.5}
        assert (await console.http.get(f"/runs/{run_id}/log", params=part)).status_code == 200
    answer = await console.http.get(f"/runs/{run_id}/log", params={"format": "parquet", "from": 3.2, "to": 3.5})
    times = pyarrow.parquet.read_table(io.BytesIO(answer.content)).column("mission.time").to_numpy()
    assert (times[0], times[-1], len(times)) == (pytest.approx(3.2), pytest.approx(3.5), 301)
    for bad in ({"from": 1e5}, {"from": 3, "to": 2}, {"from": -1}):
        answer = await console.http.get(f"/runs/{run_id}/log", params=bad)
        assert answer.status_code == 422
        assert answer.json()["tip"]


async def test_live_run_is_recorded_tick_by_tick(console):
    run_id = await _captured(console)
    ticks = np.concatenate(list(console.services.store.read(run_id).chunks()))
    assert ticks.dtype == TICK
    assert ticks["tick"][0] == 0
    assert (np.diff(ticks["tick"][1:]) == 1).all()  # without a gap from the first command on
    run = (await console.http.get(f"/runs/{run_id}")).json()
    assert run["kind"] == "live"
    assert run["ticks"] == len(ticks)
    assert run["outcome"]["contacts"]
    assert run["config"]["published"]["impedance"]["damping"] == 0.1
    assert set(run["versions"]) >= {"becalm", "python", "pymunk", "numpy", "numba"}


@pytest.mark.parametrize("log_format", ["csv", "parquet", "mcap"])
async def test_log_reads_back_bit_for_bit(console, log_format):
    run_id = await _captured(console)
    ticks = np.concatenate(list(console.services.store.read(run_id).chunks()))
    answer = await console.http.get(f"/runs/{run_id}/log", params={"format": log_format})
    assert f'filename="becalm-{run_id}.{log_format}"' in answer.headers["content-disposition"]
    if log_format == "mcap":
        _same_numbers(io.BytesIO(answer.content), ticks)
        return
    if log_format == "parquet":
        table = pyarrow.parquet.read_table(io.BytesIO(answer.content))
        assert all(table.schema.field(column.name).metadata[b"unit"].decode() == column.unit for column in COLUMNS)
    else:
        lines = answer.content.splitlines(keepends=True)
        comments = [line for line in lines if line.startswith(b"#")]
        assert f"# {COLUMNS[1].name} [{COLUMNS[1].unit}]\n".encode() in comments
        table = pyarrow.csv.read_csv(io.BytesIO(b"".join(lines[len(comments) :])))
    _same_bits(table, ticks)


async def test_log_of_a_run_in_progress(console):
    await console.granted("run", speed=0.1)  # it is in progress for more than a minute
    await console.granted("capture")
    run_id = (await console.snapshot())["run_id"]
    reader = console.services.store.read(run_id)
    await console.until(lambda _: reader.tick_count > 100)
    answer = await console.http.get(f"/runs/{run_id}/log", params={"format": "parquet"})
    table = pyarrow.parquet.read_table(io.BytesIO(answer.content))
    assert table.num_rows > 100
    assert (await console.snapshot())["outcome"] is None


async def test_mission_that_never_moved_leaves_no_run(console):
    idle = (await console.snapshot())["run_id"]
    await console.granted("reset")
    await console.granted("capture")
    await console.until_run((await console.snapshot())["run_id"], "running")
    assert (await console.http.get(f"/runs/{idle}")).status_code == 404


async def test_reset_in_the_middle_keeps_the_run_as_cancelled(console):
    await console.granted("capture")
    run_id = (await console.snapshot())["run_id"]
    await console.granted("reset")
    run = await console.until_run(run_id, "cancelled")
    assert run["outcome"] is None
    assert run["note"] == "ended by reset"


async def test_a_second_sequence_leaves_the_outcome_of_the_first_in_the_run(console):
    await console.granted("reset", configuration="published", changes={"judging": {"time_limit": 0.2}})
    await console.granted("run", speed=0)
    await console.granted("capture")
    first = await console.until(lambda snapshot: snapshot.outcome is not None)
    await console.granted("capture")
    second = await console.until(lambda snapshot: snapshot.outcome is not None)
    assert first.run_id == second.run_id
    of_first, of_second = (each.outcome.model_dump(mode="json") for each in (first, second))
    assert of_first != of_second
    run = await console.until_kept(first.run_id, lambda run: run["outcome"] == of_second)
    assert run["earlier_outcomes"] == [of_first]


PUBLISHED = {"configuration": "published"}


async def test_scripted_run_equals_the_command_line_and_the_library(console):
    changes = {"published": {"impedance": {"damping": 3.0}}}
    answer = await console.http.post("/runs", json={**PUBLISHED, "changes": changes, "direct": True, "seed": 7})
    assert answer.status_code == 202
    assert answer.json()["status"] in ("queued", "running")
    run = await console.until_run(answer.json()["id"], "finished", "failed")
    assert run["status"] == "finished", run["note"]
    arguments = [
        "run",
        "--configuration",
        "published",
        "--json",
        "--direct",
        "--seed",
        "7",
        "--set",
        "published.impedance.damping=3.0",
    ]
    printed = json.loads(CliRunner().invoke(main, arguments).stdout)
    for name, value in run["outcome"].items():
        assert printed[name] == value, name
    assert printed["config"] == run["config"]
    flown = []
    config = revised(named_configuration("published"), {**changes, "simulation": {"seed": 7}})
    result = run_capture(config, direct=True, on_ticks=flown.append)
    assert result.outcome.model_dump(mode="json") == run["outcome"]
    recorded = np.concatenate(list(console.services.store.read(run["id"]).chunks()))
    assert recorded.tobytes() == np.concatenate(flown).tobytes()


async def test_bad_scripted_run_starts_nothing(console):
    for body, field in [
        ({"changes": {"target": {"mass": -1}}}, "target.mass"),
        ({"configuration": "nonesuch"}, "configuration"),
        ({"seed": -1}, "seed"),
        ({"speed": 1}, "speed"),
    ]:
        answer = await console.http.post("/runs", json=body)
        assert answer.status_code == 422
        assert answer.json()["errors"][0]["field"] == field
    listed = (await console.http.get("/runs")).json()["runs"]
    assert [run for run in listed if run["kind"] == "scripted"] == []


async def test_scripted_run_is_cancelled_then_removed(console):
    """A run that would take minutes: it is ended while it waits or flies, and stays listed until it is removed."""
    changes = {"judging": {"time_limit": 3600.0}, "target": {"initial_spin": 0.0, "initial_y": 0.6}}
    body = {**PUBLISHED, "changes": changes, "direct": False}
    runs = [(await console.http.post("/runs", json=body)).json()["id"] for _ in range(2)]
    for run_id in reversed(runs):  # first the one that waits
        assert (await console.http.delete(f"/runs/{run_id}")).status_code == 409
        assert (await console.http.post(f"/runs/{run_id}/cancel")).status_code == 202
    for run_id in runs:
        await console.until_run(run_id, "cancelled", "finished")
        assert (await console.http.delete(f"/runs/{run_id}")).status_code == 204
    listed = (await console.http.get("/runs")).json()["runs"]
    assert [run for run in listed if run["kind"] == "scripted"] == []


async def test_a_disk_that_fails_is_a_problem_on_the_page_and_the_mission_flies_on(console, monkeypatch):
    def full(_writer, _ticks):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("server.library.writer.RunWriter.append", full)
    await console.granted("capture")
    shown = await console.until(lambda snapshot: any("recorded" in each.title for each in snapshot.problems))
    (problem,) = [each for each in shown.problems if "recorded" in each.title]
    assert "No space left" in problem.message
    assert "disk" in problem.tip
    await console.until(lambda snapshot: snapshot.tick > shown.tick + 20)


async def test_queue_is_bounded(console, monkeypatch):
    monkeypatch.setattr("server.library.scripted.CAPACITY", 0)
    answer = await console.http.post("/runs", json={})
    assert answer.status_code == 503
    assert answer.headers["retry-after"]


async def test_library_is_paged_newest_first(console):
    store = console.services.store
    await console.granted("pause")
    made = []
    for second in range(5):
        record = _record(second)
        store.create(record)
        made.append(record.id)
    first = (await console.http.get("/runs", params={"limit": 2, "cursor": "2021"})).json()
    second = (await console.http.get("/runs", params={"limit": 2, "cursor": first["next_cursor"]})).json()
    last = (await console.http.get("/runs", params={"limit": 2, "cursor": second["next_cursor"]})).json()
    assert [run["id"] for page in (first, second, last) for run in page["runs"]] == made[::-1]
    assert last["next_cursor"] is None


def _record(second: int) -> RunRecord:
    return RunRecord(
        id=f"20200101T00000{second}000-abcdef",
        kind="scripted",
        status="finished",
        configuration="published",
        config=named_configuration("published"),
        started=f"2020-01-01T00:00:0{second}+00:00",
    )


async def test_ended_run_is_removed_and_the_live_one_is_not(console):
    record = _record(1)
    console.services.store.create(record)
    assert (await console.http.delete(f"/runs/{record.id}")).status_code == 204
    assert (await console.http.get(f"/runs/{record.id}")).status_code == 404
    live = (await console.snapshot())["run_id"]
    assert (await console.http.delete(f"/runs/{live}")).status_code == 409


@pytest.mark.parametrize("run_id", ["20200101T000000000-abcdef", "nonesuch", "..", "%2e%2e"])
@pytest.mark.parametrize("resource", ["", "/log", "/events", "/report"])
async def test_unknown_run_is_not_found(console, run_id, resource):
    answer = await console.http.get(f"/runs/{run_id}{resource}")
    assert answer.status_code == 404
    assert answer.headers["content-type"] == "application/problem+json"


async def test_unknown_format_is_refused(console):
    live = (await console.snapshot())["run_id"]
    answer = await console.http.get(f"/runs/{live}/log", params={"format": "xlsx"})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["field"] == "format"


async def test_live_run_is_flown_again_from_its_own_log(console):
    """Commands and edits at whatever ticks they came: the log knows which, and the same ticks follow."""
    http = console.http
    await console.granted("run", speed=20)
    await console.until(lambda snapshot: snapshot.tick > 50)
    assert (await http.patch("/mission/config", json={"published": {"impedance": {"damping": 2.0}}})).is_success
    await console.granted("capture")
    await console.until(lambda snapshot: snapshot.tick > 1000)
    assert (await http.patch("/mission/config", json={"published": {"impedance": {"damping": 3.0}}})).is_success
    await console.granted("hold")
    await console.granted("cage")
    await console.granted("run", speed=0)
    snapshot = await console.until(lambda snapshot: snapshot.outcome is not None)
    await console.until_run(snapshot.run_id, "finished")
    reader = console.services.store.read(snapshot.run_id)
    recorded = np.concatenate(list(reader.chunks()))
    end = int(recorded["tick"][-1]) + 1
    again = np.concatenate(list(rerun(reader.history(), end)))
    assert first_difference(recorded, again[recorded["tick"]]) is None
    now = np.concatenate(list(controlled(reader.history(), reader.chunks())))
    assert first_difference(recorded, now) is None


ENDLESS = {"judging": {"time_limit": 3600.0}, "target": {"initial_spin": 0.0, "initial_y": 0.6}}


async def test_what_the_method_does_not_know_starts_nothing(console):
    answer = await console.http.post("/runs", json={"configuration": "becalm", "direct": True})
    assert answer.status_code == 409
    assert "direct_cage is refused: the configured method has no such command" in answer.json()["detail"]
    assert (await console.http.get("/runs", params={"kind": "scripted"})).json()["runs"] == []


async def test_many_runs_at_once_are_queued_all_or_none(console):
    bodies = [{**PUBLISHED, "direct": True, "seed": seed} for seed in (1, 2)]
    answer = await console.http.post("/runs", json=[*bodies, {"changes": {"target": {"mass": -1}}}])
    assert answer.status_code == 422
    assert (await console.http.get("/runs", params={"kind": "scripted"})).json()["runs"] == []
    queued = (await console.http.post("/runs", json=bodies)).json()
    assert [run["seed"] for run in queued] == [1, 2]
    assert {run["engine"] for run in queued} == {"pymunk"}
    for run in queued:
        assert (await console.until_run(run["id"], "finished"))["integrity"] == "complete"


async def test_idempotency_key(console):
    headers = {"Idempotency-Key": "a-script-7"}
    first, again = [
        await console.http.post("/runs", json={**PUBLISHED, "changes": ENDLESS}, headers=headers) for _ in range(2)
    ]
    assert first.json()["id"] == again.json()["id"]
    other = await console.http.post("/runs", json={"seed": 3}, headers=headers)
    assert other.status_code == 409
    assert "a-script-7" in other.json()["detail"]
    assert (await console.http.post(f"/runs/{first.json()['id']}/cancel")).status_code == 202


async def test_log_of_a_run_that_has_none_yet(console):
    record = _record(1).model_copy(update={"status": "queued"})
    console.services.store.create(record)
    answer = await console.http.get(f"/runs/{record.id}/log", params={"format": "mcap"})
    assert answer.status_code == 409
    assert "no log" in answer.json()["detail"]
    assert answer.json()["tip"]


async def test_notes_and_star_against_a_change_meanwhile(console):
    record = _record(1)
    console.services.store.create(record)
    address = f"/runs/{record.id}"
    tag = (await console.http.get(address)).headers["etag"]
    assert (await console.http.get(address, headers={"If-None-Match": tag})).status_code == 304
    note = {"text": "the left hand slips", "time": 3.4, "who": "ana"}
    changed = await console.http.patch(address, json={"starred": True, "notes": [note]}, headers={"If-Match": tag})
    assert changed.status_code == 200
    assert changed.json()["notes"][0]["text"] == "the left hand slips"
    late = await console.http.patch(address, json={"starred": False}, headers={"If-Match": tag})
    assert late.status_code == 412
    assert (await console.http.get(address)).json()["starred"] is True


async def test_name_and_tags_are_kept_listed_and_bounded(console):
    for second in (1, 2):
        console.services.store.create(_record(second))
    address = f"/runs/{_record(1).id}"
    named = (
        await console.http.patch(address, json={"name": " Soft touch ", "tags": ["paper", "paper", "fig 7"]})
    ).json()
    assert (named["name"], named["tags"], named["starred"]) == ("Soft touch", ["paper", "fig 7"], False)
    assert (await console.http.patch(address, json={"starred": True})).json()["tags"] == ["paper", "fig 7"]
    listed = (await console.http.get("/runs", params={"tag": "PAPER"})).json()
    assert ([run["name"] for run in listed["runs"]], listed["total"]) == (["Soft touch"], 1)
    for wrong in ({"tags": ["a,b"]}, {"tags": [" "]}, {"tags": ["x"] * 21}, {"name": "x" * 101}, {"name": "a\nb"}):
        answer = await console.http.patch(address, json=wrong)
        assert (answer.status_code, next(iter(wrong)) in answer.json()["detail"]) == (422, True)
    assert (await console.http.patch(address, json={"name": "", "tags": []})).json()["tags"] == []


async def test_a_run_tells_what_was_changed(console):
    changes = {"published": {"impedance": {"damping": 3.0}}}
    run = (await console.http.post("/runs", json={"configuration": "published", "changes": changes, "seed": 7})).json()
    assert [(each["path"], each["configured"], each["value"], each["unit"]) for each in run["changes"]] == [
        ("published.impedance.damping", 1.5, 3.0, "N s/m")
    ]
    assert run["initial_spin"] == 1.0


@pytest.mark.parametrize(
    ("wanted", "found"),
    [
        ({"kind": "scripted"}, 2),
        ({"starred": True}, 1),
        ({"text": "SLIPS"}, 1),
        ({"configuration": "published_figures"}, 0),
        ({"started_to": "2020-01-01T00:00:01.5"}, 1),
        ({"outcome": "ejection"}, 0),
        ({"parent": "nobody"}, 0),
        ({"status": "failed"}, 0),
    ],
)
async def test_list_is_filtered(console, wanted, found):
    for second in (1, 2):
        console.services.store.create(_record(second))
    body = {"starred": True, "notes": [{"text": "the left hand slips"}]}
    assert (await console.http.patch(f"/runs/{_record(1).id}", json=body)).status_code == 200
    answer = await console.http.get("/runs", params={**wanted, "cursor": "2021"})
    assert len(answer.json()["runs"]) == found


async def test_ticks_for_a_plot(console):
    run_id = await _captured(console)
    peak = max(touch["peak"] for touch in (await console.http.get(f"/runs/{run_id}")).json()["outcome"]["contacts"])
    history = (await console.http.get(f"/runs/{run_id}/ticks", params={"points": 200})).json()
    names = [column["name"] for column in history["columns"]]
    places = [names.index(f"{arm}.hand_force") for arm in ("left", "right")]
    forces = [row[place] for row in history["rows"] for place in places if row[place] is not None]  # null: a gap
    assert max(forces) == pytest.approx(peak, rel=1e-12)
    assert 150 < len(history["rows"]) <= 201
    assert (await console.http.get(f"/runs/{run_id}/ticks", params={"from": 1e4})).status_code == 422
