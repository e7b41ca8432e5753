"""Plans: touch (eq. 4, 5), closing, release; straight paths with cubic time scaling."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.config import MissionConfig
from sim.configurations import nested, revised
from sim.control.memory import MEMORY
from sim.control.trajectory import BOTH_ARMS, follow, plan_end, plan_opening, time_scaling
from sim.method.published.memory import PlanKind
from sim.method.published.plans import plan_cage, plan_touch, time_to_angle
from sim.perception.perceived import PERCEIVED
from sim.record import record_of

compiling = settings(deadline=None)  # the first example may compile
PARAMETERS = record_of(MissionConfig())
START_HANDS = np.array([[-0.1984, 0.385, -math.pi / 2], [0.1984, 0.385, math.pi / 2]])
CORNER_CIRCLE = 0.075 * math.sqrt(2.0) + 0.015
TIP = 0.039749
PLAN_TIME = 2e-3
"""[s]: the document's times of the first plan are counted in the authors' steps of 1 ms."""


def state_of(target_pose=(0.0, 0.35, 0.0), target_twist=(0.0, 0.0, 1.0), time=0.0):
    state = np.zeros(1, PERCEIVED)[0]
    state["target_pose"], state["target_twist"], state["time"] = target_pose, target_twist, time
    return state


def touch_plan(parameters=PARAMETERS, **state):
    memory = np.zeros(1, MEMORY)[0]
    plan_touch(memory, parameters, state_of(**state), START_HANDS)
    return memory


def cage_plan(parameters=PARAMETERS, capture_time=0.6, **state):
    memory = np.zeros(1, MEMORY)[0]
    plan_cage(memory, parameters, state_of(**state), START_HANDS, capture_time)
    return memory


class TestTimeScaling:
    def test_begins_and_ends_at_rest(self):
        assert time_scaling(0.0) == (0.0, 0.0)
        assert time_scaling(1.0) == (1.0, 0.0)
        assert time_scaling(0.5) == (0.5, 1.5)

    @compiling
    @given(st.floats(0.001, 0.999))
    def test_rises_and_its_rate_is_its_derivative(self, part):
        step = 1e-6
        difference = (time_scaling(part + step)[0] - time_scaling(part - step)[0]) / (2 * step)
        assert time_scaling(part)[1] == pytest.approx(difference, abs=1e-8)
        assert time_scaling(part)[1] > 0.0


class TestTimeToAngle:
    @compiling
    @given(st.floats(-6.0, 6.0), st.floats(0.01, 5.0), st.booleans(), st.floats(0.1, 5.0))
    def test_a_corner_is_there_then_and_not_sooner_than_allowed(self, angle, speed, clockwise, at_least):
        spin = -speed if clockwise else speed
        time = time_to_angle(angle, spin, at_least)
        assert time >= at_least - 1e-9
        turned_too_far = (spin * time - angle) / (math.pi / 2)
        assert turned_too_far == pytest.approx(round(turned_too_far), abs=1e-6)

    def test_is_the_first_such_time(self):
        assert time_to_angle(0.3, 1.0, 0.1) == pytest.approx(0.3)
        assert time_to_angle(0.3, 1.0, 0.4) == pytest.approx(0.3 + math.pi / 2)


class TestTouchPlan:
    def test_first_plan_has_the_published_times(self):
        memory = touch_plan()
        assert memory["plan_kind"] == PlanKind.TOUCH
        assert memory["plan_time"][1] == pytest.approx(2.144, abs=PLAN_TIME)
        assert memory["plan_time"][2] - memory["plan_time"][1] == pytest.approx(1.051, abs=PLAN_TIME)

    @pytest.mark.parametrize(("drift", "arm"), [(0.0, 1), (0.02, 1), (-0.02, 0), (-1e-9, 0)])
    def test_arm_is_the_one_that_the_target_drifts_to(self, drift, arm):
        assert touch_plan(target_twist=(drift, 0.0, 1.0))["plan_arm"] == arm

    @pytest.mark.parametrize("drift", [0.03, -0.03])
    @pytest.mark.parametrize("spin", [1.0, -1.0, 0.55])
    def test_tip_meets_the_face_where_it_will_be(self, drift, spin):
        """Eq. 4: at the target's tilt of contact, the tip rests on the face, alpha from its middle towards the edge."""
        memory = touch_plan(target_twist=(drift, 0.0, spin), target_pose=(0.01, 0.36, 0.2))
        arm, end = int(memory["plan_arm"]), memory["plan_time"][2]
        x, y, angle = memory["plan_pose"][arm, 2]
        centre = np.array([0.01 + drift * end, 0.36])
        tilt = math.copysign(math.radians(18), spin)
        c, s = math.cos(-tilt), math.sin(-tilt)
        gaps = []
        for side in (-1.0, 1.0):
            tip = np.array([x, y]) + side * TIP * np.array([math.cos(angle), math.sin(angle)]) - centre
            along, across = c * tip[0] - s * tip[1], s * tip[0] + c * tip[1]
            gaps.append((abs(along) - 0.09, across))
        nearest = min(gaps, key=lambda gap: abs(gap[0]))
        assert nearest[0] == pytest.approx(0.0, abs=1e-9)
        assert max(gaps)[0] > 0.02  # the other tip stays clear of the face
        assert abs(nearest[1]) == pytest.approx(0.75 * 0.075)
        # The lever makes the push slow the spin: force along -sign(drift) at an arm of that sign.
        assert math.copysign(1.0, nearest[1]) == -math.copysign(1.0, drift) * math.copysign(1.0, spin)

    @pytest.mark.parametrize("spin", [1.0, -0.7, 2.5])
    def test_waits_outside_the_circle_of_the_corners(self, spin):
        memory = touch_plan(target_twist=(0.01, 0.0, spin))
        arm, wait = int(memory["plan_arm"]), memory["plan_time"][1]
        x, y, angle = memory["plan_pose"][arm, 1]
        centre = np.array([0.01 * wait, 0.35])
        for side in (-1.0, 1.0):
            tip = np.array([x, y]) + side * TIP * np.array([math.cos(angle), math.sin(angle)]) - centre
            assert np.hypot(*tip) > CORNER_CIRCLE

    def test_wait_is_not_shorter_than_its_minimum(self):
        for spin in (0.6, 1.0, 3.0, 8.0):
            assert touch_plan(target_twist=(0.0, 0.0, spin))["plan_time"][1] >= 1.0 - 1e-9

    def test_a_target_without_spin_is_still_met(self):
        memory = touch_plan(target_twist=(0.02, 0.0, 0.0))
        assert np.isfinite(memory["plan_pose"]).all()
        assert np.isfinite(memory["plan_time"]).all()

    def test_predicts_the_targets_free_motion_to_the_plans_end(self):
        memory = touch_plan(target_twist=(0.02, -0.01, 1.0))
        end = plan_end(memory)
        assert memory["predicted_target"] == pytest.approx([0.02 * end, 0.35 - 0.01 * end, end])

    def test_begins_at_the_hands_present_poses_and_counts(self):
        memory = touch_plan(time=7.0)
        assert memory["plan_pose"][:, 0].tolist() == START_HANDS.tolist()
        assert memory["plan_time"][0] == 7.0
        assert memory["plan_count"] == 1


