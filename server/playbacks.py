"""Recorded runs that somebody watches again, each in a scene of its own.

Whoever watches holds the clock: they name a moment, and it is drawn and answered. Nothing here plays by itself.
"""

from __future__ import annotations

import secrets
import threading
from pathlib import Path

from server.control import Control
from server.problems import ServiceBusy
from server.published import MissionSnapshot, PlantStatus
from server.run_folder import RunReader
from server.scene import Scene
from sim.capture.playback import Playback

AT_ONCE = 8
"""Scenes of recorded runs that may be open; each is a server of its own."""

_STANDS_STILL = PlantStatus(running=False, speed=1.0, lateness=0.0, real_time_factor=0.0)


class Screening:
    """One recorded run and its scene; one call at a time."""

    def __init__(self, reader: RunReader) -> None:
        """Open the run at its start; the scene's server is running then."""
        self._record = reader.record
        self._playback = Playback(reader.history(), reader.chunks)
        self.scene = Scene(reader.record.config)
        self.doorway = self.scene.start()
        """The unix socket that the scene is served on."""

    def show(self, time: float) -> MissionSnapshot:
        """Draw the run at that mission time [s]; what was published then, but for what only a live mission has.

        Raises:
            MissionRefused: today's phases do not allow a command that was granted then.

        """
        snapshot = self._playback.at(time)
        self.scene.reconfigure(self._playback.config)
        self.scene.show(snapshot)
        return MissionSnapshot(
            **dict(snapshot),
            run_id=self._record.id,
            configuration=self._record.configuration,
            plant=_STANDS_STILL,
            commands={},
            control=Control(),
            problems=(),
        )

    def close(self) -> None:
        """End the scene."""
        self.scene.stop()


class Playbacks:
    """The screenings that are open, by keys that cannot be guessed; called from any thread."""

    def __init__(self) -> None:
        self._open: dict[str, Screening | None] = {}
        self._lock = threading.Lock()

    def open(self, reader: RunReader) -> tuple[str, Screening]:
        """A new screening and its key.

        Raises:
            ServiceBusy: as many as may be are open.
            ConfigError: the run's configuration cannot be laid out today.

        """
        key = secrets.token_hex(8)
        with self._lock:
            if len(self._open) >= AT_ONCE:
                what = f"{AT_ONCE} recorded runs are being watched already"
                raise ServiceBusy(what, tip="close one of the pages that replay a run, then try again")
            self._open[key] = None
        try:
            screening = Screening(reader)
        except BaseException:
            self._open.pop(key, None)
            raise
        self._open[key] = screening
        return key, screening

    def doorway(self, key: str) -> Path | None:
        """The unix socket of a screening's scene; None if there is none."""
        screening = self._open.get(key)
        return None if screening is None else screening.doorway

    def close(self, key: str) -> None:
        """End a screening."""
        screening = self._open.pop(key, None)
        if screening is not None:
            screening.close()

    def shutdown(self) -> None:
        """End all of them."""
        for key in tuple(self._open):
            self.close(key)
