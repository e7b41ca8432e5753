"""A recorded run watched again: every moment as it was published, in a scene of its own, bounded and private."""

from __future__ import annotations

import asyncio
import json
import time
from functools import partial

import httpx
import msgspec
import pytest
import viser
import zstandard
from websockets import Subprotocol
from websockets.asyncio import client as websocket
from websockets.exceptions import ConnectionClosed

from server.library import replay_sessions
from server.settings import Settings

PATIENCE = 180.0

connect = partial(websocket.connect, open_timeout=PATIENCE)


@pytest.fixture(scope="module")
def served(serving, tmp_path_factory):
    """One service for all of them; they leave nothing behind but the run."""
    with serving(Settings(data_dir=tmp_path_factory.mktemp("data"), configuration="published_figures")) as running:
        yield running


@pytest.fixture(scope="module")
def run(served) -> dict:
    """A scripted run that has ended."""
    deadline = time.monotonic() + PATIENCE
    with httpx.Client(base_url=served.api, timeout=PATIENCE) as http:
        run = http.post("/runs", json={"configuration": "published", "direct": True}).json()
        while run["status"] not in ("finished", "failed"):
            assert time.monotonic() < deadline
            time.sleep(0.05)
            run = http.get(f"/runs/{run['id']}").json()
    assert run["status"] == "finished"
    return run


def _watching(served, run_id: str):
    return connect(f"ws://127.0.0.1:{served.port}/api/v1/runs/{run_id}/playback", max_size=None)


async def _next(socket) -> dict:
    async with asyncio.timeout(PATIENCE):
        return json.loads(await socket.recv())


async def _shown(socket, moment: float) -> dict:
    await socket.send(json.dumps({"type": "show", "time": moment}))
    return await _next(socket)


async def test_any_moment_is_shown_and_reported(served, run):
    async with _watching(served, run["id"]) as watcher:
        opened = await _next(watcher)
        assert opened["end"] == pytest.approx(run["duration"])
        late, early = [await _shown(watcher, moment) for moment in (opened["end"], 0.5)]
    assert late["outcome"] == run["outcome"]
    assert (early["type"], early["tick"], early["outcome"]) == ("snapshot", 500, None)
    assert early["run_id"] == run["id"]


async def test_its_scene_is_served_as_long_as_somebody_watches(served, run):
    root = f"http://127.0.0.1:{served.port}"
    async with httpx.AsyncClient(timeout=PATIENCE) as http:
        async with _watching(served, run["id"]) as watcher:
            scene = (await _next(watcher))["scene"]
            page = await http.get(root + scene)
            assert (page.status_code, "<canvas" in page.text or "<script" in page.text) == (200, True)
            address = f"ws://127.0.0.1:{served.port}{scene.rstrip('/')}"
            protocol = Subprotocol(f"viser-v{viser.__version__}")
            async with connect(address, subprotocols=[protocol], max_size=None, compression=None) as browser:
                async with asyncio.timeout(PATIENCE):
                    assert await browser.recv()
        async with asyncio.timeout(PATIENCE):
            while (await http.get(root + scene)).status_code != 404:
                await asyncio.sleep(0.02)


def _messages(frame: bytes) -> list[dict]:
    """What viser says in one frame: two lengths, then its messages, compressed."""
    packed = frame[16 : 16 + int.from_bytes(frame[8:16], "little")]
    return msgspec.msgpack.decode(zstandard.ZstdDecompressor().decompress(packed))["messages"]


async def test_a_picture_is_asked_of_the_browser_behind_what_it_shows(served, run):
    async with _watching(served, run["id"]) as watcher:
        scene = (await _next(watcher))["scene"]
        address = f"ws://127.0.0.1:{served.port}{scene.rstrip('/')}"
        protocol = Subprotocol(f"viser-v{viser.__version__}")
        async with connect(address, subprotocols=[protocol], max_size=None, compression=None) as browser:
            asked = {"type": "picture", "name": "one", "time": run["duration"], "width": 640, "height": 360}
            await watcher.send(json.dumps(asked))
            shown = await _next(watcher)
            assert shown["outcome"] == run["outcome"]
            said: list[dict] = []
            async with asyncio.timeout(PATIENCE):
                while not said or said[-1]["type"] != "GetRenderRequestMessage":
                    said += _messages(bytes(await browser.recv(decode=False)))
    *before, request = said
    assert (request["render_uuid"], request["width"], request["height"]) == ("one", 640, 360)
    assert request["format"] == "image/png"  # without a background
    moved = [each for each in before if each["type"] == "SetPositionMessage" and each["name"] == "/target"]
    assert moved[-1]["position"][:2] == pytest.approx(shown["target"]["pose"][:2], abs=1e-4)


async def test_camera_and_layers_are_its_own(served, run):
    async with (
        _watching(served, run["id"]) as watcher,
        httpx.AsyncClient(base_url=served.api, timeout=PATIENCE) as http,
    ):
        await _next(watcher)
        await watcher.send(json.dumps({"type": "arrange", "camera": "top", "layers": {"trails": False}}))
        await _shown(watcher, 1.0)
        live = (await http.get("/scene")).json()
    assert (live["camera"], live["layers"]["trails"]) == ("perspective", True)


@pytest.mark.parametrize(
    ("message", "named"),
    [
        ('{"type":"show","time":-1}', "time"),
        ('{"type":"show","time":1e999}', "time"),
        ('{"type":"dance"}', "dance"),
        ("[]", "object"),
        ('{"type":"arrange","layers":{"stars":true}}', "stars"),
        ('{"type":"picture","name":"a b","time":1,"width":640,"height":360}', "name"),
        ('{"type":"picture","name":"a","time":1,"width":640,"height":100000}', "height"),
    ],
)
async def test_what_is_no_message_is_told_and_the_watching_goes_on(served, run, message, named):
    async with _watching(served, run["id"]) as watcher:
        await _next(watcher)
        await watcher.send(message)
        answer = await _next(watcher)
        assert answer["type"] == "invalid"
        assert named in answer["detail"]
        assert (await _shown(watcher, 0.5))["tick"] == 500


async def test_a_run_that_is_none_is_refused_with_a_reason(served):
    async with _watching(served, "20260101T000000000-abcdef") as watcher:
        refused = await _next(watcher)
        assert (refused["type"], refused["problem"]["status"]) == ("refused", 404)
        with pytest.raises(ConnectionClosed):
            await watcher.recv()


async def _opened(served, run) -> None:
    """Wait until it may be watched: who watched before may still be leaving."""
    async with asyncio.timeout(PATIENCE):
        while True:
            async with _watching(served, run["id"]) as watcher:
                if (await _next(watcher))["type"] == "opened":
                    return


async def test_only_so_many_at_once(served, run, monkeypatch):
    monkeypatch.setattr(replay_sessions, "MAX_SESSIONS", 1)
    async with asyncio.timeout(PATIENCE):
        while True:
            async with _watching(served, run["id"]) as watcher:
                if (await _next(watcher))["type"] == "opened":
                    async with _watching(served, run["id"]) as second:
                        assert (await _next(second))["problem"]["status"] == 503
                    break
    await _opened(served, run)


async def test_the_live_scene_is_arranged_over_rest(console):
    changed = await console.http.patch("/scene", json={"camera": "top", "layers": {"frames": True}})
    assert changed.status_code == 200
    assert (await console.http.get("/scene")).json() == changed.json()
    assert (changed.json()["camera"], changed.json()["layers"]["frames"]) == ("top", True)
    refused = await console.http.patch("/scene", json={"layers": {"stars": True}})
    assert refused.status_code == 422
    assert "stars" in refused.json()["detail"]
