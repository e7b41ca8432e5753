"""Scripted runs: headless captures, faster than real time, one after another in a process of their own.

A run waits as a folder in the store, so that what was queued when the service ended is flown at its next start.
"""

from __future__ import annotations

import logging
import threading
import traceback
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from contextlib import suppress
from pathlib import Path
from typing import Any

from server.errors import ServiceBusy
from server.instants import wall_clock
from server.library.background_writer import BackgroundWriter
from server.library.record import LoggedEvent, RunRecord, RunStatus, TickArray
from server.library.runs import RunStore
from server.library.writer import RunWriter
from server.process.realtime import shorten_switch_interval
from sim.capture.beginning import Beginning
from sim.capture.events import Event
from sim.capture.mission import Mission, prepare
from sim.capture.run import ask, fly_to_verdict
from sim.control.phases import Command
from sim.errors import CaptureError, MissionRefused
from sim.study.executors import LocalProcesses

CAPACITY = 64
"""Runs that may wait."""

NICENESS = 10
"""The live mission's clock comes first."""

log = logging.getLogger(__name__)


class _Cancelled(Exception):
    """Somebody asked for the run to end."""


def fly(store: RunStore, record: RunRecord, on_progress: Callable[[float], None] | None = None) -> RunRecord:
    """Fly a queued run from its start to its verdict, recording every tick.

    It waits for the thread that writes twice a simulated second, up to 5 ms in a process that has not shortened its
    switch interval (`server.process.realtime`).

    Args:
        store: where the run stands.
        record: of the run.
        on_progress: called with the mission time [s] up to which everything is written: no killed process loses it.

    Returns:
        The run's record: finished, failed with a note, or cancelled.

    """
    writer = store.write(record.model_copy(update={"status": "running", "started": wall_clock()}))
    try:
        with BackgroundWriter(writer, on_progress) as background:
            last_words = _fly_to_verdict(writer, background, store.read(record.id).beginning())
        writer.close(**last_words)
    except _Cancelled:
        writer.close(status="cancelled")
    except CaptureError as error:
        writer.close(status="failed", note=f"{type(error).__name__}: {error}")
    except OSError:
        writer.abandon()  # the disk has failed; the run will be found with what is on it
        raise
    except BaseException:
        writer.close(status="failed", note=traceback.format_exc(limit=-1))
        raise
    return writer.record


def _fly_to_verdict(writer: RunWriter, background: BackgroundWriter, beginning: Beginning | None) -> dict[str, Any]:
    """The changes of the run's record with which it is to be closed."""
    if writer.is_cancelled:
        raise _Cancelled

    def log(event: Event) -> None:
        background.log(LoggedEvent(**event.model_dump(), at=wall_clock()))

    def keep(ticks: TickArray) -> None:
        background.keep(ticks)
        if writer.is_cancelled:
            raise _Cancelled

    record = writer.record
    prepare(record.config)  # else what is compiled counts as flown
    mission, command = _begun(record, beginning)
    if command is not None:
        background.log(_granted(command, mission))
    result = fly_to_verdict(mission, on_ticks=keep, on_event=log)
    return {"status": "finished", "outcome": result.outcome, "real_time_factor": result.real_time_factor}


def _begun(record: RunRecord, beginning: Beginning | None) -> tuple[Mission, Command | None]:
    """The mission before its first tick, and what it was asked for; a future goes on as it was rehearsed."""
    if beginning is None:
        mission, command = Mission(record.config), Command.DIRECT_CAGE if record.direct else Command.CAPTURE
        ask(mission, command)
        return mission, command
    mission = beginning.mission(record.config)
    if beginning.request is not None:
        mission.request(beginning.request)
    return mission, beginning.request


def _granted(command: Command, mission: Mission) -> LoggedEvent:
    """The command that a scripted run begins with."""
    tick = mission.next_tick
    return LoggedEvent(
        time=mission.time, tick=tick, kind="command", severity="info", message=f"{command.value} granted",
        at=wall_clock(), who="script", command=command.value, accepted=True, takes_effect=tick,
    )  # fmt: skip


def _fly_in_worker(root: Path, topic_rate: float | None, run_id: str) -> None:
    shorten_switch_interval()
    store = RunStore(root, topic_rate)
    record = store.record(run_id)
    if record.status == "queued":
        fly(store, record)


