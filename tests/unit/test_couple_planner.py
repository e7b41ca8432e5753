"""The planner of the co-moving couple: a mirrored state has the mirrored plan; what cannot be done is dropped."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sim.compiled import FloatArray
from sim.config import MissionConfig
from sim.configurations import nested, revised
from sim.method.co_moving_couple.memory import CANDIDATE, COUPLE_MEMORY, CoupleHandle, Dropped
from sim.method.co_moving_couple.planner import (
    STEP,
    candidate_touch,
    note_gaps,
    roll_out_touch,
    target_at,
    time_to_contact,
    touch_times,
)
from sim.method.method import method_of
from sim.model.clearance import initial_base_pose
from sim.model.robot import chain, initial_joint_angles
from sim.perception.perceived import PERCEIVED
from sim.record import Record, record_of

CONFIG = revised(MissionConfig(), {"method": "co_moving_couple"})
PREDICTIONS = (
    "time", "cost", "force", "manipulability", "clearance", "apart", "base_rotation", "lever_start", "lever_end",
)  # fmt: skip
MIRROR = np.array([-1.0, 1.0, -1.0])
"""Of a pose or twist (x, y, angle), in the plane of symmetry x = 0."""


class Planned:
    """Candidates of one state, rolled out."""

    def __init__(self, target: tuple[float, float, float], twist: tuple[float, float, float], **changes: Any) -> None:
        """Plan for a target that is so; parameters by path with `__` for the dot."""
        paths = {path.replace("__", "."): value for path, value in changes.items()}
        config = revised(CONFIG, nested(paths))
        self.parameters = record_of(config)
        self.handle: CoupleHandle = method_of(config).handle(config, np.zeros(1, COUPLE_MEMORY))
        self.state: Record = np.zeros(1, PERCEIVED)[0]
        self.state["base_pose"] = initial_base_pose(config)
        self.state["joint_angle"] = initial_joint_angles(config.robot.arm)
        self.state["target_pose"], self.state["target_twist"] = target, twist
        self.state["target_inertia"] = config.perception.assumed_inertia
        links = chain(self.handle.fixed[0]["robot"], self.state["base_pose"], self.state["joint_angle"], np.zeros(2))
        self.hands = links.hand_pose

    def candidate(self, index: int, worth: float = math.inf) -> Record:
        """That candidate with its predictions."""
        plan: Record = np.zeros(1, CANDIDATE)[0]
        candidate_touch(self.handle, self.parameters, self.state, index, plan)
        roll_out_touch(self.handle, self.parameters, self.state, self.hands, plan, worth)
        return plan

    def path(self, plan: Record) -> FloatArray:
        """What the last roll-out left: hands' poses and (base rotation, manipulabilities), a row a `STEP`."""
        return self.handle.work[0]["path"][: int(plan["steps"])].copy()

    def first_feasible(self) -> int:
        """The number of the first candidate that is not dropped."""
        return next(index for index in range(90) if self.candidate(index)["dropped_for"] == Dropped.NONE)


TARGET, TWIST = np.array([0.012, 0.355, 0.3]), np.array([0.004, -0.003, 1.4])


@pytest.fixture(scope="module")
def planned() -> Planned:
    """A square beside the middle that drifts and spins counter-clockwise."""
    return Planned(tuple(TARGET), tuple(TWIST))


class TestMirror:
    def test_of_a_state_has_the_same_predictions(self, planned: Planned) -> None:
        mirrored = Planned(tuple(MIRROR * TARGET), tuple(MIRROR * TWIST))
        for index in range(0, 90, 7):
            plan, other = planned.candidate(index), mirrored.candidate(index)
            assert plan["dropped_for"] == other["dropped_for"], index
            for name in PREDICTIONS:
                assert float(other[name]) == pytest.approx(float(plan[name]), rel=1e-6, abs=1e-9), (index, name)

    def test_has_the_hands_change_places(self, planned: Planned) -> None:
        index = planned.first_feasible()
        path = planned.path(planned.candidate(index))
        mirrored = Planned(tuple(MIRROR * TARGET), tuple(MIRROR * TWIST))
        other = mirrored.path(mirrored.candidate(index))
        assert other[:, 0, :2] == pytest.approx(path[:, 1, :2] * MIRROR[:2], abs=1e-9)
        assert other[:, 2, 0] == pytest.approx(-path[:, 2, 0], abs=1e-9)
        assert other[:, 2, 1] == pytest.approx(path[:, 2, 2], abs=1e-9)


