"""Phases of a mission, the commands that are allowed in each, and the answers.

`next_phase` is pure: it decides requests only. What follows from time and measurement (touch, spin under its
threshold, plan finished, verdict) is decided in the tick, by the method (`sim.method.method`).
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import IntEnum, StrEnum
from functools import cache
from types import MappingProxyType

from sim.compiled import compiled
from sim.errors import MissionRefused


class Phase(IntEnum):
    """What the mission is doing."""

    IDLE = 0
    DETUMBLING = 1
    CAGING = 2
    HOLDING = 3
    RELEASED = 4
    STOPPED = 5
    FAULTED = 6

    @property
    def label(self) -> str:
        """The name that REST, logs and screens use."""
        return self.name.lower()


AT_REST = 0
"""The activity of every method in which joints are held and nothing is under way."""


class Verdict(IntEnum):
    """Why a capture is over."""

    NONE = 0
    EJECTION = 1
    BASE_COLLISION = 2
    TIME_LIMIT = 3
    LOCKED = 4


class Command(StrEnum):
    """What an operator may ask of the mission."""

    CAPTURE = "capture"
    DETUMBLE = "detumble"
    CAGE = "cage"
    DIRECT_CAGE = "direct_cage"
    HOLD = "hold"
    RELEASE = "release"
    STOP = "stop"


class Sequence(IntEnum):
    """How far the phases follow one another by themselves."""

    NONE = 0
    CAPTURE = 1
    DETUMBLE_ONLY = 2
    CAGE_ONLY = 3
    DIRECT_CAGE = 4


_ACTIVE = (Phase.DETUMBLING, Phase.CAGING)
_STARTABLE = (Phase.IDLE, Phase.HOLDING, Phase.RELEASED)

_TRANSITIONS: dict[Command, tuple[tuple[Phase, ...], Phase, Sequence]] = {
    Command.CAPTURE: (_STARTABLE, Phase.DETUMBLING, Sequence.CAPTURE),
    Command.DETUMBLE: (_STARTABLE, Phase.DETUMBLING, Sequence.DETUMBLE_ONLY),
    Command.CAGE: ((*_STARTABLE, Phase.DETUMBLING), Phase.CAGING, Sequence.CAGE_ONLY),
    Command.DIRECT_CAGE: ((Phase.IDLE,), Phase.CAGING, Sequence.DIRECT_CAGE),
    Command.HOLD: ((*_ACTIVE, Phase.RELEASED), Phase.HOLDING, Sequence.NONE),
    Command.RELEASE: ((Phase.HOLDING,), Phase.RELEASED, Sequence.NONE),
}

_ADVICE = {
    Phase.IDLE: "nothing is under way yet; capture, detumble, cage or direct_cage starts",
    Phase.DETUMBLING: "detumbling is under way; hold it first",
    Phase.CAGING: "caging is under way; hold it first",
    Phase.HOLDING: "the arms are held; capture, detumble, cage or release may follow",
    Phase.RELEASED: "the hands are open; capture, detumble or cage may follow, or hold",
    Phase.STOPPED: "the mission was stopped; reset it first",
    Phase.FAULTED: "the plant failed; reset the mission first",
}


ALL_COMMANDS = frozenset(Command)


def next_phase(phase: Phase, command: Command, commands: frozenset[Command] = ALL_COMMANDS) -> tuple[Phase, Sequence]:
    """The phase and sequence that a request leads to, of a method that has these commands.

    STOP is always granted; it leaves a fault as it is.

    Raises:
        MissionRefused: the phase does not allow the request, or the method has no such command; the message says why.

    """
    if command is Command.STOP:
        return (Phase.FAULTED if phase is Phase.FAULTED else Phase.STOPPED), Sequence.NONE
    if command not in commands:
        raise MissionRefused(
            f"{command.value} is refused: the configured method has no such command",
            tip=f"it has {', '.join(sorted(each.value for each in commands))}",
        )
    allowed, following, sequence = _TRANSITIONS[command]
    if phase not in allowed:
        raise MissionRefused(f"{command.value} is refused in phase {phase.label}: {_ADVICE[phase]}", tip=_ADVICE[phase])
    return following, sequence


@cache
def allowed_commands(phase: Phase, commands: frozenset[Command] = ALL_COMMANDS) -> Mapping[Command, str | None]:
    """Every command with None where phase and method allow it, else the reason why not."""
    reasons: dict[Command, str | None] = {}
    for command in Command:
        try:
            next_phase(phase, command, commands)
            reasons[command] = None
        except MissionRefused as refusal:
            reasons[command] = str(refusal)
    return MappingProxyType(reasons)


@compiled
def phase_after(verdict: int) -> int:
    """The phase that a verdict leads to: the arms hold, or the mission stops where the target strikes the base."""
    return Phase.STOPPED if verdict == Verdict.BASE_COLLISION else Phase.HOLDING
