"""Studies over REST, on the running service."""

from __future__ import annotations

import asyncio
import csv
import io
from typing import Any

import pyarrow.parquet
import pytest

from server.app import create_app
from server.studies import queue as study_queue
from sim.study.design import study_of

PATIENCE = 180.0
"""Bound on every wait [s]."""

GRID = {
    "name": "four",
    "configuration": "published",
    "grid": {
        "published.impedance.mass": [0.1],
        "published.impedance.damping": [1.5, 15.0],
        "published.impedance.stiffness": [0.0, 10.0],
    },
}
SAMPLE = {
    "configuration": "published",
    "samples": {"count": 3, "over": {"target.initial_spin": {"from": 0.9, "to": 1.1}}},
}


async def started(console, study: Any, **fields: Any) -> dict[str, Any]:
    answer = await console.http.post("/studies", json={"study": study, **fields})
    assert answer.status_code == 202, answer.text
    assert answer.headers["Location"].endswith(answer.json()["id"])
    return answer.json()


async def until(console, study_id: str, *statuses: str) -> dict[str, Any]:
    async with asyncio.timeout(PATIENCE):
        while True:
            study = (await console.http.get(f"/studies/{study_id}")).json()
            if study["status"] in statuses:
                return study
            await asyncio.sleep(0.05)


async def all_rows(console, study_id: str) -> list[dict[str, Any]]:
    return (await console.http.get(f"/studies/{study_id}/results", params={"format": "json"})).json()


async def test_a_grid_from_start_to_table_and_to_a_run_of_one_cell(console):
    begun = await started(console, GRID)
    assert begun["progress"]["total"] == 4
    assert [axis["values"] for axis in begun["axes"]] == [[0.1], [1.5, 15.0], [0.0, 10.0]]
    assert [axis["unit"] for axis in begun["axes"]] == ["kg", "N s/m", "N/m"]
    assert await _rows_as_they_come(console, begun["id"]) == [0, 1, 2, 3]
    study = await until(console, begun["id"], "finished")
    assert study["progress"]["done"] == 4
    assert sum(share["cells"] for share in study["outcomes"]) == 4
    [table] = study["agreement"]
    assert (table["mass"], table["cells"]) == (0.1, 4)

    rows = await all_rows(console, study["id"])
    assert [row["cell"] for row in rows] == [0, 1, 2, 3]
    text = (await console.http.get(f"/studies/{study['id']}/results")).text
    assert [float(row["peak_tip_force"]) for row in csv.DictReader(io.StringIO(text))] == [
        row["peak_tip_force"] for row in rows
    ]
    parquet = await console.http.get(f"/studies/{study['id']}/results", params={"format": "parquet"})
    assert pyarrow.parquet.read_table(io.BytesIO(parquet.content)).to_pylist() == rows
    await _expect_a_run_that_ends_as_its_row_says(console, study["id"], rows[1])


async def _rows_as_they_come(console, study_id: str) -> list[int]:
    """The cells of the rows asked for two at a time, each after the last one seen."""
    seen: list[int] = []
    last = 0
    async with asyncio.timeout(PATIENCE):
        while len(seen) < 4:
            page = (await console.http.get(f"/studies/{study_id}/rows", params={"after": last, "limit": 2})).json()
            assert len(page["rows"]) <= 2
            seen += [row["cell"] for row in page["rows"]]
            last = page["last"]
            await asyncio.sleep(0.02)
    return sorted(seen)


async def _expect_a_run_that_ends_as_its_row_says(console, study_id: str, row: dict[str, Any]) -> None:
    answer = await console.http.post(f"/studies/{study_id}/cells/{row['cell']}/run")
    assert answer.status_code == 202, answer.text
    assert (answer.json()["kind"], answer.json()["parent"]) == ("study", study_id)
    run = await console.until_run(answer.json()["id"], "finished")
    for measure in (
        "at_first_closure",
        "at_locked_arms",
        "peak_tip_force",
        "final_target_spin",
        "momentum_error",
        "cage_margin",
    ):
        assert run["outcome"][measure] == row[measure]


async def test_a_sample_has_confidence_intervals(console):
    study = await until(console, (await started(console, SAMPLE, seed=5))["id"], "finished")
    assert study["definition"]["seed"] == 5
    [axis] = study["axes"]
    assert axis["values"] is None
    assert axis["drawn_from"]["from"] == 0.9
    assert all(share["low"] < share["share"] <= share["high"] for share in study["outcomes"])


async def test_changes_hold_for_all_cells(console):
    study = await started(console, GRID, changes={"contact": {"friction": 0.1}})
    assert study["definition"]["changes"] == {"contact.friction": 0.1, "simulation.engine": "reduced"}


async def test_cancelled_and_gone_on_with(console):
    first = await started(console, "published")
    second = await started(console, GRID)
    async with asyncio.timeout(PATIENCE):
        while not (await console.http.get(f"/studies/{first['id']}/rows")).json()["rows"]:
            await asyncio.sleep(0.05)
    assert (await console.http.post(f"/studies/{second['id']}/cancel")).json()["status"] == "cancelled"
    assert (await console.http.delete(f"/studies/{first['id']}")).status_code == 409
    await console.http.post(f"/studies/{first['id']}/cancel")
    cancelled = await until(console, first["id"], "cancelled")
    assert 0 < cancelled["progress"]["done"] < 484

    assert (await console.http.post(f"/studies/{second['id']}/resume")).status_code == 202
    whole = await until(console, second["id"], "finished")
    assert whole["progress"]["done"] == 4
    refused = await console.http.post(f"/studies/{second['id']}/resume")
    assert refused.status_code == 409
    assert "finished" in refused.json()["detail"]
    assert (await console.http.delete(f"/studies/{first['id']}")).status_code == 204
    page = (await console.http.get("/studies")).json()
    assert [study["id"] for study in page["studies"]] == [second["id"]]


