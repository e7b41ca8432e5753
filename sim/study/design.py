"""What a study flies: a base configuration, and every combination of its axes and samples as one cell each.

A cell's place in the study, its values and its seed follow from the study alone: the same study gives the same
cells on any machine and with any executor.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import numpy as np
from pydantic import Field, JsonValue, ValidationError, ValidationInfo, field_validator, model_validator

from sim.config import Engine, MissionConfig, NamesVersion
from sim.configurations import (
    REFERENCE_CONFIGURATION,
    named_configuration,
    nested,
    read_config_file,
    revised,
)
from sim.errors import ConfigError
from sim.parameters import WholeNumber
from sim.schema_history import (
    PARAMETER_CHANGES,
    VERSION,
    Read,
    config_version,
    require_known_version,
    under_todays_names,
)
from sim.study.axes import (
    Axis,
    Distribution,
    Samples,
    StudyModel,
    Value,
    checked,
    is_number,
    require_axis,
    require_parameter,
    why_gone,
)

SEED = "simulation.seed"

METHOD = "method"
ENGINE = "simulation.engine"
STUDY_ENGINE = Engine.REDUCED
"""The engine of a study that names none; its definition then names it, so that a stored one always does."""

_STORED = "stored"
"""Context in which a definition is read that some version has flown."""

_AXIS_WORDS = {name for model in (Axis, Distribution) for name in model.model_fields} | {"from", "to"}
_FOR_POINTS, _FOR_CELLS = 0, 1  # two streams of one seed


@dataclass(frozen=True)
class Cell:
    """One capture of a study."""

    index: int
    """Its place in the study."""
    values: Mapping[str, Value]
    """Of the varied parameters, by full path."""
    seed: int
    """Of the capture's random numbers."""


