"""`becalm run`: one headless capture, kept in the library like every other run."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple, get_args

import click

from server.library.changes import display_name
from server.library.export import LogFormat, exported
from server.library.record import RunRecord
from server.library.runs import RunStore, new_record
from server.library.scripted import fly
from server.process.realtime import shorten_switch_interval
from sim.config import MissionConfig
from sim.errors import ConfigError, PlantError
from sim.files import replacing

PROGRESS_STEP = 5.0
"""Mission time between two lines of progress where the terminal cannot rewrite one [s]."""


class LogFile(NamedTuple):
    """Where the ticks go besides the library."""

    path: Path
    log_format: LogFormat


def log_file(path: Path) -> LogFile:
    """The log of that name, in the format of its suffix.

    Raises:
        ConfigError: another suffix, or a folder that does not exist.

    """
    suffix = path.suffix.removeprefix(".")
    for log_format in get_args(LogFormat):
        if suffix == log_format:
            if not path.parent.is_dir():
                raise ConfigError(f"--log {path}: the folder {path.parent} does not exist")
            return LogFile(path, log_format)
    raise ConfigError(f"--log {path}: the format {suffix!r} is unknown; there are .csv, .parquet and .mcap")


def run(store: RunStore, configuration: str, config: MissionConfig, *, direct: bool, log: LogFile | None) -> RunRecord:
    """Fly a capture and keep it; progress goes to standard error.

    Raises:
        PlantError: the simulation failed; what was flown is in the library.

    """
    shorten_switch_interval()
    click.echo("Preparing the simulation (the first time compiles for about half a minute)", err=True)
    record = new_record("scripted", display_name(configuration, config), config, direct=direct)
    store.create(record)
    record = fly(store, record, _progress())
    if sys.stderr.isatty():
        click.echo("", err=True)
    if log is not None:
        _write_log(store, record, log)
    if record.outcome is None:
        raise PlantError(f"run {record.id} {record.status}: {record.note}", tip="its ticks are in the library of runs")
    return record


def _progress() -> Callable[[float], None]:
    if sys.stderr.isatty():
        return lambda time: click.echo(f"\rFlying: {time:6.1f} s", err=True, nl=False)
    shown = 0.0

    def show(time: float) -> None:
        nonlocal shown
        if time >= shown + PROGRESS_STEP:
            shown = time
            click.echo(f"Flying: {time:6.1f} s", err=True)

    return show


def _write_log(store: RunStore, record: RunRecord, log: LogFile) -> None:
    """Write beside the file first, so that there is never half a log under its name."""
    with replacing(log.path) as draft, draft.open("xb") as file:
        for piece in exported(store.read(record.id), log.log_format):
            file.write(piece)
    click.echo(f"Wrote {log.path}", err=True)
