"""A whole capture, headless: as fast as the machine goes, by the same mission that flies live."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

from sim.capture.events import Event, Ticks
from sim.capture.mission import Mission
from sim.config import MissionConfig
from sim.control.phases import Command
from sim.errors import MissionRefused
from sim.record import Record
from sim.snapshot import Outcome

_CHUNK = 500  # ticks at a time: their rows stay in the processor's cache until they are read
_UNREAD_CHUNK = 5000  # where nobody reads them


@dataclass(frozen=True)
class RunResult:
    """What a headless run gives beside its ticks."""

    outcome: Outcome
    ticks: int
    simulated_time: float
    """[s]"""
    wall_time: float
    """Compiled time only, without `on_ticks` [s]."""
    monitor: Record
    """What was noted of it, one element of `MONITOR`."""
    events: list[Event] = field(default_factory=list)

    @property
    def real_time_factor(self) -> float:
        """Simulated seconds per second of compiled time."""
        return self.simulated_time / self.wall_time if self.wall_time > 0.0 else 0.0


def run_capture(
    config: MissionConfig,
    *,
    direct: bool = False,
    on_ticks: Callable[[Ticks], None] | None = None,
    on_event: Callable[[Event], None] | None = None,
) -> RunResult:
    """Fly a capture, or direct caging, from the start to its verdict.

    Args:
        config: of the run; `judging.time_limit` bounds it.
        direct: without detumbling.
        on_ticks: called with consecutive arrays of `TICK`; what it raises ends the run.
        on_event: called with every event as it happens, before the ticks it is among.

    Raises:
        ConfigError: the target overlaps the robot at the start.
        MissionRefused: it cannot end well, and the message says why, with numbers; nothing was flown.
        PlantDiverged: the simulated state is not finite.

    """
    mission = Mission(config)
    ask(mission, Command.DIRECT_CAGE if direct else Command.CAPTURE)
    return fly_to_verdict(mission, on_ticks=on_ticks, on_event=on_event)


def ask(mission: Mission, command: Command) -> None:
    """Request what ends with a verdict, unless the method says that it cannot end well from here.

    Raises:
        MissionRefused: it says so, with numbers; or the phase does not allow it.

    """
    if speaks_against := mission.refusal(command, on_robot=False):
        raise MissionRefused(speaks_against)
    mission.request(command)


def fly_to_verdict(
    mission: Mission,
    *,
    on_ticks: Callable[[Ticks], None] | None = None,
    on_event: Callable[[Event], None] | None = None,
) -> RunResult:
    """Fly a mission whose capture is under way to its verdict; arguments as those of `run_capture`.

    Raises:
        PlantDiverged: the simulated state is not finite.

    """
    ticks, wall_time, began = 0, 0.0, mission.time
    events: list[Event] = []
    while mission.outcome is None:
        before = time.perf_counter()
        rows = None if on_ticks is None else mission.advance(_CHUNK)
        ticks += mission.advance_unrecorded(_UNREAD_CHUNK) if rows is None else len(rows)
        wall_time += time.perf_counter() - before
        events += _drain_events(mission, on_event)
        if on_ticks is not None and rows is not None:
            on_ticks(rows)
    return RunResult(
        outcome=mission.outcome,
        ticks=ticks,
        simulated_time=mission.time - began,
        wall_time=wall_time,
        events=events,
        monitor=mission.monitor,
    )


def _drain_events(mission: Mission, on_event: Callable[[Event], None] | None) -> list[Event]:
    """The events since the last call, each passed to `on_event`."""
    events = mission.take_events()
    for event in events:
        if on_event is not None:
            on_event(event)
    return events
