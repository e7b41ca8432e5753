"""Limits with hysteresis, alarms that are raised, acknowledged, shelved and over, and what is kept of them."""

from __future__ import annotations

import numpy as np
import pytest

from server.alarms.board import AlarmBoard, AlarmRecord, Moment, Reading
from server.alarms.limits import SIGNALS, Level, Limits, LimitStore
from server.library.journal import AT_HAND, Journal
from server.published import Problem
from sim.capture.tick import TICK
from sim.errors import ConfigError, MissionRefused

LIMITS = Limits(watch=1.0, warning=2.0, critical=4.0, hysteresis=0.2)


def _at(second: int) -> Moment:
    return Moment(f"2026-11-30T10:00:{second:02d}.000+00:00", "run", float(second))


def _see(board, value, second, limits=LIMITS, problems=()):
    level = limits.level(value, "above", board.level("limit:tip_force"))
    reading = Reading("limit:tip_force", "tip_force", "Tip force", "N", "above", level, value, limits.bound(level))
    board.see([reading], problems, _at(second))
    return board.alarms


@pytest.mark.parametrize(
    ("value", "before", "level"),
    [
        (0.9, Level.NORMAL, Level.NORMAL),
        (1.1, Level.NORMAL, Level.WATCH),
        (0.9, Level.WATCH, Level.WATCH),
        (0.7, Level.WATCH, Level.NORMAL),
        (5.0, Level.NORMAL, Level.CRITICAL),
        (3.9, Level.CRITICAL, Level.CRITICAL),
        (3.9, Level.WARNING, Level.WARNING),
        (3.7, Level.CRITICAL, Level.WARNING),
    ],
)
def test_a_level_is_left_only_well_within_its_bound(value, before, level):
    assert LIMITS.level(value, "above", before) is level
    below = Limits(watch=-1.0, warning=-2.0, critical=-4.0, hysteresis=0.2)
    assert below.level(-value, "below", before) is level


def test_a_level_without_a_bound_is_passed_over():
    assert Limits(critical=4.0).level(3.0, "above", Level.NORMAL) is Level.NORMAL
    assert Limits(watch=1.0, critical=4.0).level(9.0, "above", Level.NORMAL) is Level.CRITICAL


def test_levels_out_of_order_are_refused_with_both_values():
    with pytest.raises(ConfigError, match="warning = 1: must be above watch, which is 2"):
        Limits(watch=2.0, warning=1.0).require_order("above")
    with pytest.raises(ConfigError, match="critical = 3: must be below watch, which is 2"):
        Limits(watch=2.0, critical=3.0).require_order("below")


def test_every_signal_has_limits_in_order_and_is_read_of_ticks():
    ticks = np.zeros(3, TICK)
    ticks["hand_wrench"][1, 0, :2] = (3.0, -4.0)
    ticks["target_twist"][2] = (0.3, 0.4, -2.0)
    ticks["joint_rate"][0, 1, 2] = -7.0
    read = {name: signal.of(ticks).max() for name, signal in SIGNALS.items() if signal.of is not None}
    assert (read["tip_force"], read["target_spin"], read["target_drift"], read["joint_rate"]) == (5.0, 2.0, 0.5, 7.0)
    for signal in SIGNALS.values():
        signal.default.require_order(signal.side)


def test_an_alarm_waits_for_its_acknowledgement_once_it_is_over():
    board = AlarmBoard()
    (raised,) = _see(board, 2.5, 1)
    assert (raised.level, raised.active, raised.since, raised.bound) == ("warning", True, 1.0, 2.0)
    (worse,) = _see(board, 3.0, 2)
    assert (worse.worst, worse.since) == (3.0, 1.0)
    (over,) = _see(board, 0.1, 3)
    assert (over.active, over.worst) == (False, 3.0)
    board.acknowledge(over.key, "ana", _at(4))
    assert board.alarms == ()
    assert [(record.happening, record.who) for record in board.take_records()] == [
        ("raised", None),
        ("over", None),
        ("acknowledged", "ana"),
    ]
    assert board.take_records() == []


