"""The cells of a study on any `concurrent.futures.Executor`: processes on this machine, or threads of this one.

Each cell gives one row, whatever happens to the processes that fly it. A worker that dies breaks the executor
(`BrokenExecutor`); the cells that it was flying are then flown again, one at a time, so that the one that
kills its worker is found and no other cell is lost.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from dataclasses import dataclass
from functools import partial
from multiprocessing.connection import wait as wait_for_end
from typing import ParamSpec, TypeVar

from sim.errors import CaptureError
from sim.study.run import CellTask, Row, failed_row, fly_cell

_P = ParamSpec("_P")
_R = TypeVar("_R")

LOOKING_UP = 0.5
"""How often a study without progress is checked for being still wanted [s]."""

OpenExecutor = Callable[[], Executor]
"""Gives a fresh executor; called again when one has broken."""


@dataclass(frozen=True)
class Workers:
    """What flies the cells of a study."""

    open_executor: OpenExecutor
    count: int
    """Cells that fly at a time."""
    words: str
    """For people: "2 processes on this machine"."""


class WorkersUnavailable(CaptureError):
    """No worker of the executor can be had, or not one that flies this version of the code."""


class LocalProcesses(ProcessPoolExecutor):
    """Worker processes on this machine, started clean (spawn): nothing of this process is inherited."""

    def __init__(self, workers: int, niceness: int = 0) -> None:
        context = multiprocessing.get_context("spawn")
        super().__init__(workers, mp_context=context, initializer=begin_worker, initargs=(niceness,))

    def submit(self, function: Callable[_P, _R], /, *args: _P.args, **kwargs: _P.kwargs) -> Future[_R]:
        """As every executor; a worker that starts for it keeps the mask, so that Ctrl-C never reaches it."""
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            return super().submit(function, *args, **kwargs)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)

    def kill(self) -> None:
        """End every worker at once, whatever it does; whoever waits for it gets `BrokenExecutor`."""
        for process in tuple((self._processes or {}).values()):  # `kill_workers` from Python 3.14 on
            process.kill()


def local_workers(count: int, niceness: int = 0) -> Workers:
    """That many processes on this machine."""
    words = f"{count} {'process' if count == 1 else 'processes'} on this machine"
    return Workers(partial(LocalProcesses, count, niceness), count, words)


def local_threads(count: int) -> Workers:
    """That many threads of this process, which compiled code lets run side by side.

    They start at once, where a process takes seconds to load what is compiled; but what one of them makes crash takes
    all along, and Python's part of a cell, a fifth, is done by one at a time.
    """
    words = f"{count} {'thread' if count == 1 else 'threads'} of this process"
    return Workers(partial(ThreadPoolExecutor, count), count, words)


def begin_worker(niceness: int) -> None:
    """A worker ends with the process that leads the study, however that ends; `niceness` lets others go first."""
    leave_realtime()
    if hasattr(os, "nice"):
        os.nice(niceness)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def leave_realtime() -> None:
    """Be scheduled as others are, also where the leading process is a real-time one: a worker inherits that."""
    if sys.platform == "linux" and os.sched_getscheduler(0) in (os.SCHED_RR, os.SCHED_FIFO):
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    assert parent is not None
    wait_for_end([parent.sentinel])
    os._exit(1)


def fly_cells(
    tasks: Iterable[CellTask],
    keep: Callable[[Row], None],
    open_executor: OpenExecutor,
    *,
    at_once: int,
    gives_up: Callable[[], bool] = lambda: False,
) -> None:
    """Fly cells and hand each row over as it comes, in the order in which they end.

    Args:
        tasks: the cells; taken one by one as there is room.
        keep: called in this thread, once with the row of every cell; what it raises ends the study.
        open_executor: see `OpenExecutor`; whatever it gives is shut down in the end.
        at_once: cells handed to the executor at a time; twice its workers keeps them busy.
        gives_up: asked now and then while nothing comes; true ends the study without the cells in flight.

    Raises:
        WorkersUnavailable: the executor has no worker that could fly a cell.
        KeyboardInterrupt: after the cells in flight have ended and their rows were kept.

    """
    crew = _Crew(keep, open_executor, gives_up)
    try:
        for task in tasks:
            crew.submit(task)
            while crew.in_flight >= at_once:
                crew.collect()
        while crew.in_flight:
            crew.collect()
    except _GivenUp:
        return
    except KeyboardInterrupt:
        crew.land()
        raise
    finally:
        crew.dismiss()


class _GivenUp(Exception):
    """The cells in flight are no longer waited for."""


class _Crew:
    """An executor, opened again when it breaks, and the cells that it is flying."""

    def __init__(self, keep: Callable[[Row], None], open_executor: OpenExecutor, gives_up: Callable[[], bool]) -> None:
        self._keep = keep
        self._gives_up = gives_up
        self._open = open_executor
        self._flying: dict[Future[Row], CellTask] = {}
        self._executor = open_executor()

    @property
    def in_flight(self) -> int:
        return len(self._flying)

    def _reopen(self) -> None:
        """Open a fresh executor, and see that its workers start."""
        self._executor.shutdown()
        self._executor = self._open()
        try:
            self._executor.submit(os.getpid).result()
        except (BrokenExecutor, CancelledError) as error:
            tip = "fly a single capture (becalm run) to see whether the simulation starts at all"
            raise WorkersUnavailable(f"no worker process can be started: {error}", tip=tip) from None

    def submit(self, task: CellTask) -> None:
        try:
            self._flying[self._executor.submit(fly_cell, task)] = task
        except BrokenExecutor:
            self._recover([task])

    def collect(self) -> None:
        """Keep what has ended since the last call; waits until something has, or nobody waits for it any longer."""
        while not (ended := wait(self._flying, LOOKING_UP, FIRST_COMPLETED).done):
            if self._gives_up():
                raise _GivenUp
        lost = self._kept(ended)
        if lost:
            self._recover(lost)

    def _kept(self, ended: Iterable[Future[Row]]) -> list[CellTask]:
        """The cells among them whose worker was lost; the rows of all others are kept."""
        lost = []
        for future in ended:
            task = self._flying.pop(future)
            try:
                row = future.result()
            except (BrokenExecutor, CancelledError):
                lost.append(task)
                continue
            except WorkersUnavailable:
                raise
            except Exception as error:  # of the executor: the cell's own are in its row
                row = failed_row(task.cell, f"{type(error).__name__}: {error}")
            self._keep(row)
        return lost

    def _recover(self, lost: list[CellTask]) -> None:
        """Fly the lost cells again, each alone, on a fresh executor."""
        ended, _ = wait(self._flying)
        lost += self._kept(ended)
        self._reopen()
        for task in sorted(lost, key=lambda task: task.cell.index):
            self._keep(self._flown_alone(task))

    def _flown_alone(self, task: CellTask) -> Row:
        try:
            return self._executor.submit(fly_cell, task).result()
        except (BrokenExecutor, CancelledError):
            self._reopen()
            return failed_row(task.cell, "its worker process died, and died again when it flew this cell alone")

    def land(self) -> None:
        """Start nothing more; wait for the cells in flight and keep their rows."""
        for future in [future for future in self._flying if future.cancel()]:
            del self._flying[future]
        ended, _ = wait(self._flying)
        self._kept(ended)

    def dismiss(self) -> None:
        """Close the executor; waits for nothing whose row would not be kept."""
        for future in self._flying:
            future.cancel()
        self._executor.shutdown(wait=not self._flying)
