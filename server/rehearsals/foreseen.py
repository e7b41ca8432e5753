"""What was foreseen of the live run: kept with it when its sequence begins, to stand beside what then happens."""

from __future__ import annotations

import logging
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from server.errors import LoopSilent, ServiceBusy
from server.jobs.queue import JobQueue
from server.library.recorder import Recorder
from server.library.run_state import RunState
from server.rehearsals.jobs import LookAheadJob
from server.rehearsals.look_ahead import FUTURES, LookAhead
from server.rehearsals.worker import Ahead
from sim.config import MissionConfig
from sim.control.phases import Command
from sim.errors import CaptureError, MissionRefused
from sim.rehearsal.futures import rehearsed
from sim.rehearsal.rehearsal import Rehearsal, planned
from sim.rehearsal.situation import REQUESTS
from sim.rehearsal.uncertainty import UncertaintyModel

log = logging.getLogger(__name__)


class _Rehearsed(NamedTuple):
    run: str
    rehearsal: Rehearsal
    outline: bytes


class Foreseen:
    """The last rehearsal of a request, or the look-ahead, of the mission as it was when the request was granted.

    Where neither is ready and somebody looks, the state at the press is rehearsed while the sequence is under way. For
    any thread; nothing here waits for the disk.
    """

    def __init__(
        self,
        recorder: Recorder,
        look_ahead: LookAhead,
        queue: JobQueue,
        find_state: Callable[[], RunState],
    ) -> None:
        self._recorder, self._look_ahead = recorder, look_ahead
        self._queue, self._find = queue, find_state
        self._last: _Rehearsed | None = None
        self._kept_of: str | None = None
        """The last run that has one."""

    def rehearsed(self, run: str, rehearsal: Rehearsal, outline: bytes) -> None:
        """Somebody has rehearsed a state of the live run, and this came out (JSON of a `RehearsalResult`)."""
        if rehearsal.request is not None:
            self._last = _Rehearsed(run, rehearsal, outline)
        elif self._kept_of != run:  # of what is under way: better than nothing
            self._keep(run, outline)

    def is_wanted(self, run: str, command: str, config: MissionConfig) -> bool:
        """Whether `state` has to be asked for before that command is: nothing is ready, and somebody looks."""
        begins = command in {each.value for each in REQUESTS}
        return begins and self._look_ahead.is_looked_at and self._outline(run, command, config) is None

    def state(self) -> RunState | None:
        """The live mission's state, just before something is asked of it; waits for the mission thread.

        None where there is none: what is asked will be told why.
        """
        try:
            return self._find()
        except (LoopSilent, MissionRefused, ServiceBusy):
            return None

    def begun(self, run: str, command: str, config: MissionConfig) -> None:
        """That command has been granted in that run, with that configuration in force."""
        outline = self._outline(run, command, config)
        if outline is not None:
            self._keep(run, outline)

    def begun_unforeseen(self, before: RunState, command: str) -> None:
        """That command has been granted in that state: it is rehearsed now, and kept with the run afterwards."""
        run, situation = before
        try:
            rehearsal = planned(
                situation,
                {},
                request=Command(command),
                uncertainty=UncertaintyModel(),
                futures=FUTURES,
                seed=situation.tick,
            )
            self._queue.add(LookAheadJob(rehearsal, run, asker=run, on_made=partial(self._made, run)))
        except (CaptureError, ServiceBusy) as reason:
            log.info("nothing is foreseen of run %s: %s", run, reason)

    def _made(self, run: str, ahead: Ahead) -> None:
        self._keep(run, ahead.outline)

    def _outline(self, run: str, command: str, config: MissionConfig) -> bytes | None:
        return self._rehearsed(run, command, config) or self._look_ahead.outline(run, command, config)

    def _rehearsed(self, run: str, command: str, config: MissionConfig) -> bytes | None:
        last = self._last
        if last is None or last.rehearsal.request is None or (last.run, last.rehearsal.request.value) != (run, command):
            return None
        return last.outline if any(_flies_as(config, case) for case in last.rehearsal.cases.values()) else None

    def _keep(self, run: str, outline: bytes) -> None:
        self._recorder.keep_foreseen(run, outline)
        self._kept_of = run


def _flies_as(config: MissionConfig, case: MissionConfig) -> bool:
    """Whether a mission so configured is what a case has flown, in an engine and judged as futures are."""
    return rehearsed(config).model_copy(update={"judging": case.judging}) == case
