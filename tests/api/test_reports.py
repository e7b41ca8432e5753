"""Reports of runs and studies: over REST and from the command line, of what has ended and what goes on."""

from __future__ import annotations

import asyncio
import re

import pytest
from click.testing import CliRunner

from becalm.cli import main
from server.library.runs import new_record
from server.studies.store import StudyStore
from sim.config import MissionConfig
from sim.study.design import study_of

PATIENCE = 180.0
"""Bound on every wait [s]."""

CHANGES = {"target": {"initial_spin": 1.25}, "simulation": {"engine": "reduced"}}


async def _report(console, path: str, **params: str):
    answer = await console.http.get(f"{path}/report", params=params)
    assert answer.status_code == 200, answer.text
    return answer


async def test_a_run_for_an_appendix(console):
    queued = await console.http.post("/runs", json={"configuration": "published", "direct": True, "changes": CHANGES})
    run = await console.until_run(queued.json()["id"], "finished")
    await console.http.patch(f"/runs/{run['id']}", json={"name": "The <first> one", "tags": ["paper"]})
    page = await _report(console, f"/runs/{run['id']}")
    assert page.headers["content-type"] == "text/html; charset=utf-8"
    assert page.headers["content-disposition"] == f'attachment; filename="becalm-{run["id"]}.html"'
    outcome = run["outcome"]
    for said in (
        "The &lt;first&gt; one",
        run["id"],
        "published (edited), direct caging",
        "target.initial_spin",
        "reduced",
        f"{outcome['peak_tip_force']:.3f} N",
        f"{outcome['closed_at']:.3f} s" if outcome["closed_at"] is not None else "never",
        f"{outcome['contacts'][0]['start']:.3f}",
        "paper",
    ):
        assert said in page.text
    assert page.text.count("<svg") == 2
    assert not re.search(r"(src|href)=.?https?:", page.text)
    paper = await _report(console, f"/runs/{run['id']}", format="pdf")
    assert paper.headers["content-type"] == "application/pdf"
    assert paper.content.startswith(b"%PDF")
    assert (await console.http.get(f"/runs/{run['id']}/report", params={"format": "docx"})).status_code == 422


async def test_a_live_run_has_one_as_soon_as_something_is_recorded(console):
    await console.granted("detumble")
    snapshot = await console.until(lambda snapshot: snapshot.phase == "detumbling" and snapshot.time > 1.0)
    page = await _report(console, f"/runs/{snapshot.run_id}")
    assert "No verdict: the run is running" in page.text
    waiting = new_record("scripted", "published", MissionConfig())
    console.services.store.create(waiting)
    refused = await console.http.get(f"/runs/{waiting.id}/report")
    assert refused.status_code == 409
    assert "recorded nothing" in refused.json()["detail"]


async def _flown(console, study: dict) -> dict:
    begun = (await console.http.post("/studies", json={"study": study})).json()
    async with asyncio.timeout(PATIENCE):
        while (found := (await console.http.get(f"/studies/{begun['id']}")).json())["status"] != "finished":
            assert found["status"] in ("queued", "running"), found["note"]
            await asyncio.sleep(0.05)
    return found


@pytest.mark.parametrize(
    ("varied", "figures", "said"),
    [
        ({"grid": {"target.initial_spin": [0.9, 1.1]}}, 2, "0.9, 1.1 rad/s"),
        (
            {"grid": {"target.initial_spin": [0.9, 1.1], "published.impedance.damping": [1.5, 3.0]}},
            4,
            "published.impedance.damping",
        ),
        (
            {"samples": {"count": 4, "over": {"target.initial_spin": {"from": 0.9, "to": 1.1}}}},
            4,
            "4 draws, latin hypercube",
        ),
    ],
)
async def test_a_study_with_its_table_maps_and_odds(console, varied, figures, said):
    study = await _flown(console, {"name": "of two spins", "configuration": "published", "direct": True, **varied})
    page = await _report(console, f"/studies/{study['id']}")
    assert "of two spins" in page.text
    assert said in page.text
    assert page.text.count("<svg") >= figures
    rows = (await console.http.get(f"/studies/{study['id']}/results", params={"format": "json"})).json()
    for row in rows:  # of so few each is listed
        assert f"{row['peak_tip_force']:.4g}" in page.text
    paper = await _report(console, f"/studies/{study['id']}", format="pdf")
    assert paper.content.startswith(b"%PDF")


async def test_a_study_without_a_row_says_so(console):
    record = StudyStore(console.services.studies.root).create(study_of({"grid": {"target.initial_spin": [0.9, 1.1]}}))
    page = await _report(console, f"/studies/{record.id}")
    assert "No cell has an outcome yet" in page.text
    assert (await console.http.get("/studies/20200101T000000000-abcdef/report")).status_code == 404


def test_the_command_writes_one(tmp_path):
    runner = CliRunner()
    assert runner.invoke(main, ["run", "--configuration", "published", "--direct", "--json"]).exit_code == 0
    for name, beginning in (("run.html", b"<!doctype html>"), ("run.pdf", b"%PDF")):
        written = runner.invoke(main, ["report", "latest", "--out", str(tmp_path / name)])
        assert written.exit_code == 0, written.output
        assert (tmp_path / name).read_bytes().startswith(beginning)
    refused = runner.invoke(main, ["report", "latest", "--out", str(tmp_path / "run.docx")])
    assert refused.exit_code == 2
    assert ".html or .pdf" in refused.output
    missing = runner.invoke(main, ["report", "20200101T000000000-abcdef", "--out", str(tmp_path / "run.pdf")])
    assert missing.exit_code == 1
    assert "no run or study" in missing.output
