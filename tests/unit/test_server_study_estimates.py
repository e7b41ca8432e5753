"""How long studies take is measured one at a time, the one asked for last, and remembered for a moment."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from server.studies import estimates as study_estimates
from server.studies.estimates import StudyEstimates
from sim.study import flight
from sim.study.design import study_of
from sim.study.executors import Workers, WorkersUnavailable

PATIENCE = 60.0
"""Bound on every wait [s]."""


def study(mass: float, **fields):
    return study_of({"grid": {"published.impedance.mass": [mass, 2 * mass]}, **fields})


class Trial:
    """Workers that are threads, and cells that end when they are let."""

    def __init__(self, monkeypatch):
        self.flown: list[float] = []
        self.began = threading.Event()
        self.may_end = threading.Event()
        self.may_end.set()
        self.opened = 0
        monkeypatch.setattr(flight, "fly_cell", self._fly)

    def _fly(self, task):
        self.flown.append(task.cell.values["published.impedance.mass"])
        self.began.set()
        assert self.may_end.wait(PATIENCE)
        return {}

    def workers(self) -> Workers:
        self.opened += 1
        return Workers(lambda: ThreadPoolExecutor(1), 1, "1 thread")


@pytest.fixture
def trial(monkeypatch):
    return Trial(monkeypatch)


@pytest.fixture
def estimates(trial):
    made = StudyEstimates(trial.workers)
    yield made
    trial.may_end.set()
    made.shutdown()


def test_whoever_asks_is_answered_at_once_and_later_with_the_time(trial, estimates):
    trial.may_end.clear()
    assert estimates.ask(study(0.1)) is None
    trial.may_end.set()
    known = estimates.wait(study(0.1), PATIENCE)
    assert known is not None
    assert known.seconds is not None
    assert known.words == "1 thread"
    assert estimates.ask(study(0.1, name="another", seed=7)) == known


def test_only_the_study_asked_for_last_is_measured_next(trial, estimates):
    trial.may_end.clear()
    estimates.ask(study(0.1))
    assert trial.began.wait(PATIENCE)
    for number in range(1, 20):
        estimates.ask(study(float(number)))
    trial.may_end.set()
    assert estimates.wait(study(19.0), PATIENCE) is not None
    assert set(trial.flown) == {0.1, 0.2, 19.0, 38.0}
    assert trial.opened == 1


@pytest.mark.usefixtures("trial")
def test_what_was_measured_long_ago_is_measured_again(estimates, monkeypatch):
    first = estimates.wait(study(0.1), PATIENCE)
    monkeypatch.setattr(study_estimates, "FRESH", 0.0)
    assert estimates.ask(study(0.1)) is None
    monkeypatch.setattr(study_estimates, "FRESH", 60.0)
    assert first is not None


def test_without_workers_the_reason_is_said(estimates, monkeypatch):
    def none() -> Workers:
        raise WorkersUnavailable("the scheduler does not answer")

    monkeypatch.setattr(estimates, "_find_workers", none)
    known = estimates.wait(study(0.1), PATIENCE)
    assert known is not None
    assert (known.seconds, known.words) == (None, "the scheduler does not answer")


def test_the_workers_end_when_nothing_is_asked(trial, estimates, monkeypatch):
    monkeypatch.setattr(study_estimates, "IDLE_TIME", 0.01)
    assert estimates.wait(study(0.1), PATIENCE) is not None
    for thread in threading.enumerate():
        if thread.name == "becalm-trial":
            thread.join(PATIENCE)
    assert estimates.wait(study(0.2), PATIENCE) is not None
    assert trial.opened == 2
