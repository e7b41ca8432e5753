"""Writes a run in a thread of its own while it is flown on: compiled code and zstd leave Python to other threads."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Self

from server.library.record import LoggedEvent, TickArray
from server.library.writer import RunWriter

PARTS_BEHIND = 2
"""Parts of a run, half a second of it each, that may wait to be written while it is flown on."""


class BackgroundWriter:
    """Gives a writer what comes, in its order; all is written when its `with` is left, or has failed."""

    def __init__(self, writer: RunWriter, on_written: Callable[[float], None] | None = None) -> None:
        """Begin with nothing to write.

        Args:
            writer: of the run.
            on_written: called in the caller's thread with the mission time [s] up to which a killed process loses
                nothing.

        """
        self._writer, self._on_written = writer, on_written
        self._thread = ThreadPoolExecutor(1, "becalm-writing")
        self._waiting: deque[Future[float | None]] = deque()
        self._parts: deque[Future[float | None]] = deque()
        """What of it is ticks: events are little, and come many at a time."""
        self._failed = False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        """Write what waits.

        Raises:
            OSError: it cannot be written; also after another error, for the run is not on disk as that error left it.

        """
        self._thread.shutdown(wait=True)
        while self._waiting:
            self._finish_one()

    def log(self, event: LoggedEvent) -> None:
        """Have an event written."""
        self._submit(lambda: self._writer.log(event))

    def keep(self, ticks: TickArray) -> None:
        """Have ticks written, once few enough parts before them are left to be.

        Raises:
            OSError: what came before cannot be written.

        """
        self._parts.append(self._submit(lambda: self._put(ticks)))
        if len(self._parts) > PARTS_BEHIND:
            oldest = self._parts.popleft()
            while self._finish_one() is not oldest:
                pass

    def _put(self, ticks: TickArray) -> float:
        self._writer.append(ticks)
        self._writer.flush()
        return float(ticks["time"][-1])

    def _submit(self, write: Callable[[], float | None]) -> Future[float | None]:
        self._waiting.append(self._thread.submit(self._attempt, write))
        return self._waiting[-1]

    def _attempt(self, write: Callable[[], float | None]) -> float | None:
        """Write, unless something before it is missing: a log has no gaps."""
        if self._failed:
            return None
        try:
            return write()
        except BaseException:
            self._failed = True
            raise

    def _finish_one(self) -> Future[float | None]:
        """Wait until the oldest of what waits is written; gives what it was."""
        oldest = self._waiting.popleft()
        written = oldest.result()
        if written is not None and self._on_written is not None:
            self._on_written(written)
        return oldest