class TestCandidate:
    def test_waits_for_a_side_that_comes_to_the_contact_angle(self, planned: Planned) -> None:
        plan = planned.candidate(planned.first_feasible())
        until = time_to_contact(plan, planned.state)
        assert until >= CONFIG.co_moving_couple.search.least_approach_time
        nx, ny = planned.handle.fixed[0]["shape"]["normals"][plan["side"]]
        side = TARGET[2] + TWIST[2] * until + math.atan2(ny, nx)
        assert math.remainder(side - float(plan["contact_angle"]), math.pi / 2) == pytest.approx(0.0, abs=1e-9)

    def test_has_the_force_that_takes_the_energy_out_along_its_arc(self) -> None:
        fast = Planned((0.0, 0.35, 0.3), (0.0, 0.0, 2.5), co_moving_couple__touch__planned_cap=5.0)
        plan, touch = fast.candidate(0), CONFIG.co_moving_couple.touch
        assert plan["force"] > touch.force_floor
        lever = 0.5 * (plan["lever_start"] + plan["lever_end"]) + touch.assumed_friction * 0.075
        work = 2.0 * plan["force"] * lever * plan["arc"]
        assert work == pytest.approx(0.5 * CONFIG.perception.assumed_inertia * (2.5**2 - touch.spin_left**2))

    def test_brakes_the_target_it_rolls_out_to_the_spin_left(self, planned: Planned) -> None:
        plan, pose = planned.candidate(planned.first_feasible()), np.empty(3)
        times = touch_times(plan, planned.parameters["co_moving_couple"], planned.state)
        assert target_at(plan, planned.state, times, times.contact, pose) == pytest.approx(TWIST[2])
        assert pose[:2] == pytest.approx(TARGET[:2] + times.contact * TWIST[:2])
        left = target_at(plan, planned.state, times, times.end, pose)
        assert left == pytest.approx(CONFIG.co_moving_couple.touch.spin_left)
        normal = pose[2] + plan["normal_offset"]
        after = left * (times.end - times.leave)
        assert normal - after == pytest.approx(float(plan["end_angle"]), abs=1e-6)

    def test_follows_the_faces_with_the_tips_while_they_touch(self, planned: Planned) -> None:
        """Seen from the target, each touching tip is its radius off the side, whatever the target does."""
        plan = planned.candidate(planned.first_feasible())
        path, target = planned.path(plan), np.empty(3)
        times = touch_times(plan, planned.parameters["co_moving_couple"], planned.state)
        for step in range(math.ceil(times.contact / STEP), int(times.leave / STEP) - 1):
            target_at(plan, planned.state, times, STEP * (step + 1), target)
            for arm, sign in ((0, -1.0), (1, 1.0)):
                hand, normal = path[step, arm], target[2] + plan["normal_offset"]
                tip = hand[:2] + 0.039749 * np.array([math.cos(hand[2]), math.sin(hand[2])]) - target[:2]
                assert sign * (tip @ (math.cos(normal), math.sin(normal))) == pytest.approx(0.09, abs=1e-6)


