"""`becalm import`: a log from elsewhere becomes a run of the library."""

from __future__ import annotations

from pathlib import Path

from server.imports.library import Imported, imported
from server.library.runs import RunStore
from sim.errors import ConfigError


def import_log(data: Path, file: Path, map_file: Path) -> Imported:
    """Import a log into that data folder.

    Raises:
        ConfigError: a file cannot be read, or something in it cannot be right; nothing is left of it then.

    """
    try:
        text = map_file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"--map {map_file} cannot be read: {error}") from None
    if not file.is_file():
        raise ConfigError(f"{file} is no file")
    return imported(RunStore(data / "runs").make_root(), file, text, file.name)


def as_text(done: Imported) -> str:
    """What `becalm import` prints."""
    lines = [f"{done.file}: {done.ticks} ticks, {done.duration:.2f} s, run {done.run}"]
    return "\n".join([*lines, *(f"  {notice}" for notice in done.notices)])
