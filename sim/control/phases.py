"""Phases of a mission, what an operator may ask in each, and the answers.

`next_phase` is pure: it decides requests only. What follows from time and measurement (touch, spin
under its threshold, plan finished) is decided in the tick, `sim.control.controller`.
"""

from __future__ import annotations

from enum import IntEnum, StrEnum

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


class Activity(IntEnum):
    """What the hands are doing within a phase."""

    NONE = 0
    APPROACHING = 1
    """A detumbling path is followed."""
    WAITING = 2
    """The path is done, joints are held, and the target comes to the hand."""
    ABSORBING = 3
    """The touched hand yields under admittance."""
    RETREATING = 4
    """Joints are held while the target leaves the hand."""
    SETTLING = 5
    """The spin is under its threshold; joints are held until the caging plan is made."""
    CLOSING = 6
    """A caging path is followed with both hands."""
    OPENING = 7
    """Both hands draw back from the target."""

    @property
    def label(self) -> str:
        """The name that REST, logs and screens use."""
        return self.name.lower()


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


def next_phase(phase: Phase, command: Command) -> tuple[Phase, Sequence]:
    """The phase and sequence that a request leads to.

    STOP is always granted; it leaves a fault as it is.

    Raises:
        MissionRefused: the phase does not allow the request; the message says why.

    """
    if command is Command.STOP:
        return (Phase.FAULTED if phase is Phase.FAULTED else Phase.STOPPED), Sequence.NONE
    allowed, following, sequence = _TRANSITIONS[command]
    if phase not in allowed:
        raise MissionRefused(f"{command.value} is refused in phase {phase.label}: {_ADVICE[phase]}", tip=_ADVICE[phase])
    return following, sequence


def allowed_commands(phase: Phase) -> dict[Command, str | None]:
    """Every command with None where the phase allows it, else the reason why not."""
    reasons: dict[Command, str | None] = {}
    for command in Command:
        try:
            next_phase(phase, command)
            reasons[command] = None
        except MissionRefused as refusal:
            reasons[command] = str(refusal)
    return reasons
