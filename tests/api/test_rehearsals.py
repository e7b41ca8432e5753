"""Rehearsals, atlases and the look-ahead over REST, on the running service."""

from __future__ import annotations

import asyncio
import io
from typing import Any

import numpy as np
import pyarrow.parquet
import pytest

from becalm.replaying import replay
from server.rehearsals import foreseen, look_ahead

PATIENCE = 180.0
"""Bound on every wait [s]."""

SHORT = {"source": "live", "request": "capture", "futures": 20, "horizon": 2.0}


async def started(console, what: str, body: dict[str, Any]) -> dict[str, Any]:
    answer = await console.http.post(f"/{what}", json=body)
    assert answer.status_code == 202, answer.text
    assert answer.headers["Location"] == f"/api/v1/{what}/{answer.json()['id']}"
    return answer.json()


async def until(console, address: str, *statuses: str) -> dict[str, Any]:
    async with asyncio.timeout(PATIENCE):
        while True:
            found = (await console.http.get(address)).json()
            if found["status"] in statuses:
                return found
            await asyncio.sleep(0.05)


async def test_a_rehearsal_of_an_edit_from_start_to_table(console):
    changes = {"robot": {"servo": {"time_constant": 0.02}}}
    begun = await started(console, "rehearsals", {**SHORT, "changes": changes, "seed": 4})
    assert begun["progress"]["total"] == 40
    assert (begun["phase"], begun["run"], begun["result"]) == ("idle", None, None)
    early = await console.http.get(f"/rehearsals/{begun['id']}/result")
    assert early.status_code == 409
    drawn_early = await console.http.put("/scene/futures", json={"rehearsal": begun["id"]})
    assert (drawn_early.status_code, "no futures to draw" in drawn_early.json()["detail"]) == (409, True)
    ended = await until(console, f"/rehearsals/{begun['id']}", "finished", "failed")
    assert ended["status"] == "finished", ended["note"]
    assert ended["progress"]["done"] == 40
    result = ended["result"]
    assert result["changes"] == {"robot.servo.time_constant": 0.02}
    for case in (result["as_it_is"], result["as_changed"]):
        assert case["futures"] == sum(each["futures"] for each in case["odds"]) == 20
    assert {each["measure"] for each in result["compared"]} >= {"caged", "peak_tip_force"}
    assert (await console.http.get(f"/rehearsals/{begun['id']}/result")).json() == result
    for case in ("as_it_is", "as_changed"):
        drawn = await console.http.put("/scene/futures", json={"rehearsal": begun["id"], "case": case})
        assert drawn.status_code == 204, drawn.text
    assert (await console.http.delete("/scene/futures")).status_code == 204
    assert (await console.http.put("/scene/futures", json={"rehearsal": "none"})).status_code == 404
    table = await console.http.get(f"/rehearsals/{begun['id']}/result", params={"format": "parquet"})
    rows = pyarrow.parquet.read_table(io.BytesIO(table.content))
    assert rows.num_rows == 40
    assert rows.column("drawn.target_mass").to_pylist()[:20] == [
        each["draw"]["values"]["target_mass"] for each in result["as_it_is"]["each"]
    ]
    assert rows.schema.field("peak_tip_force").metadata[b"unit"] == b"N"
    again = await started(console, "rehearsals", {**SHORT, "changes": changes, "seed": 4})
    repeated = await until(console, f"/rehearsals/{again['id']}", "finished", "failed")
    if repeated["tick"] == ended["tick"]:
        assert repeated["result"] == result
    assert (await console.http.delete(f"/rehearsals/{begun['id']}")).status_code == 204
    assert (await console.http.get(f"/rehearsals/{begun['id']}")).status_code == 404


async def test_the_newest_of_an_asker_takes_the_place_of_the_older(console):
    long = {**SHORT, "futures": 2000}
    first = await started(console, "rehearsals", {**long, "asker": "page 1"})
    other = await started(console, "rehearsals", {**long, "asker": "page 2"})
    second = await started(console, "rehearsals", {**SHORT, "asker": "page 1"})
    assert (await until(console, f"/rehearsals/{first['id']}", "superseded"))["note"]
    assert (await console.http.get(f"/rehearsals/{other['id']}")).json()["status"] in ("queued", "running")
    cancelled = await console.http.post(f"/rehearsals/{other['id']}/cancel")
    assert cancelled.json()["status"] == "cancelled"
    assert (await console.http.post(f"/rehearsals/{other['id']}/cancel")).status_code == 409
    assert (await until(console, f"/rehearsals/{second['id']}", "finished", "failed"))["status"] == "finished"