def test_an_acknowledged_alarm_is_raised_again_where_it_gets_worse():
    board = AlarmBoard()
    _see(board, 2.5, 1)
    board.acknowledge(None, "ana", _at(2))
    (seen,) = _see(board, 1.5, 3)
    assert (seen.acknowledged_by, seen.level) == ("ana", "watch")
    (again,) = _see(board, 5.0, 4)
    assert (again.acknowledged_by, again.level, again.since) == (None, "critical", 4.0)
    board.acknowledge(again.key, "ben", _at(5))
    assert _see(board, 0.0, 6) == ()


def test_what_is_only_to_be_watched_needs_no_acknowledgement():
    board = AlarmBoard()
    assert _see(board, 1.5, 1)[0].level == "watch"
    assert _see(board, 0.0, 2) == ()


def test_a_shelved_alarm_stays_in_the_list_says_nothing_and_speaks_again_in_time():
    board = AlarmBoard()
    (alarm,) = _see(board, 2.5, 1)
    board.shelve(alarm.key, _at(10).at, "ana", _at(2))
    _see(board, 0.0, 3)
    (worse,) = _see(board, 5.0, 4)
    assert (worse.level, worse.shelved_by) == ("critical", "ana")
    assert _see(board, 5.0, 10)[0].shelved_until is None
    board.shelve(alarm.key, _at(30).at, "ana", _at(11))
    board.unshelve(alarm.key, "ben", _at(12))
    assert board.alarms[0].shelved_by is None
    with pytest.raises(MissionRefused, match="not in the list"):
        board.shelve("limit:spin", _at(30).at, "ana", _at(13))


def test_problems_are_alarms_by_their_severity():
    board = AlarmBoard()
    problem = Problem(severity="error", title="Link lost", message="silent for 2 s", tip="mend it", since=0.5)
    (alarm,) = _see(board, 0.0, 1, problems=(problem,))
    assert (alarm.level, alarm.message, alarm.since, alarm.value) == ("critical", "silent for 2 s", 0.5, None)
    (changed,) = _see(board, 0.0, 2, problems=(problem.model_copy(update={"message": "silent for 3 s"}),))
    assert changed.message == "silent for 3 s"
    (over,) = _see(board, 0.0, 3)
    assert over.active is False
    assert [record.happening for record in board.take_records()] == ["raised", "over"]


def test_chosen_limits_are_kept_and_forgotten(tmp_path):
    store = LimitStore(tmp_path)
    assert store.limits("tip_force") == SIGNALS["tip_force"].default
    store.choose("tip_force", LIMITS, who="ana", at="now")
    assert LimitStore(tmp_path).limits("tip_force") == LIMITS
    store.forget("tip_force")
    assert LimitStore(tmp_path).chosen == {}
    with pytest.raises(ConfigError, match="nothing of that name is watched; known: tip_force"):
        store.choose("weather", LIMITS, who="ana", at="now")


def test_a_damaged_file_of_limits_costs_no_more_than_what_was_chosen(tmp_path):
    (tmp_path / "limits.json").write_text('{"version": 1, "chosen": {"tip_force": 3}}')
    store = LimitStore(tmp_path)
    assert store.limits("tip_force") == SIGNALS["tip_force"].default
    assert "limits.json is damaged" in (store.trouble or "")


def test_what_happened_to_alarms_is_kept_over_a_restart(tmp_path):
    def journal():
        return Journal(tmp_path, "alarms", AlarmRecord, lambda: None)

    board, kept = AlarmBoard(), journal()
    _see(board, 2.5, 1)
    _see(board, 0.0, 2)
    records = board.take_records()
    kept.keep(*records)
    assert journal().newest() == records[::-1]
    with (tmp_path / "alarms.jsonl").open("a") as file:
        file.write("damaged\n")
    kept.keep(*records * AT_HAND)
    assert len(journal().newest()) == AT_HAND
    assert journal().newest(1) == [records[-1]]