class Study(StudyModel):
    """A named configuration with changes, and the parameters that vary over it.

    With axes and samples, every combination of grid values meets every point of the sample. The last axis of the
    grid changes faster than the first, the sample's points fastest.
    """

    version: NamesVersion = Field(default_factory=config_version, description="Of the parameters' names")
    name: str = Field("study", min_length=1)
    description: str = ""
    configuration: str = REFERENCE_CONFIGURATION
    changes: dict[str, JsonValue] = Field(default_factory=dict, description="Full path to value, for all cells")
    direct: bool = Field(False, description="Direct caging, without detumbling")
    seed: WholeNumber = Field(0, ge=0, le=2**63 - 1, description="Of the sample's points and of every cell's own seed")
    grid: dict[str, Axis] = Field(default_factory=dict, description="Full path to the values of an axis")
    samples: Samples | None = None

    @model_validator(mode="before")
    @classmethod
    def _names_its_engine(cls, given: Any, info: ValidationInfo) -> Any:
        """A study that 0.1.0 stored names none: it was flown by that of its configuration."""
        if not isinstance(given, Mapping) or info.context == _STORED:
            return given
        changes, grid = given.get("changes", {}), given.get("grid", {})
        if not isinstance(changes, Mapping) or not isinstance(grid, Mapping):
            return given
        changes = flattened(changes)
        if ENGINE in changes or ENGINE in flattened(grid):
            return given
        return {**given, "changes": {ENGINE: STUDY_ENGINE.value, **changes}}

    @field_validator("changes", "grid", mode="before")
    @classmethod
    def _by_full_path(cls, given: Any) -> Any:
        return flattened(given) if isinstance(given, Mapping) else given

    @field_validator("samples", mode="before")
    @classmethod
    def _over_by_full_path(cls, given: Any) -> Any:
        if isinstance(given, Mapping) and isinstance(given.get("over"), Mapping):
            return {**given, "over": flattened(given["over"])}
        return given

    @model_validator(mode="after")
    def _is_possible(self, info: ValidationInfo) -> Self:
        if not self.varied:
            raise ValueError("the study varies nothing; give it a grid or samples")
        self._require_parameters(stored=info.context == _STORED)
        self._require_each_path_once()
        for path in self.grid:
            _require_distinct(path, self.levels[path])
        self._require_points_within_bounds()
        try:
            assert self.base
        except ConfigError as error:
            raise ValueError(str(error)) from None
        return self

    def _require_parameters(self, *, stored: bool) -> None:
        """What a stored study varied may have been removed since: its rows are read all the same."""
        sampled = self.samples.over if self.samples else {}
        for where, paths in (("grid", self.grid), ("samples.over", sampled), ("changes", self.changes)):
            require = require_parameter if where == "changes" else require_axis
            for path in paths:
                if not (stored and why_gone(path)):
                    require(path, where)

    def _require_each_path_once(self) -> None:
        sampled = self.samples.over if self.samples else {}
        for path in self.varied:
            if path in self.changes:
                raise ValueError(f"{path} is varied by the study; it cannot be set to {self.changes[path]!r} as well")
        for path in sampled:
            if path in self.grid:
                raise ValueError(f"{path} is an axis of the grid; it cannot be sampled as well")
            if not is_number(path):
                raise ValueError(
                    f"samples.over.{path} cannot be drawn: it is not a continuous number; put it on the grid"
                )
        if SEED in self.changes:
            raise ValueError(f"{SEED} cannot be set: every cell has its own, which follows from the study's seed")

    def _require_points_within_bounds(self) -> None:
        columns = zip(self.samples.over if self.samples else (), zip(*self._points, strict=True), strict=True)
        for path, drawn in columns:
            for extreme in (min(drawn), max(drawn)):
                try:
                    checked(path, extreme, "samples.over")
                except ValueError as error:
                    raise ValueError(f"{error}; narrow the distribution, or cut it with from and to") from None

    @property
    def varied(self) -> tuple[str, ...]:
        """Full paths of the parameters that vary: those of the grid, then those of the sample."""
        return (*self.grid, *(self.samples.over if self.samples else ()))

    @cached_property
    def base(self) -> MissionConfig:
        """The configuration that all cells share but for what varies."""
        return revised(named_configuration(self.configuration), nested(self.changes))

    @cached_property
    def levels(self) -> dict[str, tuple[Value, ...]]:
        """Full path to the values of each axis of the grid."""
        return {
            path: tuple(checked(path, value, "grid") for value in axis.listed()) for path, axis in self.grid.items()
        }

    @cached_property
    def _points(self) -> tuple[tuple[float, ...], ...]:
        """The sample's points, values in the order of `over`; one point of nothing without a sample."""
        if self.samples is None:
            return ((),)
        stream = np.random.SeedSequence(self.seed, spawn_key=(_FOR_POINTS,))
        return tuple(map(tuple, self.samples.points(np.random.default_rng(stream)).tolist()))

    @property
    def shape(self) -> tuple[int, ...]:
        """How many values each axis has, and how many points the sample has."""
        return (*(len(values) for values in self.levels.values()), len(self._points))

    @property
    def count(self) -> int:
        """How many cells the study has."""
        return math.prod(self.shape)

    def cell(self, index: int) -> Cell:
        """The cell at that place, 0 to `count` - 1.

        Raises:
            IndexError: the study has no such cell.

        """
        if not 0 <= index < self.count:
            raise IndexError(f"the study has {self.count} cells, numbered from 0; there is none at {index}")
        rest, point = divmod(index, len(self._points))
        chosen: dict[str, Value] = {}
        for path, levels in reversed(self.levels.items()):
            rest, place = divmod(rest, len(levels))
            chosen[path] = levels[place]
        values = {path: chosen[path] for path in self.grid}
        if self.samples:
            values |= zip(self.samples.over, self._points[point], strict=True)
        stream = np.random.SeedSequence(self.seed, spawn_key=(_FOR_CELLS, index))
        seed = values.get(SEED, int(stream.generate_state(1)[0]))
        return Cell(index, values, int(seed))

    def cells(self) -> Iterator[Cell]:
        """All cells in their order."""
        return map(self.cell, range(self.count))

    def definition(self) -> dict[str, Any]:
        """The study as a study file holds it, in JSON values."""
        return self.model_dump(mode="json", by_alias=True, exclude_none=True)


