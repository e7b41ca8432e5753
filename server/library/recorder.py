"""The recorder: puts the live run on disk in a thread of its own, so that no disk ever delays a tick."""

from __future__ import annotations

import logging
import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Any

from server.library.record import LoggedEvent, RunRecord, TickArray
from server.library.runs import RunStore
from server.library.writer import RunWriter
from server.log.writer import prepare_logs

FLUSH_PERIOD = 0.25
"""Longest time that a tick waits in memory [s]; a killed process loses no more."""

EAGER_BACKLOG = 2**20
"""Bytes of ticks from which on the thread does not wait for its next flush."""

BACKLOG_LIMIT = 64 * 2**20
"""Bytes of ticks that may wait for the disk before the loop holds the clock back."""

log = logging.getLogger(__name__)


class Recorder:
    """Writes one run after another. Its calls return at once; a failing disk shows in `failure`."""

    def __init__(self, store: RunStore) -> None:
        self._store = store
        self._work: deque[Callable[[], None]] = deque()
        self._wake = threading.Event()
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._live, name="becalm-recorder", daemon=True)
        self._writer: RunWriter | None = None
        self._received = 0
        self._written = 0
        self._written_at = 0.0
        self.failure: str | None = None

    def start(self) -> None:
        """Start the thread."""
        prepare_logs()
        self._thread.start()

    def shutdown(self, timeout: float = 2.0) -> None:
        """Write what waits, then end the thread."""
        self._closing.set()
        self._wake.set()
        self._thread.join(timeout)

    @property
    def backlog(self) -> int:
        """Bytes of ticks that wait for the disk."""
        return self._received - self._written

    @property
    def lag(self) -> float:
        """How long the oldest tick in memory may have waited for the disk [s]."""
        return time.monotonic() - self._written_at if self.backlog else 0.0

    def open(self, record: RunRecord) -> None:
        """Begin a run."""
        self._do_soon(lambda: self._open(record))

    def append(self, ticks: TickArray) -> None:
        """Record rows of `TICK`, at the next flush: to wake the thread each time would cost the loop more."""
        self._received += ticks.nbytes  # counted by the mission thread only
        self._work.append(lambda: self._append(ticks))
        if self.backlog > EAGER_BACKLOG:
            self._wake.set()

    def log(self, event: LoggedEvent) -> None:
        """Record an event."""
        self._do_soon(lambda: self._with_writer(lambda writer: writer.log(event)))

    def keep_foreseen(self, run_id: str, outline: bytes) -> None:
        """Keep what was foreseen of a run (JSON), whether it is still written or not."""
        self._do_soon(lambda: self._store.keep_foreseen(run_id, outline))

    def revise(self, **changes: Any) -> None:
        """Change the run's record."""
        self._do_soon(lambda: self._with_writer(lambda writer: writer.revise(**changes)))

    def close(self, **changes: Any) -> None:
        """End the run with these last words."""
        self._do_soon(lambda: self._close(changes))

    def discard(self, run_id: str) -> None:
        """End the run and remove it: nothing ever happened in it."""
        self._do_soon(lambda: self._close({}))
        self._do_soon(lambda: self._store.discard(run_id))

    def _do_soon(self, work: Callable[[], None]) -> None:
        self._work.append(work)
        self._wake.set()

    def _live(self) -> None:
        while not self._closing.is_set():
            self._wake.wait(FLUSH_PERIOD)
            self._wake.clear()
            self._write()
        self._write()
        self._guarded(lambda: self._close({}))

    def _write(self) -> None:
        began = time.monotonic()
        while self._work:
            self._guarded(self._work.popleft())
        self._guarded(lambda: self._with_writer(RunWriter.flush))
        self._written_at = began

    def _guarded(self, work: Callable[[], None]) -> None:
        try:
            work()
        except Exception as error:
            # The thread outlives every failure: the next run may be recorded again.
            log.exception("the recorder cannot write")
            reason = error.strerror if isinstance(error, OSError) else None
            self.failure = f"{reason or error} ({self._store.root})"
            if self._writer is not None:
                self._writer.abandon()
                self._writer = None

    def _open(self, record: RunRecord) -> None:
        self._writer = self._store.write(record)
        self.failure = None

    def _append(self, ticks: TickArray) -> None:
        self._written += ticks.nbytes
        self._with_writer(lambda writer: writer.append(ticks))

    def _with_writer(self, act: Callable[[RunWriter], None]) -> None:
        if self._writer is not None:
            act(self._writer)

    def _close(self, changes: dict[str, Any]) -> None:
        if self._writer is not None:
            self._writer.close(**changes)  # a failure leaves it to `_guarded`, which abandons it
            self._writer = None
