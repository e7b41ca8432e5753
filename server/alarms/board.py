"""The list of alarms: what is beyond its limits, or was and has not been acknowledged.

An alarm is raised where a signal goes beyond a limit, and again where it goes beyond the next one. It leaves the list
once it is over and has been acknowledged; one of level *watch* needs no acknowledgement. Whoever shelves one takes its
voice for a while: it stays in the list. (ISA 18.2 has these states.)
"""

from __future__ import annotations

import threading
from collections.abc import Iterable
from typing import Any, Literal, NamedTuple

from pydantic import Field

from server.alarms.limits import Level, LevelName, Side
from server.published import Problem
from sim.errors import MissionRefused
from sim.snapshot import FrozenMessage

Happening = Literal["raised", "over", "acknowledged", "shelved", "unshelved"]


class Moment(NamedTuple):
    """When something happens."""

    at: str
    """Wall clock, ISO 8601 in UTC."""
    run_id: str
    time: float
    """Mission time [s]."""


class Alarm(FrozenMessage):
    """Something that is not as it should be, or was."""

    key: str = Field(description="Names it while it is in the list")
    signal: str | None = Field(description="That is beyond a limit; null of a problem")
    title: str
    message: str = Field(description="Of a problem; else empty")
    tip: str = Field(description="Likewise")
    level: LevelName = Field(description="The highest since it was raised, or acknowledged")
    active: bool = Field(description="Whether it is so now; an alarm that is over waits to be acknowledged")
    value: float | None = Field(description="The last, or the farthest beyond the limit since, SI; null of a problem")
    worst: float | None = Field(description="Farthest beyond the limit since it was raised")
    bound: float | None = Field(description="Of its level")
    unit: str = Field(description="SI; empty of a problem")
    side: Side | None = Field(description="Where the limit is gone beyond; null of a problem")
    run_id: str = Field(description="Of the mission in which it was raised")
    since: float = Field(description="Mission time when it was raised [s]")
    raised_at: str = Field(description="The same on the wall clock, ISO 8601 in UTC")
    acknowledged_by: str | None = Field(description="Who has seen it; null while nobody has")
    acknowledged_at: str | None = Field(description="When, ISO 8601 in UTC")
    shelved_by: str | None = Field(description="Who shelved it; null of one that has its voice")
    shelved_until: str | None = Field(description="ISO 8601 in UTC; it says nothing until then")


class AlarmRecord(FrozenMessage):
    """What happened to an alarm."""

    at: str = Field(description="ISO 8601 in UTC")
    happening: Happening
    key: str
    title: str
    level: LevelName
    value: float | None
    unit: str
    run_id: str
    time: float = Field(description="Mission time [s]")
    who: str | None = Field(description="Of what somebody did; else null")


class Reading(NamedTuple):
    """A signal since the last look."""

    key: str
    signal: str
    title: str
    unit: str
    side: Side
    level: Level
    value: float
    bound: float | None


_PROBLEM_LEVELS: dict[str, LevelName] = {"info": "watch", "warning": "warning", "error": "critical"}
_NAMES: dict[Level, LevelName] = {Level.WATCH: "watch", Level.WARNING: "warning", Level.CRITICAL: "critical"}
_ORDER: dict[LevelName, Level] = {name: level for level, name in _NAMES.items()}


_UNSEEN = {"acknowledged_by": None, "acknowledged_at": None, "shelved_by": None, "shelved_until": None}
"""Of an alarm that is raised."""
_NO_SIGNAL: dict[str, Any] = {
    "signal": None, "value": None, "worst": None, "bound": None, "unit": "", "side": None,
}  # fmt: skip
"""Of an alarm about a problem."""


def _shelf(alarm: Alarm | None) -> dict[str, str | None]:
    """What stays of an alarm that was shelved."""
    return {} if alarm is None else {"shelved_by": alarm.shelved_by, "shelved_until": alarm.shelved_until}


