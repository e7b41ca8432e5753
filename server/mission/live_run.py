"""When the live mission is recorded.

A run begins with its mission. Until the first command that moves the robot it holds the first tick
only, and a mission that never moved leaves no run. From that command on every tick is recorded, until the
verdict, or until nothing has moved for a while; the next such command goes on recording.
"""

from __future__ import annotations

from typing import Any

from server.library.record import LoggedEvent, RunStatus, TickArray
from server.library.recorder import Recorder
from server.library.runs import new_record
from server.mission.fork import Fork
from sim.config import MissionConfig
from sim.snapshot import Outcome

REST_AFTER = 5.0
"""Mission time without motion, beyond the hold before a verdict, after which recording rests [s]."""

STOPPED_NOTE = "ended by STOP"
"""Of a run that rests without a verdict because it was stopped."""

CUT_OFF_NOTE = "cut off: the service ended"
"""Of a run that was under way when the service ended in order."""


class LiveRun:
    """The run of one live mission. Used by the mission thread only."""

    def __init__(
        self,
        recorder: Recorder,
        configuration: str,
        config: MissionConfig,
        fork: Fork | None = None,
        *,
        robot: bool = False,
    ) -> None:
        """Of a mission that begins, of a robot's too, or of a fork, which is recorded at once."""
        if fork is None:
            record = new_record("live", configuration, config, robot=robot)
        else:
            marks = {"status": "running", "parent": fork.parent.run_id, "forked_at": fork.tick}
            record = new_record("fork", configuration, fork.history.config, **marks)
        self.id = record.id
        self._recorder = recorder
        self._recording = self._has_first_tick = self._has_moved = fork is not None
        self._quiet_since: float | None = None
        self._outcomes: list[Outcome] = []
        self._record = record

    def open(self) -> None:
        """Put the run on disk."""
        self._recorder.open(self._record)

    @property
    def has_moved(self) -> bool:
        """Whether a command has moved the robot since the mission began."""
        return self._has_moved

    def begin(self, configuration: str, config: MissionConfig) -> None:
        """Record every tick from here on: a command that moves the robot was granted."""
        if not self._has_moved:
            self._recorder.revise(configuration=configuration, config=config)
        if not self._recording:
            self._recorder.revise(status="running", note=None)
        self._recording = self._has_moved = True
        self._quiet_since = None

    def keep(self, ticks: TickArray) -> None:
        """Record these rows of `TICK`, if recording is on; the mission's first tick always."""
        if self._recording:
            self._recorder.append(ticks)
        elif not self._has_first_tick:
            self._recorder.append(ticks[:1])
        self._has_first_tick = True

    def log(self, event: LoggedEvent) -> None:
        """Record an event, whether ticks are recorded or not."""
        self._recorder.log(event)

    def conclude(self, outcome: Outcome) -> None:
        """A sequence of the mission has its verdict; those of the sequences before it stay."""
        self._end("finished", outcome=outcome, earlier_outcomes=tuple(self._outcomes))
        self._outcomes.append(outcome)

    def fail(self, note: str) -> None:
        """The plant failed; what was recorded stays."""
        self._end("failed", note=note)

    def note_quiet(self, time: float, hold_time: float, status: RunStatus) -> None:
        """Nothing moves at this mission time [s]; after a while recording rests with this status."""
        if self._quiet_since is None:
            self._quiet_since = time
        if self._recording and time - self._quiet_since > hold_time + REST_AFTER:
            self._end(status, note=STOPPED_NOTE if status == "cancelled" else None)

    def note_motion(self) -> None:
        """Something moves."""
        self._quiet_since = None

    def close(self, why: str) -> None:
        """The mission ends, whatever it was doing; a run without a verdict keeps why."""
        if not self._has_moved:
            self._recorder.discard(self.id)
        elif self._recording:
            self._recorder.close(status="cancelled", note=why)
        else:
            self._recorder.close()

    def _end(self, status: RunStatus, **last_words: Any) -> None:
        self._recording = False
        self._recorder.revise(status=status, **last_words)
