"""A service on a data folder full of damage: it starts, and each bad file costs what it held and nothing else."""

from __future__ import annotations

import asyncio
import json
import os
import shutil
from pathlib import Path

import httpx
import pytest

from server.app import create_app
from server.library.folder import RECORD_NAME
from server.library.record import Remarks
from server.library.runs import RunStore, new_record
from server.studies.store import StudyStore
from sim.config import MissionConfig
from sim.study.design import study_of


def _as_pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


def _ended(store, **fields):
    record = new_record("scripted", "published", MissionConfig())
    record = record.model_copy(update={"status": "finished", "integrity": "complete", **fields})
    store.create(record)
    return record.id


@pytest.fixture
def damaged(settings):
    """Runs, studies and presets of which each has something else wrong; (what is good, what is bad)."""
    store = RunStore(settings.data_dir / "runs").make_root()
    studies = StudyStore(settings.data_dir / "studies").make_root()
    good, starred = _ended(store), _ended(store)
    (store.root / starred / "remarks.json").write_bytes(b'{"starred": true')
    spoils = (
        lambda path: path.write_bytes(b"[" * 100_000),
        lambda path: (path.unlink(), path.mkdir()),
        lambda path: (path.unlink(), path.symlink_to(path.name)),
        _as_pipe,
        lambda path: path.write_text(path.read_text().replace('"duration": 0.0', '"duration": NaN')),
        lambda path: path.write_text(path.read_text().replace('"queued"', '"of tomorrow"')),
    )
    bad = [_ended(store, status="queued", integrity=None) for _ in spoils]
    for run_id, spoil in zip(bad, spoils, strict=True):
        spoil(store.root / run_id / RECORD_NAME)
    copied = store.root / (good[:-6] + "abcdef")
    shutil.copytree(store.root / good, copied)
    study, bad_study = (studies.create(study_of({"grid": {"target.mass": [2.0]}})) for _ in range(2))
    studies.revise(study.id, status="finished")
    (studies.root / bad_study.id / "study.json").write_text('{"id": 1}')
    (settings.data_dir / "presets.json").write_bytes(b"\xff")
    return {"good": good, "starred": starred, "bad": {*bad, copied.name}, "study": study.id, "bad study": bad_study.id}


async def test_a_service_on_a_damaged_folder(damaged, settings):
    app = create_app(settings.model_copy(update={"keep_days": 0.0}))
    transport = httpx.ASGITransport(app)
    async with (
        app.router.lifespan_context(app),
        httpx.AsyncClient(transport=transport, base_url="http://localhost/api/v1") as http,
    ):
        async with asyncio.timeout(120):  # retention is the last to look at everything
            while (await http.get(f"/runs/{damaged['good']}")).status_code != 404:
                await asyncio.sleep(0.01)
        page = (await http.get("/runs")).json()
        assert damaged["starred"] in [run["id"] for run in page["runs"]]
        reasons = {each["id"]: each["reason"] for each in page["unreadable"]}
        assert reasons.keys() == {*damaged["bad"], damaged["starred"]}
        for run_id in damaged["bad"]:
            answer = await http.get(f"/runs/{run_id}")
            assert (answer.status_code, answer.json()["title"]) == (409, "Refused")
            assert answer.json()["tip"]
        patched = await http.patch(f"/runs/{damaged['starred']}", json={"starred": False})
        assert patched.status_code == 409
        metrics = await http.get("http://localhost/metrics")
        assert f"becalm_runs_unreadable {len(reasons)}" in metrics.text.replace(".0\n", "\n")
        studies = (await http.get("/studies")).json()
        assert [study["id"] for study in studies["studies"]] == [damaged["study"]]
        assert [study["id"] for study in studies["unreadable"]] == [damaged["bad study"]]
        assert (await http.get(f"/studies/{damaged['bad study']}")).status_code == 409
        assert (await http.get("/presets")).status_code == 409
        assert (await http.get("/health")).status_code == 200
        for run_id in damaged["bad"]:
            assert (await http.delete(f"/runs/{run_id}")).status_code == 204
        assert [each["id"] for each in (await http.get("/runs")).json()["unreadable"]] == [damaged["starred"]]
    lines = map(json.loads, (settings.data_dir / "access" / "audit.log").read_text().splitlines())
    assert [line["path"] for line in lines if line["who"] == "retention"] == [f"/api/v1/runs/{damaged['good']}"]


async def test_requests_at_once_with_one_key_make_one_run(console):
    answers = await asyncio.gather(
        *(
            console.http.post(
                "/runs", json={"configuration": "published", "direct": True}, headers={"Idempotency-Key": "one"}
            )
            for _ in range(8)
        )
    )
    assert {answer.status_code for answer in answers} == {202}
    assert len({answer.json()["id"] for answer in answers}) == 1


