"""In what a run's configuration differs from the named one that it began as."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from server.run_folder import RunRecord
from sim.capture.snapshot import Published
from sim.config import PARAMETERS, differences
from sim.configurations import NAMED_CONFIGURATIONS

EDITED = " (edited)"
"""How the name of a configuration ends that was changed."""

SEED = "simulation.seed"


class ParameterChange(Published):
    """One parameter that is not as the named configuration has it."""

    path: str
    title: str = Field(description="What the parameter is")
    unit: str = Field(description="1 for a pure number or a choice")
    configured: Any = Field(description="As the named configuration has it")
    value: Any = Field(description="As it was flown")


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
