"""A mission that would compile while it flies is refused, and what it needs is prepared beside the service."""

from __future__ import annotations

import logging
import multiprocessing
import threading
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from typing import ClassVar

import pytest

from server.errors import ServiceBusy
from server.link.robot_link import RobotLink
from server.mission import compiling
from server.mission.compiling import MissionCompiler
from sim.config import MissionConfig
from sim.configurations import revised
from sim.errors import ConfigError, MissionRefused

OURS = revised(MissionConfig(), {"method": "co_moving_couple"})
PUBLISHED = revised(OURS, {"method": "published"})
REDUCED = revised(OURS, {"simulation": {"engine": "reduced"}})


class Beside:
    """In place of the process: what it was asked to do, and the test says when it has."""

    begun: ClassVar[list[Beside]] = []

    def __init__(self, *_):
        self.future = Future()
        self.asked = threading.Event()
        Beside.begun.append(self)
        opened.release()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def submit(self, work, config):
        self.work, self.config = work, config
        self.asked.set()
        return self.future

    def kill(self):
        self.future.set_exception(BrokenProcessPool("killed"))


opened = threading.Semaphore(0)


def asked() -> Beside:
    """The next process, once it has been asked to do something."""
    assert opened.acquire(timeout=60)
    beside = Beside.begun[-1]
    assert beside.asked.wait(60)
    return beside


def settled() -> None:
    """Return when nothing is prepared any more."""
    for thread in threading.enumerate():
        if thread.name == "becalm-compiler":
            thread.join(60)
            assert not thread.is_alive()


@pytest.fixture
def loaded(monkeypatch):
    """Configurations that were prepared in this process; no process begins."""
    seen: list[MissionConfig] = []
    Beside.begun.clear()
    while opened.acquire(blocking=False):
        pass
    monkeypatch.setattr(compiling, "LOOK_PERIOD", 0.01)
    monkeypatch.setattr(compiling, "LocalProcesses", Beside)
    monkeypatch.setattr(compiling, "prepare", seen.append)
    return seen


@pytest.fixture
def compiler(loaded):  # noqa: ARG001 - nothing is compiled
    """It has prepared our own method."""
    compiler = MissionCompiler(robot=False)
    compiler.prepare(OURS)
    yield compiler
    compiler.shutdown()
    settled()


def test_what_was_prepared_may_fly_at_once(compiler):
    compiler.require(OURS)
    assert Beside.begun == []


@pytest.mark.parametrize("other", [PUBLISHED, REDUCED])
def test_another_method_or_engine_is_prepared_first_and_once(compiler, loaded, other):
    for _ in range(2):
        with pytest.raises(ServiceBusy, match=r"^method = .* with simulation.engine = .* is being prepared"):
            compiler.require(other)
    beside = asked()
    assert beside.config == other
    beside.future.set_result(None)
    settled()
    compiler.require(other)
    assert len(Beside.begun) == 1
    assert loaded == [OURS, other]


@pytest.mark.parametrize(("share", "words"), [(0.5, r" \(50 % compiled\)$"), (1.0, r" is being prepared$")])
def test_it_says_how_far_it_is_but_not_that_all_is_compiled(compiler, monkeypatch, share, words):
    looked = threading.Event()

    def look(*_, **__):
        looked.set()
        return share

    monkeypatch.setattr(compiling, "compiled_share", look)
    with pytest.raises(ServiceBusy):
        compiler.require(PUBLISHED)
    asked()
    for _ in range(2):  # what the first look gave is there at the second
        looked.clear()
        assert looked.wait(60)
    with pytest.raises(ServiceBusy, match=words):
        compiler.require(PUBLISHED)


def test_what_is_asked_meanwhile_waits_behind_it(compiler, loaded):
    with pytest.raises(ServiceBusy):
        compiler.require(PUBLISHED)
    with pytest.raises(ServiceBusy, match=r"engine = reduced waits until method = published .* is being prepared"):
        compiler.require(REDUCED)
    asked().future.set_result(None)
    asked().future.set_result(None)
    settled()
    assert loaded == [OURS, PUBLISHED, REDUCED]
    compiler.require(REDUCED)


@pytest.mark.parametrize(
    ("failure", "refusal"), [(ConfigError("no"), ConfigError), (BrokenProcessPool("out of memory"), MissionRefused)]
)
def test_a_failure_is_logged_and_told_and_tried_again_only_when_asked(compiler, caplog, failure, refusal):
    with pytest.raises(ServiceBusy):
        compiler.require(PUBLISHED)
    with caplog.at_level(logging.ERROR, "server.mission.compiling"):
        asked().future.set_exception(failure)
        settled()
    assert "method = published" in caplog.text
    with pytest.raises(refusal, match=str(failure)):
        compiler.require(PUBLISHED)
    assert len(Beside.begun) == 1
    with pytest.raises(ServiceBusy):
        compiler.require(PUBLISHED)
    asked()


def test_a_robots_mission_goes_by_its_method_and_compiles_what_a_robot_needs(loaded, monkeypatch):
    warmed: list[MissionConfig] = []
    monkeypatch.setattr(RobotLink, "warm_up", warmed.append)
    compiler = MissionCompiler(robot=True)
    compiler.prepare(OURS)
    compiler.require(REDUCED)
    with pytest.raises(ServiceBusy, match=r"^method = published is being prepared"):
        compiler.require(PUBLISHED)
    beside = asked()
    assert beside.work == RobotLink.warm_up
    beside.future.set_result(None)
    settled()
    compiler.require(PUBLISHED)
    assert (warmed, loaded) == ([OURS, PUBLISHED], [])


def test_the_process_ends_with_the_service_and_that_is_no_failure(caplog):
    compiler = MissionCompiler(robot=False)
    with caplog.at_level(logging.ERROR, "server.mission.compiling"):
        with pytest.raises(ServiceBusy):
            compiler.require(PUBLISHED)
        compiler.shutdown()
        settled()
    assert multiprocessing.active_children() == []
    assert caplog.text == ""
