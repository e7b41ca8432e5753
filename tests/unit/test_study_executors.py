"""Cells on executors that fail as executors do: every cell gives one row, whatever happens."""

from __future__ import annotations

from collections import Counter
from concurrent.futures import BrokenExecutor, Executor, Future

import pytest

from sim.study.cores import cores
from sim.study.design import study_of
from sim.study.executors import WorkersUnavailable, fly_cells
from sim.study.run import CellTask, failed_row

STUDY = study_of({"grid": {"published.impedance.mass": {"from": 0.1, "to": 1.0, "count": 10}}})
TASKS = [CellTask(STUDY.base, STUDY.direct, cell) for cell in STUDY.cells()]


class Fleet:
    """Opens executors whose futures end at once; some cells break them."""

    def __init__(self, deaths: dict[int, int] | None = None, *, starts: bool = True, fails: int | None = None) -> None:
        self.deaths = Counter(deaths or {})  # cell to how often it kills its worker
        self.starts = starts
        self.fails = fails
        self.opened: list[Scripted] = []
        self.flown: Counter[int] = Counter()

    def open(self) -> Executor:
        executor = Scripted(self)
        self.opened.append(executor)
        return executor


class Scripted(Executor):
    def __init__(self, fleet: Fleet) -> None:
        self.fleet = fleet
        self.is_broken = not fleet.starts
        self.is_shut = False

    def submit(self, _function, /, *args, **_options):
        future: Future = Future()
        if not args:  # whether a worker starts at all
            self._answer(future, 1)
            return future
        cell = args[0].cell
        if self.is_broken and self.fleet.starts:
            raise BrokenExecutor("broken before")
        if self.fleet.deaths[cell.index]:
            self.fleet.deaths[cell.index] -= 1
            self.is_broken = True
        if self.fleet.fails == cell.index:
            future.set_exception(ValueError("cannot be pickled"))
        else:
            self.fleet.flown[cell.index] += not self.is_broken
            self._answer(future, {"cell": cell.index, "error": None})
        return future

    def _answer(self, future, result):
        if self.is_broken:
            future.set_exception(BrokenExecutor("a worker died"))
        else:
            future.set_result(result)

    def shutdown(self, *_arguments, **_options):
        self.is_shut = True


def flown(fleet: Fleet, at_once: int = 4) -> list:
    rows: list = []
    fly_cells(TASKS, rows.append, fleet.open, at_once=at_once)
    assert all(executor.is_shut for executor in fleet.opened)
    return sorted(rows, key=lambda row: row["cell"])


@pytest.mark.parametrize("at_once", [1, 4, 100])
def test_every_cell_gives_one_row(at_once):
    fleet = Fleet()
    assert [row["cell"] for row in flown(fleet, at_once)] == list(range(10))
    assert len(fleet.opened) == 1


@pytest.mark.parametrize("at_once", [1, 3, 4, 100])
@pytest.mark.parametrize("deaths", [{0: 1}, {5: 1}, {9: 1}, {2: 1, 8: 1}])
def test_after_a_lost_worker_no_cell_is_lost_or_counted_twice(deaths, at_once):
    fleet = Fleet(deaths)
    rows = flown(fleet, at_once)
    assert [row["cell"] for row in rows] == list(range(10))
    assert all(row["error"] is None for row in rows)
    assert set(fleet.flown.values()) == {1}


@pytest.mark.parametrize("at_once", [1, 4, 100])
def test_a_cell_that_kills_its_worker_twice_costs_no_other(at_once):
    rows = flown(Fleet({5: 2}), at_once)
    assert [row["cell"] for row in rows] == list(range(10))
    assert [row["cell"] for row in rows if row["error"]] == [5]
    assert rows[5] == failed_row(TASKS[5].cell, "its worker process died, and died again when it flew this cell alone")


def test_an_error_of_the_executor_is_in_the_row():
    rows = flown(Fleet(fails=3))
    assert [row["error"] for row in rows if row["error"]] == ["ValueError: cannot be pickled"]


def test_workers_that_never_start_are_said_once():
    with pytest.raises(WorkersUnavailable, match="no worker process can be started"):
        flown(Fleet(starts=False))


def test_cells_are_taken_as_there_is_room():
    taken: list[int] = []
    kept: list[int] = []

    def tasks():
        for task in TASKS:
            taken.append(task.cell.index)
            yield task

    def keep(row):
        kept.append(row["cell"])
        assert len(taken) - len(kept) < 2

    fly_cells(tasks(), keep, Fleet().open, at_once=2)
    assert len(kept) == 10


def test_an_interruption_keeps_what_has_ended_and_starts_nothing_more():
    rows: list = []
    fleet = Fleet()

    def tasks():
        yield from TASKS[:3]
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fly_cells(tasks(), rows.append, fleet.open, at_once=100)
    assert [row["cell"] for row in sorted(rows, key=lambda row: row["cell"])] == [0, 1, 2]
    assert fleet.opened[0].is_shut


def test_what_keep_raises_ends_the_study():
    def keep(_row):
        raise OSError("disk full")

    fleet = Fleet()
    with pytest.raises(OSError, match="disk full"):
        fly_cells(TASKS, keep, fleet.open, at_once=2)
    assert fleet.opened[0].is_shut
    assert fleet.flown.total() <= 2


def test_there_is_a_core():
    assert cores() >= 1


def test_a_study_that_makes_no_progress_ends_when_nobody_waits_for_it():
    """A cluster that has fallen silent: nothing ever ends, and to wait for it would be for ever."""

    class Silent(Executor):
        def submit(self, *_, **__) -> Future:
            future: Future = Future()
            future.set_running_or_notify_cancel()
            return future

        def shutdown(self, wait: bool = True, **_) -> None:
            waits.append(wait)

    waits: list[bool] = []
    asked: list[int] = []

    def asked_twice() -> bool:
        asked.append(0)
        return len(asked) == 2

    rows: list = []
    fly_cells(TASKS, rows.append, Silent, at_once=2, gives_up=asked_twice)
    assert (rows, len(asked)) == ([], 2)
    assert set(waits) == {False}
