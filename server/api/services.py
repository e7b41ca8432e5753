"""What the resources work with, composed once by `server.app`."""

from __future__ import annotations

import asyncio
import time
from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Query, Request
from starlette.requests import HTTPConnection

from server.access.guard import Access, holder_of
from server.alarms.watch import AlarmWatch
from server.jobs.queue import JobQueue
from server.library.index import RunIndex
from server.library.journal import Journal
from server.library.presets import PresetStore
from server.library.recorder import Recorder
from server.library.replay_sessions import ReplaySessions
from server.library.runs import RunStore
from server.library.scripted import ScriptedRuns
from server.library.shift_log import ShiftEntry
from server.link.robot_link import RobotLink
from server.mission.feed import Feed
from server.mission.loop import MissionLoop
from server.process.aside import Aside
from server.process.disk import DiskGuard
from server.rehearsals.foreseen import Foreseen
from server.rehearsals.look_ahead import LookAhead
from server.scene import Scene
from server.settings import Settings
from server.studies.queue import StudyQueue
from server.studies.store import StudyStore


@dataclass(frozen=True)
class Services:
    """One of each."""

    settings: Settings
    access: Access
    feed: Feed
    loop: MissionLoop
    link: RobotLink | None
    """None in simulation."""
    recorder: Recorder
    disk: DiskGuard
    store: RunStore
    index: RunIndex
    scripted: ScriptedRuns
    presets: PresetStore
    studies: StudyStore
    study_queue: StudyQueue
    rehearsals: JobQueue
    fits: JobQueue
    """Fits, which have a worker of their own."""
    look_ahead: LookAhead
    foreseen: Foreseen
    aside: Aside
    alarms: AlarmWatch
    shift_log: Journal[ShiftEntry]
    scene: Scene
    replay_sessions: ReplaySessions


# Asynchronous, though they wait for nothing: FastAPI gives others to a pool of threads, which readers may fill, and
# STOP needs both of these.
async def _services(connection: HTTPConnection) -> Services:
    services: Services = connection.app.state.services
    return services


ServicesDep = Annotated[Services, Depends(_services)]


async def _asker(connection: HTTPConnection) -> str:
    holder = holder_of(connection)
    assert holder is not None, "the guard lets nobody in here without one"
    return holder.name


LONGEST_WAIT = 600.0
"""For which a request may ask to wait [s]."""

LOOK_PERIOD = 0.05
"""Between two looks whether there is a mission [s]."""


@dataclass(frozen=True)
class Patience:
    """How long a request waits for a mission that is still being prepared."""

    connection: Request
    services: Services
    seconds: float

    async def until_ready(self) -> None:
        """Return as soon as there is a mission, or the time is over.

        Raises:
            ServiceBusy: whoever asked has gone: nothing is done for them later.

        """
        loop, until = self.services.loop, time.monotonic() + self.seconds
        while loop.status == "preparing" and not loop.ending and time.monotonic() < until:
            await asyncio.sleep(LOOK_PERIOD)
            if await self.connection.is_disconnected():
                raise loop.not_ready()


async def _patience(
    connection: Request,
    services: ServicesDep,
    wait: Annotated[bool, Query(description="Wait while the simulation is prepared, in place of a 503")] = False,
    timeout: Annotated[float, Query(gt=0, le=LONGEST_WAIT, description="With `wait`: how long at most [s]")] = 60.0,
) -> Patience:
    return Patience(connection, services, timeout if wait else 0.0)


PatienceDep = Annotated[Patience, Depends(_patience)]

AskerDep = Annotated[str, Depends(_asker)]
"""The name of who asks, as the mission's log keeps it."""
