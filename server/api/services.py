"""What the resources work with, composed once by `server.app`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends
from starlette.requests import HTTPConnection

from server.access.guard import Access, holder_of
from server.library.index import RunIndex
from server.library.presets import PresetStore
from server.library.recorder import Recorder
from server.library.replay_sessions import ReplaySessions
from server.library.runs import RunStore
from server.library.scripted import ScriptedRuns
from server.link.robot_link import RobotLink
from server.mission.feed import Feed
from server.mission.loop import MissionLoop
from server.process.aside import Aside
from server.process.disk import DiskGuard
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
    aside: Aside
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


AskerDep = Annotated[str, Depends(_asker)]
"""The name of who asks, as the mission's log keeps it."""
