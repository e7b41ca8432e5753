"""The history: bounded, evenly thinned, readable as JSON whatever the numbers."""

from __future__ import annotations

import json
import math

import numpy as np

from server.history import CAPACITY, FIRST_STRIDE, PLOTTED, HistoryRing
from sim.capture.tick import TICK


def _ticks(first: int, count: int) -> np.ndarray:
    rows = np.zeros(count, TICK)
    rows["tick"] = np.arange(first, first + count)
    rows["time"] = rows["tick"] * 1e-3
    return rows


def _read(history: HistoryRing, since: int = -1) -> dict:
    return json.loads("{" + history.encoded(since) + "}")


def test_it_spans_the_mission_in_bounded_evenly_spaced_rows():
    history = HistoryRing()
    for first in range(0, 400_000, 1000):
        history.keep(_ticks(first, 1000))
    ticks = [row[0] for row in _read(history)["rows"]]
    strides = np.diff(ticks)
    assert CAPACITY / 2 <= len(ticks) <= CAPACITY
    assert ticks[0] == 0
    assert (strides == strides[0]).all()
    assert ticks[-1] > 400_000 - strides[0] - 1


def test_blocks_of_any_size_keep_the_same_rows():
    whole, pieces = HistoryRing(), HistoryRing()
    whole.keep(_ticks(0, 5000))
    for first in range(0, 5000, 7):
        pieces.keep(_ticks(first, min(7, 5000 - first)))
    assert whole.encoded() == pieces.encoded()


def test_since():
    history = HistoryRing()
    history.keep(_ticks(0, 100))
    assert [row[0] for row in _read(history, since=50)["rows"]] == [64, 80, 96]


def test_what_is_not_finite_is_null():
    history = HistoryRing()
    rows = _ticks(0, 1)
    rows["base_pose"][0, 0] = math.nan
    history.keep(rows)
    (row,) = _read(history)["rows"]
    assert row[[column.name for column in PLOTTED].index("base.pose.x")] is None


def test_clear_begins_anew():
    history = HistoryRing()
    history.keep(_ticks(0, 100_000))
    history.begin("20200101T000000000-abcdef")
    history.keep(_ticks(0, FIRST_STRIDE + 1))
    assert len(_read(history)["rows"]) == 2
    assert _read(history)["run_id"] == "20200101T000000000-abcdef"  # rows never go without their run
