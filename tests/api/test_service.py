"""The service as a whole: health, its own documentation, who may speak to it, and what survives it."""

from __future__ import annotations

import asyncio
import os
import re
import subprocess
import sys
import time
from functools import partial
from typing import Any, cast

import httpx
import numpy as np
import pytest
from fastapi import FastAPI

from server.api.services import Patience
from server.app import create_app
from server.errors import ServiceBusy
from server.library.runs import RunStore, new_record
from server.library.writer import RunWriter
from server.pages.console import serve_console
from server.settings import Settings
from sim.capture.tick import TICK
from sim.configurations import named_configuration

PATIENCE = 180.0
"""Bound on a wait [s]: far beyond it, so that only a hang reaches it."""


async def test_health(console):
    health = (await console.http.get("/health")).json()
    assert health["status"] == "ok"
    assert health["plant"] == "simulation"
    assert health["phase"] == "idle"
    assert 0 <= health["tick_age"] < 1
    assert health["link_age"] is None


async def test_before_the_simulation_is_prepared(settings):
    """Without its lifespan a service stays as it is before the mission thread is ready."""
    app = create_app(settings)
    async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://localhost/api/v1") as http:
        assert (await http.get("/health")).json()["status"] == "preparing"
        for answer in (await http.get("/mission"), await http.post("/mission/stop")):
            assert answer.status_code == 503
            assert "prepared" in answer.json()["detail"]
            assert answer.json()["tip"]
        assert (await http.get("/mission/config")).status_code == 200


@pytest.mark.parametrize(
    ("method", "path", "body"),
    [
        ("GET", "/mission", None),
        ("POST", "/mission/commands", {"command": "capture"}),
        ("POST", "/mission/arming", {"command": "capture"}),
        ("POST", "/mission/control", {"action": "take_control"}),
        ("PATCH", "/mission/config", {"published": {"impedance": {"damping": 3.0}}}),
    ],
)
async def test_a_request_waits_for_the_mission_if_asked_to(settings, method, path, body):
    """Sent before the mission thread has begun: what is granted is granted by the mission that follows."""
    app = create_app(settings)
    async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://localhost/api/v1") as http:
        ask = partial(http.request, method, path, json=body, timeout=PATIENCE)
        refused = await ask(params={"wait": "true", "timeout": 0.01})
        assert refused.status_code == 503
        assert "wait=true" in refused.json()["tip"]
        assert (await ask(params={"wait": "true", "timeout": 0})).status_code == 422
        waiting = asyncio.create_task(ask(params={"wait": "true", "timeout": PATIENCE}))
        await asyncio.sleep(0)
        assert not waiting.done()
        async with app.router.lifespan_context(app):
            answer = await waiting
            assert answer.status_code == 200, answer.text


async def test_a_command_whose_asker_has_gone_while_it_waited_is_not_carried_out(settings):
    app = create_app(settings)

    class Gone:
        async def is_disconnected(self) -> bool:
            return True

    with pytest.raises(ServiceBusy, match="prepared"):
        await Patience(cast("Any", Gone()), app.state.services, PATIENCE).until_ready()


async def test_openapi_documents_every_refusal(console):
    document = (await console.http.get("http://localhost/openapi.json")).json()
    identifiers = [each["operationId"] for path in document["paths"].values() for each in path.values()]
    assert len(identifiers) == len(set(identifiers))
    responses = document["paths"]["/api/v1/mission/commands"]["post"]["responses"]
    assert set(responses) == {"200", "400", "401", "403", "409", "413", "415", "422", "429", "503", "504"}
    assert list(responses["409"]["content"]) == ["application/problem+json"]
    assert "HTTPValidationError" not in document["components"]["schemas"]
    assert "MissionSnapshot" in document["components"]["schemas"]


async def test_documentation_needs_nothing_from_elsewhere(console):
    page = (await console.http.get("http://localhost/docs")).text
    assert '="swagger/swagger-ui-bundle.js"' in page
    assert "https://" not in page


async def test_unknown_address_and_method(console):
    for answer, status in (
        (await console.http.get("/nonesuch"), 404),
        (await console.http.put("/mission"), 405),
        (await console.http.get("/studies/estimate"), 405),
        (await console.http.delete("/studies/estimate"), 405),
    ):
        assert answer.status_code == status
        assert answer.headers["content-type"] == "application/problem+json"


async def test_other_hosts_and_pages_are_refused(console):
    lying = await console.http.get("/health", headers={"host": "elsewhere.example"})
    foreign = await console.http.post("/mission/stop", headers={"origin": "http://elsewhere.example"})
    own = await console.http.post("/mission/stop", headers={"origin": "http://localhost"})
    assert (lying.status_code, foreign.status_code, own.status_code) == (403, 403, 200)


