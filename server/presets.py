"""Parameters that somebody has kept by name, to be flown again."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from server.files import read_document, replace_file
from server.problems import PresetNotFound
from sim.capture.snapshot import Published
from sim.config import MissionConfig
from sim.configurations import named_configuration, revised

NAME = r"[^\W_][\w .+-]{0,39}"
"""Letters, digits, spaces and a few signs; begins with a letter or digit."""


class Preset(Published):
    """How a named configuration was changed, by whom, and when."""

    name: str = Field(pattern=f"^{NAME}$", examples=["soft hands"])
    configuration: str = Field(description="The named configuration that it changes", examples=["published_figures"])
    changes: dict[str, Any] = Field(
        description="Nested, SI; only what differs", examples=[{"control": {"impedance": {"damping": 3.0}}}]
    )
    who: str = Field(description="Who kept it last")
    at: str = Field(description="When, ISO 8601 in UTC")

    def config(self) -> MissionConfig:
        """The whole of it.

        Raises:
            ConfigError: it names what there is not, or what cannot be.

        """
        return revised(named_configuration(self.configuration), self.changes)


class _PresetFile(BaseModel):
    model_config = ConfigDict(extra="forbid")

    version: int = 1
    presets: tuple[Preset, ...] = ()


class PresetStore:
    """The presets of one data folder, in one file that is replaced as a whole; from any thread."""

    def __init__(self, folder: Path) -> None:
        """Read nothing yet."""
        self._path = folder / "presets.json"
        self._lock = threading.Lock()

    def presets(self) -> tuple[Preset, ...]:
        """All of them, by name.

        Raises:
            StoredUnreadable: their file cannot be read.

        """
        try:
            return read_document(self._path, _PresetFile).presets
        except FileNotFoundError:
            return ()

    def keep(self, preset: Preset) -> None:
        """Keep a preset, in place of one of that name.

        Raises:
            ConfigError: it cannot be flown; nothing is kept then.
            StoredUnreadable: the file cannot be read, and is left for whoever can mend it.

        """
        preset.config()
        with self._lock:
            others = (other for other in self.presets() if other.name != preset.name)
            self._write(sorted((*others, preset), key=lambda each: each.name.casefold()))

    def remove(self, name: str) -> None:
        """Keep that one no longer.

        Raises:
            PresetNotFound: there is none of that name.

        """
        with self._lock:
            present = self.presets()
            kept = [preset for preset in present if preset.name != name]
            if len(kept) == len(present):
                known = ", ".join(preset.name for preset in present) or "none"
                raise PresetNotFound(f"name = {name!r}: there is no such preset; known: {known}")
            self._write(kept)

    def _write(self, presets: list[Preset]) -> None:
        replace_file(self._path, _PresetFile(presets=tuple(presets)).model_dump_json(indent=1).encode())
