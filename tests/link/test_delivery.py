"""What arrives when the machine holds up the thread that sends: zenoh's own, while whoever publishes goes on."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from server.link import contract
from server.link.session import LinkSession, Transport

from .ends import free_endpoint, until

PERIOD = 1 / contract.CONTROL_RATE
HELD_UP = 12
"""Control periods for which the sending threads get next to no processor."""
AFTER = 4
HOG = f"""
import os, sys, time
os.sched_setaffinity(0, {{int(sys.argv[1])}})
os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
end = time.monotonic() + {HELD_UP * PERIOD}
print(flush=True)
while time.monotonic() < end:
    pass
"""
"""Keeps the processor of that number for that long, before whatever is not real time."""


def _may_hold_up() -> bool:
    allowed = subprocess.run(
        [sys.executable, "-c", "import os; os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))"],
        stderr=subprocess.DEVNULL,
        check=False,
    )
    return allowed.returncode == 0 and len(os.sched_getaffinity(0)) > 1


@contextlib.contextmanager
def _held_up_sending() -> Iterator[None]:
    """zenoh's sending threads of this process are on a processor that somebody keeps to himself; this one is not."""
    mine, *_, theirs = sorted(os.sched_getaffinity(0))
    senders = [int(each.parent.name) for each in Path("/proc/self/task").glob("*/comm") if "tx-" in each.read_text()]
    assert senders
    before = os.sched_getaffinity(0)
    for thread, cpu in [(0, mine), *((thread, theirs) for thread in senders)]:
        os.sched_setaffinity(thread, {cpu})
    command = [sys.executable, "-c", HOG, str(theirs)]
    try:
        with subprocess.Popen(command, stdout=subprocess.PIPE) as hog:
            assert hog.stdout is not None
            hog.stdout.readline()
            yield
    finally:
        for thread in (0, *senders):
            os.sched_setaffinity(thread, before)


@pytest.mark.skipif(not _may_hold_up(), reason="needs two processors and the right to real-time scheduling")
def _note(numbers: list[int], payload: bytes) -> None:
    numbers.append(int(payload))


@pytest.mark.parametrize(
    "period", [(*contract.WRENCHES, contract.JOINT_STATES), (contract.JOINT_COMMAND, contract.HEARTBEAT)]
)
def test_nothing_is_lost_when_the_sending_thread_is_held_up(period):
    endpoint = free_endpoint()
    receiver, sender = LinkSession(Transport(listen=(endpoint,))), LinkSession(Transport(connect=(endpoint,)))
    came: dict[str, list[int]] = {channel.key: [] for channel in period}
    for channel in period:
        receiver.subscribe(channel, partial(_note, came[channel.key]))

    def heard() -> bool:
        for channel in period:
            sender.publish(channel, b"-1")
        return all(came.values())

    until(heard, "the receiver is known to the sender")
    with _held_up_sending():
        for number in range(HELD_UP + AFTER):
            for channel in period:
                sender.publish(channel, str(number).encode())
            time.sleep(PERIOD)  # paces them as a control period does
    last = HELD_UP + AFTER - 1
    until(lambda: all(numbers[-1] == last for numbers in came.values()), "what was sent last has come")
    sender.close()
    receiver.close()
    for key, numbers in came.items():
        assert [number for number in numbers if number >= 0] == list(range(last + 1)), key
