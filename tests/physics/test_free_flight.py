"""Free flight of the pymunk plant for a simulated minute: the invariants of mission.md, "Figures to reach"."""

from __future__ import annotations

import numpy as np
import pytest

from tests.physics.free_flight import fly_freely, reference_base_pose, remote_target

MINUTE = 60.0

LINEAR_MOMENTUM = 1e-12
"""[N s] a minute. Impulses act in opposite pairs, so that only rounding remains."""
ANGULAR_MOMENTUM = 5e-8
"""[N m s] a minute. A pivot's two anchors part by the joint drift, and its impulses by as much."""
JOINT_DRIFT = 1e-6
"""[m]. What the joints leave of one step's centrifugal parting."""
BASE_ATTITUDE = 1e-6
"""[rad]. Of the reduced-coordinate reference, after a minute."""
BASE_POSITION = 1e-6
"""[m]. The base moves by its lever arm, 0.1 to 0.3 m, times its attitude; the same bound is kept."""


@pytest.fixture(scope="module")
def flight():
    return fly_freely(remote_target(), MINUTE)


def test_the_minute_is_one_of_real_motion(flight):
    """The joints swing by tens of degrees and the base turns with them: the invariants are not trivially held."""
    assert np.ptp(flight.shape[:, :6], axis=0).min() > 0.3
    assert np.ptp(flight.base_pose[:, 2]) > 0.1


def test_linear_momentum_is_conserved(flight):
    assert np.abs(flight.momentum[:, :2] - flight.momentum[0, :2]).max() < LINEAR_MOMENTUM


def test_angular_momentum_is_conserved(flight):
    assert np.abs(flight.momentum[:, 2] - flight.momentum[0, 2]).max() < ANGULAR_MOMENTUM


def test_joints_hold_together(flight):
    assert flight.gap.max() < JOINT_DRIFT


def test_hand_mounts_stay_where_they_are_without_contact(flight):
    assert np.abs(flight.shape[:, 6:]).max() < JOINT_DRIFT


def test_base_follows_the_reduced_coordinate_reference(flight):
    error = flight.base_pose[-1] - reference_base_pose(remote_target(), flight)
    assert np.abs(error[:2]).max() < BASE_POSITION
    assert abs(error[2]) < BASE_ATTITUDE


def test_base_returns_turned_after_a_closed_loop_of_the_joints(flight):
    """A free-flyer is not holonomic: joints back where they were, the base is not (and the plant knows it)."""
    away = np.abs(flight.shape - flight.shape[0]).max(axis=1)
    later = flight.time > 5.0
    place = np.flatnonzero(later)[away[later].argmin()]
    assert abs(flight.base_pose[place, 2] - flight.base_pose[0, 2]) > 1e3 * BASE_ATTITUDE
