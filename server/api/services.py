"""What the resources work with, composed once by `server.app`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends
from starlette.requests import HTTPConnection

from server.feed import Feed
from server.loop import MissionLoop
from server.runs import RunStore
from server.scripted import ScriptedRuns
from server.settings import Settings
from server.studies import StudyStore
from server.study_queue import StudyQueue


@dataclass(frozen=True)
class Services:
    """One of each."""

    settings: Settings
    feed: Feed
    loop: MissionLoop
    store: RunStore
    scripted: ScriptedRuns
    studies: StudyStore
    study_queue: StudyQueue


def _services(connection: HTTPConnection) -> Services:
    services: Services = connection.app.state.services
    return services


ServicesDep = Annotated[Services, Depends(_services)]