class AlarmBoard:
    """From any thread; time is given."""

    def __init__(self) -> None:
        self._alarms: dict[str, Alarm] = {}
        self._records: list[AlarmRecord] = []
        self._lock = threading.Lock()

    @property
    def alarms(self) -> tuple[Alarm, ...]:
        """Those in the list, the oldest first."""
        with self._lock:
            return tuple(self._alarms.values())

    def level(self, key: str) -> Level:
        """How far that signal was beyond its limits at the last look."""
        with self._lock:
            alarm = self._alarms.get(key)
        return _ORDER[alarm.level] if alarm is not None and alarm.active else Level.NORMAL

    def take_records(self) -> list[AlarmRecord]:
        """What has happened since this was last asked."""
        with self._lock:
            records, self._records = self._records, []
        return records

    def see(self, readings: Iterable[Reading], problems: Iterable[Problem], now: Moment) -> None:
        """Look at all signals and problems of now."""
        with self._lock:
            for reading in readings:
                self._see_reading(reading, now)
            shown = {f"problem:{problem.title}": problem for problem in problems}
            for key, problem in shown.items():
                self._see_problem(key, problem, now)
            for key in [key for key in self._alarms if key.startswith("problem:") and key not in shown]:
                self._end(key, now)
            self._unshelve_old(now)

    def acknowledge(self, key: str | None, who: str, now: Moment) -> None:
        """Somebody has seen that alarm, or all.

        Raises:
            MissionRefused: there is none of that key.

        """
        with self._lock:
            chosen = list(self._alarms.values()) if key is None else [self._find(key)]
            for alarm in chosen:
                if alarm.acknowledged_at is None:
                    seen = alarm.model_copy(update={"acknowledged_by": who, "acknowledged_at": now.at})
                    self._alarms[alarm.key] = seen
                    self._record("acknowledged", seen, now, who)
                if not alarm.active:
                    del self._alarms[alarm.key]

    def shelve(self, key: str, until: str, who: str, now: Moment) -> None:
        """That alarm says nothing until then.

        Raises:
            MissionRefused: there is none of that key.

        """
        with self._lock:
            shelved = self._find(key).model_copy(update={"shelved_by": who, "shelved_until": until})
            self._alarms[key] = shelved
            self._record("shelved", shelved, now, who)

    def unshelve(self, key: str, who: str, now: Moment) -> None:
        """That alarm has its voice again.

        Raises:
            MissionRefused: there is none of that key.

        """
        with self._lock:
            self._take_off_the_shelf(self._find(key), now, who)

    def _find(self, key: str) -> Alarm:
        alarm = self._alarms.get(key)
        if alarm is None:
            raise MissionRefused(f"alarm = {key[:80]!r}: it is not in the list any more")
        return alarm

    def _see_reading(self, reading: Reading, now: Moment) -> None:
        alarm = self._alarms.get(reading.key)
        if reading.level is Level.NORMAL:
            self._end(reading.key, now)
        elif alarm is None or not alarm.active or _ORDER[alarm.level] < reading.level:
            self._raise(_of_reading(reading, now), now)
        else:
            farther = max if reading.side == "above" else min
            worst = reading.value if alarm.worst is None else farther(alarm.worst, reading.value)
            # An acknowledged alarm follows its signal down, so that it can be raised again.
            name = _NAMES[reading.level] if alarm.acknowledged_at is not None else alarm.level
            bound = reading.bound if name != alarm.level else alarm.bound
            update = {"value": reading.value, "worst": worst, "level": name, "bound": bound}
            self._alarms[reading.key] = alarm.model_copy(update=update)

    def _see_problem(self, key: str, problem: Problem, now: Moment) -> None:
        alarm = self._alarms.get(key)
        level = _PROBLEM_LEVELS[problem.severity]
        if alarm is None or not alarm.active or _ORDER[alarm.level] < _ORDER[level]:
            self._raise(_of_problem(key, problem, level, now), now)
        elif (alarm.message, alarm.tip) != (problem.message, problem.tip):
            self._alarms[key] = alarm.model_copy(update={"message": problem.message, "tip": problem.tip})

    def _raise(self, alarm: Alarm, now: Moment) -> None:
        raised = alarm.model_copy(update=_shelf(self._alarms.pop(alarm.key, None)))
        self._alarms[alarm.key] = raised
        self._record("raised", raised, now, None)

    def _end(self, key: str, now: Moment) -> None:
        alarm = self._alarms.get(key)
        if alarm is None or not alarm.active:
            return
        over = alarm.model_copy(update={"active": False})
        self._record("over", over, now, None)
        if over.level == "watch" or over.acknowledged_at is not None:
            del self._alarms[key]
        else:
            self._alarms[key] = over

    def _unshelve_old(self, now: Moment) -> None:
        for alarm in list(self._alarms.values()):
            if alarm.shelved_until is not None and alarm.shelved_until <= now.at:
                self._take_off_the_shelf(alarm, now, None)

    def _take_off_the_shelf(self, alarm: Alarm, now: Moment, who: str | None) -> None:
        heard = alarm.model_copy(update={"shelved_by": None, "shelved_until": None})
        self._alarms[alarm.key] = heard
        self._record("unshelved", heard, now, who)

    def _record(self, happening: Happening, alarm: Alarm, now: Moment, who: str | None) -> None:
        self._records.append(
            AlarmRecord(
                at=now.at,
                happening=happening,
                key=alarm.key,
                title=alarm.title,
                level=alarm.level,
                value=alarm.worst,
                unit=alarm.unit,
                run_id=now.run_id,
                time=now.time,
                who=who,
            )
        )


def _of_reading(reading: Reading, now: Moment) -> Alarm:
    return Alarm(
        key=reading.key,
        signal=reading.signal,
        title=reading.title,
        message="",
        tip="",
        level=_NAMES[reading.level],
        value=reading.value,
        worst=reading.value,
        bound=reading.bound,
        unit=reading.unit,
        side=reading.side,
        since=now.time,
        **_raised(now),
    )


def _of_problem(key: str, problem: Problem, level: LevelName, now: Moment) -> Alarm:
    return Alarm(
        key=key,
        title=problem.title,
        message=problem.message,
        tip=problem.tip,
        level=level,
        since=problem.since,
        **_NO_SIGNAL,
        **_raised(now),
    )


def _raised(now: Moment) -> dict[str, Any]:
    """What an alarm has that is raised now, whatever it is about."""
    return {"active": True, "run_id": now.run_id, "raised_at": now.at, **_UNSEEN}
