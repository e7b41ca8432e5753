"""What everyone watches: the newest snapshot, and a bounded queue of events for each subscriber.

The mission thread publishes and never waits. A snapshot is made and encoded once for all, and only if anyone looks. A
subscriber that does not keep up is sent fewer snapshots, each the newest there is; nobody else notices, and nobody is
shown what has been overtaken.
"""

from __future__ import annotations

import asyncio
import json
import threading
import uuid
from collections import deque
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from server.library.record import LoggedEvent, TickArray
from server.mission.cut_off import CutOffRun
from server.mission.history import HistoryRing
from server.mission.live_mission import MissionView
from server.published import MissionSnapshot, PlantStatus, Problem, RobotData
from sim.snapshot import Readiness

CAPACITY = 120
"""Events that wait for a subscriber at most, and frames for the event loop."""

WINDOW = 2
"""Snapshots that a subscriber who acknowledges may have on the way; the next one is then the newest there is."""


class Latest:
    """What is published of the mission: its snapshot, which is made, and encoded, for the first one who looks at it.

    For any thread. It is a message to subscribers, too.
    """

    kind = "snapshot"

    def __init__(self, view: MissionView, of_service: Mapping[str, Any]) -> None:
        """Of that view; `of_service` has the fields of `MissionSnapshot` that only the service knows."""
        self._view, self._of_service = view, of_service
        self._lock = threading.Lock()
        self._snapshot: MissionSnapshot | None = None
        self._encoded: str | None = None
        self.tick, self.phase = int(view.flown.row["tick"]), view.phase.label
        self.run_id: str = of_service["run_id"]
        self.made_at: float = of_service["service_time"]

    @property
    def row(self) -> Any:
        """The tick as it is recorded, one element of `TICK`."""
        return self._view.flown.row

    @property
    def problems(self) -> tuple[Problem, ...]:
        """What the operator must see."""
        problems: tuple[Problem, ...] = self._of_service["problems"]
        return problems

    @property
    def plant(self) -> PlantStatus:
        """The plant and its clock."""
        plant: PlantStatus = self._of_service["plant"]
        return plant

    @property
    def robot(self) -> RobotData | None:
        """Age of what the robot reported; None in simulation."""
        robot: RobotData | None = self._of_service["robot"]
        return robot

    @property
    def snapshot(self) -> MissionSnapshot:
        """The snapshot."""
        with self._lock:
            if self._snapshot is None:
                self._snapshot = self._made()
            return self._snapshot

    @property
    def encoded(self) -> str:
        """Its JSON."""
        snapshot = self.snapshot
        with self._lock:
            if self._encoded is None:
                self._encoded = snapshot.model_dump_json()
            return self._encoded

    @property
    def text(self) -> str:
        """Its JSON as a message."""
        return snapshot_text(self.encoded)

    def _made(self) -> MissionSnapshot:
        of_mission = dict(self._view.snapshot())
        readiness: Readiness = of_mission["readiness"]
        if not self._of_service["plant"].running and readiness.blocked is None:  # nothing comes next while it stands
            of_mission["readiness"] = readiness.model_copy(update={"go": False, "blocked": "the clock is paused"})
        return MissionSnapshot(**of_mission, **self._of_service)


class FeedMessage(NamedTuple):
    """Another message to subscribers."""

    kind: str
    text: str


Frame = FeedMessage | Latest


class Subscriber:
    """One watcher. Everything but `next` is called in the event loop by `Feed` or by the watcher's own connection."""

    def __init__(self, rate: float, name: str = "") -> None:
        self.rate, self.name = rate, name
        self._events: deque[FeedMessage] = deque()
        self._snapshot: Latest | None = None
        self._ready = asyncio.Event()
        self._next_due = 0.0
        self._sent_until = float("-inf")
        self._unacknowledged: deque[int] = deque()
        self._acknowledges = False
        self._missed = 0
        self.lost = 0
        """Frames that it was not sent because it did not keep up: snapshots overtaken by newer ones, and events."""

    @property
    def waiting(self) -> int:
        """Frames that it has not taken yet."""
        return len(self._events) + (self._snapshot is not None)

    def offer(self, frame: Frame, now: float) -> None:
        """Queue a frame, unless it is a snapshot sooner than the subscriber's rate wants one."""
        if not isinstance(frame, Latest):
            self._queue(frame)
            return
        period = 1.0 / self.rate
        # A quarter of a period early is still this frame's turn: publishing jitters.
        if now < self._next_due - 0.25 * period:
            return
        self._next_due = max(self._next_due + period, now + 0.5 * period)
        self.show(frame)

    def show(self, frame: Latest) -> None:
        """Let this snapshot be the next one that is sent, unless a newer one was."""
        if frame.made_at > self._sent_until:
            self.lost += self._snapshot is not None
            self._snapshot = frame
            self._ready.set()

    async def next(self) -> Frame:
        """The oldest event that waits, else the newest snapshot; waits for one if there is none."""
        while True:
            if self._missed:
                missed, self._missed = self._missed, 0
                return FeedMessage("missed", json.dumps({"type": "missed", "events": missed}))
            if self._events:
                return self._events.popleft()
            if self._snapshot is not None and len(self._unacknowledged) < WINDOW:
                return self._take_snapshot(self._snapshot)
            self._ready.clear()
            await self._ready.wait()

    def acknowledge(self, tick: int) -> None:
        """The watcher has drawn the snapshot of that tick."""
        self._acknowledges = True
        if tick in self._unacknowledged:  # a fork goes back: ticks do not only grow
            while self._unacknowledged.popleft() != tick:
                pass
        self._ready.set()

    def _queue(self, frame: FeedMessage) -> None:
        if frame.kind == "reset":  # what was before it belongs to another run
            self._snapshot = None
            self._unacknowledged.clear()
        elif len(self._events) >= CAPACITY:
            self._drop_an_event()
        self._events.append(frame)
        self._ready.set()

    def _drop_an_event(self) -> None:
        """Make room; that a run began is never dropped."""
        oldest = next((event for event in self._events if event.kind == "event"), None)
        if oldest is not None:
            self._events.remove(oldest)
            self._missed += 1
            self.lost += 1

    def _take_snapshot(self, frame: Latest) -> Latest:
        self._snapshot, self._sent_until = None, frame.made_at
        if self._acknowledges:
            self._unacknowledged.append(frame.tick)
        return frame


