"""A recorded run that somebody watches again: its scene and its moments, in a process of its own.

To draw it takes as much of Python as the live scene does, and to go to a moment far away all of it for seconds: beside
a mission that would cost ticks. Whoever watches holds the clock: they name a moment, and it is drawn and answered.
"""

from __future__ import annotations

import contextlib
import shutil
import threading
from collections.abc import Mapping
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from time import monotonic
from typing import Any, NamedTuple

from server.errors import ServiceBusy
from server.instants import wall_clock
from server.library.runs import RunStore
from server.process.aside import CONTEXT, END_TIME, begin_aside
from server.published import Control, MissionSnapshot, PlantStatus
from server.scene import CameraName, Picture, Scene
from sim.capture.mission import Mission
from sim.capture.playback import Playback
from sim.capture.replay import FlightHistory, Follower
from sim.config import MissionConfig
from sim.errors import CaptureError, MissionRefused

NICENESS = 5
"""A person waits for it; the live mission's clock comes first all the same."""

_STANDS_STILL = PlantStatus(running=False, speed=1.0, lateness=0.0, real_time_factor=0.0)


def prepare_replay() -> None:
    """Compile what a replay runs (some seconds at the first one; cached on disk afterwards)."""
    Follower(FlightHistory(config=MissionConfig())).follow(Mission(MissionConfig()).advance(2))


class Opened(NamedTuple):
    """What there is to watch."""

    doorway: Path
    """The unix socket that the scene is served on."""
    end: float
    """Mission time of the last recorded tick [s]."""
    camera: CameraName
    layers: dict[str, bool]


class _Projection:
    """One recorded run and its scene."""

    def __init__(self, root: Path, run_id: str) -> None:
        """Open the run at its start; the scene's server is running then.

        Raises:
            RunNotFound: there is no such run.
            MissionRefused: it has recorded nothing.
            ConfigError: the run's configuration cannot be laid out today.

        """
        reader = RunStore(root).read(run_id)
        if not reader.has_log:
            what = f"run {run_id} has no log: it is {reader.record.status}"
            raise MissionRefused(what, tip="ask again when it flies")
        last = reader.last_tick()
        self._record = reader.record
        self._playback = Playback(reader.history(), reader.chunks)
        self._scene = Scene(reader.record.config)
        end = 0.0 if last is None else float(last["time"][0])
        self.opened = Opened(self._scene.start(), end, self._scene.camera, self._scene.layers)

    def show(self, time: float) -> str:
        """Draw the run at that mission time [s]; as JSON what was published then, but for what only a live mission has.

        Raises:
            MissionRefused: today's phases do not allow a command that was granted then.

        """
        snapshot = self._playback.at(time)
        self._scene.reconfigure(self._playback.config)
        self._scene.show(snapshot)
        return MissionSnapshot(
            **dict(snapshot),
            made_at=wall_clock(),
            service_time=monotonic(),
            robot=None,
            run_id=self._record.id,
            configuration=self._record.configuration,
            plant=_STANDS_STILL,
            commands={},
            control=Control(),
            arming_needed=(),
            armed=None,
            problems=(),
        ).model_dump_json()

    def picture(self, time: float, picture: Picture) -> str:
        """As `show`, and then have the browser draw that picture of it.

        Raises:
            MissionRefused: today's phases do not allow a command that was granted then.

        """
        snapshot = self.show(time)
        self._scene.ask_for(picture)
        return snapshot

    def arrange(self, camera: CameraName | None, layers: Mapping[str, bool]) -> None:
        """Choose camera and layers; None leaves the camera."""
        self._scene.arrange(camera, layers)


class ReplaySession:
    """A projection in its own process, as the service sees it; one call at a time."""

    def __init__(self, root: Path, run_id: str) -> None:
        """Open the run of that library.

        Raises:
            CaptureError: it cannot be watched.
            ServiceBusy: its process was lost.

        """
        self._pipe, theirs = CONTEXT.Pipe()
        self._process: BaseProcess = CONTEXT.Process(target=_project, args=(root, run_id, theirs), daemon=True)
        self._process.start()
        theirs.close()
        self._doorway: Path | None = None
        try:
            self.opened: Opened = self._answer()
            self._doorway = self.opened.doorway
        except BaseException:
            self.close()
            raise

    def show(self, time: float) -> str:
        """As the projection's.

        Raises:
            MissionRefused: today's phases do not allow a command that was granted then.
            ServiceBusy: its process was lost.

        """
        return str(self._call("show", time))

    def picture(self, time: float, picture: Picture) -> str:
        """As the projection's.

        Raises:
            MissionRefused: today's phases do not allow a command that was granted then.
            ServiceBusy: its process was lost.

        """
        return str(self._call("picture", time, picture))

    def arrange(self, camera: CameraName | None, layers: Mapping[str, bool]) -> None:
        """As the projection's.

        Raises:
            ServiceBusy: its process was lost.

        """
        self._call("arrange", camera, dict(layers))

    def close(self) -> None:
        """End it, whatever it does; waits for nothing."""
        self._process.kill()
        threading.Thread(target=self._forget, daemon=True).start()

    def _forget(self) -> None:
        self._process.join(END_TIME)
        self._pipe.close()
        if self._doorway is not None:
            shutil.rmtree(self._doorway.parent, ignore_errors=True)  # it had no time to

    def _call(self, name: str, *arguments: Any) -> Any:
        with contextlib.suppress(OSError):  # reading reports it
            self._pipe.send((name, arguments))
        return self._answer()

    def _answer(self) -> Any:
        try:
            refusal, result = self._pipe.recv()
        except (EOFError, OSError):
            raise ServiceBusy("the process that shows the run was lost", tip="open the replay again") from None
        if refusal is not None:
            raise refusal
        return result


def _project(root: Path, run_id: str, pipe: Connection) -> None:
    """Be the process of one session, until it is killed or the service ends."""
    begin_aside(NICENESS)
    try:
        projection = _Projection(root, run_id)
    except CaptureError as refusal:
        pipe.send((refusal, None))
        return
    pipe.send((None, projection.opened))
    with contextlib.suppress(EOFError):
        while True:
            name, arguments = pipe.recv()
            try:
                pipe.send((None, getattr(projection, name)(*arguments)))
            except CaptureError as refusal:
                pipe.send((refusal, None))
