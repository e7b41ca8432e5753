"""The contact law of one tip: normals, corners, never pulling, friction cone, damping."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from sim.config import ContactConfig, CornerContact
from sim.model.planar import rotated
from sim.model.shape import circle, even_plate, rectangle, regular_polygon, surface
from sim.plant.contact import penetration, tip_contact
from sim.record import code_of, record_of

HALF, RADIUS = 0.075, 0.015
SQUARE = rectangle(2 * HALF, 2 * HALF)
WEDGE = even_plate(np.array([[0.0, 0.0], [0.14, 0.0], [0.11, 0.10], [0.0, 0.13]]))
OTHERS = (rectangle(0.2, 0.1), regular_polygon(6, 0.08), circle(0.075), WEDGE)
FACE, RADIAL = code_of(CornerContact.FACE), code_of(CornerContact.RADIAL)
ROUNDING = 1e-12
compiling = settings(deadline=None)  # the first example may compile
near_the_target = st.floats(-HALF - RADIUS, HALF + RADIUS)
speeds = st.floats(-0.5, 0.5)


def touched(*, tip, hand_twist=(0.0, 0.0, 0.0), target_pose=(0.0, 0.0, 0.0), target_twist=(0.0, 0.0, 0.0), **law):
    """The contact of a tip centred at a world point, its hand's reference point there too."""
    record = record_of(ContactConfig(**law))
    hand_pose = np.array([*tip, 0.0])
    arrays = [np.array(values, dtype=float) for values in (hand_twist, target_pose, target_twist)]
    return tip_contact(record, SQUARE, RADIUS, float(tip[0]), float(tip[1]), hand_pose, *arrays)


class TestPenetration:
    @pytest.mark.parametrize("corner", [FACE, RADIAL])
    @pytest.mark.parametrize(
        ("point", "normal"),
        [((0.085, 0.02), (1, 0)), ((-0.085, 0.02), (-1, 0)), ((0.02, 0.085), (0, 1)), ((-0.02, -0.085), (0, -1))],
    )
    def test_beside_a_face(self, corner, point, normal):
        depth, *found = penetration(SQUARE, RADIUS, corner, *point)
        assert depth == pytest.approx(0.005)
        assert found == list(normal)

    @pytest.mark.parametrize("corner", [FACE, RADIAL])
    def test_beyond_reach_of_a_corner_there_is_none(self, corner):
        assert penetration(SQUARE, RADIUS, corner, HALF + 0.012, HALF + 0.012)[0] <= 0.0

    def test_beside_a_corner_the_face_formula_takes_the_face_penetrated_least(self):
        depth, *normal = penetration(SQUARE, RADIUS, FACE, HALF + 0.010, HALF + 0.004)
        assert depth == pytest.approx(RADIUS - 0.010)
        assert normal == [1.0, 0.0]

    def test_beside_a_corner_the_radial_formula_points_from_the_corner(self):
        depth, *normal = penetration(SQUARE, RADIUS, RADIAL, -HALF - 0.006, HALF + 0.008)
        assert depth == pytest.approx(RADIUS - 0.010)
        assert normal == pytest.approx([-0.6, 0.8])

    @compiling
    @given(st.floats(0.0, 2.0 * math.pi), st.floats(1e-4, 0.014))
    def test_radial_is_continuous_around_a_corner(self, angle, distance):
        """Neither depth nor normal jumps on any way around the corner, outside the square."""
        step = 1e-9

        def at(turn):
            return np.array(
                penetration(SQUARE, RADIUS, RADIAL, HALF + distance * math.cos(turn), HALF + distance * math.sin(turn))
            )

        outside = math.cos(angle) > 1e-6 or math.sin(angle) > 1e-6
        assume(outside)
        assert np.abs(at(angle + step) - at(angle)).max() < 1e-6

    @compiling
    @given(st.sampled_from(OTHERS), st.floats(-0.15, 0.15), st.floats(-0.15, 0.15))
    def test_any_other_shape_is_rounded_cleanly_whatever_the_choice(self, shape, x, y):
        distance, *normal = surface(shape, x, y)
        for corner in (FACE, RADIAL):
            assert penetration(shape, RADIUS, corner, x, y) == (RADIUS - distance, *normal)

    @compiling
    @given(st.floats(-HALF - RADIUS, HALF + RADIUS), st.floats(-HALF - RADIUS, HALF + RADIUS))
    def test_the_face_formula_is_the_authors(self, x, y):
        """Within a tip radius of a square the face penetrated least, as if it went on; radial farther away."""
        beyond_x, beyond_y = abs(x) - HALF, abs(y) - HALF
        assume(abs(beyond_x - beyond_y) > 1e-12)
        depth, nx, ny = penetration(SQUARE, RADIUS, FACE, x, y)
        outside = math.hypot(max(beyond_x, 0.0), max(beyond_y, 0.0))
        if outside >= RADIUS:
            assert depth <= 0.0
        else:
            assert depth == RADIUS - max(beyond_x, beyond_y)
            assert abs(nx) == float(beyond_x > beyond_y)
            assert abs(ny) == float(beyond_y > beyond_x)
            assert nx * x >= 0.0
            assert ny * y >= 0.0

    def test_the_face_formula_jumps_at_a_corner(self):
        """The documented exception: a hair to one side of the diagonal the normal is another."""
        one = penetration(SQUARE, RADIUS, FACE, HALF + 0.005 + 1e-9, HALF + 0.005)
        other = penetration(SQUARE, RADIUS, FACE, HALF + 0.005, HALF + 0.005 + 1e-9)
        assert one[1:] == (1.0, 0.0)
        assert other[1:] == (0.0, 1.0)

    @compiling
    @given(near_the_target, near_the_target, st.sampled_from([FACE, RADIAL]))
    def test_normal_is_a_unit_vector_and_the_square_symmetric(self, x, y, corner):
        assume(abs(abs(x) - abs(y)) > 1e-9)
        depth, nx, ny = penetration(SQUARE, RADIUS, corner, x, y)
        assert math.hypot(nx, ny) == pytest.approx(1.0)
        mirrored = penetration(SQUARE, RADIUS, corner, -x, y)
        assert mirrored[0] == depth
        if abs(x) > 1e-9:
            assert mirrored[1:] == pytest.approx((-nx, ny), abs=ROUNDING)