class TestGaps:
    @staticmethod
    def noted(left: tuple[float, float, float], right: tuple[float, float, float], base: FloatArray) -> float:
        """The least gap between hands and base at these poses."""
        handle = Planned(tuple(TARGET), tuple(TWIST)).handle
        plan, now = np.zeros(1, CANDIDATE)[0], handle.work[0]
        plan["apart"], now["base"] = 1.0, base
        now["links"]["hand_pose"] = left, right
        note_gaps(handle, plan)
        return float(plan["apart"])

    @pytest.mark.parametrize("turned", [0.0, 0.7])
    def test_are_from_tip_to_tip_of_hands_that_face_each_other(self, turned: float) -> None:
        hand, gap, c, s = CONFIG.robot.arm.hand, 0.004, math.cos(turned), math.sin(turned)
        across = gap + 2.0 * hand.tip_radius
        left, right = (0.0, 0.0, turned), (-across * s, across * c, turned + math.pi)
        assert self.noted(left, right, np.array([0.0, -5.0, 0.3])) == pytest.approx(gap)

    def test_count_the_palm_as_well_as_the_tips(self) -> None:
        hand = CONFIG.robot.arm.hand
        depth = hand.centre_offset
        left, right = (0.0, 0.0, 0.0), (0.0, -2.0 * depth - 0.05, math.pi)
        assert self.noted(left, right, np.array([0.0, 5.0, 0.0])) == pytest.approx(0.05 - 2.0 * hand.tip_radius)

    def test_are_to_the_base_in_its_own_axes(self) -> None:
        base, hand = CONFIG.robot.base, CONFIG.robot.arm.hand
        ahead = 0.5 * base.depth - base.centre_of_mass_ahead
        turned = 0.4
        # Both tips as far before the base's front as the gap says; the other hand far away.
        out = ahead + 0.007 + hand.tip_radius
        x, y = -out * math.sin(turned), out * math.cos(turned)
        left = (x, y, turned + math.pi)
        assert self.noted(left, (9.0, 9.0, 0.0), np.array([0.0, 0.0, turned])) == pytest.approx(0.007)


class TestDropped:
    def test_is_only_what_cannot_be_better_than_what_was_found(self, planned: Planned) -> None:
        index = planned.first_feasible()
        whole = planned.candidate(index)
        just_better = planned.candidate(index, float(whole["cost"]) + 1e-9)
        assert just_better["dropped_for"] == Dropped.NONE
        assert just_better["cost"] == whole["cost"]
        no_better = planned.candidate(index, 0.5 * float(whole["cost"]))
        assert no_better["dropped_for"] == Dropped.COSTLIER
        assert no_better["steps"] < whole["steps"]

    def test_for_manipulability_where_the_target_is_out_of_reach(self) -> None:
        far = Planned((0.0, 0.62, 0.3), (0.0, 0.0, 1.4))
        troubles = [int(far.candidate(index)["dropped_for"]) for index in range(0, 90, 5)]
        assert Dropped.MANIPULABILITY in troubles
        assert Dropped.NONE not in troubles

    def test_for_base_rotation_where_little_of_it_is_allowed(self) -> None:
        strict = Planned(tuple(TARGET), tuple(TWIST), co_moving_couple__search__most_base_rotation=0.01)
        troubles = [int(strict.candidate(index)["dropped_for"]) for index in range(0, 90, 5)]
        assert Dropped.BASE in troubles
        assert Dropped.NONE not in troubles

    def test_for_the_hands_where_they_would_come_near_the_base(self) -> None:
        near = Planned((0.0, 0.26, 0.3), (0.0, 0.0, 1.0))
        troubles = [int(near.candidate(index)["dropped_for"]) for index in range(0, 90, 5)]
        assert Dropped.HANDS in troubles

    def test_for_the_hands_where_they_should_be_farther_apart(self, planned: Planned) -> None:
        index = planned.first_feasible()
        apart = float(planned.candidate(index)["apart"])
        strict = Planned(tuple(TARGET), tuple(TWIST), co_moving_couple__search__least_apart=apart + 1e-6)
        assert strict.candidate(index)["dropped_for"] == Dropped.HANDS

    def test_for_clearance_where_much_of_it_is_wanted(self) -> None:
        strict = Planned(tuple(TARGET), tuple(TWIST), co_moving_couple__search__least_clearance=0.05)
        troubles = {int(strict.candidate(index)["dropped_for"]) for index in range(0, 90, 5)}
        assert Dropped.CLEARANCE in troubles
        assert Dropped.NONE not in troubles


def test_a_roll_out_leaves_the_state_as_it_was(planned: Planned) -> None:
    before = planned.state.tobytes()
    first = planned.candidate(4)
    again = planned.candidate(4)
    assert planned.state.tobytes() == before
    assert first.tobytes() == again.tobytes()
