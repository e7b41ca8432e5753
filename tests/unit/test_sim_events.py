"""What happened, in words, read from the recorded ticks."""

from __future__ import annotations

import numpy as np
import pytest

from sim.capture.events import events_of, has_event, touch_event, verdict_event, verdict_in_words
from sim.capture.tick import TICK
from sim.compiled import CompiledFunction
from sim.config import MissionConfig
from sim.control.phases import Phase
from sim.errors import Cause
from sim.method.co_moving_couple.memory import Trouble
from sim.method.method import method_named, method_of
from sim.method.published.memory import Activity
from sim.method.registry import MethodName
from sim.snapshot import Outcome, OutcomeClass, Touch

CONFIG = MissionConfig()
PERIOD = CONFIG.control.period


def quiet(count: int):
    """Ticks on which nothing happens, the target spinning fast."""
    ticks = np.zeros(count, TICK)
    ticks["tick"] = np.arange(count)
    ticks["time"] = PERIOD * np.arange(count)
    ticks["target_perceived_twist"][:, 2] = 1.0
    return ticks


def told(ticks):
    return [(event.tick, event.kind, event.severity) for event in events_of(ticks[1:], ticks[:1], CONFIG)]


def test_why_a_sequence_was_broken_off_is_told_in_the_words_of_its_method() -> None:
    ticks = quiet(3)
    ticks["trouble"][1:] = Trouble.HAND_MISSED
    config = MissionConfig(method=MethodName("co_moving_couple"))
    (event,) = events_of(ticks[1:], ticks[:1], config)
    assert (event.tick, event.kind, event.severity) == (1, "trouble", "warning")
    assert event.message == "One hand did not meet its side"


@pytest.mark.parametrize("name", list(MethodName))
def test_every_trouble_of_a_method_has_words(name: MethodName) -> None:
    words = method_named(name).words.trouble
    assert set(words) == (set(Trouble) - {Trouble.NONE} if name.value == "co_moving_couple" else set())


def outcome(**changes) -> Outcome:
    numbers = {
        "outcome": OutcomeClass.CAGED_FORCE_REDUCED,
        "at_first_closure": OutcomeClass.CAGED_FORCE_REDUCED,
        "at_locked_arms": OutcomeClass.CAGED_FORCE_REDUCED,
        "caged": True,
        "cage_margin": 0.0054,
        "peak_tip_force": 0.64,
        "peak_tip_force_to_closure": 0.64,
        "closed_at": 21.3,
        "locked_at": 21.6,
        "duration": 23.6,
        "contacts": [],
        "final_target_spin": 0.03,
        "min_manipulability": 0.03,
        "momentum_error": 1e-8,
    }
    return Outcome(**{**numbers, **changes})


class TestEventsOfTicks:
    def test_nothing_happens_on_quiet_ticks(self):
        assert told(quiet(10)) == []

    @pytest.mark.parametrize(
        ("phase", "severity"), [(Phase.DETUMBLING, "info"), (Phase.HOLDING, "info"), (Phase.STOPPED, "warning")]
    )
    def test_a_change_of_phase(self, phase, severity):
        ticks = quiet(6)
        ticks["phase"][3:] = phase
        assert told(ticks) == [(3, "phase", severity)]

    def test_a_change_right_after_the_tick_before(self):
        ticks = quiet(3)
        ticks["phase"][1:] = Phase.CAGING
        assert told(ticks) == [(1, "phase", "info")]

    @pytest.mark.parametrize(
        ("activity", "words"),
        [(Activity.APPROACHING, "touch"), (Activity.CLOSING, "closing"), (Activity.OPENING, "opening")],
    )
    def test_a_new_plan(self, activity, words):
        ticks = quiet(5)
        ticks["plan"][2:], ticks["activity"][2:] = 1, activity
        (event,) = events_of(ticks[1:], ticks[:1], CONFIG)
        assert (event.tick, event.kind) == (2, "plan")
        assert words in event.message

    @pytest.mark.parametrize(
        ("field", "kind", "severity"),
        [
            ("solid_contact", "solid_contact", "warning"),
            ("base_overlap", "base_overlap", "error"),
            ("rate_limited", "rate_limit", "warning"),
        ],
    )
    def test_a_flag_that_rises_and_not_one_that_falls(self, field, kind, severity):
        ticks = quiet(9)
        ticks[field][2:5] = 1
        assert told(ticks) == [(2, kind, severity)]

    def test_spin_under_and_over_its_threshold(self):
        ticks = quiet(9)
        ticks["target_perceived_twist"][3:6, 2] = -0.4
        assert told(ticks) == [(3, "spin_threshold", "info"), (6, "spin_threshold", "warning")]

    def test_they_come_in_order(self):
        ticks = quiet(9)
        ticks["rate_limited"][2:], ticks["phase"][1:], ticks["target_perceived_twist"][4:, 2] = 1, Phase.DETUMBLING, 0.1
        assert [tick for tick, *_ in told(ticks)] == [1, 2, 4]

    def test_time_and_tick_agree(self):
        ticks = quiet(9)
        ticks["phase"][5:] = Phase.DETUMBLING
        (event,) = events_of(ticks[1:], ticks[:1], CONFIG)
        assert event.time == pytest.approx(event.tick * PERIOD)