async def test_of_two_changes_with_one_etag_one_is_refused(console):
    run_id = _ended(console.services.store)
    console.services.store.remark(run_id, Remarks())
    etag = (await console.http.get(f"/runs/{run_id}")).headers["ETag"]
    for _ in range(10):
        answers = await asyncio.gather(
            *(
                console.http.patch(f"/runs/{run_id}", json={"notes": [{"text": text}]}, headers={"If-Match": etag})
                for text in ("mine", "yours", "theirs")
            )
        )
        assert sorted(answer.status_code for answer in answers) == [200, 412, 412]
        etag = next(answer.headers["ETag"] for answer in answers if answer.status_code == 200)


async def test_runs_at_once_never_pass_the_bound(console, monkeypatch):
    monkeypatch.setattr("server.library.scripted.CAPACITY", 5)
    monkeypatch.setattr(console.services.scripted, "_fly_next", lambda: None)
    answers = await asyncio.gather(*(console.http.post("/runs", json={}) for _ in range(12)))
    assert sorted(answer.status_code for answer in answers) == [202] * 5 + [503] * 7
    assert console.services.scripted.waiting == 5


async def test_a_data_folder_that_goes_and_comes_back_is_reported(console, settings):
    run_id = _ended(console.services.store)
    away = settings.data_dir.with_name("away")
    (settings.data_dir / "runs").rename(away)
    for answer in (
        await console.http.get("/runs"),
        await console.http.post("/runs", json={}),
    ):
        assert answer.status_code == 503, answer.text
        assert "data folder is there" in answer.json()["tip"] or "bring the folder back" in answer.json()["tip"]
    told = await console.until(lambda snapshot: any(each.title == "Nothing can be kept" for each in snapshot.problems))
    assert not (settings.data_dir / "runs").exists()
    assert told.phase == "idle"
    assert "becalm_library_readable 0" in (await console.http.get("http://localhost/metrics")).text
    away.rename(settings.data_dir / "runs")
    assert run_id in [run["id"] for run in (await console.http.get("/runs")).json()["runs"]]


async def test_a_mount_that_is_lost_under_the_service_is_told_and_nothing_is_written_in_its_place(console, settings):
    run_id = _ended(console.services.store)
    away = settings.data_dir.with_name("away")
    settings.data_dir.rename(away)
    settings.data_dir.mkdir()  # the empty folder on which it was mounted
    lost = await console.until(lambda snapshot: any(each.title == "Nothing can be kept" for each in snapshot.problems))
    (problem,) = (each for each in lost.problems if each.title == "Nothing can be kept")
    assert (problem.severity, "is gone" in problem.message, "bring the folder back" in problem.tip) == (
        "error", True, True,
    )  # fmt: skip
    preset = {"configuration": "published", "changes": {"target": {"mass": 2.0}}}
    for answer in (
        await console.http.post("/runs", json={}),
        await console.http.post("/studies", json={"study": {"grid": {"target.mass": [2.0]}}}),
        await console.http.put("/presets/lost", json=preset),
    ):
        assert answer.status_code == 503, answer.text
    await console.granted("reset")  # the mission flies on, unrecorded
    await console.granted("capture")
    await console.until(lambda snapshot: any("not being recorded" in each.title for each in snapshot.problems))
    assert list(settings.data_dir.iterdir()) == []
    settings.data_dir.rmdir()
    away.rename(settings.data_dir)
    assert (await console.http.get(f"/runs/{run_id}")).status_code == 200
    await console.until(lambda snapshot: not any(each.title == "Nothing can be kept" for each in snapshot.problems))
    recorded = (await console.granted("reset"))["id"].partition("/")[0]
    await console.granted("capture")
    assert (await console.until_run(recorded, "running"))["id"] == recorded


async def test_events_that_are_damaged_are_counted_on_their_run(console):
    run_id = _ended(console.services.store)
    events = console.services.store.root / run_id / "events.jsonl"
    good = {"time": 0.1, "tick": 1, "kind": "touch", "severity": "info", "message": "it", "at": "now"}
    events.write_text(json.dumps(good) + "\n")
    assert (await console.http.get(f"/runs/{run_id}")).json()["damaged_events"] == 0
    with events.open("a") as file:
        file.write('{"kind": \n[[[\n' + json.dumps(good) + "\n")
    assert (await console.http.get(f"/runs/{run_id}")).json()["damaged_events"] == 2
    assert len((await console.http.get(f"/runs/{run_id}/events")).json()) == 2
    events.unlink()
    events.mkdir()  # one bad file costs what it held
    assert (await console.http.get(f"/runs/{run_id}")).json()["damaged_events"] is None
