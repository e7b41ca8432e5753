"""The clock: which ticks are due, by times passed in."""

from __future__ import annotations

import pytest

from server.mission.pace import CATCH_UP, FAST_BATCH, GIVE_UP, Pace

PERIOD = 1e-3


def _fly(pace: Pace, now: float, *, resting: bool = False) -> int:
    due = pace.due(now, resting=resting)
    pace.flown(due, now)
    return due


def test_nothing_is_due_before_the_first_period():
    assert _fly(Pace(PERIOD, 0.0), 0.9e-3) == 0


def test_the_schedule_is_absolute():
    pace = Pace(PERIOD, 0.0)
    times = [0.0023, 0.0041, 0.0099, 0.0100001, 0.0150001]
    assert [_fly(pace, time) for time in times] == [2, 2, 5, 1, 5]


@pytest.mark.parametrize("speed", [0.1, 1.0, 7.0, 100.0])
def test_speed_multiplies_the_ticks(speed):
    pace = Pace(PERIOD, 0.0)
    pace.run(speed, 0.0)
    flown = sum(_fly(pace, 0.002 * turn) for turn in range(1, 501))
    assert flown == pytest.approx(1000 * speed, abs=max(1.0, speed))


def test_a_late_wake_up_is_caught_up_with_in_bounded_turns():
    pace = Pace(PERIOD, 0.0)
    first = _fly(pace, 0.1)
    assert first == round(CATCH_UP / PERIOD)
    flown = first + sum(_fly(pace, 0.1) for _ in range(10))
    assert flown == 100


def test_a_hopeless_delay_restarts_the_schedule():
    pace = Pace(PERIOD, 0.0)
    assert _fly(pace, 1.0 + GIVE_UP) == 1
    assert pace.slips == 1
    assert _fly(pace, 1.0 + GIVE_UP + 0.0031) == 2


def test_lateness_is_that_of_the_last_second():
    pace = Pace(PERIOD, 0.0)
    _fly(pace, 0.041)
    assert pace.lateness(0.041) == pytest.approx(0.040)
    while _fly(pace, 0.041):
        pass
    _fly(pace, 0.0425)
    assert pace.lateness(1.2) == pytest.approx(0.0, abs=1e-3)


def test_what_is_flown_ahead_is_not_late_and_the_schedule_stays():
    pace = Pace(PERIOD, 0.0)
    flown = []
    for now in (0.0, 0.0167, 0.0334, 0.0600):  # the last wake-up comes later than what was flown ahead
        flown.append(pace.due(now, resting=False, ahead=0.02))
        pace.flown(flown[-1], now)
    assert flown == [20, 16, 17, 27]
    assert pace.lateness(0.06) == pytest.approx(0.06 - 0.054)
    assert sum(pace.lateness_counts) == 4
    assert pace.lateness_counts[0] == 3


def test_letting_it_run_again_and_again_gains_no_time():
    pace = Pace(PERIOD, 0.0)
    flown = 0
    for turn in range(100):
        pace.run(1.0, 0.001 * turn)
        due = pace.due(0.001 * turn, resting=False, ahead=0.02)
        pace.flown(due, 0.001 * turn)
        flown += due
    assert flown == pytest.approx(99 + 20, abs=2)


def test_pausing_it_again_and_again_gains_no_time():
    """Of 100 ms in which the clock runs, one at a time between pauses of a second, it flies 100 and what is ahead."""
    pace, now, flown = Pace(PERIOD, 0.0), 0.0, 0
    for _ in range(100):
        pace.run(1.0, now)
        for _ in range(2):
            due = pace.due(now, resting=False, ahead=0.02)
            pace.flown(due, now)
            flown += due
            now += 0.0005
        pace.pause(now)
        pace.pause(now + 0.5)
        now += 1.0
    assert flown == pytest.approx(120, abs=1)


def test_full_speed_flies_a_batch_unless_nothing_is_under_way():
    pace = Pace(PERIOD, 0.0)
    pace.run(0.0, 0.0)
    assert _fly(pace, 0.001) == FAST_BATCH
    assert pace.wait(0.001, resting=False, longest=1.0) == 0.0
    assert _fly(pace, 0.0031, resting=True) == 1 + 1


def test_a_paused_clock_flies_what_is_stepped():
    pace = Pace(PERIOD, 0.0)
    pace.pause(0.0)
    assert _fly(pace, 5.0) == 0
    pace.steps_left = FAST_BATCH + 3
    assert [_fly(pace, 5.0) for _ in range(3)] == [FAST_BATCH, 3, 0]
    pace.run(1.0, 9.0)
    assert _fly(pace, 9.0021) == 2  # the pause is not caught up with


def test_wait_is_until_the_next_tick():
    pace = Pace(PERIOD, 0.0)
    assert pace.wait(0.0002, resting=False, longest=1.0) == pytest.approx(0.0008)
    pace.run(0.1, 0.0)
    assert pace.wait(0.0, resting=False, longest=0.005) == 0.005


def test_real_time_factor():
    pace = Pace(PERIOD, 0.0)
    for turn in range(1, 1001):
        _fly(pace, turn * PERIOD)
    assert pace.real_time_factor(1.0) == pytest.approx(1.0, abs=0.01)


def test_lateness_is_counted_by_classes():
    pace = Pace(PERIOD, 0.0)
    for now in (0.0005, 0.0015, 0.0095):  # nothing due; half a millisecond late; seven and a half
        _fly(pace, now)
    assert pace.lateness_counts == [1, 0, 0, 1, 0, 0, 0, 0, 0]
    assert pace.lateness_sum == pytest.approx(0.008)
