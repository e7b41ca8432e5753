"""What everyone watches: the latest snapshot, and a bounded queue for each subscriber.

The mission thread publishes and never waits. Each frame is encoded once for all. A subscriber that does
not keep up loses its oldest frames; nobody else notices.
"""

from __future__ import annotations

import asyncio
import threading
from collections import deque
from typing import NamedTuple

from server.history import HistoryRing
from server.published import MissionSnapshot
from server.run_folder import LoggedEvent

CAPACITY = 120
"""Frames that wait for a subscriber at most: two seconds at full rate."""

UNACKNOWLEDGED_LIMIT = 120
"""Snapshots that a subscriber who acknowledges may leave unacknowledged before it is sent no more for now."""


class Latest(NamedTuple):
    """The latest snapshot and its JSON."""

    snapshot: MissionSnapshot
    encoded: str


class Frame(NamedTuple):
    """One message to subscribers."""

    kind: str
    text: str
    tick: int = 0


class Subscriber:
    """One watcher. Everything but `next` is called in the event loop by `Feed` or by the watcher's own connection."""

    def __init__(self, rate: float) -> None:
        self.rate = rate
        self._frames: deque[Frame] = deque(maxlen=CAPACITY)
        self._ready = asyncio.Event()
        self._next_due = 0.0
        self._unacknowledged: deque[int] = deque()
        self._acknowledges = False
        self.lost = 0
        """Frames that were dropped because it did not keep up."""

    @property
    def waiting(self) -> int:
        """Frames that it has not taken yet."""
        return len(self._frames)

    def offer(self, frame: Frame, now: float) -> None:
        """Queue a frame, unless it is a snapshot sooner than the subscriber's rate wants one."""
        if frame.kind == "snapshot":
            period = 1.0 / self.rate
            # A quarter of a period early is still this frame's turn: publishing jitters.
            if now < self._next_due - 0.25 * period or self._is_stuck():
                return
            self._next_due = max(self._next_due + period, now + 0.5 * period)
        elif frame.kind == "reset":
            self._unacknowledged.clear()
        self.lost += len(self._frames) == CAPACITY
        self._frames.append(frame)
        self._ready.set()

    async def next(self) -> Frame:
        """The oldest frame that waits; waits for one if there is none."""
        while not self._frames:
            self._ready.clear()
            await self._ready.wait()
        frame = self._frames.popleft()
        if frame.kind == "reset":  # what was taken before it is never acknowledged by the ticks after it
            self._unacknowledged.clear()
        if frame.kind == "snapshot" and self._acknowledges:
            self._unacknowledged.append(frame.tick)
        return frame

    def acknowledge(self, tick: int) -> None:
        """The watcher has drawn the snapshot of that tick."""
        self._acknowledges = True
        while self._unacknowledged and self._unacknowledged[0] <= tick:
            self._unacknowledged.popleft()

    def _is_stuck(self) -> bool:
        return len(self._unacknowledged) >= UNACKNOWLEDGED_LIMIT


class Feed:
    """Published to by the mission thread, subscribed to in one event loop."""

    def __init__(self) -> None:
        self.latest: Latest | None = None
        self.history = HistoryRing()
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
    def lost(self) -> int:
        """Frames that watchers have lost since the service began. In the event loop only."""
        return self._lost_by_gone + sum(subscriber.lost for subscriber in self._subscribers)

    def attach(self, loop: asyncio.AbstractEventLoop) -> None:
        """From now on subscribers live in this event loop."""
        self._loop = loop

    def detach(self) -> None:
        """The event loop ends."""
        self._loop = None

    def subscribe(self, rate: float) -> Subscriber:
        """A new watcher."""
        subscriber = Subscriber(rate)
        self._subscribers.add(subscriber)
        return subscriber

    def unsubscribe(self, subscriber: Subscriber) -> None:
        """The watcher has gone."""
        if subscriber in self._subscribers:
            self._subscribers.remove(subscriber)
            self._lost_by_gone += subscriber.lost

    def publish(self, snapshot: MissionSnapshot) -> None:
        """Make this the latest snapshot."""
        encoded = snapshot.model_dump_json()
        self.latest = Latest(snapshot, encoded)
        self._send(Frame("snapshot", snapshot_text(encoded), snapshot.tick))

    def publish_event(self, event: LoggedEvent) -> None:
        """Tell everyone what happened."""
        self._send(Frame("event", '{"type":"event",' + event.model_dump_json()[1:], event.tick))

    def begin(self, run_id: str, past: HistoryRing | None = None) -> None:
        """A new mission begins, perhaps with a past: what was before is history no more."""
        self.history.begin(past)
        self._send(Frame("reset", f'{{"type":"reset","run_id":"{run_id}"}}'))

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
    """The snapshot's JSON as a frame."""
    return '{"type":"snapshot",' + encoded[1:]
