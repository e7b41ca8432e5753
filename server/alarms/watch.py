"""Looks at the live mission ten times a second, holds it against the limits, and tells everyone what has changed."""

from __future__ import annotations

import asyncio
import json
import logging
from collections.abc import Iterator

import numpy as np
from pydantic import TypeAdapter

from server.alarms.board import Alarm, AlarmBoard, AlarmRecord, Moment, Reading
from server.alarms.limits import SIGNALS, LimitStore, Side, Signal
from server.errors import DataFolderLost
from server.instants import wall_clock
from server.library.journal import Journal
from server.library.plotted import Values
from server.library.record import TickArray
from server.mission.feed import Feed, Latest
from server.mission.service_problems import CLOCK_LATE
from server.published import Problem

PERIOD = 0.1
"""Between two looks [s]; what happens between them is not lost: every tick is looked at."""

TELLING_PERIOD = 0.5
"""Between two times that everyone is told of values that have moved [s]; of an alarm at once."""

_ALARMS = TypeAdapter(tuple[Alarm, ...])

log = logging.getLogger(__name__)


class AlarmWatch:
    """In the event loop: it looks, and takes the mission nothing but a list of what it has flown."""

    def __init__(self, feed: Feed, limits: LimitStore, journal: Journal[AlarmRecord]) -> None:
        """A watch over what is published there."""
        self.board, self.limits, self.journal = AlarmBoard(), limits, journal
        self._feed = feed
        self._told: tuple[Alarm, ...] = ()
        self._tell_at = 0.0

    @property
    def now(self) -> Moment:
        """The present moment of the mission."""
        latest = self._feed.latest
        if latest is None:
            return Moment(wall_clock(), "", 0.0)
        return Moment(wall_clock(), latest.run_id, float(latest.row["time"]))

    async def keep_looking(self) -> None:
        """Look for ever."""
        while True:
            await asyncio.sleep(PERIOD)
            try:
                self.look()
                await self.tell()
            except Exception:
                # A watch that has fallen asleep must not look as if all were well.
                log.exception("the watch over limits failed; it goes on")
                await asyncio.sleep(1.0)

    def look(self) -> None:
        """Look at what has been flown since the last look."""
        latest = self._feed.latest
        ticks = self._feed.take_recent()
        if latest is not None:
            self.board.see(list(self._readings(latest, ticks)), _problems(latest), self.now)

    async def tell(self) -> None:
        """Keep what has happened, and tell everyone what has changed."""
        records = self.board.take_records()
        if records:
            try:
                await asyncio.to_thread(self.journal.keep, *records)
            except (OSError, DataFolderLost) as error:
                log.warning("what happened to alarms is not on disk: %s", error)
        alarms = self.board.alarms
        clock = asyncio.get_running_loop().time()
        if records or (alarms != self._told and clock >= self._tell_at):
            self._told, self._tell_at = alarms, clock + TELLING_PERIOD
            self._feed.publish_alarms(alarms_text(alarms))

    def _readings(self, latest: Latest, ticks: TickArray | None) -> Iterator[Reading]:
        robot = latest.robot
        others = {"lateness": latest.plant.lateness, "robot_age": None if robot is None else robot.oldest}
        for signal in SIGNALS.values():
            of_ticks = None if signal.of is None or ticks is None else _worst(signal.of(ticks), signal.side)
            value = others[signal.name] if signal.of is None else of_ticks
            if value is not None:
                yield self._reading(signal, value)

    def _reading(self, signal: Signal, value: float) -> Reading:
        key = f"limit:{signal.name}"
        limits = self.limits.limits(signal.name)
        level = limits.level(value, signal.side, self.board.level(key))
        bound = limits.bound(level)
        return Reading(key, signal.name, signal.title, signal.unit, signal.side, level, value, bound)


def _problems(latest: Latest) -> tuple[Problem, ...]:
    """Those that are alarms: a simulation that runs late loses nothing but time, and has limits of its own for that."""
    if latest.plant.kind != "simulation":
        return latest.problems
    return tuple(problem for problem in latest.problems if problem.title != CLOCK_LATE)


def _worst(values: Values, side: Side) -> float | None:
    """The value that lies farthest out; None where nothing was measured."""
    finite = values[np.isfinite(values)]
    if not len(finite):
        return None
    return float(finite.max() if side == "above" else finite.min())


def alarms_text(alarms: tuple[Alarm, ...]) -> str:
    """The list as a message of telemetry."""
    return json.dumps({"type": "alarms"})[:-1] + ',"alarms":' + _ALARMS.dump_json(alarms).decode() + "}"
