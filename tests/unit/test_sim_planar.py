"""Plane geometry: rotations, angles, velocities of points."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.model.planar import cross, direction, folded, in_frame, point_velocity, rotated, sign

ROUNDING = 1e-12
angles = st.floats(-20.0, 20.0)
lengths = st.floats(-5.0, 5.0)
compiling = settings(deadline=None)  # the first example may compile


@pytest.mark.parametrize(("value", "expected"), [(2.0, 1.0), (0.0, 1.0), (-0.0, 1.0), (-1e-300, -1.0)])
def test_sign_counts_zero_as_positive(value, expected):
    assert sign(value) == expected


def test_direction_is_cosine_and_sine_to_the_last_place():
    angles = np.concatenate([np.linspace(-20.0, 20.0, 4001), np.pi / 4 * np.arange(-9, 10), [1e-9, 1e5, -9.9e5]])
    ours = np.array([direction(float(angle)) for angle in angles])
    for place, exact in enumerate((np.cos(angles), np.sin(angles))):
        off = np.abs(ours[:, place] - exact)
        assert (off <= 2.0 * np.spacing(np.abs(exact)) + 1e-22).all()


def test_direction_of_no_number_is_none():
    assert all(math.isnan(value) for angle in (math.nan, math.inf) for value in direction(angle))


def test_rotated_by_a_quarter_turn_takes_x_to_y():
    assert rotated(math.pi / 2, 1.0, 0.0) == pytest.approx((0.0, 1.0))


@compiling
@given(angles, lengths, lengths)
def test_rotated_keeps_lengths_and_turns_back(angle, x, y):
    u, v = rotated(angle, x, y)
    assert math.hypot(u, v) == pytest.approx(math.hypot(x, y), abs=ROUNDING)
    assert rotated(-angle, u, v) == pytest.approx((x, y), abs=ROUNDING)


@compiling
@given(lengths, lengths, angles)
def test_in_frame_undoes_a_pose(x, y, angle):
    pose = np.array([0.2, -0.4, angle])
    dx, dy = rotated(angle, x, y)
    assert in_frame(pose, pose[0] + dx, pose[1] + dy) == pytest.approx((x, y), abs=1e-11)


@compiling
@given(angles, st.sampled_from([math.pi / 2, math.pi, 2 * math.pi]))
def test_folded_is_the_nearest_representative(angle, period):
    nearest = folded(angle, period)
    assert abs(nearest) <= period / 2 + ROUNDING
    turns = (angle - nearest) / period
    assert turns == pytest.approx(round(turns), abs=1e-9)


def test_cross_is_the_torque_of_a_force():
    assert cross(2.0, 0.0, 0.0, 3.0) == 6.0
    assert cross(0.0, 2.0, 3.0, 0.0) == -6.0


@compiling
@given(lengths, lengths, lengths, st.floats(-3.0, 3.0), lengths, lengths)
def test_point_velocity_is_the_derivative_of_a_point_of_the_body(vx, vy, angle, spin, x, y):
    pose, twist = np.array([0.3, -0.2, angle]), np.array([vx, vy, spin])
    step = 1e-6

    def place(time):
        dx, dy = rotated(spin * time, x - pose[0], y - pose[1])
        return np.array([pose[0] + vx * time + dx, pose[1] + vy * time + dy])

    difference = (place(step) - place(-step)) / (2 * step)
    assert np.allclose(point_velocity(pose, twist, x, y), difference, atol=1e-7)
