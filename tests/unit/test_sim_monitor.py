"""How a capture is judged: touches, verdicts, the order among them, the two readings of one run."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from scipy.optimize import fsolve

from sim.capture.caging import Cage
from sim.capture.monitor import (
    MAX_TOUCHES,
    MONITOR,
    begin_monitoring,
    outcome_of,
    overlaps_base,
    touches_of,
    watch,
)
from sim.config import MissionConfig
from sim.configurations import nested, revised
from sim.control.memory import MEMORY
from sim.control.phases import Phase, Sequence, Verdict
from sim.model.clearance import initial_base_pose, shapes_of
from sim.model.robot import chain, initial_joint_angles, robot_model
from sim.plant.plant import PLANT_STATE
from sim.record import record_of
from sim.snapshot import Outcome, OutcomeClass

CONFIG = MissionConfig()
ROBOT, SHAPES = robot_model(CONFIG.robot), shapes_of(CONFIG)
GAP = CONFIG.judging.touch_gap
CAGED, FREE = Cage(caged=True, margin=0.006), Cage(caged=False, margin=-0.01)


class Bench:
    """The judge alone, fed with states made by hand."""

    def __init__(self, config: MissionConfig = CONFIG, sequence: Sequence = Sequence.CAPTURE) -> None:
        self.config = config
        self.parameters = record_of(config)
        self.monitor, self.memory, self.state = (np.zeros(1, kind)[0] for kind in (MONITOR, MEMORY, PLANT_STATE))
        self.state["base_pose"] = initial_base_pose(config)
        self.state["target_pose"] = config.target.initial_x, config.target.initial_y, config.target.initial_angle
        self.state["joint_angle"] = initial_joint_angles(config.robot.arm)
        self.memory["phase"], self.memory["sequence"] = Phase.DETUMBLING, sequence
        self.monitor["begun_at"] = math.nan
        begin_monitoring(self.monitor, 0.0, np.zeros(3))

    def look(self, time: float, *, left: float = 0.0, right: float = 0.0, **state) -> None:
        """One tick at that time with those hand forces [N]; a force of zero is no contact."""
        self.state["time"] = time
        for arm, force in enumerate((left, right)):
            self.state["hand_wrench"][arm, 0] = force
            self.state["tip_contact"][arm, 0] = force > 0.0
        for name, value in state.items():
            self.state[name] = value
        links = chain(ROBOT, self.state["base_pose"], self.state["joint_angle"], self.state["mount_angle"])
        watch(self.monitor, self.memory, self.parameters, ROBOT, SHAPES, self.state, links)

    def close_the_hands(self) -> None:
        """Put the target, a corner in each hand, between hands that have closed on it."""
        hands = Bench.closed_angles()
        self.state["joint_angle"] = hands
        links = chain(ROBOT, self.state["base_pose"], hands, np.zeros(2))
        middle = links.hand_pose[:, :2].mean(axis=0)
        self.state["target_pose"] = *middle, math.pi / 4

    @staticmethod
    def closed_angles():
        """Joint angles that put the hand centres 0.0939 m either side of the middle, palms facing."""
        base = initial_base_pose(CONFIG)

        def error(left):
            hand = chain(ROBOT, base, np.array([left, -left]), np.zeros(2)).hand_pose[0]
            return hand - [-0.0939, 0.35, -math.pi / 2]

        left = fsolve(error, initial_joint_angles(CONFIG.robot.arm)[0])
        return np.array([left, -left])

    def outcome(self, cage: Cage = CAGED):
        return outcome_of(self.monitor, self.config, float(self.state["target_twist"][2]), cage)


class TestTouches:
    def test_one_contact_is_one_touch_with_its_peak(self):
        bench = Bench()
        for time, force in ((1.0, 0.2), (1.001, 0.5), (1.002, 0.1)):
            bench.look(time, right=force)
        bench.look(1.003)
        (touch,) = touches_of(bench.monitor)
        assert (touch.arm, touch.start, touch.peak, touch.planned) == ("right", 1.0, 0.5, True)
        assert touch.end is None, "it may go on within the gap"
        bench.look(1.003 + GAP)
        assert touches_of(bench.monitor)[0].end == 1.002

    def test_a_short_gap_is_bridged_and_a_long_one_is_not(self):
        bench = Bench()
        short, long = 1.0 + 0.9 * GAP, 1.0 + 3.0 * GAP
        for time, force in ((1.0, 0.2), (1.0 + 0.5 * GAP, 0.0), (short, 0.2), (1.0 + 2.0 * GAP, 0.0), (long, 0.2)):
            bench.look(time, left=force)
        assert [(touch.start, touch.end) for touch in touches_of(bench.monitor)] == [(1.0, short), (long, None)]

    def test_hands_touch_each_for_itself(self):
        bench = Bench()
        bench.look(1.0, left=0.2, right=0.3)
        assert {touch.arm: touch.peak for touch in touches_of(bench.monitor)} == {"left": 0.2, "right": 0.3}

    def test_a_touch_while_a_plan_runs_is_unplanned(self):
        bench = Bench()
        bench.memory["plan_knots"], bench.memory["plan_time"][:2] = 2, [0.0, 2.0]
        bench.look(1.0, left=0.2)
        bench.look(2.5)
        bench.look(3.0, right=0.2)
        assert [touch.planned for touch in touches_of(bench.monitor)] == [False, True]
        assert bench.monitor["unplanned"]

    def test_more_than_can_be_kept_still_count_for_the_peak(self):
        bench = Bench()
        for number in range(MAX_TOUCHES + 3):
            bench.look(1.5 * GAP * number, left=0.2)
            bench.look(1.5 * GAP * number + 1.1 * GAP)
        bench.look(44.0, left=5.0)
        assert len(touches_of(bench.monitor)) == MAX_TOUCHES
        assert bench.monitor["peak"] == 5.0

    def test_solid_contact_of_an_arm_is_unplanned(self):
        bench = Bench()
        bench.look(1.0, arm_contact=1)
        assert bench.monitor["unplanned"]


class TestVerdict:
    def test_none_while_nothing_decides(self):
        bench = Bench()
        bench.look(1.0)
        assert bench.monitor["verdict"] == Verdict.NONE

    def test_ejection_at_its_distance(self):
        bench = Bench()
        base_y = bench.state["base_pose"][1]
        bench.look(1.0, target_pose=(0.0, base_y + 0.599, 0.0))
        assert bench.monitor["verdict"] == Verdict.NONE
        bench.look(1.1, target_pose=(0.0, base_y + 0.601, 0.0))
        assert bench.monitor["verdict"] == Verdict.EJECTION
        assert bench.outcome(FREE).outcome is OutcomeClass.EJECTION

    def test_base_collision_by_a_corner_in_the_base(self):
        bench = Bench()
        bench.look(1.0, target_pose=(0.0, 0.15, 0.0))
        assert bench.monitor["verdict"] == Verdict.BASE_COLLISION
        assert bench.outcome(FREE).outcome is OutcomeClass.BASE_COLLISION

    def test_base_collision_by_solid_contact(self):
        bench = Bench()
        bench.look(1.0, base_contact=1)
        assert bench.monitor["verdict"] == Verdict.BASE_COLLISION

    def test_ejection_comes_before_base_collision(self):
        bench = Bench()
        bench.look(1.0, target_pose=(2.0, 2.0, 0.0), base_contact=1)
        assert bench.monitor["verdict"] == Verdict.EJECTION

    def test_time_limit(self):
        bench = Bench()
        bench.look(44.998)
        assert bench.monitor["verdict"] == Verdict.NONE
        bench.look(45.0)
        assert bench.monitor["verdict"] == Verdict.TIME_LIMIT
        assert bench.outcome(FREE).outcome is OutcomeClass.UNRESOLVED
        assert bench.outcome(FREE).duration == 45.0

    def test_detumbling_alone_has_no_time_limit(self):
        bench = Bench(sequence=Sequence.DETUMBLE_ONLY)
        bench.look(50.0)
        assert bench.monitor["verdict"] == Verdict.NONE

    def test_locked_arms_are_judged_after_their_hold_time(self):
        bench = Bench()
        bench.memory["phase"] = Phase.HOLDING
        bench.look(5.0)
        bench.look(6.998)
        assert bench.monitor["verdict"] == Verdict.NONE
        bench.look(7.0)
        assert bench.monitor["verdict"] == Verdict.LOCKED
        assert bench.outcome().locked_at == 5.0

    def test_stands_once_it_is_given(self):
        bench = Bench()
        bench.look(1.0, base_contact=1)
        bench.look(2.0, base_contact=0, right=9.0, target_pose=(3.0, 3.0, 0.0))
        assert bench.monitor["verdict"] == Verdict.BASE_COLLISION
        assert bench.monitor["verdict_at"] == 1.0
        assert bench.monitor["peak"] == 0.0

    def test_nothing_is_judged_before_a_sequence(self):
        bench = Bench()
        bench.monitor["begun_at"] = math.nan
        bench.look(1.0, right=9.0, base_contact=1)
        assert bench.monitor["verdict"] == Verdict.NONE
        assert bench.monitor["peak"] == 0.0


class TestClosure:
    @pytest.mark.parametrize(
        ("twist", "closed"),
        [((0.0, 0.0, 0.49), True), ((0.0, 0.0, -0.51), False), ((0.09, 0.0, 0.0), True), ((0.0, 0.11, 0.0), False)],
        ids=["slow spin", "fast spin", "slow drift", "fast drift"],
    )
    def test_of_a_slow_target_only(self, twist, closed):
        bench = Bench()
        bench.memory["phase"] = Phase.CAGING
        bench.close_the_hands()
        bench.look(5.0, target_twist=twist)
        assert bool(bench.monitor["closed"])
        assert (not math.isnan(bench.monitor["closed_at"])) == closed

    def test_speed_is_that_relative_to_the_turning_base(self):
        bench = Bench()
        bench.memory["phase"] = Phase.CAGING
        bench.close_the_hands()
        reach = bench.state["target_pose"][1] - bench.state["base_pose"][1]
        bench.look(5.0, target_twist=(-0.45 * reach, 0.0, 0.45), base_twist=(0.0, 0.0, 0.45))
        assert bench.monitor["closed_at"] == 5.0

    def test_freezes_the_peak_to_closure_and_not_the_whole(self):
        bench = Bench()
        bench.memory["phase"] = Phase.CAGING
        bench.look(3.0, right=0.9)
        bench.close_the_hands()
        bench.look(5.0)
        bench.look(5.5, left=1.9)
        assert bench.monitor["peak_to_closure"] == 0.9
        assert bench.monitor["peak"] == 1.9


class TestOutcome:
    def judged(self, *, before: float, after: float, unplanned_after: bool = False, config: MissionConfig = CONFIG):
        """A capture with those peaks before and after closure, locked and held."""
        bench = Bench(config)
        bench.memory["phase"] = Phase.CAGING
        bench.look(3.0, right=before)
        bench.close_the_hands()
        bench.look(5.0)
        if unplanned_after:
            bench.memory["plan_knots"], bench.memory["plan_time"][:2] = 2, [4.0, 6.0]
        bench.look(5.5, left=after)
        bench.memory["phase"] = Phase.HOLDING
        bench.look(6.0)
        bench.look(8.0)
        return bench

    def test_two_readings_of_one_run(self):
        outcome = self.judged(before=0.9, after=1.9).outcome()
        assert outcome.at_first_closure is OutcomeClass.CAGED_FORCE_REDUCED
        assert outcome.at_locked_arms is OutcomeClass.CAGED_FORCE_NOT_REDUCED
        assert outcome.outcome is outcome.at_locked_arms
        assert (outcome.peak_tip_force_to_closure, outcome.peak_tip_force) == (0.9, 1.9)

    def test_one_verdict_whatever_a_study_asks_for_and_whatever_0_1_0_wrote(self):
        config = revised(CONFIG, nested({"judging.rule": "first_closure"}))
        outcome = self.judged(before=0.9, after=1.9, config=config).outcome()
        assert outcome.outcome is OutcomeClass.CAGED_FORCE_NOT_REDUCED
        stored = {**outcome.model_dump(mode="json"), "outcome": "caged_force_reduced"}
        assert Outcome.model_validate_json(json.dumps(stored)) == outcome

    @pytest.mark.parametrize(
        ("force", "expected"),
        [(1.12968, OutcomeClass.CAGED_FORCE_REDUCED), (1.12969, OutcomeClass.CAGED_FORCE_NOT_REDUCED)],
    )
    def test_force_is_reduced_below_its_bound_only(self, force, expected):
        assert self.judged(before=force, after=0.1).outcome().at_first_closure is expected

    def test_unplanned_contact_after_closure_counts_at_the_lock_only(self):
        outcome = self.judged(before=0.5, after=0.5, unplanned_after=True).outcome()
        assert outcome.at_first_closure is OutcomeClass.CAGED_FORCE_REDUCED
        assert outcome.at_locked_arms is OutcomeClass.CAGED_UNPLANNED_CONTACT

    def test_locked_arms_without_a_cage_are_unresolved(self):
        outcome = self.judged(before=0.5, after=0.5).outcome(FREE)
        assert not outcome.caged
        assert outcome.cage_margin is None
        assert outcome.at_locked_arms is OutcomeClass.UNRESOLVED
        assert outcome.at_first_closure is OutcomeClass.CAGED_FORCE_REDUCED

    def test_momentum_error_is_the_largest_change(self):
        bench = Bench()
        bench.look(1.0, momentum=(1e-3, -2e-3, 3e-3))
        bench.look(2.0, momentum=(0.0, 0.0, 0.0))
        assert bench.monitor["momentum_error"] == pytest.approx(6e-3)

    def test_a_new_sequence_forgets_the_last(self):
        bench = self.judged(before=0.9, after=1.9)
        begin_monitoring(bench.monitor, 10.0, np.zeros(3))
        assert touches_of(bench.monitor) == []
        assert bench.monitor["peak"] == 0.0
        assert math.isnan(bench.monitor["closed_at"])
        assert bench.monitor["verdict"] == Verdict.NONE


@pytest.mark.parametrize(
    ("pose", "overlap"),
    [
        ((0.0, 0.35, 0.0), False),
        ((0.0, 0.1549, 0.0), True),
        ((0.0, 0.1551, 0.0), False),
        ((0.0, 0.18, math.pi / 4), True),
    ],
    ids=["start", "just in", "just clear", "corner in"],
)
def test_overlap_with_the_base(pose, overlap):
    bench = Bench()
    bench.state["target_pose"] = pose
    assert overlaps_base(SHAPES, bench.state) == overlap
