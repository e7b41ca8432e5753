"""What was foreseen of the live run: kept with it when its sequence begins, to stand beside what then happens."""

from __future__ import annotations

from typing import NamedTuple

from server.library.recorder import Recorder
from server.rehearsals.look_ahead import LookAhead
from sim.config import MissionConfig
from sim.rehearsal.rehearsal import Rehearsal


class _Rehearsed(NamedTuple):
    run: str
    rehearsal: Rehearsal
    outline: bytes


class Foreseen:
    """The last rehearsal of a request, or the look-ahead, of the mission as it was when the request was granted.

    For any thread; nothing here waits for the disk.
    """

    def __init__(self, recorder: Recorder, look_ahead: LookAhead) -> None:
        self._recorder, self._look_ahead = recorder, look_ahead
        self._last: _Rehearsed | None = None
        self._kept_of: str | None = None
        """The last run that has one."""

    def rehearsed(self, run: str, rehearsal: Rehearsal, outline: bytes) -> None:
        """Somebody has rehearsed a state of the live run, and this came out (JSON of a `RehearsalResult`)."""
        if rehearsal.request is not None:
            self._last = _Rehearsed(run, rehearsal, outline)
        elif self._kept_of != run:  # of what is under way: better than nothing
            self._keep(run, outline)

    def begun(self, run: str, command: str, config: MissionConfig) -> None:
        """That command has been granted in that run, with that configuration in force."""
        outline = self._rehearsed(run, command, config) or self._look_ahead.outline(run, command, config)
        if outline is not None:
            self._keep(run, outline)

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
    return config.model_copy(update={"simulation": case.simulation, "judging": case.judging}) == case
