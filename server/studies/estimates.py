"""How long studies take, here and now: a few cells of each are flown, one study at a time, and forgotten.

Whoever asks is answered at once: with what was measured a moment ago, or that it is being measured. Only the study
asked for last is measured next, so that neither a form that is being filled in nor a flood of requests makes more than
one trial at a time. The workers stay for a while, as a form asks again and again.
"""

from __future__ import annotations

import hashlib
import json
import threading
import time
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, CancelledError, Executor
from dataclasses import dataclass

from sim.errors import CaptureError
from sim.study.design import Study
from sim.study.executors import LocalProcesses, Workers, WorkersUnavailable
from sim.study.flight import cell_time

FRESH = 60.0
"""A measured time is given out for this long [s]: the machine's load changes."""
KEPT = 32
"""Studies whose times are remembered."""
IDLE_TIME = 30.0
"""The workers of the trials end when nothing was asked for this long [s]."""


@dataclass(frozen=True)
class CellTime:
    """What one more cell of a study takes."""

    seconds: float | None
    """Wall time [s]; None if it could not be measured."""
    words: str
    """What measured it, such as "2 processes on this machine", or why nothing did."""
    at: float
    """When, by `time.monotonic` [s]."""

    @property
    def age(self) -> float:
        """How long ago that was [s]."""
        return time.monotonic() - self.at


class StudyEstimates:
    """The times that studies take. Safe from any thread."""

    def __init__(self, find_workers: Callable[[], Workers]) -> None:
        self._find_workers = find_workers
        self._changed = threading.Condition()
        self._known: dict[bytes, CellTime] = {}
        self._wanted: Study | None = None
        self._thread: threading.Thread | None = None
        self._executor: Executor | None = None
        self._closing = False

    def ask(self, study: Study) -> CellTime | None:
        """What one more cell of this study takes; None while that is being measured."""
        key = _key(study)
        with self._changed:
            known = self._known.get(key)
            if known is not None and known.age < FRESH:
                return known
            self._wanted = study
            if self._thread is None and not self._closing:
                self._thread = threading.Thread(target=self._measure_what_is_wanted, name="becalm-trial", daemon=True)
                self._thread.start()
            self._changed.notify_all()
        return None

    def wait(self, study: Study, patience: float) -> CellTime | None:
        """As `ask`, but waits for the measurement; None if it is not there after `patience` [s]."""
        ends = time.monotonic() + patience
        while (known := self.ask(study)) is None and (left := ends - time.monotonic()) > 0.0:
            with self._changed:
                self._changed.wait(min(left, 1.0))
        return known

    def shutdown(self) -> None:
        """End the workers, whatever they fly."""
        with self._changed:
            self._closing = True
            executor = self._executor
            self._changed.notify_all()
        if isinstance(executor, LocalProcesses):
            executor.kill()

    def _measure_what_is_wanted(self) -> None:
        """Until nothing was wanted for a while."""
        workers: Workers | None = None
        try:
            while (study := self._next()) is not None:
                try:
                    workers = workers or self._opened()
                    assert self._executor is not None
                    measured = CellTime(
                        cell_time(study, self._executor, workers.count), workers.words, time.monotonic()
                    )
                except (CaptureError, BrokenExecutor, CancelledError) as error:
                    workers = None
                    measured = CellTime(None, str(error), time.monotonic())
                self._keep(study, measured)
        finally:
            self._dismiss()

    def _opened(self) -> Workers:
        """Workers with a fresh executor.

        Raises:
            WorkersUnavailable: there are none, or the service ends.

        """
        self._dismiss()
        workers = self._find_workers()
        executor = workers.open_executor()
        with self._changed:
            self._executor = executor
            if self._closing:
                raise WorkersUnavailable("the service ends")
        return workers

    def _next(self) -> Study | None:
        """The study to measure next; None, and the end of this thread, if there is none for a while."""
        with self._changed:
            self._changed.wait_for(lambda: self._closing or self._wanted is not None, IDLE_TIME)
            study, self._wanted = self._wanted, None
            if study is None or self._closing:
                self._thread = None
                return None
            return study

    def _keep(self, study: Study, measured: CellTime) -> None:
        with self._changed:
            self._known.pop(_key(study), None)
            self._known[_key(study)] = measured
            while len(self._known) > KEPT:
                del self._known[next(iter(self._known))]
            if self._wanted is not None and _key(self._wanted) == _key(study):
                self._wanted = None
            self._changed.notify_all()

    def _dismiss(self) -> None:
        with self._changed:
            executor, self._executor = self._executor, None
        if executor is not None:
            executor.shutdown(wait=False, cancel_futures=True)


def _key(study: Study) -> bytes:
    """The same for studies whose cells take the same time: those that differ in name, description or seed."""
    definition = study.definition()
    for name in ("name", "description", "seed"):
        definition.pop(name, None)
    return hashlib.sha256(json.dumps(definition, sort_keys=True).encode()).digest()
