"""What can be wrong with an emulated robot on demand, and how its messages leave it then."""

from __future__ import annotations

import heapq
import itertools
import random
import threading
import time
from collections.abc import Callable
from typing import Annotated, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from server.link.contract import PREFIX, Channel

Joint = Literal["left_joint_1", "left_joint_2", "left_joint_3", "right_joint_1", "right_joint_2", "right_joint_3"]
Sensor = Literal["joints", "left_wrist", "right_wrist", "base", "target"]

Message = Literal[
    "joint_states",
    "left_wrist/wrench",
    "right_wrist/wrench",
    "base/pose",
    "base/twist",
    "target/pose",
    "target/twist",
    "robot/mode",
    "robot/acknowledgement",
    "robot/heartbeat",
]
"""What a robot sends, by its key without the prefix."""

MOST_WAITING = 10_000
"""Delayed messages that are kept; what comes beyond them is lost."""


def _no_flag(value: object) -> object:
    if isinstance(value, bool):
        raise ValueError("it is a number, not true or false")
    return value


Amount = Annotated[float, BeforeValidator(_no_flag)]
"""A number, also as the command line gives it: as a text."""


class Faults(BaseModel):
    """In force until changed."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    delay: Amount = Field(0.0, ge=0, le=10, allow_inf_nan=False, description="Of everything the robot sends [s]")
    jitter: Amount = Field(0.0, ge=0, le=10, allow_inf_nan=False, description="Uniform from 0 to this, beside it [s]")
    loss: Amount = Field(0.0, ge=0, le=1, allow_inf_nan=False, description="Part of what the robot sends that is lost")
    sensor_freeze: Sensor | None = Field(None, description="A sensor that repeats its last reading with new stamps")
    joint_stuck: Joint | None = Field(None, description="A joint that does not move")
    mute: Message | None = Field(None, description="A message that is sent no more, by its key without the prefix")


class Outbox:
    """Sends messages when they are due, in a thread of its own; with no delay at once, in the caller's."""

    def __init__(self, publish: Callable[[Channel, bytes], None], seed: int) -> None:
        self.faults = Faults()
        self._publish = publish
        self._random = random.Random(seed)
        self._waiting: list[tuple[float, int, Channel, bytes]] = []
        self._order = itertools.count()
        self._change = threading.Condition()
        self._open = True
        self._thread = threading.Thread(target=self._send, name="becalm-outbox", daemon=True)
        self._thread.start()

    def send(self, channel: Channel, payload: bytes, delay: float = 0.0) -> None:
        """Send a message after this delay [s] and what the faults add to it, or lose it."""
        faults = self.faults
        if faults.mute is not None and channel.key == f"{PREFIX}/{faults.mute}":
            return
        if faults.loss and self._random.random() < faults.loss:
            return
        delay += faults.delay + (self._random.uniform(0.0, faults.jitter) if faults.jitter else 0.0)
        if delay <= 0.0:
            self._publish(channel, payload)
            return
        with self._change:
            if len(self._waiting) < MOST_WAITING:
                heapq.heappush(self._waiting, (time.monotonic() + delay, next(self._order), channel, payload))
                self._change.notify()

    def close(self) -> None:
        """Forget what waits, and end the thread."""
        with self._change:
            self._open = False
            self._change.notify()
        self._thread.join()

    def _send(self) -> None:
        while True:
            with self._change:
                while self._open and (not self._waiting or self._waiting[0][0] > time.monotonic()):
                    due = self._waiting[0][0] - time.monotonic() if self._waiting else None
                    self._change.wait(None if due is None else max(due, 0.0))
                if not self._open:
                    return
                _, _, channel, payload = heapq.heappop(self._waiting)
            self._publish(channel, payload)
