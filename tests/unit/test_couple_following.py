"""When the co-moving couple goes on, backs out, looks again or gives up: each trouble by values."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from sim.config import MissionConfig
from sim.configurations import revised
from sim.control.memory import MEMORY, NEVER
from sim.control.phases import Phase, Sequence, Verdict
from sim.method.co_moving_couple.following import detumble, fail, trouble_now
from sim.method.co_moving_couple.memory import COUPLE_MEMORY, Activity, CoupleHandle, Dropped, PlanKind, Trouble
from sim.method.co_moving_couple.sequence import begin, react
from sim.method.method import method_of
from sim.perception.perceived import PERCEIVED
from sim.record import Record, record_of

CONFIG = revised(MissionConfig(), {"method": "co_moving_couple"})
PARAMETERS = record_of(CONFIG)
METHOD = CONFIG.co_moving_couple
NOW = 10.0


class Flight:
    """A sequence in mid-flight in which nothing is wrong."""

    def __init__(self, activity: Activity, phase: Phase = Phase.DETUMBLING) -> None:
        self.handle: CoupleHandle = method_of(CONFIG).handle(CONFIG, np.zeros(1, COUPLE_MEMORY))
        self.own: Record = self.handle.own.view(np.recarray)[0]
        self.memory: Record = np.zeros(1, MEMORY).view(np.recarray)[0]
        self.state: Record = np.zeros(1, PERCEIVED).view(np.recarray)[0]
        begin(self.handle, self.memory)
        self.memory.phase, self.memory.activity, self.memory.sequence = phase, activity, Sequence.CAPTURE
        self.state.time = self.state.target_seen_at = NOW
        self.state.target_twist[2] = 2.0
        self.own.since, self.own.touches, self.own.both_touch = NOW - 0.1, 1, 1
        self.own.sense, self.own.manipulability = 1.0, 0.05
        self.own.best.contact_angle, self.own.best.end_angle = 0.0, 0.8

    def trouble(self) -> Trouble:
        return Trouble(trouble_now(self.own, self.memory, PARAMETERS, self.state))

    def react(self) -> tuple[Phase, Activity, PlanKind]:
        phase, activity, kind = react(self.handle, self.memory, PARAMETERS, self.state, Verdict.NONE)
        return Phase(phase), Activity(activity), PlanKind(kind)


def unseen(flight: Flight) -> None:
    flight.state.target_seen_at = NOW - 0.21


def stretched(flight: Flight) -> None:
    flight.own.manipulability = 0.99 * METHOD.search.manipulability_floor


def missed(flight: Flight) -> None:
    flight.own.both_touch, flight.own.since = 0, NOW - 0.51


def struck(flight: Flight) -> None:
    flight.state.hand_wrench[1, :2] = 0.0, -1.51 * METHOD.touch.force_cap


def late(flight: Flight) -> None:
    flight.own.since = NOW - 3.1


CASES: list[tuple[Activity, Callable[[Flight], None], Trouble]] = [
    (Activity.APPROACHING, unseen, Trouble.SENSOR_LOST),
    (Activity.TOUCHING, unseen, Trouble.SENSOR_LOST),
    (Activity.REGRASPING, stretched, Trouble.OUT_OF_REACH),
    (Activity.TOUCHING, stretched, Trouble.OUT_OF_REACH),
    (Activity.TOUCHING, missed, Trouble.HAND_MISSED),
    (Activity.TOUCHING, struck, Trouble.FORCE_OVER_CAP),
    (Activity.CLOSING, late, Trouble.NOT_ENCLOSED),
    (Activity.SQUEEZING, stretched, Trouble.NONE),  # to lock is safer than to back out
    (Activity.SETTLING, stretched, Trouble.NONE),
    (Activity.RECOVERING, unseen, Trouble.NONE),
    (Activity.APPROACHING, missed, Trouble.NONE),
]


class TestTrouble:
    @pytest.mark.parametrize(("activity", "happens", "trouble"), CASES)
    def test_is_named(self, activity: Activity, happens: Callable[[Flight], None], trouble: Trouble) -> None:
        flight = Flight(activity)
        assert flight.trouble() is Trouble.NONE
        happens(flight)
        assert flight.trouble() is trouble

    @pytest.mark.parametrize(("activity", "happens", "trouble"), CASES[:6])
    def test_makes_both_hands_back_out(
        self, activity: Activity, happens: Callable[[Flight], None], trouble: Trouble
    ) -> None:
        flight = Flight(activity)
        happens(flight)
        assert flight.react() == (Phase.DETUMBLING, Activity.RECOVERING, PlanKind.NONE)
        assert flight.own.trouble == trouble

    def test_is_forgotten_once_both_hands_touch_again(self) -> None:
        flight = Flight(Activity.ENTERING)
        flight.own.trouble, flight.own.failures, flight.own.waiting_since = Trouble.NO_PLAN, 3, NOW - 4.0
        flight.state.touching[:] = 1
        assert flight.react()[1] is Activity.TOUCHING
        assert (flight.own.trouble, flight.own.failures, flight.own.waiting_since) == (Trouble.NONE, 0, NEVER)

    def test_that_comes_again_and_again_ends_in_holding(self) -> None:
        flight, ends = Flight(Activity.TOUCHING), []
        for _ in range(METHOD.search.most_failures):
            search = PARAMETERS["co_moving_couple"]["search"]
            ends.append(
                fail(flight.own, search, flight.state, Phase.CAGING, Trouble.NOT_ENCLOSED, Activity.RECOVERING)[:2]
            )
        assert ends[:-1] == [(Phase.CAGING, Activity.RECOVERING)] * (METHOD.search.most_failures - 1)
        assert ends[-1] == (Phase.HOLDING, Activity.NONE)
        assert flight.own.trouble == Trouble.NOT_ENCLOSED

    def test_too_many_touches_are_not_followed_by_another(self) -> None:
        flight = Flight(Activity.RETREATING)
        flight.own.touches, flight.own.since = METHOD.touch.most_touches, NOW - 1.0
        assert flight.react()[:2] == (Phase.HOLDING, Activity.NONE)
        assert flight.own.trouble == Trouble.TOO_MANY_TOUCHES


class TestTouching:
    def test_ends_before_an_arm_comes_where_joint_rates_are_damped(self) -> None:
        flight = Flight(Activity.TOUCHING)
        warning = CONFIG.control.rates.manipulability_warning
        flight.own.manipulability = 1.4 * warning
        assert flight.react()[1] is Activity.TOUCHING
        flight.own.manipulability = 1.2 * warning
        assert flight.react() == (Phase.DETUMBLING, Activity.RETREATING, PlanKind.NONE)


class TestSearching:
    def test_goes_on_after_backing_out(self) -> None:
        flight = Flight(Activity.RECOVERING)
        assert flight.react()[1] is Activity.RECOVERING
        flight.own.since = NOW - 1.0
        assert flight.react()[1] is Activity.ESTIMATING

    def test_waits_for_a_target_that_is_out_of_sight(self) -> None:
        flight = Flight(Activity.ESTIMATING)
        flight.own.since = NOW - 1.0
        assert flight.react() == (Phase.DETUMBLING, Activity.ESTIMATING, PlanKind.ROLL_OUT_TOUCH)
        unseen(flight)
        assert flight.react() == (Phase.DETUMBLING, Activity.ESTIMATING, PlanKind.NONE)
        assert flight.own.since == NOW

    def test_that_finds_nothing_says_so_and_goes_on_until_patience_is_over(self) -> None:
        for waited, phase in ((0.0, Phase.DETUMBLING), (9.9, Phase.DETUMBLING), (10.0, Phase.HOLDING)):
            flight = Flight(Activity.ESTIMATING)
            flight.own.since, flight.own.candidate, flight.own.passing = NOW - 1.0, 90, 2
            flight.own.waiting_since = NOW - waited
            assert flight.react()[0] is phase
            assert (flight.own.trouble, flight.own.failures) == (Trouble.NO_PLAN, 0)

    def test_that_finds_nothing_begins_to_wait(self) -> None:
        flight = Flight(Activity.ESTIMATING)
        flight.own.since, flight.own.candidate, flight.own.passing = NOW - 1.0, 90, 2
        assert flight.react() == (Phase.DETUMBLING, Activity.ESTIMATING, PlanKind.NONE)
        assert (flight.own.trouble, flight.own.waiting_since) == (Trouble.NO_PLAN, NOW)
        assert flight.own.candidate == 0

    def test_a_plan_that_is_no_longer_feasible_is_not_flown(self) -> None:
        flight = Flight(Activity.APPROACHING)
        flight.own.best.dropped_for = Dropped.MANIPULABILITY
        assert flight.react()[1] is Activity.ESTIMATING
        assert flight.own.trouble == Trouble.NO_PLAN


class TestBeginning:
    def test_in_touch_backs_out_first(self) -> None:
        flight = Flight(Activity.NONE)
        flight.state.touching[1] = 1
        assert flight.react()[1] is Activity.RECOVERING

    def test_in_the_open_watches_first(self) -> None:
        flight = Flight(Activity.NONE)
        assert flight.react()[1] is Activity.ESTIMATING

    def test_a_slow_target_is_not_touched(self) -> None:
        flight = Flight(Activity.ESTIMATING)
        flight.own.since, flight.state.target_twist[2] = NOW - 1.0, 0.99 * METHOD.touch.no_touch_spin
        assert flight.react()[:2] == (Phase.CAGING, Activity.NONE)
        flight.memory.sequence = Sequence.DETUMBLE_ONLY
        assert flight.react()[:2] == (Phase.HOLDING, Activity.NONE)


def test_the_entry_begins_as_late_as_it_may() -> None:
    flight = Flight(Activity.APPROACHING)
    entry = min(0.5, max(0.2, 0.7 / 2.0))
    flight.own.best.contact_angle = 2.0 * (entry + 0.01)
    assert detumble(flight.own, flight.memory, PARAMETERS, flight.state)[1] == Activity.APPROACHING
    flight.own.best.contact_angle = 2.0 * (entry - 0.01)
    assert detumble(flight.own, flight.memory, PARAMETERS, flight.state)[1] == Activity.ENTERING
    assert math.isinf(flight.own.found.cost)
