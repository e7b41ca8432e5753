"""The mission so far in few rows: what a browser that joins late draws its plots from.

Ticks are taken together in pieces. Of each piece two rows remain: the least and the largest value of every column, so
that no peak is lost however long the mission lasts.
"""

from __future__ import annotations

import json
import threading
from collections import deque

import numpy as np
from pydantic_core import to_json

from server.library.plotted import ENCODED_COLUMNS, PLOTTED, TICK_PLACE, Values, extremes, plotted_values, rows_of
from server.library.record import TickArray

CAPACITY = 750
"""Pieces at most; two neighbours become one when it is full. Their JSON, the first that a late reader is sent, stays
under the mebibyte that WebSocket clients take of a message by default."""

TICKS_AT_ONCE = 1000
"""Ticks that are taken in with one length of their pieces, far fewer than fill the room; so many wait for a reader."""

FIRST_STRIDE = 16
"""Ticks in a piece at first: about what a screen shows in a second."""

DIGITS = 7
"""Of a number in JSON: more than any plot shows."""


class _Block:
    """Room for the pieces of a run's history. Rows below `count` never change."""

    def __init__(self, run_id: str, low: Values, high: Values) -> None:
        self.run_id = run_id
        self.low, self.high = (np.empty((CAPACITY, len(PLOTTED))) for _ in range(2))
        self.count = len(low)
        self.low[: self.count], self.high[: self.count] = low, high

    def add(self, low: Values, high: Values) -> None:
        """One piece more."""
        self.low[self.count], self.high[self.count] = low, high
        self.count += 1

    def halved(self) -> _Block:
        """Of every two neighbours one piece."""
        even = self.count - self.count % 2
        low = np.fmin(self.low[0:even:2], self.low[1:even:2])
        return _Block(self.run_id, low, np.fmax(self.high[0:even:2], self.high[1:even:2]))


_NOTHING = np.empty((0, len(PLOTTED)))


class HistoryRing:
    """The mission thread gives it ticks, and loses no time; whoever reads it takes them together, in any thread."""

    def __init__(self) -> None:
        self._stride = FIRST_STRIDE
        self._block = _Block("", _NOTHING, _NOTHING)
        self._waiting: list[TickArray] = []
        self._incoming: deque[TickArray] = deque()
        self._incoming_ticks = 0
        self._lock = threading.Lock()
        """Held while ticks are taken together; the mission thread waits for it only where a mission begins."""

    def begin(self, run_id: str, past: HistoryRing | None = None) -> None:
        """Hold nothing but that past: another mission begins, with that run."""
        with self._lock:
            self._incoming.clear()
            self._stride = FIRST_STRIDE
            self._block, self._waiting = _Block(run_id, _NOTHING, _NOTHING), []
            if past is not None:
                past._take_in()
                low, high = (each[: past._block.count] for each in (past._block.low, past._block.high))
                self._stride, self._block = past._stride, _Block(run_id, low, high)
                self._waiting = list(past._waiting)

    def keep(self, ticks: TickArray) -> None:
        """Take rows of `TICK` that follow those before; they show when their piece is whole."""
        self._incoming.append(ticks)
        self._incoming_ticks += len(ticks)
        if self._incoming_ticks >= TICKS_AT_ONCE and self._lock.acquire(blocking=False):
            self._incoming_ticks = 0
            try:
                self._take_in()
            finally:
                self._lock.release()

    def before(self, run_id: str, tick: int) -> HistoryRing:
        """A copy of all pieces that end before that tick, if they are that run's; else nothing. For any thread."""
        past = HistoryRing()
        with self._lock:
            self._take_in()
            block = self._block
            if block.run_id == run_id:
                count = int((block.high[: block.count, TICK_PLACE] < tick).sum())
                past._stride, past._block = self._stride, _Block(run_id, block.low[:count], block.high[:count])
        return past

    @property
    def end(self) -> int:
        """The last tick of its whole pieces; -1 of none."""
        return int(self._block.high[self._block.count - 1, TICK_PLACE]) if self._block.count else -1

    def encoded(self, since: int = -1) -> str:
        """The members of `History` as JSON, of the pieces with ticks after `since`; for any thread."""
        with self._lock:
            self._take_in()
            block, count = self._block, self._block.count
        low, high = block.low[:count], block.high[:count]  # which never change
        wanted = high[:, TICK_PLACE] > since
        rows = to_json(rows_of(_rounded(low[wanted]), _rounded(high[wanted])))
        return f'"run_id":{json.dumps(block.run_id)},"columns":{ENCODED_COLUMNS},"rows":{rows.decode()}'

    def _take_in(self) -> None:
        """Make pieces of the ticks that have come."""
        incoming = [self._incoming.popleft() for _ in range(len(self._incoming))]
        if incoming:
            ticks = np.concatenate(incoming)
            for start in range(0, len(ticks), TICKS_AT_ONCE):
                self._take_in_few(ticks[start : start + TICKS_AT_ONCE])

    def _take_in_few(self, ticks: TickArray) -> None:
        """Take in rows that all become pieces of one length."""
        self._waiting.append(ticks)
        first, last = (int(tick) // self._stride for tick in (self._waiting[0]["tick"][0], ticks["tick"][-1]))
        if first == last:
            return
        waiting = np.concatenate(self._waiting)
        numbers = waiting["tick"] // self._stride
        starts = np.flatnonzero(np.diff(numbers, prepend=numbers[0] - 1))
        self._waiting = [waiting[starts[-1] :]]
        for low, high in zip(*extremes(plotted_values(waiting[: starts[-1]]), starts[:-1]), strict=True):
            if self._block.count == CAPACITY:
                self._stride *= 2
                self._block = self._block.halved()
            self._block.add(low, high)


def _rounded(values: Values) -> Values:
    """To so many digits, the tick's number left whole; what is not finite stays."""
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = 10.0 ** (DIGITS - 1 - np.floor(np.log10(np.abs(values))))
        rounded = np.where((values == 0) | ~np.isfinite(scale), values, np.round(values * scale) / scale)
    rounded[:, TICK_PLACE] = values[:, TICK_PLACE]
    return rounded