def configured(base: MissionConfig, cell: Cell) -> MissionConfig:
    """The configuration of a cell.

    Raises:
        ConfigError: its values do not fit together.

    """
    return revised(base, nested({SEED: cell.seed, **cell.values}))


def flattened(tree: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """A nested mapping by full path; what describes an axis or a distribution stays whole."""
    flat: dict[str, Any] = {}
    for name, value in tree.items():
        if isinstance(value, Mapping) and value and not _AXIS_WORDS & value.keys():
            flat |= flattened(value, f"{prefix}{name}.")
        else:
            flat[f"{prefix}{name}"] = value
    return flat


def definition_of_today(stored: Mapping[str, Any]) -> Read:
    """A study's definition of any version, under current names; a removed parameter that it varies keeps its name.

    Raises:
        ConfigError: it is of a later version, or a value stands under two names.

    """
    require_known_version(stored.get(VERSION, 1))
    values = {**stored, VERSION: config_version()}
    notices: tuple[str, ...] = ()
    if isinstance(changes := stored.get("changes"), Mapping):
        values["changes"], notices = under_todays_names(flattened(changes), PARAMETER_CHANGES)
    if isinstance(grid := stored.get("grid"), Mapping):
        values["grid"] = _varied_of_today(flattened(grid))
    if isinstance(samples := stored.get("samples"), Mapping) and isinstance(over := samples.get("over"), Mapping):
        values["samples"] = {**samples, "over": _varied_of_today(flattened(over))}
    return Read(values, notices)


def _varied_of_today(paths: Mapping[str, Any]) -> dict[str, Any]:
    """In the same order, which is that of the cells."""
    return under_todays_names(paths, [change for change in PARAMETER_CHANGES if change.new is not None]).values


def study_of(definition: Mapping[str, Any], *, stored: bool = False) -> Study:
    """The study that a file, a script or a request defines.

    Args:
        definition: under current names.
        stored: some version has flown it: parameters that it varies may have been removed since.

    Raises:
        ConfigError: the definition is invalid; the message names field, value and bound.

    """
    try:
        return Study.model_validate(dict(definition), context=_STORED if stored else None)
    except ValidationError as error:
        raise ConfigError("; ".join(map(_describe_finding, error.errors(include_url=False)))) from None


def altered(study: Study, changes: Mapping[str, Any], seed: int | None) -> Study:
    """The study with these nested changes to what its cells share, and perhaps another seed.

    Raises:
        ConfigError: the result is invalid.

    """
    definition = study.definition()
    definition["changes"] |= flattened(changes)
    if seed is not None:
        definition["seed"] = seed
    return study_of(definition)


def read_study(path: Path) -> Study:
    """The study in a TOML or JSON file; without a name of its own it takes the file's.

    Raises:
        ConfigError: the file cannot be read, or the study in it is invalid.

    """
    read = definition_of_today(read_config_file(path, "study file"))
    return study_of({"name": path.stem, **read.values})


def _describe_finding(finding: Any) -> str:
    """One finding of pydantic as a line: field, value and what would be right."""
    path = ".".join(str(part) for part in finding["loc"])
    message = finding["msg"].removeprefix("Value error, ")
    if finding["type"] == "extra_forbidden":
        known = list(Study.model_fields) if len(finding["loc"]) == 1 else [*_AXIS_WORDS, *Samples.model_fields]
        close = difflib.get_close_matches(str(finding["loc"][-1]), known, n=1)
        return f"{path} is not a field of a study" + (f"; did you mean {close[0]}?" if close else "")
    return f"{path} = {finding['input']!r}: {message}" if path else message


def _require_distinct(path: str, values: tuple[Value, ...]) -> None:
    seen: set[Value] = set()
    for value in values:
        if value in seen:
            raise ValueError(f"grid.{path}: {value!r} is listed twice")
        seen.add(value)