class ScriptedRuns:
    """The queue of scripted runs and the worker that flies them one by one."""

    def __init__(self, store: RunStore) -> None:
        self._store = store
        self._waiting: deque[str] = deque()
        self._flying: str | None = None
        self._pool: LocalProcesses | None = None
        self._idle = threading.Event()
        self._idle.set()
        self._closing = False
        self._lock = threading.Lock()
        self._queueing = threading.Lock()
        """Held while a request is looked up, bounded and queued: two at once with one key make one run."""

    @property
    def waiting(self) -> int:
        """Runs that wait to be flown."""
        return len(self._waiting)

    def resume(self) -> None:
        """Queue again what waited when the service last ended."""
        records = (reader.record for reader in self._store.newest())
        for run_id in sorted(record.id for record in records if record.status == "queued"):
            self._submit(run_id)

    def queue(
        self,
        records: Sequence[RunRecord],
        admit: Callable[[], None] = lambda: None,
        beginning: Beginning | None = None,
    ) -> list[str]:
        """Put runs at the end of the queue, all or none; those of an earlier request with their key, if it had one.

        Args:
            records: of one request.
            admit: raises what stands against new runs.
            beginning: of all of them, if that is on the way.

        Returns:
            Their identifiers, in the order of the request.

        Raises:
            ServiceBusy: too many would wait.
            MissionRefused: an earlier request with that key was another one.
            OSError: they cannot be written; none of them is there then.

        """
        with self._queueing:
            key, digest = records[0].idempotency_key, records[0].request_digest
            if key is not None and (earlier := self._queued_before(key, digest)):
                return earlier
            admit()
            if len(self._waiting) + len(records) > CAPACITY:
                message = f"{len(self._waiting)} runs wait already, and no more than {CAPACITY} may"
                raise ServiceBusy(message, tip="wait until some have finished, or cancel some")
            self._create(records, beginning)
            for record in records:
                self._submit(record.id)
        return [record.id for record in records]

    def _create(self, records: Sequence[RunRecord], beginning: Beginning | None) -> None:
        try:
            for record in records:
                self._store.create(record, beginning)
        except OSError:
            for record in records:
                with suppress(OSError):
                    self._store.discard(record.id)
            raise

    def _queued_before(self, key: str, digest: str | None) -> list[str]:
        """The runs that an earlier request with that key queued, in its order."""
        earlier = [reader.record for reader in self._store.newest() if reader.record.idempotency_key == key]
        if any(record.request_digest != digest for record in earlier):
            raise MissionRefused(
                f"Idempotency-Key {key!r} came with another request before", tip="use a new key for a new request"
            )
        return sorted(record.id for record in earlier)

    def cancel(self, run_id: str) -> None:
        """End a run that waits or flies, whichever process flies it; one that flies ends within a moment."""
        with self._lock:
            if run_id in self._waiting:
                self._waiting.remove(run_id)
            is_ours = run_id == self._flying
        self._store.cancel(run_id)
        if not is_ours and self._store.record(run_id).status == "queued":
            with suppress(BlockingIOError):  # another process begins it at this moment, and sees that it should not
                self._close_unflown(run_id, "cancelled", None)

    def shutdown(self, patience: float = 1.5) -> None:
        """End the worker, and with it the run that it flies. What waits is flown after the next start."""
        with self._lock:
            self._closing = True
            pool, self._pool, flying = self._pool, None, self._flying
        if pool is None:
            return
        if flying is not None:
            self._store.cancel(flying)
        if not self._idle.wait(patience):
            pool.kill()  # it still loads or compiles; its run will be found as it was left
        pool.shutdown(wait=True, cancel_futures=True)

    def _submit(self, run_id: str) -> None:
        with self._lock:
            self._waiting.append(run_id)
        self._fly_next()

    def _fly_next(self) -> None:
        with self._lock:
            if self._closing or self._flying is not None or not self._waiting:
                return
            run_id = self._flying = self._waiting.popleft()
            self._idle.clear()
            future = self._running_pool().submit(_fly_in_worker, self._store.root, self._store.topic_rate, run_id)
        future.add_done_callback(lambda done: self._flown(run_id, done))

    def _running_pool(self) -> LocalProcesses:
        if self._pool is None:
            self._pool = LocalProcesses(1, NICENESS)
        return self._pool

    def _flown(self, run_id: str, future: Future[None]) -> None:
        error = None if future.cancelled() else future.exception()
        with self._lock:
            self._flying = None
            if error is not None:
                self._pool = None  # a worker that died takes its pool with it; the next run gets a new one
        self._idle.set()
        if error is not None and not self._closing:
            log.error("run %s failed", run_id, exc_info=error)
            self._close_failed(run_id, error)
        self._fly_next()

    def _close_failed(self, run_id: str, error: BaseException) -> None:
        """Say of a run that it was never flown; the others are flown, whatever its folder has become."""
        try:
            if self._store.record(run_id).status == "queued":
                self._close_unflown(run_id, "failed", f"the worker process failed: {error}")
        except (CaptureError, OSError) as problem:
            log.warning("run %s cannot be marked as failed: %s", run_id, problem)

    def _close_unflown(self, run_id: str, status: RunStatus, note: str | None) -> None:
        writer = self._store.write(self._store.record(run_id))
        writer.close(status=status, note=note)