class TestTouchEvents:
    def test_beginning(self):
        touch = Touch(arm="right", start=3.457, end=None, peak=0.1, planned=True)
        event = touch_event(touch, PERIOD)
        assert (event.kind, event.severity, event.tick) == ("touch", "info", 3457)
        assert event.message.startswith("Right hand")

    def test_beginning_unplanned_warns(self):
        event = touch_event(Touch(arm="left", start=1.0, end=None, peak=0.1, planned=False), PERIOD)
        assert event.severity == "warning"
        assert "unplanned" in event.message

    def test_end_tells_duration_and_peak(self):
        event = touch_event(Touch(arm="left", start=1.0, end=1.25, peak=0.456, planned=True), PERIOD)
        assert (event.kind, event.tick) == ("touch_end", 1250)
        assert "0.25 s" in event.message
        assert "0.46 N" in event.message


class TestVerdict:
    def test_caged(self):
        event = verdict_event(outcome(), 23.6, PERIOD)
        assert (event.kind, event.severity, event.cause) == ("verdict", "info", None)
        assert "Caged with a margin of 5.4 mm" in event.message
        assert "0.64 N" in event.message

    @pytest.mark.parametrize(
        ("kind", "words", "cause"),
        [
            (OutcomeClass.EJECTION, "left the robot's reach", Cause.TARGET_EJECTED),
            (OutcomeClass.BASE_COLLISION, "struck the base", Cause.BASE_STRUCK),
            (OutcomeClass.UNRESOLVED, "not caged", Cause.TIME_UP),
        ],
    )
    def test_failure_says_what_failed(self, kind, words, cause):
        failed = outcome(outcome=kind, at_first_closure=kind, at_locked_arms=kind, caged=False, cage_margin=None)
        assert words in verdict_in_words(failed)
        event = verdict_event(failed, 9.0, PERIOD)
        assert (event.severity, event.cause) == ("error", cause)


def _changed(field, activities):
    """Two ticks that differ in that field only, in every value that it can have next to 0."""
    for activity in activities:
        for value in range(1, 6):
            rows = np.zeros(2, TICK).view(np.recarray)
            rows["activity"] = activity
            rows[field][1] = value
            yield rows


@pytest.mark.parametrize("field", [name for name in TICK.names or () if name != "activity"])
def test_a_flight_without_rows_stops_at_each_tick_that_has_an_event(field):
    """Compiled code looks for the same changes as what reads events from rows that are kept, of any method."""
    looks, found = compiled_from(has_event), set()
    for name in MethodName:
        config = MissionConfig(method=name)
        method = method_of(config)
        threshold = method.spin_threshold(config)
        found |= {
            (bool(events_of(rows[1:], rows[:1], config)), looks(rows[0], rows[1], threshold))
            for rows in _changed(field, method.activities)
        }
    assert (True, False) not in found
    assert ((True, True) in found) == any(stopped for _, stopped in found)


def compiled_from(function):
    """The Python that a compiled function is made from."""
    assert isinstance(function, CompiledFunction)
    return function.py_func