async def test_a_worker_that_is_killed_is_replaced_and_the_mission_flies_on(console):
    await console.granted("run", speed=1)
    begun = await started(console, "rehearsals", {**SHORT, "futures": 200})
    async with asyncio.timeout(PATIENCE):
        while not (await console.http.get(f"/rehearsals/{begun['id']}")).json()["progress"]["done"]:
            await asyncio.sleep(0.02)
    before = await console.snapshot()
    console.services.rehearsals._pool.kill()
    ended = await until(console, f"/rehearsals/{begun['id']}", "finished", "failed")
    assert ended["status"] == "finished", ended["note"]
    assert ended["result"]["as_it_is"]["futures"] == 200
    after = await console.snapshot()
    assert (after["phase"], after["run_id"]) == (before["phase"], before["run_id"])
    assert after["tick"] > before["tick"]


async def test_from_a_recorded_state_that_is_under_way(console):
    await console.granted("reset", configuration="published")
    await console.granted("run", speed=0)
    await console.granted("capture")
    await console.until(lambda snapshot: snapshot.outcome is not None)
    run_id = (await console.snapshot())["run_id"]
    await console.until_run(run_id, "finished")
    body = {"source": {"run": run_id, "at": 1.0}, "request": None, "futures": 4, "horizon": 1.0}
    begun = await started(console, "rehearsals", body)
    assert (begun["run"], begun["phase"], begun["tick"]) == (run_id, "detumbling", 1001)
    ended = await until(console, f"/rehearsals/{begun['id']}", "finished", "failed")
    assert ended["status"] == "finished", ended["note"]
    path = ended["result"]["as_it_is"]["paths"][0]
    assert path["times"][0] == pytest.approx(1.05)
    await _opens_as_rehearsed(console, ended, 2)
    lost = await console.http.post("/rehearsals", json={**body, "source": {"run": run_id, "at": 1e4}})
    assert lost.status_code == 409
    assert "was recorded from 0 to" in lost.json()["detail"]
    none = await console.http.post("/rehearsals", json={**body, "source": {"run": "nothing", "at": 0}})
    assert none.status_code == 404


async def _kept_foreseen(console, run_id: str) -> dict[str, Any] | None:
    """What is kept of that run, once the recorder has written all that came before the verdict."""
    await console.until_run(run_id, "finished")
    answer = await console.http.get(f"/runs/{run_id}/foreseen")
    assert answer.status_code == 200, answer.text
    return answer.json()


async def _capture_now(console) -> str:
    """Fly a capture to its verdict; its run."""
    await console.granted("run", speed=0)
    await console.granted("capture")
    await console.until(lambda snapshot: snapshot.outcome is not None)
    return (await console.snapshot())["run_id"]


async def test_a_run_keeps_what_was_rehearsed_of_its_request(console):
    changes = {"published": {"impedance": {"damping": 3.0}}}
    begun = await started(console, "rehearsals", {**SHORT, "changes": changes})
    ended = await until(console, f"/rehearsals/{begun['id']}", "finished", "failed")
    assert ended["status"] == "finished", ended["note"]
    assert (await console.http.patch("/mission/config", json=changes)).status_code == 200
    kept = await _kept_foreseen(console, await _capture_now(console))
    assert kept is not None
    for case in ("as_it_is", "as_changed"):
        told = ended["result"][case]
        assert kept[case]["odds"] == told["odds"]
        assert kept[case]["bands"] == told["bands"]
        assert kept[case]["fans"] == told["fans"]
        assert (kept[case]["paths"], kept[case]["each"]) == ([], [])


async def test_a_run_keeps_nothing_of_what_was_rehearsed_with_another_configuration(console):
    begun = await started(console, "rehearsals", SHORT)
    assert (await until(console, f"/rehearsals/{begun['id']}", "finished", "failed"))["status"] == "finished"
    await console.http.patch("/mission/config", json={"published": {"impedance": {"damping": 3.0}}})
    assert await _kept_foreseen(console, await _capture_now(console)) is None


async def _opens_as_rehearsed(console, rehearsal: dict[str, Any], future: int) -> None:
    """That future as a run: it ends as was rehearsed, and `becalm replay` flies it again to the last bit."""
    answer = await console.http.post(f"/rehearsals/{rehearsal['id']}/futures/{future}/run")
    assert answer.status_code == 202, answer.text
    opened = answer.json()
    assert opened["parent"] == rehearsal["run"]
    assert f"future {future} of rehearsal {rehearsal['id']}" in opened["note"]
    run = await console.until_run(opened["id"], "finished", "failed")
    assert run["status"] == "finished", run["note"]
    told = rehearsal["result"]["as_it_is"]["each"][future]
    assert run["outcome"]["outcome"] == told["outcome"]
    assert run["outcome"]["peak_tip_force"] == told["measures"]["peak_tip_force"]
    assert run["config"]["target"]["mass"] == told["draw"]["values"]["target_mass"]
    reader = console.services.store.read(opened["id"])
    ticks = np.concatenate(list(reader.chunks()))
    assert ticks["tick"][0] == rehearsal["tick"]
    report = await asyncio.to_thread(replay, reader)
    assert report["rerun"]["same"], report["rerun"]
    assert report["controller"]["same"], report["controller"]