async def test_what_the_last_service_left_is_flown_by_the_next(settings):
    left = create_app(settings).state.services.studies.make_root()
    record = left.create(study_of(GRID))
    left.revise(record.id, status="running")  # as a killed service leaves it
    app = create_app(settings)
    async with app.router.lifespan_context(app), asyncio.timeout(PATIENCE):
        while app.state.services.studies.record(record.id).status != "finished":
            await asyncio.sleep(0.05)
    assert len(app.state.services.studies.rows(record)) == 4


async def test_a_study_of_very_many_cells_must_be_meant(console, monkeypatch):
    monkeypatch.setattr(study_queue, "MANY_CELLS", 3)
    answer = await console.http.post("/studies", json={"study": GRID})
    assert answer.status_code == 409
    problem = answer.json()
    assert problem["cells"] == 4
    assert problem["estimated_time"] > 0.0
    assert '"confirm": true' in problem["tip"]
    assert (await console.http.get("/studies")).json()["studies"] == []
    await started(console, GRID, confirm=True)


async def test_a_study_is_estimated_and_nothing_is_started(console):
    estimate = (await console.http.post("/studies/estimate", json={"study": GRID})).json()
    assert (estimate["cells"], estimate["confirmation_needed"], estimate["studies_before"]) == (4, False, 0)
    assert [axis["count"] for axis in estimate["axes"]] == [1, 2, 2]
    async with asyncio.timeout(PATIENCE):
        while estimate["measuring"]:
            await asyncio.sleep(0.05)
            estimate = (await console.http.post("/studies/estimate", json={"study": GRID})).json()
    assert estimate["seconds"] > 0.0
    assert "4 of its cells, flown by" in estimate["basis"]
    long = {"grid": {"published.impedance.damping": {"from": 0.0, "to": 10.0, "count": 1_000_000}}}
    estimate = (await console.http.post("/studies/estimate", json={"study": long})).json()
    assert (estimate["cells"], estimate["confirmation_needed"], len(estimate["axes"][0]["values"])) == (
        1_000_000,
        True,
        200,
    )
    assert (await console.http.post("/studies/estimate", json={"study": {}})).status_code == 422
    assert (await console.http.get("/studies")).json()["studies"] == []


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ({"study": "unpublished"}, "unpublished"),
        ({"study": {"grid": {"published.impedance.mas": [1.0]}}}, "did you mean published.impedance.mass"),
        ({"study": {"grid": {"published.impedance.mass": {"from": 1.0, "to": 0.5, "count": 3}}}}, "empty"),
        ({"study": {"grid": {"published.impedance.mass": [-1.0]}}}, "published.impedance.mass"),
        ({"study": {}}, "varies nothing"),
        ({"study": "published", "changes": {"contact": {"friction": -1}}}, "contact.friction"),
        ({"study": "published", "seed": -1}, "seed"),
    ],
)
async def test_a_study_that_cannot_be_is_refused_whole(console, body, words):
    answer = await console.http.post("/studies", json=body)
    assert answer.status_code == 422
    assert answer.headers["content-type"] == "application/problem+json"
    assert words in answer.json()["detail"]
    assert (await console.http.get("/studies")).json()["studies"] == []


async def test_what_is_not_there_is_said(console):
    unknown = "/studies/20261125T103000123-4f9a2c"
    for method, path in [
        ("GET", unknown), ("DELETE", unknown), ("POST", f"{unknown}/cancel"), ("GET", f"{unknown}/rows"),
        ("GET", f"{unknown}/results"), ("POST", f"{unknown}/cells/0/run"),
    ]:  # fmt: skip
        answer = await console.http.request(method, path)
        assert answer.status_code == 404
        assert "GET /api/v1/studies" in answer.json()["tip"]
    study = await started(console, GRID)
    answer = await console.http.post(f"/studies/{study['id']}/cells/4/run")
    assert answer.status_code == 404
    assert "4 cells" in answer.json()["detail"]
    answer = await console.http.get(f"/studies/{study['id']}/results", params={"format": "xls"})
    assert answer.status_code == 422


async def test_what_the_client_has_already_is_not_sent_again(console):
    study = await started(console, GRID)
    await console.http.post(f"/studies/{study['id']}/cancel")
    await until(console, study["id"], "cancelled", "finished")
    for path in ("/studies", f"/studies/{study['id']}"):
        first = await console.http.get(path)
        again = await console.http.get(path, headers={"if-none-match": first.headers["etag"]})
        assert (first.status_code, again.status_code, again.content) == (200, 304, b"")
        other = await console.http.get(path, headers={"if-none-match": '"another"'})
        assert other.content == first.content


async def test_the_papers_tables_are_at_hand(console):
    tables = (await console.http.get("/studies/published/tables")).json()
    assert len(tables["cells"]) == 242
    assert {cell["mass"] for cell in tables["cells"]} == {0.01, 0.1}
