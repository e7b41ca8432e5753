"""What readers ask for that takes long, done by processes beside the service, so that it costs the mission no turn.

Python runs one thread of a process at a time. Lists, plots and exports take it for seconds, while STOP, the mission and
everybody's telemetry wait for their turns: so they are done elsewhere, a few at a time, and what waits has a bound.

The processes fork from one that has loaded all they need (a forkserver), so that one begins within some milliseconds;
they give way to everything else on the machine, and end with the service.
"""

from __future__ import annotations

import asyncio
import contextlib
import multiprocessing
import os
import pickle
import signal
import sys
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import BrokenExecutor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial
from itertools import chain
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any, ParamSpec, TypeVar

from server.errors import ServiceBusy
from sim.errors import CaptureError
from sim.study.executors import begin_worker

NICENESS = 10
"""The live mission's clock comes first."""

ANSWERS_AT_ONCE, STREAMS_AT_ONCE = 2, 4
"""What is done at a time: of what is answered whole, and of what is sent piece by piece."""

WAITING = 32
"""Requests of either kind that may wait; who comes then is asked to come again."""

END_TIME = 0.5
"""How long a process may take to end once it was asked to [s]; then it is killed."""

_P = ParamSpec("_P")
_T = TypeVar("_T")

CONTEXT = multiprocessing.get_context("forkserver")
CONTEXT.set_forkserver_preload(["server.api.runs", "server.api.studies", "server.library.replay_session"])


class PiecesLost(Exception):
    """What has been sent of an answer cannot be completed: its connection ends, so that nobody takes it for whole."""


class _Slots:
    """So many at a time, and so many who wait, in the order in which they came."""

    def __init__(self, count: int) -> None:
        self._free = asyncio.Semaphore(count)
        self._closed = False
        self.waiting = 0

    async def take(self) -> None:
        """Wait for one.

        Raises:
            ServiceBusy: too many wait already, or the service ends.

        """
        if self.waiting >= WAITING:
            raise ServiceBusy(f"{WAITING} requests of readers wait already", tip="try again in a moment")
        self.waiting += 1
        try:
            await self._free.acquire()
        finally:
            self.waiting -= 1
        if self._closed:
            self.give_back()
            raise ServiceBusy("the service is ending", tip="start it again")

    def close(self) -> None:
        """Refuse who waits and who comes."""
        self._closed = True
        self.give_back()  # to the first that waits, who passes it on

    def give_back(self) -> None:
        """Let the next one have it."""
        self._free.release()


class Aside:
    """The processes that read, and who waits for them. In one event loop, but for `shutdown`."""

    def __init__(self) -> None:
        self._answers, self._streams = _Slots(ANSWERS_AT_ONCE), _Slots(STREAMS_AT_ONCE)
        self._threads = ThreadPoolExecutor(ANSWERS_AT_ONCE + STREAMS_AT_ONCE, "becalm-aside")
        self._lock = threading.Lock()
        self._pool: ProcessPoolExecutor | None = None
        self._open: set[PieceStream] = set()

    @property
    def waiting(self) -> int:
        """Requests that wait for a process."""
        return self._answers.waiting + self._streams.waiting

    async def warm_up(self) -> None:
        """Have a process ready."""
        with contextlib.suppress(ServiceBusy):
            await self.answer(os.getpid)

    async def answer(self, job: Callable[_P, _T], /, *args: _P.args, **kwargs: _P.kwargs) -> _T:
        """What `job` gives, which is done in another process: function and values are pickled.

        Raises:
            CaptureError: what it raises.
            ServiceBusy: too many wait already, or its process was lost.

        """
        await self._answers.take()
        try:
            future = await self.wait_for(self._submitted, partial(job, *args, **kwargs))
            return await asyncio.wrap_future(future)
        except BrokenExecutor:
            self._drop_pool()
            raise ServiceBusy("the process that reads was lost", tip="try again") from None
        finally:
            self._answers.give_back()

    async def stream(self, job: Callable[_P, Iterable[bytes]], /, *args: _P.args, **kwargs: _P.kwargs) -> PieceStream:
        """What `job` gives, piece by piece as they are taken; it is done in a process of its own, until it is closed.

        Raises:
            CaptureError: what it raises before the first piece.
            ServiceBusy: too many wait already, or its process was lost.

        """
        await self._streams.take()
        stream = PieceStream(self, partial(job, *args, **kwargs))
        self._open.add(stream)
        try:
            await stream.begin()
        except BaseException:
            stream.close()
            raise
        return stream

    def ended(self, stream: PieceStream) -> None:
        """Its place is free."""
        if stream in self._open:
            self._open.remove(stream)
            self._streams.give_back()

    async def wait_for(self, work: Callable[..., _T], *args: Any) -> _T:
        """In a thread, of which there are as many as there are places."""
        return await asyncio.get_running_loop().run_in_executor(self._threads, work, *args)

    def end_soon(self) -> None:
        """Refuse who waits, and end what is being sent."""
        self._answers.close()
        self._streams.close()
        for stream in tuple(self._open):
            stream.kill()

    def shutdown(self) -> None:
        """End all processes, whatever they do; from any thread."""
        for stream in tuple(self._open):
            stream.kill()
        self._drop_pool(wait=True)
        self._threads.shutdown(wait=False, cancel_futures=True)

    def _submitted(self, work: Callable[[], _T]) -> Future[_T]:
        with self._lock:
            if self._pool is None:
                self._pool = ProcessPoolExecutor(ANSWERS_AT_ONCE, CONTEXT, begin_aside)
            return self._pool.submit(work)

    def _drop_pool(self, *, wait: bool = False) -> None:
        with self._lock:
            pool, self._pool = self._pool, None
        if pool is None:
            return
        for process in tuple((pool._processes or {}).values()):  # `kill_workers` from Python 3.14 on
            process.kill()
        pool.shutdown(wait=wait, cancel_futures=True)


