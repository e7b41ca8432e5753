"""The mission's clock as operators command it: running or paused, its speed, and a single step under way."""

from __future__ import annotations

import time
from typing import NamedTuple

from server.mission.inbox import Answer, Request
from server.mission.live_mission import LiveMission
from server.mission.pace import FULL_SPEED, Pace
from server.mission.replies import Replies
from server.published import PlantStatus
from sim.errors import MissionRefused

SIMULATED = ("pause", "run", "step", "fork")
"""What only a simulation can do."""
_REAL_TIME = "{} is refused: a robot is flown, in real time"


class _Step(NamedTuple):
    """A single step under way."""

    request: Request
    answer: Answer
    first_tick: int


class MissionClock:
    """Used by the mission thread only, but for the counters of its pace, which any thread may read."""

    def __init__(self, period: float, replies: Replies, *, real_time: bool) -> None:
        """A clock that runs in real time.

        Args:
            period: of a tick [s].
            replies: take the answer to a step when it is finished.
            real_time: whether a robot is flown, whose clock is nobody's to choose.

        """
        self.pace = Pace(period, time.monotonic())
        self._replies = replies
        self._real_time = real_time
        self._step: _Step | None = None

    def require_simulation(self, command: str) -> None:
        """Refuse what only a simulation can do.

        Raises:
            MissionRefused: a robot is flown, and its clock is nobody's to choose.

        """
        if self._real_time and command in SIMULATED:
            raise MissionRefused(_REAL_TIME.format(command), tip="hold or stop brings the robot to rest")

    def restart(self, period: float, now: float) -> None:
        """Begin the schedule of a mission whose ticks have that period [s]."""
        self.pace.period = period
        self.pace.anchor(now)

    def pause(self, flying: LiveMission) -> str:
        """Hold the clock; in words what was done."""
        self.pace.pause(time.monotonic())
        self.finish_step("paused", flying)
        return "the clock is paused"

    def run(self, speed: float | None, flying: LiveMission) -> str:
        """Let the clock run, at that multiple of real time or as before; in words what was done."""
        self.finish_step("the clock runs", flying)
        speed = self.pace.speed if speed is None else speed
        self.pace.run(speed, time.monotonic())
        pace = "as fast as it goes" if speed == FULL_SPEED else f"at {speed:g} x real time"
        return f"the clock runs {pace}"

    def allow_steps(self, ticks: int) -> str:
        """Let a paused clock go on by so many ticks; how many in words.

        Raises:
            MissionRefused: the clock runs, or a step is under way.

        """
        refusal = self.refusals()["step"]
        if refusal:
            raise MissionRefused(refusal, tip="pause the clock first")
        self.pace.steps_left = ticks
        return _ticks(ticks)

    def begin_step(self, request: Request, answer: Answer, first_tick: int) -> None:
        """Answer that request when the ticks that it asked for are flown."""
        self._step = _Step(request, answer, first_tick)

    def finish_step(self, reason: str, flying: LiveMission) -> None:
        """Answer the step under way, if there is one, with the reason why it is not flown on; none if it is whole."""
        step, self._step = self._step, None
        self.pace.steps_left = 0
        if step is not None:
            flown = flying.tick - step.first_tick
            message = f"{flown} of {_ticks(step.request.ticks)} flown" + (f": {reason}" if reason else "")
            self._replies.grant(step.request, step.answer, message, flying)

    def finish_whole_step(self, flying: LiveMission) -> None:
        """Answer the step under way if all its ticks are flown."""
        if self._step and not self.pace.steps_left:
            self.finish_step("", flying)

    def refusals(self) -> dict[str, str | None]:
        """The commands of the clock, and those that take another mission: None if allowed now, else why not."""
        if self._real_time:
            refused = {command: _REAL_TIME.format(command) for command in SIMULATED}
            return {**dict.fromkeys(("pause", "run", "step", "reset", "fork")), **refused}
        paused = not self.pace.running
        stepping = "a step is under way" if self.pace.steps_left else None
        return {
            "pause": "the clock is paused already" if paused and not stepping else None,
            "run": None,
            "step": stepping if paused else "step is refused while the clock runs; pause it first",
            "reset": None,
            "fork": None,
        }

    def status(self, now: float) -> PlantStatus:
        """The plant and its clock, as they are published."""
        return PlantStatus(
            kind="zenoh" if self._real_time else "simulation",
            running=self.pace.running,
            speed=self.pace.speed,
            lateness=self.pace.lateness(now),
            real_time_factor=self.pace.real_time_factor(now),
        )


def _ticks(count: int) -> str:
    return "1 tick" if count == 1 else f"{count} ticks"
