"""Flies the service's studies, one after another, on workers that leave the live mission its time.

A study that was waiting or flying when the service ended, however it ended, goes on at the next start.
"""

from __future__ import annotations

import importlib
import logging
import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Executor
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from server.errors import ConfirmationNeeded, ServiceBusy, StoredUnreadable, StudyRefused
from server.instants import wall_clock
from server.studies.estimates import StudyEstimates
from server.studies.store import StudyRecord, StudyStatus, StudyStore
from sim.errors import CaptureError
from sim.study.design import Study
from sim.study.executors import LocalProcesses, OpenExecutor, Workers, WorkersUnavailable
from sim.study.flight import MANY_CELLS, TRIAL_CELLS, Progress, StudyFlight
from sim.study.table import StudyTable

CAPACITY = 16
"""Studies that may wait."""

ESTIMATE_PATIENCE = 20.0
"""The time that a very large study takes is shown to who starts it, if it can be measured within this time [s]."""

log = logging.getLogger(__name__)


class _Flying(NamedTuple):
    """The study that flies now."""

    study_id: str
    cancelled: threading.Event
    flight: StudyFlight | None = None
    """None until its table is open."""


class DurationEstimate(NamedTuple):
    """How long a study would take, if it were started now."""

    seconds: float | None
    """Wall time to fly it [s]; None while that is measured, or if it cannot be."""
    measuring: bool
    """Whether the time is being measured."""
    basis: str
    """What the time follows from, or why there is none."""
    age: float | None
    """How long ago that was measured [s]."""
    studies_before: int
    """Studies that fly or wait now."""