async def test_a_future_of_a_request_and_one_of_a_cell_open_as_runs(console):
    ended = await until(
        console, f"/rehearsals/{(await started(console, 'rehearsals', SHORT))['id']}", "finished", "failed"
    )
    await _opens_as_rehearsed(console, ended, 5)
    assert (await console.http.post(f"/rehearsals/{ended['id']}/futures/20/run")).status_code == 404
    missing = await console.http.post(f"/rehearsals/{ended['id']}/futures/0/run", params={"case": "as_changed"})
    assert missing.status_code == 404
    axes = {
        "x": {"path": "target.mass", "from": 2, "to": 3, "count": 2},
        "y": {"path": "contact.friction", "from": 0.2, "to": 0.4, "count": 2},
    }
    atlas = await started(console, "atlases", {**axes, "futures": 1, "horizon": 1.0})
    answer = await console.http.post(f"/atlases/{atlas['id']}/cells/1/0/run")
    assert answer.status_code == 202, answer.text
    assert (await console.http.post(f"/atlases/{atlas['id']}/cells/2/0/run")).status_code == 404
    run = await console.until_run(answer.json()["id"], "finished", "failed")
    assert run["status"] == "finished", run["note"]
    ended = await until(console, f"/atlases/{atlas['id']}", "finished", "failed")
    cell = next(each for each in ended["cells"] if (each["x"], each["y"]) == (1, 0))
    assert cell["outcome"] == run["outcome"]["outcome"]
    assert cell["measures"]["base_turn"] > 0.0


@pytest.mark.parametrize(
    ("fields", "status", "words"),
    [
        ({"futures": 10_000_000}, 422, "futures = 10000000: from 1 to 2000"),
        ({"futures": 0}, 422, "futures = 0"),
        ({"horizon": -1.0}, 422, "horizon = -1 s"),
        ({"uncertainty": {"target_spin": -1.0}}, 422, "uncertainty.target_spin = -1.0 rad/s"),
        ({"uncertainty": {"spin": 1.0}}, 422, "uncertainty.spin is not a field"),
        ({"changes": {"target": {"mass": -1.0}}}, 422, "target.mass = -1"),
        ({"changes": {"nothing": 1.0}}, 422, "nothing"),
        ({"request": None}, 409, "no capture is under way in phase idle"),
        ({"request": "dance"}, 422, "request"),
        ({"source": {"run": "x"}}, 422, "at"),
    ],
)
async def test_what_cannot_be_rehearsed_is_refused_and_nothing_starts(console, fields, status, words):
    answer = await console.http.post("/rehearsals", json={**SHORT, **fields})
    assert answer.status_code == status, answer.text
    assert words in answer.text
    assert console.services.rehearsals.waiting == 0


async def test_an_atlas_comes_coarse_first_and_by_revision(console):
    body = {
        "request": "capture",
        "x": {"path": "published.impedance.damping", "from": 0, "to": 8, "count": 5},
        "y": {"path": "published.impedance.stiffness", "from": 0, "to": 20, "count": 5},
        "futures": 2,
        "horizon": 1.0,
    }
    begun = await started(console, "atlases", body)
    assert begun["x"]["values"] == [0.0, 2.0, 4.0, 6.0, 8.0]
    assert begun["x"]["unit"] == "N s/m"
    assert begun["x"]["present"] == 0.1
    cells, revision = [], 0
    async with asyncio.timeout(PATIENCE):
        while True:
            page = (await console.http.get(f"/atlases/{begun['id']}", params={"after": revision})).json()
            cells += page["cells"]
            revision = page["revision"]
            if page["status"] not in ("queued", "running"):
                break
            await asyncio.sleep(0.02)
    assert page["status"] == "finished", page["note"]
    assert len(cells) == revision == 25
    assert {(cell["x"], cell["y"]) for cell in cells} == {(x, y) for x in range(5) for y in range(5)}
    assert {(cell["x"], cell["y"]) for cell in cells[:4]} == {(0, 0), (0, 4), (4, 0), (4, 4)}
    for cell in cells:
        assert cell["futures"] == sum(cell["outcomes"].values()) == 2
        assert cell["error"] is None
    assert (await console.http.get(f"/rehearsals/{begun['id']}")).status_code == 404, "an atlas is no rehearsal"


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"x": {"path": "published.impedance.dampin", "from": 0, "to": 1}}, "did you mean published.impedance.damping"),
        ({"x": {"path": "method", "from": 0, "to": 1}}, "it is a choice"),
        ({"x": {"path": "target.mass", "from": -1, "to": 1}}, "x.target.mass = -1"),
        ({"x": {"path": "target.mass", "from": 1, "to": 2, "count": 22}}, "an axis has 1 to 21 values"),
        ({"x": {"path": "contact.friction", "from": 0, "to": 1}}, "it is the other axis, too"),
        ({"futures": 11}, "futures = 11: from 1 to 10"),
    ],
)
async def test_an_atlas_that_cannot_be_is_refused(console, fields, words):
    body = {
        "x": {"path": "target.mass", "from": 1, "to": 2, "count": 3},
        "y": {"path": "contact.friction", "from": 0.1, "to": 0.5, "count": 3},
        **fields,
    }
    answer = await console.http.post("/atlases", json=body)
    assert answer.status_code == 422, answer.text
    assert words in answer.json()["detail"]


