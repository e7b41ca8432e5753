"""Fits over REST, on the running service, and from the command line."""

from __future__ import annotations

import asyncio
import json

import pytest
from click.testing import CliRunner

from becalm.cli import main

PATIENCE = 180.0
"""Bound on every wait [s]."""

FLOWN = {
    "configuration": "testbed",
    "changes": {"simulation": {"engine": "reduced"}, "judging": {"time_limit": 5.0}},
}
NAMES = ["contact.stiffness", "robot.servo.time_constant", "perception.wrist.left.gain"]


async def flown(console) -> str:
    """A run of one touch, by the right hand."""
    queued = await console.http.post("/runs", json=FLOWN)
    assert queued.status_code == 202, queued.text
    run = await console.until_run(queued.json()["id"], "finished", "failed")
    assert run["status"] == "finished", run
    return run["id"]


async def until(console, fit_id: str, *statuses: str) -> dict:
    async with asyncio.timeout(PATIENCE):
        while True:
            found = (await console.http.get(f"/fits/{fit_id}")).json()
            if found["status"] in statuses:
                return found
            await asyncio.sleep(0.05)


async def test_a_fit_from_its_start_to_a_preset_and_reports(console):
    run = await flown(console)
    begun = await console.http.post("/fits", json={"runs": [run], "parameters": NAMES, "held_out": [run]})
    assert begun.status_code == 202, begun.text
    assert begun.headers["Location"] == f"/api/v1/fits/{begun.json()['id']}"
    fit_id = begun.json()["id"]
    early = await console.http.get(f"/fits/{fit_id}/report")
    assert early.status_code == 409
    ended = await until(console, fit_id, "finished", "failed")
    assert ended["status"] == "finished", ended["note"]
    assert ended["progress"]["done"] == ended["progress"]["total"]
    values = {each["name"]: each for each in ended["result"]["parameters"]}
    assert values["contact.stiffness"]["value"] == pytest.approx(800.0, rel=0.02)
    assert not values["perception.wrist.left.gain"]["told"]
    assert ended["result"]["held_out_predictions"][0]["fitted"] == pytest.approx(0.6, abs=0.2)
    page = await console.http.get(f"/fits/{fit_id}/report", params={"format": "html"})
    assert "<svg" in page.text
    assert "contact.stiffness" in page.text
    assert not any(f'{attribute}="http' in page.text for attribute in ("src", "href"))
    paper = await console.http.get(f"/fits/{fit_id}/report", params={"format": "pdf"})
    assert paper.content.startswith(b"%PDF")
    kept = await console.http.post(f"/fits/{fit_id}/preset", json={"name": "as it is"})
    assert kept.status_code == 200, kept.text
    assert kept.json()["config"]["contact"]["stiffness"] == values["contact.stiffness"]["value"]
    assert kept.json()["config"]["judging"]["time_limit"] == 5.0
    assert (await console.http.delete(f"/fits/{fit_id}")).status_code == 204
    assert (await console.http.get(f"/fits/{fit_id}")).status_code == 404


async def test_a_fit_is_cancelled_and_what_cannot_be_fitted_is_refused(console):
    run = await flown(console)
    begun = (await console.http.post("/fits", json={"runs": [run]})).json()
    assert (console.services.fits.waiting, console.services.rehearsals.waiting) == (1, 0), "look-aheads go on"
    cancelled = await console.http.post(f"/fits/{begun['id']}/cancel")
    assert cancelled.json()["status"] == "cancelled"
    assert (await console.http.post(f"/fits/{begun['id']}/cancel")).status_code == 409
    unknown = await console.http.post("/fits", json={"runs": [run], "parameters": ["contact.stifness"]})
    assert unknown.status_code == 422
    assert "contact.stifness" in unknown.json()["detail"]
    assert (await console.http.post("/fits", json={"runs": ["20261125T103000123-4f9a2c"]})).status_code == 404
    names = {each["name"] for each in (await console.http.get("/fits/parameters")).json() if each["usual"]}
    assert "contact.stiffness" in names


def test_the_command_fits_reports_and_keeps(tmp_path, monkeypatch):
    monkeypatch.setenv("BECALM_DATA_DIR", str(tmp_path))
    run = ["run", "--configuration", "testbed", "--set", "simulation.engine=reduced", "--set", "judging.time_limit=5"]
    assert CliRunner().invoke(main, run).exit_code == 0
    chosen = ["--parameters", "contact.stiffness,robot.servo.time_constant"]
    fitted = ["fit", "latest", *chosen, "--out", str(tmp_path / "fit.json"), "--keep-as", "as it is", "--json"]
    result = CliRunner().invoke(main, fitted)
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    assert document["parameters"][0]["value"] == pytest.approx(800.0, rel=0.02)
    assert json.loads((tmp_path / "fit.json").read_text()) == document
    assert "as it is" in (tmp_path / "presets.json").read_text()
    refused = CliRunner().invoke(main, ["fit", "latest", "--parameters", "contact.stifness"])
    assert refused.exit_code == 2
    assert "contact.stifness" in refused.stderr
    assert CliRunner().invoke(main, ["fit", "latest", "--out", "fit.txt"]).exit_code == 2


async def test_a_log_from_elsewhere_becomes_a_run_and_what_cannot_be_right_is_refused(console):
    table = "t,q,b\n" + "".join(f"{0.005 * row},{0.1 + 1e-4 * row},{1e-3 * row}\n" for row in range(400))
    joints = '{ left = ["q", "q", "q"], right = ["q", "q", "q"] }'
    body = '{ x = "b", y = "b", angle = "b" }'
    said = f'time = {{ source = "t" }}\njoint_angle = {joints}\nbase_pose = {body}\ntarget_pose = {body}\n'
    kind = {"Content-Type": "application/octet-stream"}
    sent = await console.http.post("/imports", params={"name": "a.csv", "map": said}, content=table, headers=kind)
    assert sent.status_code == 201, sent.text
    assert sent.json()["ticks"] == 400
    run = (await console.http.get(sent.headers["Location"].removeprefix("/api/v1"))).json()
    assert (run["kind"], run["status"]) == ("imported", "finished")
    history = await console.http.get(f"/runs/{run['id']}/ticks", params={"points": 50})
    assert history.status_code == 200, history.text
    assert (await console.http.post("/fits", json={"runs": [run["id"]]})).status_code == 409
    wrong = {"name": "a.csv", "map": said.replace('"q"', '"z"')}
    refused = await console.http.post("/imports", params=wrong, content=table, headers=kind)
    assert refused.status_code == 422
    assert "no column z" in refused.json()["detail"]
    assert (await console.http.post("/imports", params={"name": "a.csv", "map": said}, json={})).status_code == 422
