"""A study in flight: the cells that have no row yet, flown until all have one or until the study is cancelled."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from concurrent.futures import wait as wait_for

import numpy as np
from pydantic import Field

from sim.snapshot import FrozenMessage
from sim.study.design import Study
from sim.study.executors import Workers, fly_cells
from sim.study.run import CellTask, Row, fly_cell
from sim.study.table import StudyTable

MANY_CELLS = 10_000
"""Studies of more cells are flown only if that is confirmed."""

LANDING_TIME = 10.0
"""After a cancellation: how long the cells in flight may still take [s]; a lost cluster gets none of it."""

TRIAL_CELLS = 6
"""Flown to estimate how long a study takes."""


class Progress(FrozenMessage):
    """How far a study has come, and how fast it proceeds."""

    done: int = Field(description="Cells that have a row")
    total: int = Field(description="Cells of the study")
    wall_time: float = Field(0.0, description="Since it was last begun, to its end [s]")
    cells_per_second: float | None = Field(None, description="Since it was last begun; null until a cell has ended")
    simulated_seconds_per_second: float | None = Field(None, description="Mission time flown a second of wall time")
    time_left: float | None = Field(None, description="By that pace, wall time [s]")


class StudyFlight:
    """Flies the cells that a table lacks. `progress` may be read from any thread."""

    def __init__(self, table: StudyTable, cancelled: threading.Event | None = None) -> None:
        self._cancelled = cancelled or threading.Event()
        self._table = table
        self._resumed = len(table)
        self._began = time.perf_counter()
        self._ended: float | None = None
        self._simulated_time = 0.0
        self._asked_to_end: float | None = None

    @property
    def progress(self) -> Progress:
        """Now."""
        done, total = len(self._table), self._table.study.count
        elapsed = max((self._ended or time.perf_counter()) - self._began, 1e-9)
        rate = (done - self._resumed) / elapsed
        return Progress(
            done=done,
            total=total,
            wall_time=elapsed,
            cells_per_second=rate or None,
            simulated_seconds_per_second=self._simulated_time / elapsed if rate else None,
            time_left=(total - done) / rate if rate else None,
        )

    def fly(self, workers: Workers, *, on_row: Callable[[Row], None] | None = None) -> None:
        """Fly the cells without a row; returns when all have one, or soon after `cancelled` was set.

        Args:
            workers: what flies them; twice as many cells as fly at a time are handed to it.
            on_row: called in this thread with every row, after it was kept.

        Raises:
            TableUnusable: a row cannot be kept.
            WorkersUnavailable: there is no worker that could fly a cell.

        """
        self._began = time.perf_counter()

        def keep(row: Row) -> None:
            self._table.add(row)
            self._simulated_time += row["duration"] or 0.0
            if on_row is not None:
                on_row(row)

        try:
            fly_cells(self._tasks(), keep, workers.open_executor, at_once=2 * workers.count, gives_up=self._gives_up)
        finally:
            self._ended = time.perf_counter()

    def _gives_up(self) -> bool:
        """Whether the study was cancelled so long ago that the cells in flight are no longer waited for."""
        if not self._cancelled.is_set():
            return False
        self._asked_to_end = self._asked_to_end or time.perf_counter()
        return time.perf_counter() - self._asked_to_end > LANDING_TIME

    def _tasks(self) -> Iterator[CellTask]:
        study = self._table.study
        for index in self._table.missing():
            if self._cancelled.is_set():
                return
            yield CellTask(study.base, study.direct, study.cell(index))


def cell_time(study: Study, executor: Executor, workers: int) -> float:
    """Wall time that one more cell of a study takes [s], by some spread over it, flown now, their rows dropped.

    Args:
        study: what would be flown.
        executor: what flies it; its workers start, and load what is compiled, before the time is taken.
        workers: cells that it flies at a time.

    Raises:
        BrokenExecutor: a worker died.

    """
    places = np.unique(np.linspace(0, study.count - 1, TRIAL_CELLS).astype(np.int64))
    tasks = [CellTask(study.base, study.direct, study.cell(int(place))) for place in places]
    at_once = min(workers, len(tasks))
    wait_for([executor.submit(fly_cell, tasks[0]) for _ in range(at_once)])
    before = time.perf_counter()
    for future in [executor.submit(fly_cell, task) for task in tasks]:
        future.result()
    return (time.perf_counter() - before) / len(tasks) * at_once / workers


def flight_time(study: Study, cells: int, workers: Workers) -> float:
    """How long these workers need for that many cells of a study [s], estimated by flying a few."""
    with workers.open_executor() as executor:
        return cell_time(study, executor, workers.count) * cells


def in_words(duration: float) -> str:
    """A duration [s] in words."""
    minutes, seconds = divmod(round(duration), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes:02d} min"
    return f"{minutes} min {seconds:02d} s" if minutes else f"{seconds} s"
