"""The words beside the numbers: what is happening, and whether the next phase may begin."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sim.capture.events import verdict_in_words
from sim.config import MissionConfig
from sim.control.phases import Phase
from sim.method.method import method_of
from sim.snapshot import Condition, Outcome, Plan, Readiness, Touch

_OF_THE_METHOD = (Phase.DETUMBLING, Phase.CAGING, Phase.RELEASED)


def description(
    row: Any, config: MissionConfig, phase: Phase, plan: Plan | None, touches: Sequence[Touch], outcome: Outcome | None
) -> str:
    """One sentence on what is happening at a tick, one element of `TICK`, in that phase."""
    if outcome is not None and phase in (Phase.HOLDING, Phase.STOPPED):
        return verdict_in_words(outcome) + "."
    if phase in _OF_THE_METHOD:
        return method_of(config).words.motion(row, plan, touches)
    spin, trouble = float(row["target_twist"][2]), method_of(config).words.trouble.get(int(row["trouble"]))
    if phase is Phase.HOLDING and trouble:
        return f"The arms hold: {trouble}."
    return {
        Phase.IDLE: f"The target spins at {spin:.2f} rad/s; the robot waits for a command.",
        Phase.HOLDING: "The arms hold; joint rates are zero.",
        Phase.STOPPED: "Stopped. Joint rates are zero; a reset starts again.",
        Phase.FAULTED: "The plant can no longer be trusted; joint rates are zero.",
    }[phase]


def readiness(row: Any, config: MissionConfig, phase: Phase, outcome: Outcome | None) -> Readiness:
    """Go or no-go for what comes next at a tick, one element of `TICK`, in that phase."""
    if phase in (Phase.STOPPED, Phase.FAULTED):
        why = "the mission was stopped" if phase is Phase.STOPPED else "the mission has a fault"
        return _readiness("reset", f"{why}; only a reset is possible", [])
    if outcome is not None and not outcome.caged:
        return _readiness("reset", f"the capture has ended: {_first_lower(verdict_in_words(outcome))}", [])
    if phase is Phase.HOLDING:
        return _readiness_of_held(outcome)
    following, conditions = method_of(config).words.next_step(row, config, phase)
    return _readiness(following, None, conditions)


def _readiness_of_held(outcome: Outcome | None) -> Readiness:
    if outcome is None:
        unverified = Condition.of("caged", "the arms hold; the cage is not verified", met=False)
        return _readiness("verdict", None, [unverified])
    margin = outcome.cage_margin
    words = "the target is caged" + ("" if margin is None else f" with a margin of {1e3 * margin:.1f} mm")
    caged = Condition(name="caged", met=True, value=margin, bound=0.0, unit="m", words=words)
    return _readiness("release", None, [caged])


def _readiness(following: str, blocked: str | None, conditions: list[Condition]) -> Readiness:
    go = blocked is None and all(condition.met for condition in conditions)
    return Readiness(next=following, go=go, blocked=blocked, conditions=conditions)


def _first_lower(words: str) -> str:
    return words[:1].lower() + words[1:]
