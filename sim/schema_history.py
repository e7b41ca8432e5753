"""What was renamed or removed since things were stored under its name: one table for each kind of thing.

A run, study, preset or file describes itself: its values stand under names. This module lists the names that have
changed since. Whoever renames or removes one adds a line, and everything that was stored before is still read.

An old name is never used again for something else: rows, events and files carry no version that would distinguish
the two. `tests/unit/test_sim_schema_history.py` holds that.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from sim.errors import ConfigError

VERSION = "version"
"""The key under which a stored configuration, set of changes or study says which names its parameters have."""


class Change(NamedTuple):
    """A name that stored things may have and the current version has not."""

    old: str
    """Full path; that of a group stands for all that is in it."""
    new: str | None
    """Its current path; None if it was removed."""
    why: str = ""
    """For a removed one: what holds instead, in words."""


def renamed(old: str, new: str) -> Change:
    """The parameter, measure or field, or all of a group, has another name now."""
    return Change(old, new)


def removed(old: str, why: str) -> Change:
    """It was removed; stored values of it are ignored, and whoever reads them learns why."""
    return Change(old, None, why)


PARAMETER_CHANGES: tuple[Change, ...] = (
    renamed("control.impedance", "published.impedance"),
    renamed("control.touch", "published.touch"),
    renamed("control.caging", "published.caging"),
    renamed("sensing", "perception"),
    renamed("co_moving_couple.search.most_searches", "co_moving_couple.search.most_failures"),
)
"""Paths of the configuration, in the order in which they changed: of runs, presets, studies, events and files."""

TICK_CHANGES: tuple[Change, ...] = ()
"""Fields of `TICK` (`sim.capture.tick`): of logs. A removed one stays in the log and in its exports."""

MEASURE_CHANGES: tuple[Change, ...] = ()
"""Columns of a study's table (`sim.study.run`). A removed one stays in the table and in its exports."""

RECORD_CHANGES: tuple[Change, ...] = ()
"""Fields of a run's record, those of its outcome as `outcome.peak_tip_force`. A removed one is ignored."""


def config_version() -> int:
    """Of the parameters' names: 1 at first, one more with each that changed."""
    return 1 + len(PARAMETER_CHANGES)


class Read(NamedTuple):
    """What was stored, under current names."""

    values: dict[str, Any]
    notices: tuple[str, ...]
    """What is ignored of it, and why."""


def change_of(path: str, changes: Sequence[Change]) -> Change | None:
    """What became of the name: its current path, or why it was removed; None for one that never changed."""
    found: Change | None = None
    for change in changes:
        now = path if found is None else found.new
        assert now is not None
        if _lies_in(now, change.old):
            moved = None if change.new is None else change.new + now[len(change.old) :]
            found = Change(path, moved, change.why)
            if moved is None:
                break
    return found


def todays_name(path: str, changes: Sequence[Change]) -> str | None:
    """The current name; None for a removed one."""
    change = change_of(path, changes)
    return path if change is None else change.new


def former_names(name: str, changes: Sequence[Change]) -> tuple[str, ...]:
    """The former names of a current one, the latest first."""
    names = [name]
    for change in reversed(changes):
        if change.new is not None and _lies_in(names[-1], change.new):
            names.append(change.old + names[-1][len(change.new) :])
    return tuple(names[1:])


def under_todays_names(stored: Mapping[str, Any], changes: Sequence[Change]) -> Read:
    """Values by full path, each under its current name; what never changed is kept as it is, also if it is unknown.

    Raises:
        ConfigError: a value stands both under a former name and under the current one.

    """
    values: dict[str, Any] = {}
    notices: list[str] = []
    for path, value in stored.items():
        change = change_of(path, changes)
        now = path if change is None else change.new
        if now is None:
            assert change is not None
            notices.append(f"{path} is ignored: {change.why}")
        elif now != path and now in stored:
            raise ConfigError(f"{path} is the former name of {now}, and both are given", tip=f"keep {now}")
        else:
            values[now] = value
    return Read(values, tuple(notices))


def require_known_version(version: Any) -> None:
    """Refuse what a later version of Becalm has stored.

    Raises:
        ConfigError: the message names both versions.

    """
    if type(version) is not int or version < 1:
        raise ConfigError(f"{VERSION} = {version!r}: it is not a whole number from 1 on")
    if version > config_version():
        raise ConfigError(
            f"{VERSION} = {version}: its parameters are those of a later version of Becalm; "
            f"this one reads up to {config_version()}",
            tip="read it with the version that stored it, or a later one",
        )


def _lies_in(path: str, group: str) -> bool:
    return path == group or path.startswith(group + ".")
