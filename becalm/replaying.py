"""`becalm replay`: a run against the current controller and, if it was simulated, flown again from its own log."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import click
import numpy as np

from server.library.reader import RunReader
from server.library.record import TickArray
from sim.capture.mission import prepare
from sim.capture.replay import Difference, controlled, first_difference, rerun
from sim.capture.tick import TICK, column_values
from sim.errors import CaptureError, MissionRefused


def replay(reader: RunReader) -> dict[str, Any]:
    """What `becalm replay --json` prints; `rerun` is null of a robot's run, which cannot be flown again.

    Raises:
        MissionRefused: the run holds no ticks.

    """
    if not reader.tick_count:
        raise MissionRefused(f"run {reader.record.id} holds no ticks", tip="becalm run flies one that does")
    click.echo("Preparing the simulation (the first time compiles for about half a minute)", err=True)
    history = reader.history()
    with suppress(CaptureError):  # that today's code refuses the configuration is what the comparison says
        prepare(history.config)
    end = int(_last(reader)["tick"]) + 1
    return {
        "run_id": reader.record.id,
        "ticks": reader.tick_count,
        "integrity": reader.record.integrity,
        "versions": reader.record.versions,
        "notices": [*reader.record.notices, *reader.log_notices],
        "controller": _compared(reader, controlled(history, reader.chunks())),
        "rerun": None if history.robot else _compared(reader, rerun(history, end)),
    }


def same(report: dict[str, Any]) -> bool:
    """Whether nothing differs; a robot's run is compared by its controller only."""
    return all(report[name]["same"] for name in ("controller", "rerun") if report[name] is not None)


def as_text(report: dict[str, Any]) -> str:
    """What `becalm replay` prints."""
    lines = [f"Run {report['run_id']}, {report['ticks']} ticks", *(f"  {notice}" for notice in report["notices"])]
    for name, title in (("controller", "the current controller in the recorded states"), ("rerun", "flown again")):
        lines.append(f"  {title}: {_in_words(report[name])}")
    return "\n".join(lines)


def _last(reader: RunReader) -> Any:
    last = reader.last_tick()
    assert last is not None, "there are ticks"
    return last[0]


def _in_words(result: dict[str, Any] | None) -> str:
    if result is None:
        return "not possible, a robot was flown"
    if result["same"]:
        return f"the same to the last bit in {result['compared']} ticks"
    if "refused" in result:
        return f"refused: {result['refused']}"
    first = result["first_difference"]
    return (
        f"differs from tick {first['tick']} ({first['time']:.3f} s) on: {first['quantity']} was {first['recorded']!r}, "
        f"is {first['now']!r}"
    )


def _compared(reader: RunReader, now: Iterator[TickArray]) -> dict[str, Any]:
    """Both flights tick by tick in what the log has, with no more than a few chunks in memory."""
    compared, absent = 0, reader.layout().absent
    waiting: TickArray = np.empty(0, TICK)
    try:
        for recorded in reader.chunks():
            while not len(waiting) or waiting["tick"][-1] < recorded["tick"][-1]:
                following = next(now, None)
                if following is None:
                    break
                waiting = np.concatenate([waiting, following]) if len(waiting) else following
            at = np.searchsorted(waiting["tick"], recorded["tick"])
            known = at < len(waiting)
            flown = waiting[at[known]]
            for column in absent:
                column_values(flown, column)[:] = column_values(recorded[known], column)
            difference = first_difference(recorded[known], flown)
            if difference is not None:
                return _differing(compared, difference)
            compared += int(known.sum())
            if not known.all():
                missing = int(recorded["tick"][np.argmin(known)])
                return {
                    "same": False,
                    "compared": compared,
                    "refused": f"the current flight ends before tick {missing}",
                }
            waiting = waiting[at[-1] + 1 :]
    except CaptureError as error:
        return {"same": False, "compared": compared, "refused": str(error)}
    return {"same": True, "compared": compared, "first_difference": None}


def _differing(compared: int, difference: Difference) -> dict[str, Any]:
    return {"same": False, "compared": compared, "first_difference": difference._asdict()}
