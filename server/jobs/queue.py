"""The jobs that wait, and the thread that has them done, piece by piece, by one worker beside the live mission.

Rehearsals have one queue, and fits another with a worker of its own: a fit takes minutes, and a look-ahead never waits.
"""

from __future__ import annotations

import logging
import threading
from collections import OrderedDict
from concurrent.futures import BrokenExecutor
from typing import Any

from server.errors import JobNotFound, JobRefused, ServiceBusy
from server.jobs.job import Job, JobStatus, Piece
from sim.errors import CaptureError
from sim.study.executors import LocalProcesses

CAPACITY = 8
"""Jobs that may wait or fly."""

KEPT = 32
"""Jobs that have ended and can still be read."""

IDLE_TIME = 300.0
"""After so long without anything to do the worker is let go of, and its memory with it [s]."""

log = logging.getLogger(__name__)


class JobQueue:
    """What was asked for, and what came of it. Safe from any thread."""

    def __init__(self, name: str, niceness: int) -> None:
        """Nothing waits yet; a worker of that niceness will do what comes, led by a thread of that name."""
        self._niceness = niceness
        self._jobs: OrderedDict[str, Job] = OrderedDict()
        self._changed = threading.Condition()
        self._closing = False
        self._pool: LocalProcesses | None = None
        self._forgotten: list[Piece] = []
        self._thread = threading.Thread(target=self._live, name=f"becalm-{name}", daemon=True)

    def start(self) -> None:
        """Start the thread; the worker starts with the first job."""
        self._thread.start()

    def shutdown(self, patience: float = 1.0) -> None:
        """End the worker, whatever it does."""
        with self._changed:
            self._closing = True
            pool = self._pool
            self._changed.notify()
        if pool is not None:
            pool.kill()
        if self._thread.is_alive():
            self._thread.join(patience)

    @property
    def waiting(self) -> int:
        """Jobs that have not ended."""
        return sum(not job.has_ended for job in tuple(self._jobs.values()))

    def add(self, job: Job) -> None:
        """Put a job into the queue; an older one of the same kind and asker is superseded by it.

        Raises:
            ServiceBusy: too many wait already.

        """
        with self._changed:
            for older in self._jobs.values():
                if (older.kind, older.asker) == (job.kind, job.asker) and not older.has_ended:
                    self._end(older, "superseded", "a newer one of the same asker takes its place")
            if self.waiting >= CAPACITY:
                raise ServiceBusy(
                    f"{CAPACITY} rehearsals, atlases and fits wait already",
                    tip="try again in some seconds, or cancel one",
                )
            self._jobs[job.id] = job
            self._drop_oldest()
            self._changed.notify()

    def job(self, job_id: str, kind: type[Job]) -> Any:
        """The job of that identifier.

        Raises:
            JobNotFound: there is none of that kind, or not any more.

        """
        with self._changed:
            found = self._jobs.get(job_id)
        if not isinstance(found, kind):
            raise JobNotFound(
                f"{kind.kind} {job_id!r} does not exist", tip=f"the newest {KEPT} are kept until the service ends"
            )
        return found

    def cancel(self, job: Job) -> None:
        """End a job that waits or flies.

        Raises:
            JobRefused: it has ended.

        """
        with self._changed:
            if job.has_ended:
                raise JobRefused(f"{job.kind} {job.id} is {job.status} already")
            self._end(job, "cancelled")

    def remove(self, job: Job) -> None:
        """End a job if it has not ended, and forget it."""
        with self._changed:
            if not job.has_ended:
                self._end(job, "cancelled")
            self._jobs.pop(job.id, None)

    def _drop_oldest(self) -> None:
        ended = [job.id for job in self._jobs.values() if job.has_ended]
        for job_id in ended[: max(0, len(ended) - KEPT)]:
            del self._jobs[job_id]

    def _end(self, job: Job, status: JobStatus, note: str | None = None) -> None:
        job.end(status, note)
        if status != "finished":
            self._forgotten.append(job.forgetting())
            self._changed.notify()

    def _live(self) -> None:
        while self._await_work():
            self._forget()
            job = self._most_urgent()
            if job is None:
                continue
            try:
                self._advance(job)
            except BrokenExecutor:
                self._begin_again(job)
            except CaptureError as error:
                self._fail(job, str(error))
            except Exception as error:  # the thread outlives every failure: what waits is flown all the same
                log.exception("%s %s failed", job.kind, job.id)
                self._fail(job, f"{type(error).__name__}: {error}")
        if self._pool is not None:
            self._pool.kill()
            self._pool.shutdown(wait=False, cancel_futures=True)

    def _await_work(self) -> bool:
        """Wait until something is to be done or forgotten; False when the service ends."""
        with self._changed:
            while not self._closing:
                if self._forgotten or self.waiting:
                    return True
                if not self._changed.wait(IDLE_TIME) and self._pool is not None:
                    self._pool.shutdown(wait=False)
                    self._pool = None
            return False

    def _most_urgent(self) -> Job | None:
        """Of these the oldest."""
        with self._changed:
            jobs = [job for job in self._jobs.values() if not job.has_ended]
            return min(jobs, key=lambda job: job.urgency, default=None)

    def _forget(self) -> None:
        """Have the worker end what nobody waits for; one that is lost has nothing to end."""
        with self._changed:
            forgotten, self._forgotten = self._forgotten, []
            there = self._pool is not None
        for piece in forgotten if there else ():
            try:
                self._done(piece)
            except BrokenExecutor:
                with self._changed:
                    self._pool = None
                return

    def _advance(self, job: Job) -> None:
        """Have one piece of it done."""
        with self._changed:
            if job.has_ended:
                return
            piece = job.next_piece()
            if piece is None:
                self._end(job, "finished")
                return
        result = self._done(piece)
        with self._changed:
            if not job.has_ended:
                job.keep(result)

    def _done(self, piece: Piece) -> Any:
        with self._changed:
            if self._closing:
                raise BrokenExecutor
            if self._pool is None:
                self._pool = LocalProcesses(1, self._niceness)
            future = self._pool.submit(piece.function, *piece.arguments)
        return future.result()

    def _begin_again(self, job: Job) -> None:
        """The worker was lost: once a job begins again with another one."""
        with self._changed:
            self._pool = None
            if self._closing or job.has_ended:
                return
            log.warning("the worker of %s %s was lost", job.kind, job.id)
            if job.restarted:
                self._end(job, "failed", "its worker process died, and died again")
            else:
                job.restart()

    def _fail(self, job: Job, note: str) -> None:
        with self._changed:
            if not job.has_ended:
                self._end(job, "failed", note)
