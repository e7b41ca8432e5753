"""The scene through the service's port: page and websocket, real viser and real uvicorn."""

import contextlib
import socket
import threading
import time

import httpx
import msgspec
import pytest
import uvicorn
import viser
import zstandard
from fastapi import FastAPI
from websockets.exceptions import ConnectionClosedError, InvalidStatus
from websockets.sync.client import connect

from benchmarks.loads import CAMERA
from server.access.origin import SameOrigin
from server.pages import scene_proxy
from server.pages.scene_light import lightened
from server.pages.scene_page import HEAD
from server.scene import Scene
from sim.config import MissionConfig

PATIENCE = 180.0
"""Bound on every wait [s]: far beyond any of them, so that only a hang reaches it."""
PROTOCOL = f"viser-v{viser.__version__}"


@contextlib.contextmanager
def served(doorway):
    """The address of an application that has the proxy and the service's own origin check."""
    app = FastAPI()
    app.state.scene_doorway = doorway
    app.include_router(scene_proxy.router)
    app.add_middleware(SameOrigin, hosts=("127.0.0.1",))
    with socket.create_server(("127.0.0.1", 0)) as listener:
        server = uvicorn.Server(uvicorn.Config(app, log_level="error", ws="websockets-sansio"))
        thread = threading.Thread(target=server.run, args=([listener],))
        thread.start()
        deadline = time.monotonic() + PATIENCE
        while not server.started and time.monotonic() < deadline:
            time.sleep(0.01)
        try:
            yield f"127.0.0.1:{listener.getsockname()[1]}"
        finally:
            server.should_exit = True
            thread.join(PATIENCE)


@pytest.fixture(scope="module")
def address():
    scene = Scene(MissionConfig())
    with served(scene.start()) as address:
        yield address
    scene.stop()


def socket_of(address, origin=None, subprotocols=(PROTOCOL,), path="/scene"):
    return connect(
        f"ws://{address}{path}", origin=origin, subprotocols=subprotocols, compression=None, max_size=None, proxy=None
    )


def test_the_page_comes_with_our_head_and_only_into_our_own_frames(address):
    page = httpx.get(f"http://{address}/scene/", trust_env=False, timeout=PATIENCE)
    assert page.status_code == 200
    assert page.headers["content-type"].startswith("text/html")
    assert "frame-ancestors 'self'" in page.headers["content-security-policy"]
    assert HEAD in page.text
    again = {"If-None-Match": page.headers["etag"]}
    answer = httpx.get(f"http://{address}/scene/", headers=again, trust_env=False, timeout=PATIENCE)
    assert (answer.status_code, answer.content) == (304, b"")
    assert answer.headers["content-security-policy"] == page.headers["content-security-policy"]


def test_without_its_slash_the_page_is_still_found(address):
    answer = httpx.get(f"http://{address}/scene", trust_env=False, timeout=PATIENCE)
    assert answer.is_redirect
    assert answer.headers["location"] == "/scene/"


def test_files_that_viser_has_not_are_not_found(address):
    assert httpx.get(f"http://{address}/scene/nothing.js", trust_env=False, timeout=PATIENCE).status_code == 404


@pytest.mark.parametrize("own", [True, False])
def test_the_websocket_passes_with_its_subprotocol(address, own):
    """From our own page, and from a client that is no page; the whole scene arrives."""
    with socket_of(address, origin=f"http://{address}" if own else None) as stream:
        assert stream.subprotocol == PROTOCOL
        received = 0
        while received < 100_000:
            frame = stream.recv(timeout=PATIENCE)
            assert isinstance(frame, bytes)
            received += len(frame)


def messages_of(frame):
    """The messages of a frame of viser's, and the arrays behind them."""
    packed = int.from_bytes(frame[8:16], "little")
    body = msgspec.msgpack.decode(zstandard.ZstdDecompressor().decompress(frame[16 : 16 + packed]))
    lengths = body["binaryBufferLengths"]
    return body["messages"], lengths, frame[-(-(16 + packed) // 8) * 8 :]


def whole_scene(address, path):
    """Messages by their type, until the last of the scene's lights has come, and all raw arrays."""
    found, arrays = {}, []
    with socket_of(address, path=path) as stream:
        while not {"EnvironmentMapMessage", "SpotLightMessage", "HemisphereLightMessage", "GlbMessage"} <= set(found):
            messages, lengths, raw = messages_of(stream.recv(timeout=PATIENCE))
            for message in messages:
                found.setdefault(message["type"], []).append(message)
            arrays += [raw[: sum(lengths)]] if lengths else []
    return found, arrays


def test_a_light_scene_has_no_environment_map_and_no_shadows_and_is_else_the_same(address):
    full, arrays = whole_scene(address, "/scene")
    light, same_arrays = whole_scene(address, "/scene/light")
    assert len(full["EnvironmentMapMessage"][0]["hdri_data"]) > 10_000
    assert light["EnvironmentMapMessage"][0]["hdri_data"] is None
    assert any(lamp["props"]["cast_shadow"] for lamp in full["SpotLightMessage"])
    assert not any(lamp["props"]["cast_shadow"] for lamp in light["SpotLightMessage"])
    brightness = [scene["HemisphereLightMessage"][0]["props"]["intensity"] for scene in (full, light)]
    assert brightness[1] > brightness[0]
    assert [each["name"] for each in light["GlbMessage"]] == [each["name"] for each in full["GlbMessage"]]
    assert arrays[:1] == same_arrays[:1]


@pytest.mark.parametrize("rubbish", [b"", b"short", bytes(64), b"\xff" * 200])
def test_what_is_no_frame_of_visers_is_passed_on_as_it_is(rubbish):
    assert lightened(rubbish) == rubbish


def test_a_browser_says_where_its_camera_is_and_nothing_else():
    """What viser would keep and repeat to others, what it would stumble over, and what is no number stays outside."""
    scene = Scene(MissionConfig())
    with served(scene.start()) as address, socket_of(address) as stream:
        script = {"type": "RunJavascriptMessage", "source": "alert(1)"}
        for strange in (b"rubbish", script, CAMERA | {"position": [float("nan")] * 3}, CAMERA | {"type": "Nothing"}):
            stream.send(strange if isinstance(strange, bytes) else msgspec.msgpack.encode(strange))
        stream.send("text")
        for number in range(5):
            stream.send(msgspec.msgpack.encode(CAMERA | {"position": [0.1 * number, -2.0, 3.0]}))
        deadline = time.monotonic() + PATIENCE
        told = []
        while told != [(0.4, -2.0, 3.0)] and time.monotonic() < deadline:
            time.sleep(0.01)
            told = [tuple(each.camera.position) for each in scene._server.get_clients().values()]
        assert told == [(0.4, -2.0, 3.0)]
    scene.stop()


def test_a_foreign_page_is_refused(address):
    with pytest.raises(InvalidStatus) as refused, socket_of(address, origin="http://elsewhere.example"):
        pass
    assert refused.value.response.status_code == 403


def test_another_viser_version_is_told_so(address):
    with pytest.raises(ConnectionClosedError) as closed, socket_of(address, subprotocols=("viser-v0.0.0",)) as stream:
        stream.recv(timeout=PATIENCE)
    assert closed.value.rcvd.code == 1002


def test_a_scene_that_is_gone_is_said_to_be(tmp_path):
    with served(tmp_path / "gone") as address:
        assert httpx.get(f"http://{address}/scene/", trust_env=False, timeout=PATIENCE).status_code == 503
        with pytest.raises(InvalidStatus), socket_of(address):
            pass
