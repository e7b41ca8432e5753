"""What an emulated robot sends while something is wrong with it."""

from __future__ import annotations

from typing import get_args

from server.link import contract
from server.link.contract import Sender
from server.link.faults import Faults, Message, Outbox

FROM_ROBOT = [channel for channel in contract.CHANNELS if channel.sender is Sender.ROBOT]


def test_every_message_of_the_robot_can_be_muted_and_no_other():
    assert [f"{contract.PREFIX}/{key}" for key in get_args(Message)] == [channel.key for channel in FROM_ROBOT]


def test_a_muted_message_is_not_sent_and_all_others_are():
    sent = []
    outbox = Outbox(lambda channel, _: sent.append(channel), seed=0)
    outbox.faults = Faults(mute="robot/mode")
    for channel in FROM_ROBOT:
        outbox.send(channel, b"")
    outbox.close()
    assert sent == [channel for channel in FROM_ROBOT if channel is not contract.MODE]
