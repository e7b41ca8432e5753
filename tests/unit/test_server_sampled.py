"""Columns of a run row by row: each row is of one instant, and no more of them than asked for."""

from __future__ import annotations

import numpy as np
import pytest

from server.library.export import Span
from server.library.runs import RunStore, new_record
from server.library.sampled import SAMPLED, sampled
from sim.capture.tick import COLUMNS, TICK
from sim.configurations import named_configuration
from sim.errors import ConfigError


def _reader(folder, kept):
    store = RunStore(folder)
    record = new_record("scripted", "published", named_configuration("published"))
    ticks = np.zeros(5000, TICK)
    ticks["tick"] = np.arange(len(ticks))
    ticks["time"] = 1e-3 * ticks["tick"]
    ticks["hand_wrench"][:, 0, 0] = ticks["tick"]
    ticks["target_twist"][:, 2] = -2.0 * ticks["tick"]
    writer = store.write(record)
    writer.append(ticks[kept])
    writer.close(status="finished")
    return store.read(record.id)


@pytest.fixture
def reader(tmp_path):
    return _reader(tmp_path, slice(None))


def test_what_stands_in_a_row_was_so_at_one_instant(reader):
    history = sampled(reader, ("mission.time", "left.hand_wrench.x", "target.twist.angle"), 1000)
    rows = np.array(history.rows)
    assert 900 < len(rows) <= 1000
    np.testing.assert_allclose(rows[:, 1], 1000.0 * rows[:, 0])
    np.testing.assert_allclose(rows[:, 2], -2.0 * rows[:, 1])
    assert [column.unit for column in history.columns] == ["s", "N", "rad/s"]


def test_a_short_part_is_given_tick_by_tick(reader):
    rows = sampled(reader, ("mission.tick",), 200, Span(1.0, 1.1)).rows
    assert rows == [[tick] for tick in range(1000, 1101)]


def test_where_ticks_are_missing_stands_a_row_of_nulls(tmp_path):
    kept = np.r_[0:1000, 2000:5000]
    rows = sampled(_reader(tmp_path, kept), ("mission.tick", "mission.time"), 20_000).rows
    assert rows[1000] == [None, None]
    assert (rows[999][0], rows[1001][0]) == (999.0, 2000.0)


def test_every_column_of_a_log_may_be_asked_for(reader):
    assert {column.name for column in COLUMNS} < set(SAMPLED)
    assert len(sampled(reader, tuple(SAMPLED), 2).rows[0]) == len(SAMPLED)


def test_a_column_that_there_is_not_is_refused_with_the_one_that_was_meant(reader):
    with pytest.raises(ConfigError, match=r"'left\.hand_forces' is no column") as refused:
        sampled(reader, ("left.hand_forces",), 100)
    assert "left.hand_force" in refused.value.tip