class PieceStream:
    """A process that makes pieces, and the pipe that they come through: it holds few, so who takes none stops it."""

    def __init__(self, aside: Aside, work: Callable[[], Iterable[bytes]]) -> None:
        self._aside = aside
        self._work = work
        self._pipe: Connection | None = None
        self._process: BaseProcess | None = None
        """Once it has been started."""
        self._killed = False

    async def begin(self) -> None:
        """Wait for the first piece, or for why there is none.

        Raises:
            CaptureError: what the work raises.
            ServiceBusy: its process was lost.

        """
        refusal = await self._aside.wait_for(self._started)
        if refusal is not None:
            raise refusal

    def __aiter__(self) -> PieceStream:
        return self

    async def __anext__(self) -> bytes:
        """The next piece.

        Raises:
            PiecesLost: the process ended before it had given all.

        """
        piece = await self._aside.wait_for(self._next)
        if not piece:
            raise StopAsyncIteration
        return piece

    def close(self) -> None:
        """End the process, whatever it does, and give its place to the next."""
        self.kill()
        self._aside.ended(self)

    def kill(self) -> None:
        """End the process, whatever it does, also one that is just being started; from any thread."""
        self._killed = True  # before looking, as `_started` looks after it has shown the process
        if self._process is not None:
            self._process.terminate()
            threading.Thread(target=self._forget, daemon=True).start()

    def _started(self) -> CaptureError | None:
        self._pipe, sink = CONTEXT.Pipe(duplex=False)
        process = CONTEXT.Process(target=_send_pieces, args=(self._work, sink), daemon=True)
        process.start()
        sink.close()
        self._process = process
        if self._killed:
            self.kill()
            return ServiceBusy("what reads was ended before it had begun", tip="try again")
        try:
            refusal: CaptureError | None = pickle.loads(self._pipe.recv_bytes())
        except (EOFError, OSError):
            return ServiceBusy("the process that reads was lost", tip="try again")
        return refusal

    def _next(self) -> bytes:
        assert self._pipe is not None, "it has begun"
        try:
            return self._pipe.recv_bytes()
        except (EOFError, OSError):
            raise PiecesLost("the process that reads was lost in the middle of its work") from None

    def _forget(self) -> None:
        assert self._process is not None
        assert self._pipe is not None
        self._process.join(END_TIME)
        self._process.kill()
        with contextlib.suppress(OSError):
            self._pipe.close()


def begin_aside(niceness: int = NICENESS) -> None:
    """Be a process beside the service."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the service, which then ends this
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # what it has put on the disk meanwhile goes with it
    begin_worker(niceness)


def _send_pieces(work: Callable[[], Iterable[bytes]], sink: Connection) -> None:
    """Do the work of one stream: None or a refusal first, then the pieces, then an empty one."""
    begin_aside()
    try:
        pieces = iter(work())
        first = next(pieces, b"")
    except CaptureError as refusal:
        sink.send_bytes(pickle.dumps(refusal))
        return
    with contextlib.suppress(BrokenPipeError):  # who asked has gone
        sink.send_bytes(pickle.dumps(None))
        for piece in chain([first], pieces):
            if piece:
                sink.send_bytes(piece)
        sink.send_bytes(b"")
