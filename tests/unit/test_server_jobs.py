"""The queue of jobs: who goes first, what is superseded, what becomes of what fails; its worker is played."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Future
from typing import Any

import pytest

from server.errors import JobNotFound, JobRefused, ServiceBusy
from server.jobs import queue as queue_module
from server.jobs.job import IDLY, SOON, URGENT, Job, Piece
from server.jobs.queue import CAPACITY, JobQueue

PATIENCE = 60.0


class Played:
    """A pool that does what it is given in the thread that gives it."""

    def __init__(self, *_: Any) -> None:
        self.killed = False

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        done: Future[Any] = Future()
        try:
            done.set_result(function(*arguments))
        except BaseException as error:
            done.set_exception(error)
        return done

    def kill(self) -> None:
        self.killed = True

    def shutdown(self, **_: Any) -> None:
        pass


class Steps(Job):
    """A job of some pieces, each of which is noted."""

    kind = "steps"

    def __init__(self, name: str, pieces: int, urgency: int, work: Callable[[str], None], asker: str = "") -> None:
        self.name, self.count, self.work, self.urgency = name, pieces, work, urgency
        self.ended = threading.Event()
        super().__init__(asker or name, pieces)

    def pieces(self) -> Iterator[Piece]:
        for _ in range(self.count):
            yield Piece(self.work, (self.name,))

    def keep(self, result: Any) -> None:
        assert result is None
        self.done += 1

    def end(self, status: Any, note: str | None = None) -> None:
        super().end(status, note)
        self.ended.set()

    def forgetting(self) -> Piece:
        return Piece(lambda: None, ())


@pytest.fixture
def queue(monkeypatch: pytest.MonkeyPatch) -> Iterator[JobQueue]:
    monkeypatch.setattr(queue_module, "LocalProcesses", Played)
    made = JobQueue("tests", 12)
    yield made
    made.shutdown()


def test_what_is_urgent_goes_before_what_has_begun(queue: JobQueue) -> None:
    done: list[str] = []
    urgent = Steps("urgent", 2, URGENT, done.append)

    def look(name: str) -> None:
        done.append(name)
        if done == ["look"]:
            queue.add(urgent)

    idle = Steps("look", 3, IDLY, look)
    queue.add(idle)
    queue.start()
    assert idle.ended.wait(PATIENCE)
    assert done == ["look", "urgent", "urgent", "look", "look"]
    assert (idle.status, urgent.status, idle.done) == ("finished", "finished", 3)
    assert queue.waiting == 0


def test_a_newer_one_of_the_same_asker_and_kind_takes_the_place_of_the_older(queue: JobQueue) -> None:
    first, other, second = (Steps(name, 1, SOON, print, asker) for name, asker in ("ax", "by", "cx"))
    for job in (first, other, second):
        queue.add(job)
    assert (first.status, other.status, second.status) == ("superseded", "queued", "queued")
    assert "takes its place" in str(first.note)


def test_so_many_may_wait(queue: JobQueue) -> None:
    for place in range(CAPACITY):
        queue.add(Steps(str(place), 1, SOON, print))
    with pytest.raises(ServiceBusy, match=f"{CAPACITY} rehearsals, atlases and fits wait already"):
        queue.add(Steps("one more", 1, SOON, print))
    newest = Steps("0", 1, SOON, print)
    queue.add(newest)  # takes the place of its own
    assert newest.status == "queued"


def test_what_is_cancelled_is_flown_no_further(queue: JobQueue) -> None:
    done: list[str] = []
    following = Steps("following", 1, SOON, done.append)

    def work(name: str) -> None:
        done.append(name)
        queue.cancel(cancelled)

    cancelled = Steps("cancelled", 5, URGENT, work)
    queue.add(cancelled)
    queue.add(following)
    queue.start()
    assert following.ended.wait(PATIENCE)
    assert done == ["cancelled", "following"]
    assert (cancelled.status, cancelled.done) == ("cancelled", 0)
    with pytest.raises(JobRefused, match="is cancelled already"):
        queue.cancel(cancelled)


def test_the_worker_ends_what_is_cancelled_while_nothing_else_waits(queue: JobQueue) -> None:
    forgotten = threading.Event()

    class Forgettable(Steps):
        def forgetting(self) -> Piece:
            return Piece(forgotten.set, ())

    cancelled = Forgettable("cancelled", 5, SOON, lambda _: queue.cancel(cancelled))
    queue.add(cancelled)
    queue.start()
    assert forgotten.wait(PATIENCE)
    assert cancelled.status == "cancelled"


def test_a_job_begins_again_once_if_its_worker_is_lost(queue: JobQueue) -> None:
    tries: list[str] = []

    def dies(name: str) -> None:
        tries.append(name)
        if len(tries) == 2:
            raise BrokenExecutor

    def always_dies(_: str) -> None:
        raise BrokenExecutor

    once, always = Steps("once", 3, URGENT, dies), Steps("always", 3, SOON, always_dies)
    queue.add(once)
    queue.add(always)
    queue.start()
    assert always.ended.wait(PATIENCE)
    assert (once.status, once.done, len(tries)) == ("finished", 3, 5)
    assert always.status == "failed"
    assert "died again" in str(always.note)


def test_what_fails_says_why_and_what_waits_is_flown(queue: JobQueue) -> None:
    def fails(_: str) -> None:
        raise ValueError("no such thing")

    failing, following = Steps("failing", 1, URGENT, fails), Steps("following", 1, SOON, print)
    queue.add(failing)
    queue.add(following)
    queue.start()
    assert following.ended.wait(PATIENCE)
    assert (failing.status, failing.note) == ("failed", "ValueError: no such thing")
    assert following.status == "finished"


def test_a_job_is_found_by_its_kind_until_it_is_removed(queue: JobQueue) -> None:
    job = Steps("a", 1, SOON, print)
    queue.add(job)
    assert queue.job(job.id, Steps) is job
    with pytest.raises(JobNotFound):
        queue.job("nothing", Steps)
    queue.remove(job)
    assert job.status == "cancelled"
    with pytest.raises(JobNotFound, match="does not exist"):
        queue.job(job.id, Steps)
