"""A recorded mission at any of its ticks, published as it was then.

A tick holds states and commanded joint rates; touches, plan and judgement follow from all ticks before it. So the
current controller follows the recorded states, once, and sets a mark at the start of every block: from the nearest one
any tick of a block is a few milliseconds away, forwards or backwards.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from sim.capture.events import Ticks
from sim.capture.mission import Mark
from sim.capture.replay import FlightHistory, Follower
from sim.capture.tick import TICK
from sim.config import MissionConfig
from sim.snapshot import Snapshot

BLOCK = 500
"""Ticks from one mark to the next."""

_BLOCKS_KEPT = 8
"""Blocks of ticks that stay in memory; about 0.3 MB each."""

_HALF = 0.5
"""Part of a period by which recorded times may differ from tick times period."""

ReadTicks = Callable[[float, float], Iterator[Ticks]]
"""The recorded ticks from one mission time to another, both included [s]."""


class _BlockStart(NamedTuple):
    """The start of a block."""

    mark: Mark
    interventions: int


class Playback:
    """One recorded mission; belongs to one thread at a time."""

    def __init__(self, history: FlightHistory, read: ReadTicks) -> None:
        """Start before the first tick.

        Raises:
            ConfigError: the target overlaps the robot at the start.

        """
        self._read = read
        self._period = history.config.control.period
        self._follower = Follower(history)
        self._places = [_BlockStart(self._follower.mission.mark(), 0)]
        self._blocks: OrderedDict[int, Ticks] = OrderedDict()
        self._followed = -1

    @property
    def config(self) -> MissionConfig:
        """In force at the tick that was shown last."""
        return self._follower.mission.config

    def at(self, time: float) -> Snapshot:
        """The recorded tick nearest to that mission time [s], or the last before it; the start before the first.

        Raises:
            MissionRefused: the current phases do not allow a command that was granted then.

        """
        tick = max(0, int(time / self._period + _HALF))
        block = tick // BLOCK
        if tick < self._followed or block > self._followed // BLOCK:
            self._go_to(block)
        rows = self._block(block)
        self._follow(rows[(rows["tick"] > self._followed) & (rows["tick"] <= tick)], tick)
        return self._follower.mission.snapshot()

    def _go_to(self, block: int) -> None:
        """Go to the start of a block, through all that have not been passed yet."""
        known = min(block, len(self._places) - 1)
        # Going on from where it stands is as good as from a mark, and spares following a part twice.
        if not known * BLOCK - 1 <= self._followed < block * BLOCK:
            self._return_to(known)
        for number in range(max(0, self._followed + 1) // BLOCK, block):
            rows = self._block(number)
            self._follow(rows[rows["tick"] > self._followed], (number + 1) * BLOCK - 1)
            if number + 1 == len(self._places):
                self._places.append(_BlockStart(self._follower.mission.mark(), self._follower.done))

    def _return_to(self, block: int) -> None:
        place = self._places[block]
        self._follower.mission.go_back(place.mark)
        self._follower.done = place.interventions
        self._followed = block * BLOCK - 1

    def _follow(self, rows: Ticks, until: int) -> None:
        """Follow these rows; nothing was recorded after them until that tick."""
        if len(rows):
            self._follower.follow(rows)
            self._follower.mission.take_events()
        self._followed = max(self._followed, until)

    def _block(self, number: int) -> Ticks:
        rows = self._blocks.get(number)
        if rows is None:
            first, last = number * BLOCK, (number + 1) * BLOCK - 1
            found = list(self._read((first - _HALF) * self._period, (last + _HALF) * self._period))
            rows = self._blocks[number] = np.concatenate(found) if found else np.empty(0, TICK)
            if len(self._blocks) > _BLOCKS_KEPT:
                self._blocks.popitem(last=False)
        self._blocks.move_to_end(number)
        return rows
