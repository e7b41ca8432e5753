"""A run of any length in few rows for a plot, with every peak in them."""

from __future__ import annotations

import numpy as np

from server.export import WHOLE, Span
from server.history import PLOTTED, History, HistoryColumn
from server.run_folder import RunReader, TickArray
from sim.capture.tick import column_values


def decimated(reader: RunReader, points: int, span: Span = WHOLE) -> History:
    """The plotted columns of a run, or of a part of it, in at most that many rows.

    Time is cut into pieces of one length. A piece of several ticks gives two rows, the least and the largest value of
    every column: so the first row has the piece's first time, the second its last, and no touch between them is lost.
    """
    columns = [HistoryColumn(name=column.name, unit=column.unit) for column in PLOTTED]
    last = reader.last_tick()
    if last is None:
        return History(run_id=reader.record.id, columns=columns, rows=[])
    start = span.since or 0.0
    end = float(last["time"][0]) if span.until is None else min(span.until, float(last["time"][0]))
    pieces = _Pieces(start, (end - start) / (points // 2))
    for ticks in reader.chunks(*span):
        pieces.take(ticks)
    return History(run_id=reader.record.id, columns=columns, rows=pieces.rows())


class _Pieces:
    """Smallest and largest values of consecutive pieces of time."""

    def __init__(self, start: float, width: float) -> None:
        self._start, self._width = start, max(width, 1e-9)
        self._numbers: list[int] = []
        self._low: list[TickArray] = []
        self._high: list[TickArray] = []

    def take(self, ticks: TickArray) -> None:
        """Add ticks that follow those before."""
        values = np.column_stack([column_values(ticks, column).astype(float) for column in PLOTTED])
        numbers = ((ticks["time"] - self._start) / self._width * (1 - 1e-12)).astype(int)
        starts = np.flatnonzero(np.diff(numbers, prepend=numbers[0] - 1))
        lows, highs = np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)
        for number, low, high in zip(numbers[starts].tolist(), lows, highs, strict=True):
            if self._numbers and self._numbers[-1] == number:
                self._low[-1], self._high[-1] = np.minimum(self._low[-1], low), np.maximum(self._high[-1], high)
            else:
                self._numbers.append(number)
                self._low.append(low)
                self._high.append(high)

    def rows(self) -> list[list[float | None]]:
        """All rows; one only of a piece with a single tick. What is not finite is null."""
        kept = []
        for low, high in zip(self._low, self._high, strict=True):
            kept += [low] if low[0] == high[0] else [low, high]
        return [[value if np.isfinite(value) else None for value in row.tolist()] for row in kept]
