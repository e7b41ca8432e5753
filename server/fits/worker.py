"""What the worker process does of a fit: it goes on in a thread, and between two looks at it the worker is free."""

from __future__ import annotations

import threading
from typing import NamedTuple

from sim.identification.fit import FitPlan, fit
from sim.identification.result import FitResult
from sim.study.cores import cores

LOOK = 0.25
"""How long a look waits for the end [s]."""


class Looked(NamedTuple):
    """How far a fit has come."""

    part: float
    """That is done, 0 to 1."""
    words: str
    """What is being done."""
    result: FitResult | None
    """Once it has ended."""


class _Running:
    """A fit under way."""

    def __init__(self, plan: FitPlan) -> None:
        self.cancelled, self.ended = threading.Event(), threading.Event()
        self._plan, self._part, self._words = plan, 0.0, ""
        self._result: FitResult | None = None
        self._error: BaseException | None = None
        threading.Thread(target=self._fit, name="becalm-fit", daemon=True).start()

    def look(self) -> Looked:
        """How far it is.

        Raises:
            CaptureError: it has failed.

        """
        if self.ended.wait(LOOK) and self._error is not None:
            raise self._error
        return Looked(self._part, self._words, self._result)

    def _tell(self, part: float, words: str) -> None:
        self._part, self._words = part, words

    def _fit(self) -> None:
        try:
            self._result = fit(self._plan, threads=cores(), on_progress=self._tell, cancelled=self.cancelled)
        except Exception as error:  # whoever waits gets it at the next look
            self._error = error
        finally:
            self.ended.set()


_running: dict[str, _Running] = {}
"""By the identifier of the job."""


def begin(job: str, plan: FitPlan) -> None:
    """Begin a fit."""
    _running[job] = _Running(plan)


def look(job: str) -> Looked:
    """How far it is; one that has ended is let go of.

    Raises:
        CaptureError: it has failed.

    """
    running = _running[job]
    try:
        looked = running.look()
    except BaseException:
        del _running[job]
        raise
    if looked.result is not None:
        del _running[job]
    return looked


def forget(job: str) -> None:
    """End a fit that nobody waits for."""
    running = _running.pop(job, None)
    if running is not None:
        running.cancelled.set()
