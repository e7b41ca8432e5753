"""One future: a capture flown on the reduced plant from a drawn state, by the method's own perception and control."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from sim.capture.beginning import Beginning
from sim.capture.caging import cage
from sim.capture.events import Ticks
from sim.capture.mission import Mission
from sim.capture.monitor import outcome_of
from sim.config import Engine, MissionConfig, NoiseDraws, SimulationConfig
from sim.configurations import nested, revised
from sim.control.phases import Command
from sim.errors import PlantError
from sim.rehearsal.situation import Situation
from sim.rehearsal.uncertainty import Draw, UncertaintyModel, draw, true_config, true_state
from sim.snapshot import Outcome
from sim.study.run import measures_of

TRACE_RATE = 20.0
"""Rows a second that are kept of a future [Hz]."""

TRACE = np.dtype(
    [
        ("time", np.float64),
        ("base_pose", np.float64, (3,)),
        ("target_pose", np.float64, (3,)),
        ("hand_pose", np.float64, (2, 3)),
        ("target_twist", np.float64, (3,)),
        ("hand_wrench", np.float64, (2, 3)),
        ("manipulability", np.float64, (2,)),
    ]
)
"""What is kept of a future's ticks, as fields of `TICK`."""

Trace = np.ndarray[Any, np.dtype[Any]]
"""An array of `TRACE`."""

_TAIL = 1.0
"""After its time limit a future is flown no longer than that [s]; then its outcome is unresolved."""


@dataclass(frozen=True)
class Flown:
    """One future, flown."""

    drawn: Draw
    outcome: Outcome
    measures: Mapping[str, Any]
    """As a study's row has them (`sim.study.run.MEASURES`), and `time_to_cage` [s] from the situation on."""
    trace: Trace
    error: str | None
    """Why it could not be flown to its end."""


def rehearsed(
    config: MissionConfig, settle: float | None = None, values: Mapping[str, Any] = MappingProxyType({})
) -> MissionConfig:
    """A configuration as futures fly it: in the reduced engine, its noise in pairs, judged soon after the arms lock.

    Args:
        config: what it is made of.
        settle: that long after at most [s]; None leaves it as it is.
        values: by path, that take the place of those of the configuration first.

    Raises:
        ConfigError: a value does not fit, or the step is too long for its contacts in that engine.

    """
    own = SimulationConfig.model_fields
    paths: dict[str, Any] = dict(values) | {
        f"simulation.{name}": own[name].default for name in ("solver_iterations", "joint_error_time", "collision_slop")
    }
    paths["simulation.engine"] = Engine.REDUCED.value
    paths["perception.noise.draws"] = NoiseDraws.IN_PAIRS.value
    if settle is not None:
        paths["judging.hold_time"] = min(settle, values.get("judging.hold_time", config.judging.hold_time))
    return revised(config, nested(paths))


def fly_future(
    situation: Situation,
    config: MissionConfig,
    request: Command | None,
    model: UncertaintyModel,
    seed: int,
    future: int,
    horizon: float,
) -> Flown:
    """Fly the future of that number.

    Args:
        situation: that it begins in.
        config: in force from then on, as `rehearsed` gives it.
        request: the sequence that is asked for; None goes on with the one under way.
        model: what is not known for sure.
        seed: of the rehearsal.
        future: its number, from 0.
        horizon: mission time after which it is unresolved [s].

    """
    drawn = draw(situation, config, model, seed, future)
    mission = standing(situation, config, request, drawn, horizon)
    every = max(1, round(1.0 / (TRACE_RATE * config.control.period)))
    trace: list[Trace] = []
    error = None
    try:
        _fly(mission, situation.time + horizon + _TAIL, every, trace)
    except PlantError as failure:
        error = str(failure)
    outcome = mission.outcome or _unresolved(mission)
    return Flown(drawn, outcome, _measures(outcome, mission, situation), np.concatenate(trace), error)


def standing(
    situation: Situation, config: MissionConfig, request: Command | None, drawn: Draw, horizon: float
) -> Mission:
    """The mission of a future, before its first tick."""
    true, beginning = begun(situation, config, request, drawn, horizon)
    mission = beginning.mission(true)
    if beginning.request is not None:
        mission.request(beginning.request)
    return mission


def begun(
    situation: Situation, config: MissionConfig, request: Command | None, drawn: Draw, horizon: float
) -> tuple[MissionConfig, Beginning]:
    """What a future is flown with, and where it begins: all that it depends on."""
    true = true_config(config, drawn)
    since = situation.time if request is not None else float(situation.mark.flight[0]["monitor"]["begun_at"])
    limit = min(config.judging.time_limit, situation.time - since + horizon)
    true = true.model_copy(update={"judging": true.judging.model_copy(update={"time_limit": limit})})
    return true, Beginning.at(situation.mark, true_state(situation, drawn), true, request)


def _fly(mission: Mission, end: float, every: int, trace: list[Trace]) -> None:
    def keep(rows: Ticks) -> None:
        kept = rows[rows["tick"] % every == 0]
        trace.append(_trace(kept))

    period = mission.config.control.period
    while mission.outcome is None and mission.time < end - 0.5 * period:
        mission.advance_unrecorded(math.ceil((end - mission.time) / period), every=every, on_kept=keep)


def _trace(rows: Ticks) -> Trace:
    kept = np.empty(len(rows), TRACE)
    for name in TRACE.names or ():
        kept[name] = rows[name]
    return kept


def _unresolved(mission: Mission) -> Outcome:
    """How a future stands that no verdict has ended."""
    row = mission.flown().row
    found = cage(mission.config, row["hand_pose"], row["target_pose"])
    outcome = outcome_of(mission.monitor, mission.config, float(row["target_twist"][2]), found)
    return outcome.model_copy(update={"duration": mission.time - float(mission.monitor["begun_at"])})


def _measures(outcome: Outcome, mission: Mission, situation: Situation) -> dict[str, Any]:
    measured = measures_of(outcome, mission.monitor, mission.config)
    closed = outcome.closed_at if outcome.caged else None
    measured["outcome"] = outcome.outcome.value
    return {**measured, "time_to_cage": None if closed is None else closed - situation.time}
