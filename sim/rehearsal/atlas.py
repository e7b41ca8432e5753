"""The atlas: a map over two parameters around a state, a few futures a cell, coarse first."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import Field

from sim.capture.mission import prepare
from sim.config import PARAMETERS, MissionConfig, value_at
from sim.configurations import revised
from sim.control.phases import Command
from sim.errors import CaptureError, ConfigError
from sim.rehearsal.futures import Flown, fly_future, rehearsed
from sim.rehearsal.rehearsal import SETTLE, require_within
from sim.rehearsal.situation import Situation
from sim.rehearsal.summary import BANDED, measured
from sim.rehearsal.uncertainty import UncertaintyModel
from sim.snapshot import FrozenMessage
from sim.study.axes import checked, require_axis

MOST_VALUES = 21
"""Of an axis."""

MOST_A_CELL = 10
"""Futures of a cell."""

_DIGITS = 12


class AtlasAxis(FrozenMessage):
    """One of the two parameters."""

    path: str
    values: tuple[float, ...] = Field(description="In their order")


class AtlasCell(FrozenMessage):
    """What the futures of one cell say."""

    x: int = Field(description="Place of its value on the first axis, from 0")
    y: int = Field(description="... on the second")
    futures: int
    caged: int = Field(description="Futures that ended in a cage")
    outcome: str | None = Field(description="The most frequent; null where none could be flown")
    odds: float = Field(description="Its share")
    outcomes: dict[str, int] = Field(description="Futures of each outcome")
    measures: dict[str, float | None] = Field(description="The median of each over those that have it")
    error: str | None = Field(description="Why the cell cannot be flown")


@dataclass(frozen=True)
class Atlas:
    """What is to be flown. Small, and travels as a pickle."""

    situation: Situation
    config: MissionConfig
    """That all cells share but for the two parameters."""
    x: AtlasAxis
    y: AtlasAxis
    request: Command | None
    uncertainty: UncertaintyModel
    futures: int
    """Of each cell; those of the same number draw alike in all cells."""
    seed: int
    horizon: float

    @property
    def total(self) -> int:
        """Cells."""
        return len(self.x.values) * len(self.y.values)

    def cells(self) -> list[tuple[int, int]]:
        """All of them, places on both axes: first a few all over the map, then those between."""
        shape = len(self.x.values), len(self.y.values)
        return sorted(np.ndindex(*shape), key=lambda cell: (-_stride(cell[0], cell[1], max(shape)), cell))

    def config_at(self, x: int, y: int) -> MissionConfig:
        """The configuration of a cell.

        Raises:
            ConfigError: its values do not fit together.

        """
        values = {self.x.path: _typed(self.x, x), self.y.path: _typed(self.y, y)}
        return rehearsed(self.config, SETTLE, values)

    def present(self, axis: AtlasAxis) -> float:
        """The value that is configured now."""
        return float(value_at(self.config, axis.path))


def _stride(x: int, y: int, size: int) -> int:
    """The largest power of two that divides both places."""
    stride = 1
    while 2 * stride < size and x % (2 * stride) == 0 and y % (2 * stride) == 0:
        stride *= 2
    return stride


def _typed(axis: AtlasAxis, place: int) -> float | int:
    value = axis.values[place]
    return int(value) if PARAMETERS[axis.path].annotation is int else value


def axis_between(path: str, start: float, stop: float, count: int, name: str) -> AtlasAxis:
    """Evenly spaced values of a parameter, both ends included.

    Raises:
        ConfigError: no such number, too many values, or values out of its bounds; the message names the axis.

    """
    if not 1 <= count <= MOST_VALUES:
        raise ConfigError(f"{name}.count = {count}: an axis has 1 to {MOST_VALUES} values")
    try:
        require_axis(path, name)
        if PARAMETERS[path].annotation not in (float, int):
            raise ValueError(f"{name}.path = {path!r}: it is a choice; an axis is a number")
        spread = np.linspace(start, stop, count).tolist()
        values = [checked(path, float(f"{value:.{_DIGITS}g}"), name) for value in spread]
    except ValueError as error:
        raise ConfigError(str(error)) from None
    if len(set(values)) < len(values):
        raise ConfigError(f"{name}: from = {start:g} to = {stop:g} makes {count} values that are not all different")
    return AtlasAxis(path=path, values=tuple(float(value) for value in values))


def planned_atlas(
    situation: Situation,
    changes: Mapping[str, Any],
    x: AtlasAxis,
    y: AtlasAxis,
    *,
    request: Command | None,
    uncertainty: UncertaintyModel,
    futures: int,
    seed: int,
    horizon: float,
) -> Atlas:
    """An atlas, checked.

    Raises:
        ConfigError: a value is out of bounds; the message names field, value and bound.
        MissionRefused: the request cannot begin there.

    """
    require_within(futures, seed, horizon, MOST_A_CELL)
    if x.path == y.path:
        raise ConfigError(f"y.path = {y.path!r}: it is the other axis, too", tip="an atlas is over two parameters")
    config = rehearsed(revised(situation.config, changes) if changes else situation.config, SETTLE)
    situation.require_can_begin(config, request)
    return Atlas(situation, config, x, y, request, uncertainty, futures, seed, horizon)


def fly_atlas_cells(atlas: Atlas, cells: Iterable[tuple[int, int]], *, threads: int) -> list[AtlasCell]:
    """Fly some cells in threads of this process; each gives a row, whatever its values are."""
    prepare(atlas.config, recorded=False)
    with ThreadPoolExecutor(threads, "becalm-atlas") as pool:
        return list(pool.map(lambda cell: fly_atlas_cell(atlas, *cell), cells))


def fly_atlas_cell(atlas: Atlas, x: int, y: int) -> AtlasCell:
    """Fly the futures of a cell."""
    try:
        config = atlas.config_at(x, y)
        atlas.situation.require_can_begin(config, atlas.request)
        flown = [future_of_cell(atlas, config, number) for number in range(atlas.futures)]
    except CaptureError as error:
        nothing: dict[str, float | None] = dict.fromkeys(BANDED)
        return AtlasCell(
            x=x, y=y, futures=0, caged=0, outcome=None, odds=0.0, outcomes={}, measures=nothing, error=str(error)
        )
    outcomes = Counter(each.outcome.outcome.value for each in flown)
    outcome, count = outcomes.most_common(1)[0]
    return AtlasCell(
        x=x,
        y=y,
        futures=len(flown),
        caged=sum(each.outcome.caged for each in flown),
        outcome=outcome,
        odds=count / len(flown),
        outcomes=dict(outcomes),
        measures={name: _median(flown, name) for name in BANDED},
        error=None,
    )


def future_of_cell(atlas: Atlas, config: MissionConfig, number: int) -> Flown:
    """One future of a cell, whose configuration that is."""
    return fly_future(atlas.situation, config, atlas.request, atlas.uncertainty, atlas.seed, number, atlas.horizon)


def _median(flown: Iterable[Flown], name: str) -> float | None:
    values = [value for each in flown if (value := measured(each, name)) is not None]
    return float(np.median(values)) if values else None