class StudyQueue:
    """The studies that wait, and the thread that flies them one by one."""

    def __init__(self, store: StudyStore, find_workers: Callable[[], Workers]) -> None:
        """`find_workers` is called for every study: a cluster need not be there before."""
        self._store = store
        self._find_workers = find_workers
        self._estimates = StudyEstimates(find_workers)
        self._one_waits = threading.Lock()
        self._waiting: deque[str] = deque()
        self._flying: _Flying | None = None
        self._changed = threading.Condition()
        self._closing = False
        self._executor: Executor | None = None
        self._thread = threading.Thread(target=self._live, name="becalm-studies", daemon=True)

    @property
    def waiting(self) -> int:
        """Studies that wait to be flown."""
        return len(self._waiting)

    def start(self) -> None:
        """Take up what the last service left unfinished, and start the thread."""
        for record in sorted(self._store.newest(), key=lambda record: record.id):
            if not record.ended_already:
                with suppress(OSError):  # on a disk that does not take it the study waits all the same
                    self._store.revise(record.id, status="queued")
                self._waiting.append(record.id)
        self._thread.start()

    def shutdown(self, patience: float = 1.5) -> None:
        """End after the cells in flight, or without those that take longer than `patience` [s].

        What has not finished goes on after the next start.
        """
        with self._changed:
            self._closing = True
            if self._flying is not None:
                self._flying.cancelled.set()
            self._changed.notify()
        self._estimates.shutdown()
        self._thread.join(patience)
        if self._thread.is_alive() and isinstance(self._executor, LocalProcesses):
            self._executor.kill()
            self._thread.join(patience)

    def add(self, study: Study, *, confirmed: bool) -> StudyRecord:
        """Put a study at the end of the queue.

        Raises:
            ConfirmationNeeded: it has more than `MANY_CELLS` cells, and nobody said that this is meant.
            ServiceBusy: too many wait already.

        """
        if study.count > MANY_CELLS and not confirmed:
            raise ConfirmationNeeded(study.count, self._time_of(study))
        with self._changed:
            self._require_room()
            record = self._store.create(study)
            self._put(record.id)
        return record

    def resume(self, study_id: str) -> StudyRecord:
        """Put a study that was cancelled or has failed at the end of the queue; its rows stay.

        Raises:
            StudyNotFound: there is none with that identifier.
            StudyRefused: it is whole, or is not ended.
            ServiceBusy: too many wait already.

        """
        with self._changed:
            record = self._store.record(study_id)
            if record.status not in ("cancelled", "failed"):
                raise StudyRefused(f"study {study_id} is {record.status}", tip="only a cancelled or failed one goes on")
            self._require_room()
            record = self._store.revise(study_id, status="queued", note=None, ended=None)
            self._put(study_id)
        return record

    def cancel(self, study_id: str) -> StudyRecord:
        """End a study that waits, or one that flies after the cells in flight; its rows stay.

        Raises:
            StudyNotFound: there is none with that identifier.
            StudyRefused: it has ended.

        """
        with self._changed:
            record = self._store.record(study_id)
            if record.ended_already:
                raise StudyRefused(f"study {study_id} is {record.status} already", tip="DELETE removes it")
            if study_id in self._waiting:
                self._waiting.remove(study_id)
            elif self._flying is not None and self._flying.study_id == study_id:
                self._flying.cancelled.set()
                return record
            # Nobody flies it; it waits, or has come into the folder as a copy.
            return self._store.revise(study_id, status="cancelled", ended=wall_clock())

    def delete(self, study_id: str) -> None:
        """Remove a study that has ended.

        Raises:
            StudyNotFound: there is none with that identifier.
            StudyRefused: it has not ended.

        """
        with self._changed:
            if not self._has_ended(study_id):
                raise StudyRefused(f"study {study_id} has not ended", tip="cancel it first")
            self._store.delete(study_id)

    def _has_ended(self, study_id: str) -> bool:
        """Whether nothing flies or waits of it; of one that cannot be read nothing does."""
        try:
            return self._store.record(study_id).ended_already
        except StoredUnreadable:
            return self._flying is None or self._flying.study_id != study_id

    def progress(self, record: StudyRecord) -> Progress:
        """How far a study has come, with its pace if it flies now."""
        flying = self._flying
        if flying is not None and flying.flight is not None and flying.study_id == record.id:
            return flying.flight.progress
        return Progress(done=record.done, total=record.cells, wall_time=record.wall_time)

    def estimate(self, study: Study) -> DurationEstimate:
        """How long that study would take now; answered at once, also while that is being measured."""
        flying = self._flying
        before = len(self._waiting) + (flying is not None)
        pace = flying.flight.progress.cells_per_second if flying is not None and flying.flight is not None else None
        if pace:
            return DurationEstimate(study.count / pace, False, "the pace of the study that flies now", 0.0, before)
        known = self._estimates.ask(study)
        if known is None:
            return DurationEstimate(None, True, f"{TRIAL_CELLS} of its cells, flown now", None, before)
        if known.seconds is None:
            return DurationEstimate(None, False, known.words, known.age, before)
        basis = f"{min(TRIAL_CELLS, study.count)} of its cells, flown by {known.words}"
        return DurationEstimate(known.seconds * study.count, False, basis, known.age, before)

    def _time_of(self, study: Study) -> float | None:
        """The same as soon as it is known [s]; None if that takes too long, cannot be measured, or somebody waits."""
        if not self._one_waits.acquire(blocking=False):
            return None
        try:
            known = self._estimates.wait(study, ESTIMATE_PATIENCE)
        finally:
            self._one_waits.release()
        return None if known is None or known.seconds is None else known.seconds * study.count

    def _require_room(self) -> None:
        if len(self._waiting) >= CAPACITY:
            raise ServiceBusy(f"{CAPACITY} studies wait already", tip="wait until one has finished, or cancel one")

    def _put(self, study_id: str) -> None:
        self._waiting.append(study_id)
        self._changed.notify()

    def _live(self) -> None:
        importlib.import_module("scipy.stats")  # takes a second or two: no request shall wait for it
        while (flying := self._next()) is not None:
            try:
                self._fly(*flying[:2])
            except CaptureError as error:
                if self._closing:
                    return  # for want of workers; it goes on after the next start
                self._end(flying.study_id, "failed", str(error))
            except Exception as error:
                # The thread outlives every failure: the studies that wait are flown all the same.
                log.exception("study %s failed", flying.study_id)
                self._end(flying.study_id, "failed", f"{type(error).__name__}: {error}")

    def _next(self) -> _Flying | None:
        """The study to fly next; waits for one. None when the service ends."""
        with self._changed:
            self._flying = None
            self._changed.wait_for(lambda: self._closing or self._waiting)
            if self._closing:
                return None
            self._flying = _Flying(self._waiting.popleft(), threading.Event())
            return self._flying

    def _fly(self, study_id: str, cancelled: threading.Event) -> None:
        record = self._store.revise(study_id, status="running")
        with StudyTable(self._store.table_path(study_id), record.study) as table:
            flight = StudyFlight(table, cancelled)
            self._flying = _Flying(study_id, cancelled, flight)
            try:
                workers = self._find_workers()
                flight.fly(replace(workers, open_executor=partial(self._open_executor, workers.open_executor)))
            finally:
                progress = flight.progress
                self._store.revise(study_id, done=progress.done, wall_time=record.wall_time + progress.wall_time)
        if progress.done == progress.total:
            self._end(study_id, "finished", None)
        elif not self._closing:
            self._end(study_id, "cancelled", None)

    def _open_executor(self, opened: OpenExecutor) -> Executor:
        """A fresh executor, to be killed if the service ends; none once it does.

        Raises:
            WorkersUnavailable: the service ends.

        """
        if self._closing:
            raise WorkersUnavailable("the service ends")
        self._executor = opened()
        return self._executor

    def _end(self, study_id: str, status: StudyStatus, note: str | None) -> None:
        """Say how a study ended; the others are flown, whatever its folder has become."""
        try:
            self._store.revise(study_id, status=status, note=note, ended=wall_clock())
        except (CaptureError, OSError) as error:
            log.warning("study %s is %s, but its record cannot be written: %s", study_id, status, error)