class TestForce:
    def test_none_without_contact(self):
        contact = touched(tip=(0.2, 0.0))
        assert not contact.touching
        assert (contact.force_x, contact.force_y) == (0.0, 0.0)

    def test_spring(self):
        contact = touched(tip=(HALF + RADIUS - 0.002, 0.01))
        assert contact.touching
        assert contact.force_x == pytest.approx(800.0 * 0.002)
        assert contact.force_y == pytest.approx(0.0, abs=ROUNDING)
        assert (contact.point_x, contact.point_y) == pytest.approx((HALF - 0.002, 0.01))

    def test_damper_adds_to_an_approach_and_takes_from_a_retreat(self):
        tip = (HALF + RADIUS - 0.002, 0.0)
        approach = touched(tip=tip, hand_twist=(-0.1, 0.0, 0.0)).force_x
        retreat = touched(tip=tip, hand_twist=(0.1, 0.0, 0.0)).force_x
        assert approach == pytest.approx(1.6 + 2.0 * 0.1)
        assert retreat == pytest.approx(1.6 - 2.0 * 0.1)

    def test_never_pulls(self):
        assert touched(tip=(HALF + RADIUS - 1e-4, 0.0), hand_twist=(5.0, 0.0, 0.0)).force_x == 0.0

    def test_friction_opposes_sliding_and_reaches_its_full_value(self):
        contact = touched(tip=(HALF + RADIUS - 0.002, 0.0), hand_twist=(0.0, 0.2, 0.0))
        assert contact.force_y == pytest.approx(-0.3 * contact.force_x)

    def test_friction_is_smooth_through_zero_sliding(self):
        tip, speed = (HALF + RADIUS - 0.002, 0.0), 1e-3
        slow = touched(tip=tip, hand_twist=(0.0, speed, 0.0), friction_speed=speed)
        assert slow.force_y == pytest.approx(-0.3 * math.tanh(1.0) * slow.force_x)

    def test_the_targets_spin_drags_the_tip_along(self):
        contact = touched(tip=(HALF + RADIUS - 0.002, 0.0), target_twist=(0.0, 0.0, 1.0))
        assert contact.force_y > 0.0

    @compiling
    @given(
        near_the_target,
        near_the_target,
        speeds,
        speeds,
        speeds,
        st.sampled_from(["face", "radial"]),
        st.floats(0.0, 1.0),
    )
    def test_lies_in_the_friction_cone_of_its_normal(self, x, y, vx, vy, spin, corner, friction):
        contact = touched(
            tip=(x, y), hand_twist=(vx, vy, 0.0), target_twist=(0.0, 0.0, spin), corner=corner, friction=friction
        )
        assume(contact.touching)
        _, nx, ny = penetration(SQUARE, RADIUS, FACE if corner == "face" else RADIAL, x, y)
        normal = contact.force_x * nx + contact.force_y * ny
        sliding = -contact.force_x * ny + contact.force_y * nx
        assert normal >= 0.0
        assert abs(sliding) <= friction * normal * (1 + 1e-9) + ROUNDING

    @compiling
    @given(near_the_target, near_the_target, st.floats(-3.0, 3.0), speeds, speeds, speeds)
    def test_turns_with_the_world(self, x, y, turn, vx, vy, spin):
        """Nothing in the law knows north: everything turned together turns the force, and where it acts."""
        assume(abs(abs(x) - abs(y)) > 1e-9)
        still = touched(tip=(x, y), hand_twist=(vx, vy, 0.0), target_twist=(0.0, 0.0, spin))
        turned = touched(
            tip=rotated(turn, x, y),
            hand_twist=(*rotated(turn, vx, vy), 0.0),
            target_pose=(0.0, 0.0, turn),
            target_twist=(0.0, 0.0, spin),
        )
        assume(still.touching == turned.touching)  # on the very edge rounding decides
        assert rotated(turn, still.force_x, still.force_y) == pytest.approx((turned.force_x, turned.force_y), abs=1e-6)
        assert rotated(turn, still.point_x, still.point_y) == pytest.approx((turned.point_x, turned.point_y), abs=1e-9)

    def test_depends_on_relative_motion_only(self):
        tip = (HALF + RADIUS - 0.002, 0.01)
        still = touched(tip=tip, hand_twist=(-0.05, 0.02, 0.0))
        carried = touched(tip=tip, hand_twist=(0.25, -0.28, 0.0), target_twist=(0.3, -0.3, 0.0))
        assert (carried.force_x, carried.force_y) == pytest.approx((still.force_x, still.force_y))
