"""Studies on a Dask cluster: the workers behind a scheduler's address as one `concurrent.futures.Executor`.

A worker that dies costs no cell: the scheduler hands its cells to another. A scheduler that dies breaks the
executor; the study goes on if another answers at the same address, else it ends and keeps its rows. A worker that
runs other code than this process is refused, since rows of two versions must not meet in one table.
"""

from __future__ import annotations

import importlib
import re
import socket
import struct
import threading
import time
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor, Future
from functools import partial
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from server.settings import SCHEDULER_ADDRESS
from sim.errors import ConfigError
from sim.study.executors import Workers, WorkersUnavailable
from sim.study.table import code_fingerprint

if TYPE_CHECKING:
    from distributed import Client

_P = ParamSpec("_P")
_R = TypeVar("_R")

_LENGTH = struct.Struct("<Q")

CONNECTING_TIME = 10.0
"""For the scheduler to answer, and again for a worker to be there [s]."""

LARGEST_GREETING = 100_000
"""Bytes of the first message of a Dask scheduler, which has some hundred; other programs seem to announce more."""

CONNECTED = "running"
"""Dask's word for a client that has its scheduler."""


def cluster_workers(scheduler: str) -> Workers:
    """The workers of the Dask scheduler at that address, which now has at least one.

    Raises:
        ConfigError: the address cannot be one.
        WorkersUnavailable: Dask is not installed, nothing answers there, there is no worker, or one runs other code.

    """
    if not re.match(SCHEDULER_ADDRESS, scheduler):
        raise ConfigError(f"scheduler = {scheduler!r} is no address of a Dask scheduler; write tcp://HOST:8786")
    _require_dask()
    threads = _in_time(scheduler, lambda: _threads(scheduler))
    opened = partial(_in_time, scheduler, partial(ClusterExecutor, scheduler))
    return Workers(opened, threads, f"{threads} threads of the cluster at {scheduler}")


def _threads(scheduler: str) -> int:
    with ClusterExecutor(scheduler) as executor:
        return executor.threads


def _in_time(scheduler: str, ask: Callable[[], _R]) -> _R:
    """What the cluster answers, unless it falls silent on the way: Dask itself would wait for ever.

    Raises:
        WorkersUnavailable: it says nothing more, or it cannot do what it is asked.

    """
    answer: Future[_R] = Future()

    def wait_for_it() -> None:
        try:
            answer.set_result(ask())
        except BaseException as error:
            answer.set_exception(error)

    threading.Thread(target=wait_for_it, name="becalm-cluster", daemon=True).start()
    try:
        return answer.result(3 * CONNECTING_TIME)
    except TimeoutError:
        tip = "see whether the scheduler and its workers still run, and restart them"
        raise WorkersUnavailable(f"the Dask cluster at {scheduler} has fallen silent", tip=tip) from None


class ClusterExecutor(Executor):
    """Runs functions on the cluster; connects when it is made, and lets go of the cluster when it is shut down."""

    def __init__(self, scheduler: str) -> None:
        """Connect, and see that there are workers with this process's code.

        Raises:
            WorkersUnavailable: see `cluster_workers`.

        """
        self._scheduler = scheduler
        self._client = _connected(scheduler)
        try:
            self._require_same_code(scheduler)
        except BaseException:
            self._client.close(CONNECTING_TIME)
            raise
        self._executor = self._client.get_executor(pure=False)

    @property
    def threads(self) -> int:
        """Cells that all its workers can fly at a time, now."""
        return sum(self._client.nthreads().values())

    def submit(self, function: Callable[_P, _R], /, *args: _P.args, **kwargs: _P.kwargs) -> Future[_R]:
        """As every executor; a worker that joined later is asked for its code as well.

        Raises:
            BrokenExecutor: the scheduler is lost. What was with it by then is cancelled; what came after never ends.

        """
        if self._client.status == CONNECTED:
            future: Future[_R] = self._executor.submit(_run_same_code, code_fingerprint(), function, *args, **kwargs)
            if self._client.status == CONNECTED:
                return future
        raise BrokenExecutor(f"the Dask scheduler at {self._scheduler} is lost")

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Wait for what has been submitted, or give it up, and disconnect."""
        self._executor.shutdown(wait=wait and not cancel_futures)
        self._client.close(CONNECTING_TIME)

    def _require_same_code(self, scheduler: str) -> None:
        try:
            self._client.wait_for_workers(1, timeout=CONNECTING_TIME)
        except TimeoutError:
            what = f"the Dask scheduler at {scheduler} has no worker"
            raise WorkersUnavailable(what, tip=f"start some: dask worker {scheduler} --nthreads 1") from None
        found: dict[str, Any] = self._client.run(_worker_code, on_error="return")
        for worker, code in found.items():
            if code != code_fingerprint():
                raise _other_code(worker, code)


def _require_dask() -> None:
    try:
        importlib.import_module("distributed")  # an extra, and a second to load
    except ImportError:
        tip = "install it with: pip install 'becalm[cluster]'"
        raise WorkersUnavailable("Dask is not installed", tip=tip) from None


def _connected(scheduler: str) -> Client:
    from distributed import Client  # noqa: PLC0415 - see `_require_dask`

    try:
        _require_greeting(scheduler)
        return Client(scheduler, timeout=CONNECTING_TIME, set_as_default=False)
    except (OSError, TimeoutError, ValueError, MemoryError) as error:
        tip = "start one (dask scheduler), or see whether its address and port are right"
        raise WorkersUnavailable(f"no Dask scheduler answers at {scheduler} ({error})", tip=tip) from None


def _require_greeting(scheduler: str) -> None:
    """See that what listens there greets as a Dask scheduler does, which speaks first.

    Dask's own client believes whatever length it reads: the first letters of a web server's answer are 10^18 bytes.

    Raises:
        OSError: nothing listens there, it says nothing in time, or it is something else.

    """
    kind, _, place = scheduler.partition("://")
    if kind != "tcp":
        return  # encrypted or over HTTP: the handshake before is a check of its own
    host, _, port = place.rpartition(":")
    until = time.monotonic() + CONNECTING_TIME
    with socket.create_connection((host.strip("[]"), int(port)), CONNECTING_TIME) as connection:
        greeting = b""
        while len(greeting) < _LENGTH.size:
            connection.settimeout(max(until - time.monotonic(), 0.001))
            try:
                piece = connection.recv(_LENGTH.size - len(greeting))
            except TimeoutError:
                raise OSError(f"it accepts connections, but has said nothing for {CONNECTING_TIME:g} s") from None
            if not piece:
                raise OSError("it closes the connection without a word")
            greeting += piece
    if _LENGTH.unpack(greeting)[0] > LARGEST_GREETING:
        raise OSError(f"something else answers there, with {greeting!r}")


def _worker_code() -> tuple[str, ...]:
    return code_fingerprint()


def _run_same_code(code: tuple[str, ...], function: Callable[_P, _R], *args: _P.args, **kwargs: _P.kwargs) -> _R:
    """On the worker."""
    if code_fingerprint() != code:
        raise _other_code("a worker that joined", code_fingerprint())
    return function(*args, **kwargs)


def _other_code(worker: str, code: object) -> WorkersUnavailable:
    has = f"cannot run Becalm ({code})" if isinstance(code, Exception) else f"has other code ({code})"
    what = f"{worker} {has}; this process has {code_fingerprint()}"
    return WorkersUnavailable(what, tip="install the same version of Becalm and of its requirements on every worker")
