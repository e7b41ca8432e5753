"""A run of any length in few rows for a plot, with every peak in them."""

from __future__ import annotations

import numpy as np

from server.library.export import WHOLE, Span
from server.library.plotted import HISTORY_COLUMNS, History, Values, extremes, plotted_values, rows_of
from server.library.reader import RunReader
from server.library.record import TickArray


def decimated(reader: RunReader, points: int, span: Span = WHOLE) -> History:
    """The plotted columns of a run, or of a part of it, in at most that many rows, but for those that mark gaps.

    Time is cut into pieces of one length. A piece of several ticks gives two rows, the least and the largest value of
    every column: so the first row has the piece's first time, the second its last, and no touch between them is lost.
    """
    last = reader.last_tick()
    if last is None:
        return History(run_id=reader.record.id, columns=HISTORY_COLUMNS, rows=[])
    start = span.since or 0.0
    end = float(last["time"][0]) if span.until is None else min(span.until, float(last["time"][0]))
    pieces = _Pieces(start, (end - start) / (points // 2))
    for ticks in reader.chunks(*span):
        pieces.take(ticks)
    return History(run_id=reader.record.id, columns=HISTORY_COLUMNS, rows=pieces.rows())


class _Pieces:
    """Smallest and largest values of consecutive pieces of time."""

    def __init__(self, start: float, width: float) -> None:
        self._start, self._width = start, max(width, 1e-9)
        self._numbers: list[int] = []
        self._low: list[Values] = []
        self._high: list[Values] = []

    def take(self, ticks: TickArray) -> None:
        """Add ticks that follow those before."""
        values = plotted_values(ticks)
        numbers = ((ticks["time"] - self._start) / self._width * (1 - 1e-12)).astype(int)
        starts = np.flatnonzero(np.diff(numbers, prepend=numbers[0] - 1))
        for number, low, high in zip(numbers[starts].tolist(), *extremes(values, starts), strict=True):
            if self._numbers and self._numbers[-1] == number:
                self._low[-1], self._high[-1] = np.fmin(self._low[-1], low), np.fmax(self._high[-1], high)
            else:
                self._numbers.append(number)
                self._low.append(low)
                self._high.append(high)

    def rows(self) -> list[list[float | None]]:
        """All rows, and nulls where ticks are missing."""
        return rows_of(np.array(self._low), np.array(self._high)) if self._low else []
