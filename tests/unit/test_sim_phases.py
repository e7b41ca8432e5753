"""The phase machine: every command in every phase, with the reason where it is refused."""

from __future__ import annotations

import pytest

from sim.control.phases import Command, Phase, Sequence, allowed_commands, next_phase
from sim.errors import MissionRefused

IDLE, DETUMBLING, CAGING, HOLDING, RELEASED, STOPPED, FAULTED = Phase

TABLE = {
    (IDLE, Command.CAPTURE): (DETUMBLING, Sequence.CAPTURE),
    (IDLE, Command.DETUMBLE): (DETUMBLING, Sequence.DETUMBLE_ONLY),
    (IDLE, Command.CAGE): (CAGING, Sequence.CAGE_ONLY),
    (IDLE, Command.DIRECT_CAGE): (CAGING, Sequence.DIRECT_CAGE),
    (DETUMBLING, Command.CAGE): (CAGING, Sequence.CAGE_ONLY),
    (DETUMBLING, Command.HOLD): (HOLDING, Sequence.NONE),
    (CAGING, Command.HOLD): (HOLDING, Sequence.NONE),
    (HOLDING, Command.CAPTURE): (DETUMBLING, Sequence.CAPTURE),
    (HOLDING, Command.DETUMBLE): (DETUMBLING, Sequence.DETUMBLE_ONLY),
    (HOLDING, Command.CAGE): (CAGING, Sequence.CAGE_ONLY),
    (HOLDING, Command.RELEASE): (RELEASED, Sequence.NONE),
    (RELEASED, Command.CAPTURE): (DETUMBLING, Sequence.CAPTURE),
    (RELEASED, Command.DETUMBLE): (DETUMBLING, Sequence.DETUMBLE_ONLY),
    (RELEASED, Command.CAGE): (CAGING, Sequence.CAGE_ONLY),
    (RELEASED, Command.HOLD): (HOLDING, Sequence.NONE),
}
"""What is granted; STOP aside, all else is refused."""


@pytest.mark.parametrize("command", list(Command))
@pytest.mark.parametrize("phase", list(Phase))
def test_every_command_in_every_phase(phase, command):
    if command is Command.STOP:
        assert next_phase(phase, command) == (FAULTED if phase is FAULTED else STOPPED, Sequence.NONE)
    elif (phase, command) in TABLE:
        assert next_phase(phase, command) == TABLE[phase, command]
    else:
        with pytest.raises(MissionRefused, match=f"{command.value} is refused in phase {phase.label}: ") as refusal:
            next_phase(phase, command)
        assert refusal.value.tip


@pytest.mark.parametrize("phase", list(Phase))
def test_allowed_commands_are_those_that_are_granted(phase):
    reasons = allowed_commands(phase)
    assert set(reasons) == set(Command)
    for command, reason in reasons.items():
        assert (reason is None) == (command is Command.STOP or (phase, command) in TABLE)


@pytest.mark.parametrize("phase", [STOPPED, FAULTED])
def test_only_a_reset_leads_out_of_stop_and_fault(phase):
    refused = [reason for reason in allowed_commands(phase).values() if reason is not None]
    assert len(refused) == len(Command) - 1
    assert all("reset" in reason for reason in refused)


def test_labels_are_those_of_rest_and_screens():
    assert [phase.label for phase in Phase] == [
        "idle", "detumbling", "caging", "holding", "released", "stopped", "faulted",
    ]  # fmt: skip
