"""The table of a study as arrays, each value at the place of its cell."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sim.compiled import FloatArray
from sim.snapshot import OutcomeClass
from sim.study.axes import Value
from sim.study.design import Study
from sim.study.run import MEASURES
from sim.study.table import StudyRows

CLASSES = tuple(OutcomeClass)
NO_CLASS = -1
"""Of a cell that has not ended, or failed."""

CLASSED = ("outcome", "at_first_closure", "at_locked_arms")
NUMBERS = tuple(column for column in MEASURES if column.kind in (float, int))

IntArray = np.ndarray[tuple[int, ...], np.dtype[np.int8]]


class Axis(NamedTuple):
    """One axis of a grid."""

    path: str
    values: tuple[Value, ...]


class Spread(NamedTuple):
    """Which axes of a grid lie across, upright and from panel to panel, and where the others stand."""

    x: Axis
    y: Axis | None
    panels: Axis | None
    held: Sequence[tuple[Axis, int]]
    """Further axes, each at one of its values."""


def usual_spread(study: Study) -> Spread | None:
    """The last two axes of the grid, a panel for each value of the first; None without a grid."""
    axes = [Axis(path, values) for path, values in study.levels.items()]
    if not axes:
        return None
    if len(axes) == 1:
        return Spread(axes[0], None, None, ())
    return Spread(axes[-2], axes[-1], axes[0] if len(axes) > 2 else None, [(axis, 0) for axis in axes[1:-2]])


class StudyCells:
    """What came out of each cell."""

    def __init__(self, study: Study, table: StudyRows) -> None:
        """Read the table, once."""
        self.study = study
        self._numbers = {name: np.full(study.count, np.nan) for name in (*study.varied, *(c.name for c in NUMBERS))}
        self._classes = {name: np.full(study.count, NO_CLASS, np.int8) for name in CLASSED}
        self.caged = np.full(study.count, np.nan)
        self.failed = 0
        self.done = 0
        places = {each.value: place for place, each in enumerate(CLASSES)}
        numeric = [name for name in self._numbers if name not in study.levels]
        for row in table.rows("cell", *numeric, *CLASSED, "caged", "error"):
            self._take(row["cell"], row, numeric, places)

    def _take(self, cell: int, row: dict[str, Value | None], numeric: Sequence[str], places: dict[str, int]) -> None:
        self.done += 1
        if row["error"] is not None:
            self.failed += 1
            return
        for name in numeric:
            value = row[name]
            self._numbers[name][cell] = np.nan if value is None else value
        for name in CLASSED:
            self._classes[name][cell] = places.get(str(row[name]), NO_CLASS)
        self.caged[cell] = bool(row["caged"])

    def numbers(self, name: str) -> FloatArray:
        """A drawn parameter or a measure of all cells; nan where there is none, shape (cells,)."""
        return self._numbers[name]

    def classes(self, name: str) -> IntArray:
        """Places in `CLASSES` of all cells, or `NO_CLASS`, shape (cells,)."""
        return self._classes[name]

    def occurring(self, name: str) -> list[OutcomeClass]:
        """The classes that occur, in their order."""
        return [each for place, each in enumerate(CLASSES) if (self._classes[name] == place).any()]

    def panels(self, values: FloatArray, spread: Spread) -> FloatArray:
        """Means over a sample's points, shape (panels, y, x); nan where no cell has a value."""
        points = values.reshape(self.study.shape)
        counts = np.isfinite(points).sum(axis=-1)
        means = np.where(counts, np.nansum(points, axis=-1) / np.maximum(counts, 1), np.nan)
        return _spread_out(means, spread)

    def class_panels(self, name: str, spread: Spread) -> IntArray:
        """The class that most points of each place have, shape (panels, y, x)."""
        points = self._classes[name].reshape(self.study.shape)
        counts = np.stack([(points == place).sum(axis=-1) for place in range(len(CLASSES))])
        most = np.where(counts.any(axis=0), counts.argmax(axis=0), NO_CLASS).astype(np.int8)
        return _spread_out(most, spread)


def _spread_out(values: np.ndarray, spread: Spread) -> np.ndarray:
    """From the grid's axes to panels, y and x."""
    if spread.y is None:
        return values[np.newaxis, np.newaxis, :]
    if spread.panels is None:
        return values.T[np.newaxis]
    for _, place in spread.held:
        values = values[:, place]
    return values.transpose(0, 2, 1)


def summarised(values: FloatArray) -> tuple[float, ...]:
    """Least, mean, median, 95 % quantile and largest of those that there are."""
    known = values[np.isfinite(values)]
    return (
        float(known.min()),
        float(known.mean()),
        float(np.median(known)),
        float(np.quantile(known, 0.95)),
        float(known.max()),
    )
