"""Parameters that somebody has kept by name, to be flown again."""

from __future__ import annotations

import json
import threading
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from server.errors import PresetNotFound
from server.files import finding, finite, read_document, replace_file
from server.texts import shortened
from sim.config import MissionConfig
from sim.configurations import named_configuration, revised
from sim.errors import ConfigError
from sim.schema_history import VERSION, config_version
from sim.snapshot import FrozenMessage
from sim.stored import read_parameters

NAME = r"[^\W_][\w .+-]{0,39}"
"""Letters, digits, spaces and a few signs; begins with a letter or digit."""


class Preset(FrozenMessage):
    """How a named configuration was changed, by whom, and when."""

    name: str = Field(pattern=f"^{NAME}$", examples=["soft hands"])
    configuration: str = Field(description="The named configuration that it changes", examples=["published_figures"])
    changes: dict[str, Any] = Field(
        description="Nested, SI; only what differs", examples=[{"published": {"impedance": {"damping": 3.0}}}]
    )
    who: str = Field(description="Who kept it last")
    at: str = Field(description="When, ISO 8601 in UTC")
    version: int = Field(default_factory=config_version, description="Of the parameters' names")
    notices: tuple[str, ...] = Field(
        (), exclude=True, description="What this version ignores of what an earlier one kept, and why"
    )

    def config(self) -> MissionConfig:
        """The whole of it.

        Raises:
            ConfigError: it names what does not exist, or what is invalid.

        """
        return revised(named_configuration(self.configuration), self.changes)


class UnreadablePreset(NamedTuple):
    """A preset of the file that is damaged or of another version."""

    name: str
    """As far as there is one; else its place in the file, in words."""
    reason: str


class _PresetFile(BaseModel):
    """Each preset is read by itself, so that one that cannot be read costs no other."""

    model_config = ConfigDict(extra="forbid")

    version: int = 1
    presets: tuple[Any, ...] = ()


class PresetStore:
    """The presets of one data folder, in one file that is replaced as a whole; from any thread.

    What cannot be read of it stays as it is for whoever can repair it, until it is replaced or removed by its name.
    """

    def __init__(self, folder: Path) -> None:
        """Read nothing yet."""
        self._path = folder / "presets.json"
        self._lock = threading.Lock()

    def presets(self) -> tuple[Preset | UnreadablePreset, ...]:
        """All of them, in the order of the file.

        Raises:
            StoredUnreadable: the file as a whole cannot be read.

        """
        return tuple(_preset(entry, place) for place, entry in enumerate(self._entries(), 1))

    def keep(self, preset: Preset) -> None:
        """Keep a preset, in place of one of that name.

        Raises:
            ConfigError: it cannot be flown; nothing is kept then.
            StoredUnreadable: the file as a whole cannot be read, and is left for whoever can repair it.

        """
        preset.config()
        with self._lock:
            kept = [entry for entry in self._entries() if _name(entry) != preset.name]
            self._write(
                sorted((*kept, preset.model_dump(mode="json")), key=lambda each: (_name(each) or "").casefold())
            )

    def remove(self, name: str) -> None:
        """Keep that one no longer.

        Raises:
            PresetNotFound: there is none of that name.

        """
        with self._lock:
            present = self._entries()
            kept = [entry for entry in present if _name(entry) != name]
            if len(kept) == len(present):
                known = ", ".join(shortened(each) for each in map(_name, present) if each) or "none"
                raise PresetNotFound(f"name = {name!r}: there is no such preset; known: {known}")
            self._write(kept)

    def _entries(self) -> tuple[Any, ...]:
        try:
            return read_document(self._path, _PresetFile, numbers=False).presets
        except FileNotFoundError:
            return ()

    def _write(self, entries: list[Any]) -> None:
        content = json.dumps({"version": _PresetFile().version, "presets": entries}, indent=1, ensure_ascii=False)
        replace_file(self._path, content.encode())


def _preset(entry: Any, place: int) -> Preset | UnreadablePreset:
    try:
        preset = Preset.model_validate(_of_today(entry))
    except ValidationError as error:
        reason = finding(error)
    except ConfigError as error:
        reason = str(error)
    else:
        if finite(entry):
            return preset
        reason = "a number in it is not finite"
    return UnreadablePreset(shortened(_name(entry) or f"number {place}"), reason)


def _of_today(entry: Any) -> Any:
    """A preset of any version, with its changes under the names of today.

    Raises:
        ConfigError: it is of a later version.

    """
    if not isinstance(entry, dict) or not isinstance(entry.get("changes"), dict):
        return entry
    changes = read_parameters({VERSION: entry.get(VERSION, 1), **entry["changes"]})
    return {**entry, "changes": changes.values, VERSION: config_version(), "notices": changes.notices}


def _name(entry: Any) -> str | None:
    name = entry.get("name") if isinstance(entry, dict) else None
    return name if isinstance(name, str) else None
