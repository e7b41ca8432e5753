"""Runs of the library as a fit reads them, and what is kept of what it finds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from server.errors import JobRefused
from server.library.changes import base_name
from server.library.presets import Preset
from server.library.reader import RunReader
from server.library.record import RunRecord
from sim.config import differences, value_at
from sim.configurations import DEFAULT_CONFIGURATION, NAMED_CONFIGURATIONS, named_configuration, nested
from sim.identification.fit import FitPlan, planned
from sim.identification.parameters import DEFAULT, changed
from sim.identification.recording import recording


def recorded_plan(
    runs: Sequence[RunReader], names: Sequence[str] | None = None, held_out: Sequence[RunReader] = ()
) -> FitPlan:
    """A fit to these runs; of what is usually fitted where no names are given.

    Raises:
        ConfigError: a name is unknown, or the runs do not go together.
        MissionRefused: nothing can be learnt from a run; the message says why.
        StoredUnreadable: a log is damaged.

    """
    fitted, kept = (
        [
            recording(
                each.record.id,
                each.record.config,
                each.chunks(),
                raw=each.record.kind == "imported",
                robot=each.record.robot,
            )
            for each in readers
        ]
        for readers in (runs, held_out)
    )
    return planned(fitted, tuple(names) if names is not None else DEFAULT, kept)


def preset_of(name: str, record: RunRecord, fitted: Mapping[str, float], who: str, at: str) -> Preset:
    """A run's configuration with fitted values, to be kept by name.

    Raises:
        JobRefused: the fit has found no parameter of the configuration.

    """
    if not fitted:
        raise JobRefused(
            "the fit has found nothing that a preset can keep",
            tip="fit parameters of the configuration, such as contact.stiffness, to a run with a touch",
        )
    base = base_name(record.configuration)
    base = base if base in NAMED_CONFIGURATIONS else DEFAULT_CONFIGURATION
    config = changed(record.config, fitted)
    paths = differences(named_configuration(base), config)
    changes: dict[str, Any] = nested({path: _plain(value_at(config, path)) for path in paths})
    return Preset(name=name, configuration=base, changes=changes, who=who, at=at)


def _plain(value: Any) -> Any:
    """As JSON has it."""
    return [list(point) for point in value] if isinstance(value, tuple) else getattr(value, "value", value)