async def test_a_capture_pressed_before_the_look_ahead_is_ready_is_rehearsed_from_the_press(console, monkeypatch):
    monkeypatch.setattr(look_ahead, "FUTURES", 6)
    monkeypatch.setattr(foreseen, "FUTURES", 6)
    await console.granted("run", speed=0.1)  # still under way when its look-ahead would be made
    assert (await console.http.get("/rehearsals/look-ahead")).json()["made"] is False
    run_id, pressed_at = (await console.snapshot())["run_id"], (await console.snapshot())["tick"]
    await console.granted("capture")
    during = (await console.http.get("/rehearsals/look-ahead")).json()
    assert during["reason"] == "no sequence can begin in phase detumbling", "nothing more is made of the state before"
    async with asyncio.timeout(PATIENCE):
        while (kept := (await console.http.get(f"/runs/{run_id}/foreseen")).json()) is None:
            assert (await console.snapshot())["outcome"] is None
            await asyncio.sleep(0.05)
    assert (kept["request"], kept["phase"], kept["as_it_is"]["futures"]) == ("capture", "idle", 6)
    assert kept["tick"] >= pressed_at


async def test_a_run_that_is_over_when_it_is_foreseen_keeps_that_too(console, monkeypatch):
    monkeypatch.setattr(look_ahead, "FUTURES", 6)
    monkeypatch.setattr(foreseen, "FUTURES", 6)
    await console.granted("run", speed=0)
    assert (await console.http.get("/rehearsals/look-ahead")).json()["made"] is False
    run_id = await _capture_now(console)
    await console.granted("reset")
    async with asyncio.timeout(PATIENCE):
        while (kept := (await console.http.get(f"/runs/{run_id}/foreseen")).json()) is None:
            await asyncio.sleep(0.05)
    assert kept["request"] == "capture"


async def test_nothing_is_foreseen_of_a_capture_that_nobody_looks_at(console):
    run_id = await _capture_now(console)
    assert console.services.rehearsals.waiting == 0
    assert await _kept_foreseen(console, run_id) is None


async def test_the_look_ahead_is_made_for_who_looks_and_says_go_or_why_not(console, monkeypatch):
    monkeypatch.setattr(look_ahead, "FUTURES", 10)
    assert console.services.rehearsals.waiting == 0, "nobody looked: nothing is made"
    first = (await console.http.get("/rehearsals/look-ahead")).json()
    assert (first["made"], first["reason"]) == (False, "its futures are being flown")
    async with asyncio.timeout(PATIENCE):
        while not (said := (await console.http.get("/rehearsals/look-ahead")).json())["made"]:
            await asyncio.sleep(0.1)
    assert said["request"] == "capture"
    assert said["words"].startswith(f"Capture: {said['caged']['futures']} of 10 futures caged")
    assert said["go"] == (said["caged"]["share"] >= 0.9)
    assert (said["reason"] is None) == said["go"]
    run_id = (await console.snapshot())["run_id"]
    await console.granted("run", speed=0.1)  # under way for minutes, whenever the next one is due
    await console.granted("capture")
    async with asyncio.timeout(PATIENCE):
        while "no sequence can begin in phase" not in (said["reason"] or ""):
            said = (await console.http.get("/rehearsals/look-ahead")).json()
            await asyncio.sleep(0.1)
    assert not said["made"]
    await console.granted("run", speed=0)
    kept = await _kept_foreseen(console, run_id)
    assert kept is not None, "nobody had rehearsed it: the run has the look-ahead"
    assert (kept["request"], kept["as_it_is"]["futures"]) == ("capture", 10)


async def test_the_uncertainty_model_is_told_with_units_and_bounds(console):
    fields = {each["name"]: each for each in (await console.http.get("/rehearsals/uncertainty")).json()["fields"]}
    assert fields["friction"]["default"] == 0.2
    assert fields["target_spin"]["unit"] == "rad/s"
    assert all(each["minimum"] == 0.0 < each["maximum"] for each in fields.values())
