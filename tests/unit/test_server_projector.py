"""What the scene is given of the live mission: each snapshot once."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from server.mission.projector import Projector
from sim.capture.tick import TICK


class Scene:
    """Keeps what it is given."""

    def __init__(self) -> None:
        self.watched = False
        self.given: list[Any] = []

    def reconfigure(self, _config: object) -> None:
        pass

    def show(self, snapshot: object) -> None:
        self.given.append(("shown", snapshot))

    def pass_by(self, tick: int, _points: object) -> None:
        self.given.append(("passed", tick))


def _latest(tick: int) -> Any:
    return SimpleNamespace(tick=tick, row=np.zeros(1, TICK)[0], snapshot=f"snapshot {tick}")


def test_each_snapshot_is_passed_once_and_drawn_once():
    scene, feed = Scene(), SimpleNamespace(latest=None, drawn=False)
    loop = SimpleNamespace(view=SimpleNamespace(config=None))
    projector = Projector(scene, feed, loop)  # type: ignore[arg-type]  # what stands in for them
    for tick, watched in ((1, False), (2, False), (2, True), (3, True), (3, False), (4, False)):
        if feed.latest is None or feed.latest.tick != tick:
            feed.latest = _latest(tick)
        scene.watched = watched
        for _ in range(3):
            projector.draw_latest()
        assert feed.drawn == watched
    assert scene.given == [
        ("passed", 1), ("passed", 2), ("shown", "snapshot 2"), ("shown", "snapshot 3"), ("passed", 4)
    ]  # fmt: skip
