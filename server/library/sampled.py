"""Any columns of a run, row by row as they were recorded together: for expressions of them, and one against another."""

from __future__ import annotations

import difflib
import math

import numpy as np

from server.library.export import WHOLE, Span
from server.library.plotted import PLOTTED, History, HistoryColumn, Plotted, recorded
from server.library.reader import RunReader
from sim.capture.tick import COLUMNS
from sim.errors import ConfigError

SAMPLED: dict[str, Plotted] = {each.name: each for each in (*(recorded(column) for column in COLUMNS), *PLOTTED)}
"""Every column of the log, and what plots show beside them, by name."""


def sampled(reader: RunReader, names: tuple[str, ...], points: int, span: Span = WHOLE) -> History:
    """Those columns at every n-th tick, n so small as that many rows allow; a row of nulls where ticks are missing.

    Raises:
        ConfigError: there is no such column.

    """
    columns = [_column(name) for name in names]
    last = reader.last_tick()
    end = 0.0 if last is None else float(last["time"][0])
    duration = max(0.0, min(end, math.inf if span.until is None else span.until) - (span.since or 0.0))
    stride = max(1, math.ceil((duration / reader.record.config.control.period + 1) / points))
    rows: list[list[float | None]] = []
    before = None
    for chunk in reader.chunks(*span):
        ticks = chunk[chunk["tick"] % stride == 0]
        values = np.column_stack([column.of(ticks) for column in columns])
        for tick, row in zip(ticks["tick"].tolist(), values.tolist(), strict=True):
            if before is not None and tick - before > stride:
                rows.append([None] * len(columns))
            rows.append([value if math.isfinite(value) else None for value in row])
            before = tick
    named = [HistoryColumn(name=each.name, unit=each.unit) for each in columns]
    return History(run_id=reader.record.id, columns=named, rows=rows)


def _column(name: str) -> Plotted:
    if name in SAMPLED:
        return SAMPLED[name]
    close = difflib.get_close_matches(name, SAMPLED, n=1)
    tip = f"did you mean {close[0]}?" if close else "GET /runs/{run_id}/columns names them"
    raise ConfigError(f"columns: {name!r} is no column of a log", tip=tip)
