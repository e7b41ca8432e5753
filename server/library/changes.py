"""In what a run's configuration differs from the named one that it began as."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import Field

from server.library.record import RunRecord
from sim.config import PARAMETERS, MissionConfig, differences
from sim.configurations import NAMED_CONFIGURATIONS, named_configuration
from sim.parameters import points_text
from sim.snapshot import FrozenMessage

EDITED = " (edited)"
"""How the name of a configuration ends that was changed."""

SEED = "simulation.seed"

MOST_CHANGES_TOLD = 6
"""In one line; the log holds all of them."""


class ParameterChange(FrozenMessage):
    """One parameter that is not as the named configuration has it."""

    path: str
    title: str = Field(description="What the parameter is")
    unit: str = Field(description="1 for a pure number or a choice")
    configured: Any = Field(description="As the named configuration has it")
    value: Any = Field(description="As it was flown")


def change_words(path: str, old: Any, new: Any) -> str:
    """A change in words, each value in the unit of the configuration: "published.impedance.damping 1.5 → 3 N s/m"."""
    unit = PARAMETERS[path].json_schema_extra["unit"]
    return f"{path} {value_words(old)} → {value_words(new)}" + ("" if unit == "1" else f" {unit}")


def value_words(value: Any) -> str:
    """A parameter's value as it is read, without its unit."""
    if isinstance(value, tuple):
        return points_text(value)
    return f"{value:.7g}" if isinstance(value, float) else str(value)


def changed_words(changes: Mapping[str, tuple[Any, Any]]) -> str:
    """Old and new value of each path, in one line that stays readable when there are many; empty without changes."""
    words = [change_words(path, old, new) for path, (old, new) in changes.items()]
    left = len(words) - MOST_CHANGES_TOLD
    return "; ".join(words[:MOST_CHANGES_TOLD]) + (f"; and {left} more" if left > 0 else "")


def display_name(configuration: str, config: MissionConfig) -> str:
    """The configuration's name, and whether it has been edited."""
    edited = differences(named_configuration(configuration), config)
    return f"{configuration}{EDITED}" if edited else configuration


def base_name(configuration: str) -> str:
    """The named configuration that an edited one came from."""
    return configuration.removesuffix(EDITED)


def changes_of(record: RunRecord) -> tuple[ParameterChange, ...]:
    """What was changed, but for the seed; nothing for a configuration that is not known by its name today."""
    named = NAMED_CONFIGURATIONS.get(base_name(record.configuration))
    if named is None:
        return ()
    return tuple(
        ParameterChange(
            path=path,
            title=PARAMETERS[path].description,
            unit=PARAMETERS[path].json_schema_extra["unit"],
            configured=old,
            value=new,
        )
        for path, (old, new) in differences(named, record.config).items()
        if path != SEED
    )
