"""The history: bounded, evenly thinned, true to every peak, readable as JSON whatever the numbers."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np

from server.library.plotted import PLOTTED
from server.mission.history import CAPACITY, FIRST_STRIDE, HistoryRing
from sim.capture.tick import TICK

NAMES = [column.name for column in PLOTTED]


def _ticks(first: int, count: int) -> np.ndarray:
    rows = np.zeros(count, TICK)
    rows["tick"] = np.arange(first, first + count)
    rows["time"] = rows["tick"] * 1e-3
    return rows


def _read(history: HistoryRing, since: int = -1) -> dict:
    return json.loads("{" + history.encoded(since) + "}")


def _column(history: HistoryRing, name: str) -> list[Any]:
    return [row[NAMES.index(name)] for row in _read(history)["rows"]]


def test_it_spans_the_mission_in_bounded_rows():
    history = HistoryRing()
    for first in range(0, 400_000, 1000):
        history.keep(_ticks(first, 1000))
    ticks = _column(history, "mission.tick")
    assert CAPACITY <= len(ticks) <= 2 * CAPACITY
    assert ticks == sorted(set(ticks))
    strides = np.diff(ticks[::2])
    assert strides.max() <= 2 * np.median(strides)
    assert ticks[0] == 0
    assert ticks[-1] > 400_000 - strides.max() - 1


def test_full_it_fits_a_message_that_every_client_takes():
    """A mebibyte is what WebSocket clients take unless they are told otherwise; the numbers here are of full length."""
    history, random = HistoryRing(), np.random.default_rng(1)
    ticks = _ticks(0, FIRST_STRIDE * CAPACITY + 1)
    for name in TICK.names or ():
        if TICK[name].base.kind == "f" and name != "time":
            ticks[name] = random.normal(scale=1e-3, size=ticks[name].shape)
    history.keep(ticks)
    assert len(_read(history)["rows"]) == 2 * CAPACITY
    assert len(history.encoded()) < 2**20


def test_no_peak_is_lost_however_long_the_mission_lasts():
    """Eleven minutes with one tick of force in them: as high as the peak that the page states."""
    history = HistoryRing()
    for first in range(0, 660_000, 16):
        ticks = _ticks(first, 16)
        if first == 64_000:
            ticks["hand_wrench"][3, 1, :2] = (-0.64, 0.48)
            ticks["hand_wrench"][9, 1, :2] = (0.1, -0.6)
        history.keep(ticks)
    assert max(_column(history, "right.hand_force")) == 0.8
    assert min(_column(history, "right.hand_wrench.y")) == -0.6


def test_blocks_of_any_size_keep_the_same_rows():
    whole, pieces = HistoryRing(), HistoryRing()
    whole.keep(_ticks(0, 5000))
    for first in range(0, 5000, 7):
        pieces.keep(_ticks(first, min(7, 5000 - first)))
    assert whole.encoded() == pieces.encoded()


def test_since():
    history = HistoryRing()
    history.keep(_ticks(0, 100))
    assert [row[0] for row in _read(history, since=79)["rows"]] == [80, 95]


def test_what_is_not_finite_is_null_and_hides_no_other_value():
    history = HistoryRing()
    rows = _ticks(0, 2 * FIRST_STRIDE + 1)
    rows["base_pose"][:FIRST_STRIDE, 0] = math.nan
    rows["base_pose"][FIRST_STRIDE, 0] = math.nan
    history.keep(rows)
    assert _column(history, "base.pose.x") == [None, None, 0, 0]


def test_missing_ticks_are_a_row_of_nulls():
    history = HistoryRing()
    history.keep(_ticks(0, FIRST_STRIDE))
    history.keep(_ticks(10 * FIRST_STRIDE, FIRST_STRIDE + 1))
    assert _column(history, "left.hand_force") == [0, 0, None, 0, 0]
    times = _column(history, "mission.time")
    assert times == sorted(times)


def test_a_fork_has_its_parents_past_and_begin_forgets():
    parent, fork = HistoryRing(), HistoryRing()
    parent.keep(_ticks(0, 100_000))
    fork.begin("20200101T000000000-abcdef", parent)
    assert _read(fork)["rows"] == _read(parent)["rows"]
    assert _read(fork)["run_id"] == "20200101T000000000-abcdef"  # rows never go without their run
    parent.keep(_ticks(100_000, 1000))
    assert _read(fork)["rows"] != _read(parent)["rows"]
    fork.begin("20200101T000000000-abcdef")
    fork.keep(_ticks(0, FIRST_STRIDE + 1))
    assert len(_read(fork)["rows"]) == 2


def test_what_was_before_a_tick_goes_on_as_if_the_rest_had_not_been():
    history, past = HistoryRing(), HistoryRing()
    history.begin("one")
    past.keep(_ticks(0, 3000))
    for first in range(0, 5000, 100):
        history.keep(_ticks(first, 100))
    before = history.before("one", 3000)
    assert 3000 - 2 * FIRST_STRIDE < before.end < 3000
    assert history.before("another", 3000).end == -1
    before.keep(_ticks(before.end + 1, 3000 - before.end - 1))
    assert _read(before)["rows"] == _read(past)["rows"]
    assert _column(history, "mission.tick")[-1] > 4900  # it goes on as it was
