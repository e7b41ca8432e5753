"""A whole capture, headless: as fast as the machine goes, by the same mission that flies live."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field

from sim.capture.events import Event, Ticks
from sim.capture.mission import Mission
from sim.config import MissionConfig
from sim.control.phases import Command
from sim.snapshot import Outcome

_CHUNK = 500  # ticks at a time: their rows stay in the processor's cache until they are read


@dataclass(frozen=True)
class RunResult:
    """What a headless run gives beside its ticks."""

    outcome: Outcome
    ticks: int
    simulated_time: float
    """[s]"""
    wall_time: float
    """Compiled time only, without `on_ticks` [s]."""
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
        PlantDiverged: the simulated state is not finite.

    """
    mission = Mission(config)
    mission.request(Command.DIRECT_CAGE if direct else Command.CAPTURE)
    ticks, wall_time = 0, 0.0
    events: list[Event] = []
    while mission.outcome is None:
        before = time.perf_counter()
        rows = mission.advance(_CHUNK)
        wall_time += time.perf_counter() - before
        ticks += len(rows)
        events += _drain_events(mission, on_event)
        if on_ticks is not None:
            on_ticks(rows)
    return RunResult(
        outcome=mission.outcome,
        ticks=ticks,
        simulated_time=mission.time,
        wall_time=wall_time,
        events=events,
    )


def _drain_events(mission: Mission, on_event: Callable[[Event], None] | None) -> list[Event]:
    """The events since the last call, each passed to `on_event`."""
    events = mission.take_events()
    for event in events:
        if on_event is not None:
            on_event(event)
    return events
