"""How requests reach the mission thread: a bounded queue of (request, future), and STOP beside it."""

from __future__ import annotations

import json
import threading
from collections import deque
from collections.abc import Iterator, Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

from pydantic import Field

from server.errors import ServiceBusy
from server.mission.fork import Fork
from sim.config import MissionConfig
from sim.snapshot import FrozenMessage

CAPACITY = 32
"""Requests that may wait; a healthy loop empties the inbox every few milliseconds."""

CommandName = Literal[
    "capture",
    "detumble",
    "cage",
    "direct_cage",
    "hold",
    "release",
    "reset",
    "pause",
    "run",
    "step",
    "fork",
    "stop",
    "configure",
    "arm",
    "take_control",
    "relieve",
    "hand_over",
    "release_control",
]


class Revision(NamedTuple):
    """A configuration that was made from another one, and checked, by the thread that asks."""

    before: MissionConfig
    """In force when it was made."""
    after: MissionConfig


def arguments_of(configuration: str | None = None, changes: Mapping[str, Any] | None = None) -> str:
    """A request's arguments as a text: the same for the same arguments, whatever the order of their names."""
    return json.dumps([configuration, changes or {}], sort_keys=True)


@dataclass(frozen=True)
class Request:
    """What somebody asks of the mission thread."""

    command: CommandName
    who: str = "operator"
    speed: float | None = None
    ticks: int = 1
    configuration: str | None = None
    revision: Revision | None = None
    """With `configure`, and with `reset` if it takes changes."""
    arguments: str = ""
    """What else was asked for, as `arguments_of` has it; an arming is good for the same only."""
    fork: Fork | None = None
    to: str = ""
    """With `hand_over`: the name of who may take control."""
    arming: str | None = None
    """The token of an arming: with `arm` the new one, with any other command the one that it brings."""
    arms: str = ""
    """With `arm`: the command that is armed, whose arguments are the other fields."""


class CommandAnswer(FrozenMessage):
    """What the loop did with a request that it granted."""

    id: str = Field(description="Of this request, unique within the service")
    command: CommandName
    accepted: bool
    phase: str = Field(description="After the request")
    tick: int
    time: float = Field(description="Mission time [s]")
    message: str


Answer = Future[CommandAnswer]


class Granted(NamedTuple):
    """A request that the mission thread answers after the next tick, and with what."""

    request: Request
    answer: Answer
    message: str


class Inbox:
    """Bounded. STOP is not queued: it is looked at first in every turn."""

    def __init__(self) -> None:
        self.wake = threading.Event()
        self._requests: deque[tuple[Request, Answer]] = deque()
        self._lock = threading.Lock()
        self._stops: list[tuple[Request, Answer]] = []

    @property
    def waiting(self) -> int:
        """Requests that have not been looked at."""
        return len(self._requests) + len(self._stops)

    def put(self, request: Request) -> Answer:
        """Queue a request.

        Raises:
            ServiceBusy: too many wait already.

        """
        answer: Answer = Future()
        with self._lock:
            waiting = self._stops if request.command == "stop" else self._requests
            if request.command != "stop" and len(waiting) >= CAPACITY:
                raise ServiceBusy(f"{CAPACITY} requests wait already", tip="the mission thread is busy; try again")
            waiting.append((request, answer))
        self.wake.set()
        return answer

    def stops(self) -> list[tuple[Request, Answer]]:
        """Take every STOP that was asked for, also by who no longer waits for the answer."""
        if not self._stops:
            return []
        with self._lock:
            stops, self._stops = self._stops, []
        for _, answer in stops:
            answer.set_running_or_notify_cancel()
        return stops

    def requests(self) -> Iterator[tuple[Request, Answer]]:
        """Take the queued requests one by one, the oldest first, but for those that were given up.

        Ends as soon as a STOP is asked for: what waits then is for the next turn, after it.
        """
        while self._requests and not self._stops:
            request, answer = self._requests.popleft()
            if answer.set_running_or_notify_cancel():
                yield request, answer

    def refuse_requests(self, error: Exception) -> None:
        """Answer every request that waits with this error, but no STOP."""
        with self._lock:
            waiting, self._requests = self._requests, deque()
        for _, answer in waiting:
            if answer.set_running_or_notify_cancel():
                answer.set_exception(error)

    def refuse_all(self, error: Exception) -> None:
        """Answer everything that waits with this error."""
        for _, answer in self.stops():
            if not answer.cancelled():
                answer.set_exception(error)
        self.refuse_requests(error)
