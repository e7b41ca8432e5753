"""What a reading may be: by itself, by both clocks, and after the one before it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from server.link import trust
from server.link.bounds import Bounds, WristFrame
from server.link.identity import MOST_OTHERS, SILENCE, Identity
from server.link.wire import JointSample, PlaneSample
from server.settings import Settings
from sim.errors import Cause

MS = 1_000_000
SECOND = 1000 * MS
NOW = 1_764_000_000 * SECOND
YEAR = 86400 * 365.25
BOUNDS = Bounds()
HAND = WristFrame(frame="left_hand")


def _plane(value, rest=(0.0, 0.0, 0.0), frame="left_hand", stamp=NOW):
    return PlaneSample(stamp, frame, np.array(value, float), np.array(rest, float))


@pytest.mark.parametrize(
    ("age", "words"),
    [
        (0.012, ""),
        (-0.004, ""),
        (0.5, "measured 500 ms ago"),
        (3600.0, "measured 3.6e+03 s ago"),
        (4 * 3600.0, "measured 4 h ago"),
        (56 * YEAR, "measured 56 years ago"),
        (-0.5, "stamped 500 ms in the future"),
        (-56 * YEAR, "stamped 56 years in the future"),
    ],
)
@pytest.mark.parametrize("known", [True, False])
def test_a_stamp_is_of_now_by_both_clocks_or_by_the_joint_states(age, words, known):
    times = trust.Times(NOW if known else None, NOW, 0.1)
    told = trust.stamp_fault(NOW - round(age * SECOND), times, BOUNDS)
    assert bool(told) == bool(words)
    assert words in told
    assert ("joint states" in told) == (bool(words) and not known)
    assert age < 0.1 or "at most 100 ms" in told


def test_before_either_clock_is_known_no_stamp_is_refused():
    assert not trust.stamp_fault(NOW, trust.Times(None, 0, 0.1), BOUNDS)


def test_a_stamp_that_stands_still_or_runs_back_is_said():
    assert "stands still" in trust.order_fault(NOW, NOW)
    assert "runs back: 3000 ms" in trust.order_fault(NOW, NOW + 3 * SECOND)


@pytest.mark.parametrize(
    ("frame", "words"), [("left_hand", ""), ("left_sensor", "'left_sensor', not in 'left_hand'"), ("", "is empty")]
)
def test_a_frame_is_known_by_its_name(frame, words):
    told = trust.frame_fault(frame, "left_hand")
    assert words in told
    assert bool(told) == bool(words)


@pytest.mark.parametrize(
    ("what", "value", "words"),
    [
        ("angle", 2.5, ""),
        ("angle", 71.6, "looks like degrees"),
        ("angle", -1e308, "at most"),
        ("rate", 9.9, ""),
        ("rate", 57.3, "looks like degrees"),
        ("rate", 1e308, "at most"),
    ],
)
def test_joints_in_degrees_are_suspected(what, value, words):
    numbers: dict[str, Any] = {"angle": np.zeros((2, 3)), "rate": np.zeros((2, 3))}
    numbers[what][1, 1] = value
    told = trust.joints_fault(JointSample(NOW, **numbers), BOUNDS)
    assert words in told
    assert bool(told) == bool(words)
    assert not words or f"{what} of right_joint_2" in told


@pytest.mark.parametrize("rate", [0.05, -0.5])
@pytest.mark.parametrize("factor", [1.0, math.degrees(1.0)])
def test_rates_in_degrees_beside_angles_in_radians_are_noticed(rate, factor):
    watch, found = trust.JointWatch(), None
    for step in range(200):
        angle = np.full((2, 3), rate * 0.005 * step)
        found = found or watch.drift(JointSample(NOW + 5 * MS * step, angle, np.full((2, 3), rate * factor)))
    assert (found is not None) == (factor > 1.0)
    assert found is None or (found.cause is Cause.READING_REFUSED and "degrees" in found.message)


def test_a_joint_that_jumps_is_named():
    watch, angle = trust.JointWatch(), np.zeros((2, 3))
    assert watch.drift(JointSample(NOW, angle, angle)) is None
    angle = angle.copy()
    angle[0, 2] = 0.5
    trouble = watch.drift(JointSample(NOW + 5 * MS, angle, np.zeros((2, 3))))
    assert trouble == (Cause.READING_JUMPED, "left_joint_3 jumped by 0.500 rad in 5 ms")


@pytest.mark.parametrize(
    ("value", "rest", "words"),
    [
        ((0.5, -0.4, 3.0), (0.01, 0.01, 0.0), ""),
        ((350.0, 0.0, 0.0), (0.0, 0.0, 0.0), "millimetres"),
        ((0.0, -1e308, 0.0), (0.0, 0.0, 0.0), "outside of the testbed"),
        ((0.0, 0.0, 0.0), (0.8, 0.0, 0.0), "z = 0.8 m"),
        ((0.0, 0.0, 0.0), (0.0, math.pi / 2, 0.0), "tilted by 1.57 rad (90 degrees)"),
    ],
)
def test_a_pose_is_on_the_testbed_and_in_its_plane(value, rest, words):
    told = trust.pose_fault(_plane(value, rest), BOUNDS)
    assert words in told
    assert bool(told) == bool(words)


@pytest.mark.parametrize(
    ("value", "rest", "words"),
    [
        ((0.1, 0.1, 3.0), (0.01, 0.02, 0.02), ""),
        ((1e308, 1e308, 0.0), (0.0, 0.0, 0.0), "moves at"),
        ((0.0, 0.0, 57.3), (0.0, 0.0, 0.0), "spins at"),
        ((0.0, 0.0, 0.0), (0.5, 0.0, 0.0), "moves out of the plane"),
        ((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), "turns out of the plane"),
    ],
)
def test_a_twist_is_in_the_plane(value, rest, words):
    told = trust.twist_fault(_plane(value, rest), BOUNDS)
    assert words in told
    assert bool(told) == bool(words)


@pytest.mark.parametrize(
    ("value", "rest", "words"),
    [
        ((20.0, -20.0, 1.0), (5.0, 0.1, 0.1), ""),
        ((1e300, 0.0, 0.0), (0.0, 0.0, 0.0), "force 1e+300 N"),
        ((0.0, 0.0, 0.0), (-51.0, 0.0, 0.0), "force 51 N"),
        ((0.0, 0.0, -6.0), (0.0, 0.0, 0.0), "torque 6 N m"),
    ],
)
def test_a_wrench_is_within_the_sensors_range(value, rest, words):
    told = trust.WristWatch(HAND, BOUNDS).fault(_plane(value, rest))
    assert words in told
    assert bool(told) == bool(words)


def test_a_blow_of_one_reading_is_a_jump_and_a_hard_touch_is_none():
    watch = trust.WristWatch(HAND, BOUNDS)
    forces = [0.0, 1.0, 3.0, 5.0, 4.0, 3.0]  # rises by 2 N a reading: harder than any capture's blow
    told = [watch.jump(_plane((force, 0, 0), stamp=NOW + i * 5 * MS)) for i, force in enumerate(forces)]
    assert not any(told)
    assert "force jumped by 17 N in 5 ms" in watch.jump(_plane((20.0, 0, 0), stamp=NOW + 30 * MS))
    assert "force jumped by 20 N" in watch.jump(_plane((0.0, 0, 0), stamp=NOW + 35 * MS))
    assert "torque jumped by 0.3 N m" in watch.jump(_plane((0.0, 0, 0.3), stamp=NOW + 40 * MS))


def test_what_changed_while_readings_were_lost_is_no_jump():
    watch = trust.WristWatch(HAND, BOUNDS)
    watch.jump(_plane((0.0, 0, 0)))
    assert not watch.jump(_plane((6.0, 0, 0), stamp=NOW + 10 * MS))


def test_a_wrench_of_a_sensor_is_the_hands():
    # A sensor 40 mm along the hand's y, turned by half a turn, that tells what the hand does to the target.
    sensor = WristFrame(frame="left_sensor", angle=math.pi, x=0.0, y=0.04, sign=-1)
    np.testing.assert_allclose(sensor.in_hand(np.array([1.0, 2.0, 0.3])), [1.0, 2.0, -0.3 - 0.04], atol=1e-12)
    np.testing.assert_array_equal(HAND.in_hand(np.array([1.0, 2.0, 0.3])), [1.0, 2.0, 0.3])


def test_bounds_and_frames_are_settings():
    settings = Settings.model_validate(
        {"link_bounds": "force=100, tilt=0.2", "link_left_wrist": "frame=ft_left,angle=3.1416,y=0.04,sign=-1"}
    )
    assert (settings.link_bounds.force, settings.link_bounds.tilt) == (100.0, 0.2)
    assert settings.link_left_wrist == WristFrame(frame="ft_left", angle=3.1416, y=0.04, sign=-1)
    for wrong in ({"link_bounds": "forse=1"}, {"link_bounds": "force=inf"}, {"link_left_wrist": "frame=a,sign=2"}):
        with pytest.raises(ValueError, match=r"forse|finite|sign"):
            Settings.model_validate(wrong)


def test_the_first_robot_is_the_one_and_another_beside_it_grounds_both():
    identity = Identity()
    assert not identity.refusal("a.1", 10.0)
    assert "another robot, b.1, beside a.1" in identity.refusal("b.1", 10.1)
    assert identity.robot == "a.1"
    assert "two robots" in str(identity.trouble(10.2))
    identity.refusal("a.1", 10.2 + SILENCE)
    assert identity.trouble(10.2 + SILENCE) is None
    assert not identity.refusal("b.1", 10.3 + 2 * SILENCE)  # the first is gone
    assert identity.robot == "b.1"
    assert identity.trouble(10.3 + 2 * SILENCE) is None


def test_a_robot_that_is_not_the_named_one_is_refused():
    identity = Identity("b")
    assert "this console flies b" in identity.refusal("a.1", 10.0)
    assert identity.robot == ""
    assert "this console flies b" in str(identity.trouble(10.0))
    assert not identity.refusal("b.7", 10.1)


def test_ever_new_identities_fill_no_memory():
    identity = Identity()
    identity.refusal("a.1", 10.0)
    for number in range(1000):
        identity.refusal(f"x.{number}", 10.0)
    assert len(identity.others(10.0)) == MOST_OTHERS
