"""A foreign log becomes a run of the library."""

from __future__ import annotations

from pathlib import Path

from pydantic import Field

from server.imports.conversion import converted
from server.imports.mapping import log_map
from server.instants import wall_clock
from server.library.changes import display_name
from server.library.record import LoggedEvent
from server.library.runs import RunStore, new_record
from sim.snapshot import FrozenMessage

CHUNK = 5_000
"""Ticks that are written at once."""


class Imported(FrozenMessage):
    """A log that has become a run."""

    run: str = Field(description="Identifier of the run")
    file: str
    ticks: int
    duration: float = Field(description="[s]")
    notices: list[str] = Field(description="What was found wrong: gaps, clock steps, values that are not numbers")


def imported(store: RunStore, path: Path, map_text: str, name: str) -> Imported:
    """Import a log.

    Args:
        store: that the run stands in from then on.
        path: of the file.
        map_text: TOML that says what is what.
        name: of the file, as whoever asks knows it.

    Raises:
        ConfigError: it cannot be imported; nothing is left of it, and the message names what to correct.

    """
    given = log_map(map_text)
    log = converted(path, given)
    told = f"imported from {name}" + "".join(f"; {notice}" for notice in log.notices)
    record = new_record("imported", display_name(given.configuration, log.config), log.config, note=told)
    writer = store.write(record.model_copy(update={"status": "running"}))
    try:
        for start in range(0, len(log.ticks), CHUNK):
            writer.append(log.ticks[start : start + CHUNK])
        for notice in log.notices:
            writer.log(_event(notice))
        writer.close(status="finished")
    except BaseException:
        writer.abandon()
        store.discard(record.id)
        raise
    return Imported(
        run=record.id, file=name, ticks=len(log.ticks), duration=writer.record.duration, notices=log.notices
    )


def _event(notice: str) -> LoggedEvent:
    return LoggedEvent(time=0.0, tick=0, kind="import", severity="warning", message=notice, at=wall_clock())
