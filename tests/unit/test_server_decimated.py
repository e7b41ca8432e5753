"""A long run in few rows: no more than asked for, and no peak lost."""

from __future__ import annotations

import numpy as np
import pytest

from server.library.decimated import decimated
from server.library.export import Span, exported
from server.library.plotted import PLOTTED
from server.library.runs import RunStore, new_record
from sim.capture.tick import TICK
from sim.configurations import named_configuration

NAMES = [column.name for column in PLOTTED]
FORCE = NAMES.index("left.hand_force")


@pytest.fixture
def reader(tmp_path):
    """Twenty seconds with one tick of force in them."""
    store = RunStore(tmp_path)
    record = new_record("scripted", "published", named_configuration("published"))
    ticks = np.zeros(20_000, TICK)
    ticks["tick"] = np.arange(len(ticks))
    ticks["time"] = 1e-3 * ticks["tick"]
    ticks["hand_wrench"][12_345, 0, :2] = (-6.0, 4.5)
    ticks["hand_wrench"][12_349, 0, :2] = (0.5, -5.0)
    writer = store.write(record)
    for part in np.array_split(ticks, 41):
        writer.append(part)
        writer.flush()
    writer.close(status="finished")
    return store.read(record.id)


def _times(history):
    return [row[1] for row in history.rows]


@pytest.mark.parametrize("points", [2, 100, 1000])
def test_no_more_rows_than_asked_for_and_the_peak_is_among_them(reader, points):
    history = decimated(reader, points)
    assert points * 0.9 <= len(history.rows) <= points + 1
    assert max(row[FORCE] or 0.0 for row in history.rows) == 7.5
    assert _times(history) == sorted(_times(history))
    assert (_times(history)[0], _times(history)[-1]) == (0.0, pytest.approx(19.999))


def test_a_short_part_is_given_tick_by_tick(reader):
    history = decimated(reader, 1000, Span(12.3, 12.4))
    assert _times(history) == pytest.approx(np.arange(12_300, 12_401) * 1e-3)


def test_where_ticks_are_missing_stands_a_row_of_nulls(tmp_path):
    store = RunStore(tmp_path)
    record = new_record("scripted", "published", named_configuration("published"))
    ticks = np.zeros(3000, TICK)
    ticks["tick"] = np.arange(len(ticks))
    ticks["time"] = 1e-3 * ticks["tick"]
    writer = store.write(record)
    for part in (ticks[:1000], ticks[2000:]):
        writer.append(part)
        writer.flush()
    writer.close(status="finished")
    rows = decimated(store.read(record.id), 100).rows
    gaps = [row for row in rows if row[FORCE] is None]
    assert [row[NAMES.index("mission.time")] for row in gaps] == [pytest.approx(1.4995)]
    assert decimated(store.read(record.id), 20_000, Span(0.9, 0.95)).rows[-1][FORCE] == 0.0


def test_every_format_of_a_run_is_streamed_in_small_pieces(reader):
    """Memory is bounded by a chunk, not by the run: no piece grows with it."""
    for log_format in ("csv", "parquet", "mcap"):
        sizes = [len(piece) for piece in exported(reader, log_format)]
        assert max(sizes) < 2**20
