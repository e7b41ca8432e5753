"""The scene as a browser receives it from its own socket."""

import contextlib
import stat
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import viser
from websockets.sync.client import unix_connect

from server.scene import CAMERAS, LAYERS, Scene
from sim.capture.mission import Mission
from sim.config import MissionConfig, TargetConfig
from sim.configurations import revised
from sim.rehearsal.summary import CaseResult
from sim.rehearsal.summary import Path as Way

QUIET = 1.0
"""A scene that sends nothing for this long has nothing to send [s]."""
PATIENCE = 180.0
"""Bound on the wait for what must come [s]."""
WHOLE_SCENE = 100_000
"""Far more than any change, less than all meshes [bytes]."""


@pytest.fixture
def scene():
    scene = Scene(MissionConfig())
    yield scene
    scene.stop()


def flown():
    mission = Mission(MissionConfig())
    mission.advance(1)
    return mission


def joined(doorway):
    protocol = f"viser-v{viser.__version__}"
    return unix_connect(
        str(doorway),
        "ws://viser/",
        subprotocols=[protocol],
        compression=None,
        max_size=None,
        open_timeout=PATIENCE,
    )


def drained(browser, *, more_than=-1):
    """Bytes received until the scene is quiet, and as many have come as must."""
    received = 0
    while True:
        try:
            received += len(browser.recv(timeout=QUIET if received > more_than else PATIENCE))
        except TimeoutError:
            return received


def test_a_late_browser_gets_the_whole_scene_and_then_only_what_changes(scene):
    doorway = scene.start()
    mission = flown()
    scene.show(mission.snapshot())
    with joined(doorway) as browser:
        assert drained(browser, more_than=WHOLE_SCENE) > WHOLE_SCENE
        scene.show(mission.snapshot())
        assert drained(browser) == 0
        mission.advance(50)
        scene.show(mission.snapshot())
        assert 0 < drained(browser, more_than=0) < 2_000


def test_it_knows_whether_it_is_watched_and_draws_trails_of_what_nobody_watched(scene):
    doorway = scene.start()
    assert not scene.watched
    mission = flown()
    scene.show(mission.snapshot())
    for tick in range(1, 20):
        scene.pass_by(tick + 1, ((0.01 * tick, 0.5), (-0.3, 0.0), (0.3, 0.0)))
    with joined(doorway) as browser:
        unseen = drained(browser, more_than=WHOLE_SCENE)
        assert scene.watched
        mission.advance(50)
        scene.show(mission.snapshot())
        trail = drained(browser, more_than=0)
        mission.advance(1)
        scene.show(mission.snapshot())
        assert trail > 10_000 > drained(browser, more_than=0)
    assert unseen > WHOLE_SCENE


def test_only_another_geometry_is_drawn_again(scene):
    config = MissionConfig()
    with joined(scene.start()) as browser:
        drained(browser, more_than=WHOLE_SCENE)
        scene.reconfigure(revised(config, {"published": {"impedance": {"damping": 3.0}}}))
        assert drained(browser) == 0
        scene.reconfigure(config.model_copy(update={"target": TargetConfig(side=0.2)}))
        assert drained(browser, more_than=WHOLE_SCENE) > WHOLE_SCENE


def test_layers_are_switched_by_name(scene):
    assert scene.layers == {layer: layer not in ("frames", "reach") for layer in LAYERS}
    with joined(scene.start()) as browser:
        drained(browser, more_than=WHOLE_SCENE)
        scene.set_layers({"trails": False, "frames": True})
        assert drained(browser, more_than=0) > 0
    assert scene.layers["frames"]
    with pytest.raises(ValueError, match="stars"):
        scene.set_layers({"stars": True})


@pytest.mark.parametrize("camera", CAMERAS)
def test_every_camera_can_be_chosen_before_any_browser_is_there(scene, camera):
    scene.start()
    scene.set_camera(camera)
    scene.show(flown().snapshot())
    assert scene.camera == camera


def test_an_unknown_camera_is_refused(scene):
    with pytest.raises(ValueError, match="moon"):
        scene.set_camera("moon")


def test_a_scene_that_is_not_started_ignores_snapshots(scene):
    scene.show(flown().snapshot())


def test_nothing_is_printed_on_standard_output(capsys):
    scene = Scene(MissionConfig())
    scene.start()
    scene.stop()
    assert capsys.readouterr().out == ""


def listening_here() -> list[int]:
    """TCP ports that this process listens on (Linux)."""
    inodes = set()
    for each in Path("/proc/self/fd").iterdir():
        with contextlib.suppress(OSError):
            inodes.add(each.readlink().name.removeprefix("socket:[").removesuffix("]"))
    rows = [line.split() for table in ("tcp", "tcp6") for line in _lines(Path("/proc/self/net") / table)]
    return [int(row[1].rpartition(":")[2], 16) for row in rows if row[3] == "0A" and row[9] in inodes]


def _lines(table: Path) -> list[str]:
    return table.read_text().splitlines()[1:] if table.exists() else []


def test_it_has_no_port_and_only_this_user_reaches_it(scene):
    before = listening_here()
    doorway = scene.start()
    assert listening_here() == before
    assert stat.S_IMODE(doorway.parent.stat().st_mode) == 0o700
    scene.stop()
    assert not doorway.parent.exists()


def test_a_long_name_of_the_temporary_folder_does_no_harm(scene, tmp_path, monkeypatch):
    folder = tmp_path / ("x" * 90)
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    assert scene.start().is_socket()


def foretold(futures, most_likely, worst):
    """A case whose futures go straight out by 10 cm each, every one from a place of its own."""

    def way(place):
        return [[place + 0.02 * step, place, 0.1 * step] for step in range(6)]

    paths = [
        Way(future=number, times=[0.1 * step for step in range(6)], base=way(0.0), target=way(number / 10),
             left=way(number / 10 + 0.01), right=way(number / 10 + 0.02))
        for number in range(futures)
    ]  # fmt: skip
    said: dict[str, Any] = {"paths": paths, "most_likely": most_likely, "worst": worst}
    return CaseResult.model_construct(**said)


def test_futures_are_drawn_until_the_mission_begins_again(scene):
    scene.start()
    mission = flown()
    scene.show(mission.snapshot())
    scene.foretell(foretold(5, most_likely=2, worst=4))
    drawing = scene._futures
    lines = {line.name: line for line in drawing._lines}
    bodies = ("target", "left", "right")
    assert set(lines) == {f"/futures/{what}_{body}" for what in ("bundle", "likely", "worst") for body in bodies}
    assert len(lines["/futures/bundle_left"].points) == 3 * 5
    np.testing.assert_allclose(lines["/futures/worst_target"].points[0, 0, :2], (0.4, 0.4))
    assert drawing._ghost.handle.visible
    np.testing.assert_allclose(drawing._ghost.handle.position[:2], (0.3, 0.2))
    mission.advance(10)
    scene.show(mission.snapshot())
    scene.pass_by(1, ((0.0, 0.35), (0.1, 0.3), (-0.1, 0.3)))  # begun again while nobody looks
    assert not drawing._lines
    scene.foretell(foretold(5, most_likely=2, worst=4))
    scene.show(mission.snapshot())
    assert drawing._lines
    scene.show(flown().snapshot())
    assert not drawing._lines
    assert not drawing._ghost.handle.visible