async def test_shutdown_closes_the_run(settings):
    app = create_app(settings)
    async with (
        app.router.lifespan_context(app),
        httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://localhost/api/v1") as http,
    ):
        while (await http.get("/health")).json()["status"] == "preparing":
            pass
        assert (await http.post("/mission/commands", json={"command": "capture"})).status_code == 200
        run_id = (await http.get("/mission")).json()["run_id"]
    reader = RunStore(settings.data_dir / "runs").read(run_id)
    assert reader.record.status == "cancelled"
    assert reader.tick_count > 1


async def test_run_of_a_dead_process_is_recovered(settings, console):
    store = RunStore(settings.data_dir / "runs").make_root()
    record = new_record("live", "published", named_configuration("published"))
    store.create(record)  # running, and nobody holds its folder
    ticks = np.zeros(10, TICK)
    ticks["tick"], ticks["time"] = np.arange(10), np.arange(10) * 1e-3
    writer = RunWriter(store.root / record.id, record)
    for part in (ticks[:9], ticks[9:]):
        writer.append(part)
        writer.flush()
    writer.abandon()
    log = store.root / record.id / "log.mcap"
    log.write_bytes(log.read_bytes()[:-30])  # cut short in the middle of a chunk
    run = (await console.http.get(f"/runs/{record.id}")).json()
    assert run["status"] == "failed"
    assert "recovered" in run["note"]
    assert run["integrity"] == "recovered"
    assert run["ticks"] == 9


async def test_run_of_another_living_process_is_left_alone(settings, console):
    store = RunStore(settings.data_dir / "runs").make_root()
    record = new_record("live", "published", named_configuration("published"))
    store.create(record)
    writer = RunWriter(store.root / record.id, record)
    assert (await console.http.get(f"/runs/{record.id}")).json()["status"] == "running"
    writer.close(status="finished")
    assert (await console.http.get(f"/runs/{record.id}")).json()["status"] == "finished"


def test_kill_9_loses_less_than_a_second(tmp_path):
    environment = {**os.environ, "BECALM_DATA_DIR": str(tmp_path)}
    command = [sys.executable, "-m", "becalm", "serve", "--port", "0", "--no-open"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        url = re.search(r"http://\S+", process.stdout.readline())[0] + "api/v1"
        with httpx.Client(base_url=url, timeout=180) as http:
            _wait(lambda: http.get("/health").json()["status"] == "ok")
            http.post("/mission/commands", json={"command": "capture"}).raise_for_status()
            _wait(lambda: http.get("/mission").json()["time"] > 1.5)
            seen = http.get("/mission").json()
            # A clock that was held up catches up half a second, so that these two take more than a second.
            _wait(lambda: http.get("/mission").json()["time"] > seen["time"] + 2.0)
        process.kill()
    reader = RunStore(tmp_path / "runs").read(seen["run_id"])
    assert reader.record.status == "failed"
    assert "recovered" in (reader.record.note or "")
    assert reader.last_tick()["time"][0] > seen["time"]


def _wait(fits) -> None:
    deadline = time.monotonic() + 180
    while not fits():
        assert time.monotonic() < deadline
        time.sleep(0.02)


async def test_console_is_served_with_its_caching(tmp_path):
    (tmp_path / "assets").mkdir()
    (tmp_path / "index.html").write_text("<title>Becalm</title>")
    (tmp_path / "assets" / "index-1a2b.js").write_text("1")
    app = FastAPI()
    serve_console(app, tmp_path)
    async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://localhost") as http:
        page, script = await http.get("/"), await http.get("/assets/index-1a2b.js")
    assert "Becalm" in page.text
    assert page.headers["cache-control"] == "no-cache"
    assert "immutable" in script.headers["cache-control"]


async def test_service_without_a_built_console_says_so(tmp_path):
    app = FastAPI()
    serve_console(app, tmp_path)
    async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://localhost") as http:
        assert (await http.get("/")).status_code == 503
        assert (await http.get("/docs")).status_code == 200


async def test_service_starts_with_changes(tmp_path):
    settings = Settings(data_dir=tmp_path, configuration="published_figures", changes={"target": {"initial_spin": 0.6}})
    app = create_app(settings)
    async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://localhost/api/v1") as http:
        body = (await http.get("/mission/config")).json()
    assert body["edited"] == {"target.initial_spin": {"from": 1.0, "to": 0.6}}