class Feed:
    """Published to by the mission thread, subscribed to in one event loop."""

    def __init__(self) -> None:
        self.service = uuid.uuid4().hex
        """Tells this service from the one before a restart."""
        self.cut_off: CutOffRun | None = None
        """The run that the end of the service before this one cut off; forgotten when a second mission begins."""
        self.latest: Latest | None = None
        self.history = HistoryRing()
        self.alarms: FeedMessage | None = None
        """The newest list of alarms, for whoever joins."""
        self._recent: deque[TickArray] = deque(maxlen=CAPACITY)
        self.drawn = False
        """Whether a scene that someone looks at draws the snapshots; the projector says so."""
        self._has_begun = False
        self._subscribers: set[Subscriber] = set()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._pending: deque[Frame] = deque(maxlen=CAPACITY)
        self._scheduled = threading.Event()
        self._lost_by_gone = 0

    @property
    def subscribers(self) -> tuple[Subscriber, ...]:
        """Who watches now. In the event loop only."""
        return tuple(self._subscribers)

    @property
    def watched(self) -> bool:
        """Whether anyone sees each snapshot; for any thread."""
        return self.drawn or bool(self._subscribers)

    @property
    def lost(self) -> int:
        """Frames that watchers have lost since the service began. In the event loop only."""
        return self._lost_by_gone + sum(subscriber.lost for subscriber in self._subscribers)

    def attach(self, loop: asyncio.AbstractEventLoop) -> None:
        """From now on subscribers live in this event loop."""
        self._loop = loop

    def detach(self) -> None:
        """The event loop ends."""
        self._loop = None

    def subscribe(self, rate: float, name: str = "") -> Subscriber:
        """A new watcher, by the name of who watches."""
        subscriber = Subscriber(rate, name)
        self._subscribers.add(subscriber)
        return subscriber

    def unsubscribe(self, subscriber: Subscriber) -> None:
        """The watcher has gone."""
        if subscriber in self._subscribers:
            self._subscribers.remove(subscriber)
            self._lost_by_gone += subscriber.lost

    def publish(self, latest: Latest) -> None:
        """Show this to everyone who looks."""
        self.latest = latest
        self._send(latest)

    def publish_event(self, event: LoggedEvent) -> None:
        """Tell everyone what happened."""
        self._send(FeedMessage("event", '{"type":"event",' + event.model_dump_json()[1:]))

    def keep(self, ticks: TickArray) -> None:
        """Take rows of `TICK` that have been flown: for the history, and for whoever looks at each of them."""
        self.history.keep(ticks)
        self._recent.append(ticks)

    def take_recent(self) -> TickArray | None:
        """The ticks that have been flown since this was last asked; None if there are none. For one reader."""
        recent = [self._recent.popleft() for _ in range(len(self._recent))]
        return np.concatenate(recent) if recent else None

    def publish_alarms(self, text: str) -> None:
        """Tell everyone the list of alarms."""
        self.alarms = FeedMessage("alarms", text)
        self._send(self.alarms)

    def begin(self, run_id: str, past: HistoryRing | None = None) -> None:
        """A new mission begins, perhaps with a past: what was before is history no more."""
        if self._has_begun:
            self.cut_off = None
        self._has_begun = True
        self.history.begin(run_id, past)
        self._send(FeedMessage("reset", f'{{"type":"reset","run_id":"{run_id}"}}'))

    def _send(self, frame: Frame) -> None:
        loop = self._loop
        if loop is None or not self._subscribers:
            return
        self._pending.append(frame)
        # One call at a time: an event loop that is held up finds one call waiting, not thousands.
        if not self._scheduled.is_set():
            self._scheduled.set()
            try:
                loop.call_soon_threadsafe(self._distribute)
            except RuntimeError:
                self._loop = None  # the event loop has closed; the service is ending

    def _distribute(self) -> None:
        self._scheduled.clear()
        now = asyncio.get_running_loop().time()
        while self._pending:
            frame = self._pending.popleft()
            for subscriber in tuple(self._subscribers):
                subscriber.offer(frame, now)


def snapshot_text(encoded: str) -> str:
    """The snapshot's JSON as a message."""
    return '{"type":"snapshot",' + encoded[1:]
