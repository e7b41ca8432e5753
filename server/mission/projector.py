"""Shows the live mission in the scene, at the scene's own pace and in its own thread."""

from __future__ import annotations

import logging
import threading
from pathlib import Path

from server.mission.feed import Feed
from server.mission.loop import MissionLoop
from server.scene import Scene

PERIOD = 1 / 30
"""Wall time between two pictures [s]."""

log = logging.getLogger(__name__)


class Projector:
    """Draws each latest snapshot once. A scene that fails is logged; the mission does not notice."""

    def __init__(self, scene: Scene, feed: Feed, loop: MissionLoop) -> None:
        self._scene = scene
        self._feed = feed
        self._loop = loop
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

    def _project(self) -> None:
        shown = None
        while not self._closing.wait(PERIOD):
            latest = self._feed.latest
            if latest is None or latest is shown:
                continue
            shown = latest
            try:
                self._scene.reconfigure(self._loop.view.config)
                self._scene.show(latest.snapshot)
            except Exception:
                log.exception("the scene could not be drawn")
