"""Shows the live mission in the scene, at the scene's own pace and in its own thread."""

from __future__ import annotations

import logging
import threading
from pathlib import Path
from typing import Any

from server.mission.feed import Feed, Latest
from server.mission.loop import MissionLoop
from server.scene import Scene
from server.scene.traces import TracedPoints

PERIOD = 1 / 30
"""Wall time between two pictures [s]."""

log = logging.getLogger(__name__)


class Projector:
    """Draws each latest snapshot once, while any browser shows the scene.

    A scene that fails is logged; the mission does not notice.
    """

    def __init__(self, scene: Scene, feed: Feed, loop: MissionLoop) -> None:
        self._scene = scene
        self._feed = feed
        self._loop = loop
        self._shown: Latest | None = None
        self._passed: Latest | None = None
        """What was noted last while nobody looked."""
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._project, name="becalm-scene", daemon=True)

    def start(self) -> Path:
        """Start the scene and its thread; the unix socket that the scene is served on."""
        doorway = self._scene.start()
        self._thread.start()
        return doorway

    def shutdown(self, timeout: float = 2.0) -> None:
        """End the thread and the scene."""
        self._closing.set()
        self._thread.join(timeout)
        self._scene.stop()

    def draw_latest(self) -> None:
        """Draw the latest snapshot; while nobody looks, only note where its bodies are. Neither is done twice."""
        latest, watched = self._feed.latest, self._scene.watched
        self._feed.drawn = watched
        if latest is None or latest is self._shown or (latest is self._passed and not watched):
            return
        try:
            self._scene.reconfigure(self._loop.view.config)
            if watched:
                self._shown = latest
                self._scene.show(latest.snapshot)
            else:
                self._passed = latest
                self._scene.pass_by(latest.tick, _traced(latest.row))
        except Exception:
            log.exception("the scene could not be drawn")

    def _project(self) -> None:
        while not self._closing.wait(PERIOD):
            self.draw_latest()


def _traced(row: Any) -> TracedPoints:
    """Centres of the target and of both hands in a tick, one element of `TICK`."""
    (target_x, target_y, _), (left, right) = row["target_pose"].tolist(), row["hand_pose"].tolist()
    return (target_x, target_y), (left[0], left[1]), (right[0], right[1])