class TestCagePlan:
    def test_a_slow_target_is_met_at_once_hands_turned_to_it(self):
        memory = cage_plan(target_twist=(0.0, 0.0, 0.2), target_pose=(0.0, 0.35, 0.7))
        assert memory["plan_arm"] == BOTH_ARMS
        assert memory["plan_time"][1] == pytest.approx(1.0)
        turn = 0.7 + 0.2 - math.pi / 4
        assert memory["plan_pose"][1, 1, 2] == pytest.approx(turn + math.pi / 2)

    @pytest.mark.parametrize("spin", [0.4, -0.4, 1.0])
    def test_a_faster_target_is_awaited_without_turning(self, spin):
        memory = cage_plan(target_twist=(0.0, 0.0, spin), target_pose=(0.0, 0.35, 0.1))
        time = memory["plan_time"][1]
        lead = math.radians(19.17) * math.copysign(1.0, spin)
        at_close = (0.1 + spin * time - (math.pi / 4 - lead)) / (math.pi / 2)
        assert at_close == pytest.approx(round(at_close), abs=1e-3)
        assert memory["plan_pose"][1, 1, 2] == pytest.approx(math.pi / 2)
        assert 1.0 <= time <= 1.0 + math.pi / 2 / abs(spin)

    def test_distances_are_the_published_ones(self):
        memory = cage_plan(target_twist=(0.0, 0.0, 0.1))
        for knot, distance in ((1, 0.11779), (2, 0.09389)):
            between = memory["plan_pose"][1, knot, :2] - memory["plan_pose"][0, knot, :2]
            assert np.hypot(*between) / 2 == pytest.approx(distance, abs=5e-6)

    @compiling
    @given(st.floats(-0.6, 0.6), st.floats(-3.0, 3.0), st.floats(-0.05, 0.05))
    def test_hands_face_each_other_across_the_predicted_centre(self, spin, angle, drift):
        memory = cage_plan(target_twist=(drift, 0.01, spin), target_pose=(0.0, 0.35, angle))
        time = memory["plan_time"][1]
        centre = [drift * time, 0.35 + 0.01 * time]
        for knot in (1, 2):
            left, right = memory["plan_pose"][:, knot]
            assert (left[:2] + right[:2]) / 2 == pytest.approx(centre)
            assert right[2] - left[2] == pytest.approx(math.pi)
            assert abs(right[2] - math.pi / 2) <= math.pi / 4 + 1e-9

    def test_capture_time_is_that_given(self):
        memory = cage_plan(capture_time=0.5)
        assert memory["plan_time"][2] - memory["plan_time"][1] == pytest.approx(0.5)


