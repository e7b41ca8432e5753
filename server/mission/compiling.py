"""What a mission of another method or engine runs is compiled beside the service: no mission thread waits for it."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from concurrent.futures import Future, wait

from server.errors import ServiceBusy
from server.link.robot_link import RobotLink
from sim.capture.compile_progress import compiled_share
from sim.capture.mission import prepare
from sim.config import MissionConfig
from sim.errors import CaptureError, MissionRefused
from sim.study.executors import LocalProcesses, leave_realtime

NICENESS = 10
"""The live mission's clock comes first."""

LOOK_PERIOD = 0.5
"""Between two looks how far a compilation is [s]."""

log = logging.getLogger(__name__)


class MissionCompiler:
    """Knows what missions this process can fly at once, and prepares others, one after another.

    A process of its own compiles; a thread that has no deadlines then loads what it has compiled.
    """

    def __init__(self, *, robot: bool) -> None:
        """Of missions with a robot, or of simulated ones."""
        self._robot = robot
        self._prepared: set[str] = set()
        self._failed: dict[str, Exception] = {}
        self._waiting: dict[str, MissionConfig] = {}
        """By what is prepared; the first of them now."""
        self._share: float | None = None
        self._pool: LocalProcesses | None = None
        self._closing = False
        self._lock = threading.Lock()

    def share(self, config: MissionConfig) -> float:
        """How much of what a mission runs has been compiled, from 0 to 1; for any thread."""
        return compiled_share(config, simulated=not self._robot)

    def prepare(self, config: MissionConfig) -> None:
        """Compile and load what a mission runs, here and now."""
        self._work(config)
        self._prepared.add(self._words(config))

    def require(self, config: MissionConfig) -> None:
        """Refuse a mission that would compile while it flies, and begin to prepare it.

        Raises:
            ServiceBusy: it is being prepared, or waits for what is; the message says how far that is.
            CaptureError: its preparation has failed; asked again, it is tried again.

        """
        words = self._words(config)
        with self._lock:
            if words in self._prepared:
                return
            failure = self._failed.pop(words, None)
            if failure is not None:
                raise _refusal(words, failure)
            if not self._closing:
                self._queue(words, config)
            raise ServiceBusy(self._progress(words), tip=_TIP)

    def shutdown(self) -> None:
        """End what compiles; for any thread."""
        self._closing = True
        pool = self._pool
        if pool is not None:
            pool.kill()

    def _words(self, config: MissionConfig) -> str:
        """What of a configuration decides what is compiled."""
        method = f"method = {config.method.value}"
        return method if self._robot else f"{method} with simulation.engine = {config.simulation.engine.value}"

    @property
    def _work(self) -> Callable[[MissionConfig], None]:
        return RobotLink.warm_up if self._robot else prepare

    def _queue(self, words: str, config: MissionConfig) -> None:
        begins = not self._waiting
        self._waiting.setdefault(words, config)
        if begins:
            threading.Thread(target=self._prepare_waiting, name="becalm-compiler", daemon=True).start()

    def _progress(self, words: str) -> str:
        first = next(iter(self._waiting), words)
        # Whole is what is counted function by function: the loop around them is compiled for each method anew.
        share = self._share
        far = f" ({100 * share:.0f} % compiled)" if share is not None and share < 1.0 else ""
        behind = "" if words == first else f"{words} waits until "
        return f"{behind}{first} is being prepared{far}"

    def _prepare_waiting(self) -> None:
        leave_realtime()  # before there is a process: it inherits how this thread is scheduled
        while True:
            with self._lock:
                if self._closing or not self._waiting:
                    return
                words, config = next(iter(self._waiting.items()))
                self._share = None
            failure = self._failure(words, config)
            with self._lock:
                del self._waiting[words]
                if failure is None:
                    self._prepared.add(words)
                elif not self._closing:
                    self._failed[words] = failure

    def _failure(self, words: str, config: MissionConfig) -> Exception | None:
        """What went wrong as it was prepared; None if nothing did."""
        log.info("%s is being prepared", words)
        try:
            self._compile_beside(config)
            self._work(config)  # from the disk by now
        except Exception as error:
            if not self._closing:
                log.exception("%s could not be prepared", words)
            return error
        log.info("%s is prepared", words)
        return None

    def _compile_beside(self, config: MissionConfig) -> None:
        with LocalProcesses(1, NICENESS) as pool:
            self._pool = pool
            future = pool.submit(self._work, config)
            if self._closing:  # looked at after there is a process, as `shutdown` looks for one after it has said so
                pool.kill()
            try:
                self._watch(future, config)
            finally:
                self._pool = None

    def _watch(self, future: Future[None], config: MissionConfig) -> None:
        """Wait until it is compiled, and look meanwhile how far that is."""
        while not wait([future], LOOK_PERIOD).done:
            self._share = self.share(config)
        future.result()


_TIP = (
    "it takes seconds, or a minute or two where it is compiled for the first time; "
    "the mission that flies is not touched: ask again then"
)


def _refusal(words: str, failure: Exception) -> CaptureError:
    """The failure as it is told to who asks."""
    if isinstance(failure, CaptureError):
        return failure
    why = f"{type(failure).__name__}: {failure}"
    return MissionRefused(
        f"{words} could not be prepared: {why}", tip="ask again to try again; the service's log says more"
    )