class TestReleasePlan:
    def test_hands_draw_back_along_their_own_axes_without_turning(self):
        memory = np.zeros(1, MEMORY)[0]
        hands = np.array([[-0.09, 0.35, -math.pi / 2 + 0.1], [0.09, 0.35, math.pi / 2 + 0.1]])
        plan_opening(memory, state_of(), hands, PlanKind.RELEASE, 0.20, 2.0)
        for arm in range(2):
            way = memory["plan_pose"][arm, 1, :2] - hands[arm, :2]
            palm = np.array([math.sin(hands[arm, 2]), -math.cos(hands[arm, 2])])
            assert way @ palm == pytest.approx(np.hypot(*way))
            assert (memory["plan_pose"][arm, 1, :2] - [0.0, 0.35]) @ palm == pytest.approx(0.20)
            assert memory["plan_pose"][arm, 1, 2] == hands[arm, 2]

    def test_hands_that_are_far_already_stay(self):
        memory = np.zeros(1, MEMORY)[0]
        hands = np.array([[-0.3, 0.35, -math.pi / 2], [0.3, 0.35, math.pi / 2]])
        plan_opening(memory, state_of(), hands, PlanKind.RELEASE, 0.20, 2.0)
        assert memory["plan_pose"][:, 1] == pytest.approx(hands)


class TestFollow:
    def test_passes_its_knots_at_rest_at_their_times(self):
        memory = touch_plan()
        for knot in range(3):
            follow(memory, float(memory["plan_time"][knot]), 1)
            assert memory["desired_hand_pose"][1] == pytest.approx(memory["plan_pose"][1, knot])
            assert memory["desired_hand_twist"][1] == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)

    @pytest.mark.parametrize("time", [0.5, 1.7, 2.5, 3.0])
    def test_twist_is_the_derivative_of_the_pose(self, time):
        memory, step = touch_plan(), 1e-6
        poses = []
        for at in (time - step, time + step):
            follow(memory, at, 1)
            poses.append(memory["desired_hand_pose"][1].copy())
        follow(memory, time, 1)
        assert memory["desired_hand_twist"][1] == pytest.approx((poses[1] - poses[0]) / (2 * step), abs=1e-8)

    def test_path_is_a_straight_line(self):
        memory = touch_plan()
        start, end = memory["plan_pose"][1, 0], memory["plan_pose"][1, 1]
        for part in (0.2, 0.5, 0.9):
            follow(memory, float(part * memory["plan_time"][1]), 1)
            done = (
                (memory["desired_hand_pose"][1] - start)[:2]
                @ (end - start)[:2]
                / ((end - start)[:2] @ (end - start)[:2])
            )
            assert memory["desired_hand_pose"][1] == pytest.approx(start + done * (end - start))

    def test_rests_at_the_end(self):
        memory = touch_plan()
        follow(memory, plan_end(memory) + 5.0, 1)
        assert memory["desired_hand_pose"][1] == pytest.approx(memory["plan_pose"][1, 2])
        assert not memory["desired_hand_twist"][1].any()


def test_without_a_plan_its_end_has_long_passed():
    assert plan_end(np.zeros(1, MEMORY)[0]) < -1e6


def test_contact_position_moves_the_touch_along_the_face():
    near_corner = record_of(revised(MissionConfig(), nested({"published.touch.contact_position": 1.0})))
    middle, edge = touch_plan()["plan_pose"][1, 2], touch_plan(near_corner)["plan_pose"][1, 2]
    assert np.hypot(*(edge - middle)[:2]) == pytest.approx(0.25 * 0.075)
