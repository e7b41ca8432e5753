"""Where the co-moving couple puts hands on a target, and what they do there: signs, frames and units by values."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.capture.caging import cage
from sim.compiled import FloatArray
from sim.config import MissionConfig
from sim.configurations import revised
from sim.control.memory import MEMORY
from sim.method.co_moving_couple.geometry import (
    from_target,
    half_side,
    hand_at_tip,
    hand_before_corner,
    tip_distance,
    tip_on_face,
    to_target,
    touching_tip,
)
from sim.method.co_moving_couple.laws import braking_force, close_in, follow_faces, share_forces
from sim.method.co_moving_couple.memory import COUPLE_MEMORY, CoupleHandle
from sim.method.co_moving_couple.reference import corner_towards, touch_pose
from sim.method.method import method_of
from sim.model.robot import tip_position
from sim.model.shape import even_plate, signed_distance
from sim.model.target import target_shape
from sim.perception.perceived import PERCEIVED
from sim.record import Record, packed, record_of

CONFIG = revised(MissionConfig(), {"method": "co_moving_couple"})
PARAMETERS = record_of(CONFIG)
TOUCH = CONFIG.co_moving_couple.touch
SQUARE = target_shape(CONFIG.target)
WEDGE = even_plate(np.array([[0.0, 0.0], [0.2, 0.0], [0.0, 0.1]]))
SENSES = pytest.mark.parametrize("sense", [1.0, -1.0])
ARMS = pytest.mark.parametrize("arm", [0, 1])
X, Y = 0.02, 0.37
CENTRE = np.array([X, Y])
FORCE = 0.3
LEVER = 0.05
OVERTIME = 0.2
"""How far past its arc a touch goes on that has not braked enough [rad]."""


LEAST_MARGIN = 0.005
"""Of a cage [m]."""


def handle() -> CoupleHandle:
    made: CoupleHandle = method_of(CONFIG).handle(CONFIG, np.zeros(1, COUPLE_MEMORY))
    return made


ROBOT = handle().fixed[0]["robot"]


def cross(a: FloatArray, b: FloatArray) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def unit(angle: float) -> FloatArray:
    return np.array([math.cos(angle), math.sin(angle)])


def face_velocity(spin: float, lever: FloatArray) -> FloatArray:
    """Of a point of the target that turns without drifting."""
    return spin * np.array([-lever[1], lever[0]])


class TestTipsOnFaces:
    @SENSES
    @pytest.mark.parametrize("normal_angle", [0.0, 1.2, -2.5])
    def test_a_tip_is_on_the_half_that_comes_out(self, sense: float, normal_angle: float) -> None:
        tip = np.array(tip_on_face(0.09, LEVER, sense, normal_angle, *CENTRE))
        outwards = face_velocity(2.0 * sense, tip - CENTRE) @ unit(normal_angle)
        assert outwards == pytest.approx(2.0 * LEVER)
        assert (tip - CENTRE) @ unit(normal_angle) == pytest.approx(0.09)

    @SENSES
    @pytest.mark.parametrize("normal_angle", [0.0, 1.2, -2.5])
    def test_pressing_there_brakes(self, sense: float, normal_angle: float) -> None:
        tip = np.array(tip_on_face(0.09, LEVER, sense, normal_angle, *CENTRE))
        assert cross(tip - CENTRE, -FORCE * unit(normal_angle)) == pytest.approx(-sense * FORCE * LEVER)

    @SENSES
    @pytest.mark.parametrize("side", [0, 1, 2])
    def test_that_half_of_a_side_ends_at_the_corner_that_comes_out(self, sense: float, side: int) -> None:
        foot = WEDGE.offsets[side] * WEDGE.normals[side]
        ends = [WEDGE.vertices[side], WEDGE.vertices[(side + 1) % WEDGE.corners]]
        out = [end for end in ends if face_velocity(sense, end) @ WEDGE.normals[side] > 0.0]
        assert len(out) == 1
        expected = float(np.linalg.norm(out[0] - foot))
        assert half_side(packed(WEDGE)[0], side, sense) == pytest.approx(expected)

    def test_a_tip_that_touches_is_its_radius_from_the_surface(self) -> None:
        distance = tip_distance(packed(SQUARE)[0], 2, ROBOT)
        assert distance == pytest.approx(0.075 + 0.015)
        x, y = tip_on_face(distance, LEVER, 1.0, math.atan2(SQUARE.normals[2, 1], SQUARE.normals[2, 0]), 0.0, 0.0)
        assert signed_distance(SQUARE, x, y) == pytest.approx(0.015)

    @pytest.mark.parametrize("tip", [0, 1])
    @pytest.mark.parametrize("angle", [0.0, 0.9, -2.0])
    def test_a_hand_put_at_a_tip_has_its_tip_there(self, tip: int, angle: float) -> None:
        pose = np.empty(3)
        hand_at_tip(ROBOT, tip, 0.11, 0.42, angle, pose)
        assert tip_position(ROBOT, pose, tip) == pytest.approx((0.11, 0.42))
        assert pose[2] == angle


@SENSES
@ARMS
def test_a_hand_touches_with_its_leading_tip_so_that_it_is_around_the_trailing_corner(arm: int, sense: float) -> None:
    made, pose = handle(), np.empty(3)
    plan = _plan(made.own[0], sense)
    touch_pose(made, plan, sense, arm, 0.0, 0.0, X, Y, pose)
    normal = unit(0.0 if arm == 1 else math.pi)
    tips = [np.array(tip_position(ROBOT, pose, tip)) - CENTRE for tip in range(2)]
    levers = [-sense * cross(normal, tip) for tip in tips]
    touching = touching_tip(sense)
    assert tips[touching] @ normal == pytest.approx(0.09)
    assert levers[touching] == pytest.approx(LEVER)
    assert levers[1 - touching] > 0.075 + 0.03
    assert -sense * cross(normal, pose[:2] - CENTRE) > 0.08


class TestHandsBeforeCorners:
    @pytest.mark.parametrize("angle", [0.0, 0.7, -2.2])
    def test_cage_the_target_from_the_radius_that_counts_as_enclosing(self, angle: float) -> None:
        made, hands = handle(), np.empty((2, 3))
        target = np.array([*CENTRE, angle])
        corner = corner_towards(made.fixed[0]["shape"], angle, 0.0)
        for arm in range(2):
            hand_before_corner(arm, angle + corner, made.fixed[0]["cage_radius"], X, Y, hands[arm])
        assert cage(CONFIG, hands, target).margin > LEAST_MARGIN

    @ARMS
    def test_touch_both_faces_of_the_corner_at_the_radius_of_touching(self, arm: int) -> None:
        made, hand = handle(), np.empty(3)
        corner = corner_towards(made.fixed[0]["shape"], 0.0, 0.0)
        hand_before_corner(arm, corner, made.fixed[0]["touch_radius"], 0.0, 0.0, hand)
        for tip in range(2):
            assert signed_distance(SQUARE, *tip_position(ROBOT, hand, tip)) == pytest.approx(0.015, abs=1e-6)

    @pytest.mark.parametrize("target_angle", [0.0, 1.0, -4.0])
    @pytest.mark.parametrize("direction", [0.0, 0.6, 3.0])
    def test_the_corner_chosen_is_one_of_the_shape_and_the_nearest(self, target_angle: float, direction: float) -> None:
        corner = corner_towards(packed(SQUARE)[0], target_angle, direction)
        apart = math.remainder(corner - math.pi / 4, math.pi / 2)
        assert apart == pytest.approx(0.0, abs=1e-12)
        assert abs(corner + target_angle - direction) <= math.pi / 4 + 1e-12


def test_seen_from_the_target_a_pose_turns_and_moves_with_it() -> None:
    relative, pose = np.empty(3), np.empty(3)
    to_target(np.array([1.0, 2.0, math.pi / 2]), np.array([1.0, 2.5, 2.0]), relative)
    assert relative == pytest.approx([0.5, 0.0, 2.0 - math.pi / 2])
    from_target(np.array([0.0, 0.0, math.pi]), relative, pose)
    assert pose == pytest.approx([-0.5, 0.0, 2.0 + math.pi / 2])


def _plan(own: Record, sense: float) -> Record:
    """The plan of a touch at a lever that stays, whose normals turn from 0 on."""
    plan = own["best"]
    plan["normal_offset"], plan["contact_angle"], plan["end_angle"] = 0.0, 0.0, 0.6 * sense
    plan["hand_angle"] = math.pi / 2 + 0.2 * sense
    plan["lever_start"] = plan["lever_end"] = LEVER
    plan["force"] = FORCE
    own["sense"], own["lever"] = sense, LEVER
    return plan


def _state(spin: float, normal_angle: float = 0.0, inertia: float = 9e-3) -> Record:
    state = np.zeros(1, PERCEIVED)[0]
    state["target_pose"], state["target_twist"] = (*CENTRE, normal_angle), (0.0, 0.0, spin)
    state["target_inertia"] = inertia
    return state


def _braked(sense: float, spin: float, arc: float, true_inertia: float, assumed: float) -> tuple[float, float]:
    """The spin that a target ends with which is pressed on along that arc and the overtime, and the largest force."""
    own, touch = handle().own[0], PARAMETERS["co_moving_couple"]["touch"]
    _plan(own, sense)
    own["best"]["end_angle"] = sense * arc
    angle, rate, largest, dt = 0.0, sense * spin, 0.0, 1e-3
    while sense * angle < arc + OVERTIME and sense * rate > TOUCH.spin_left:
        force = braking_force(own, touch, _state(rate, angle, assumed))
        largest = max(largest, force)
        rate -= sense * dt * 2.0 * force * LEVER / true_inertia
        angle += dt * rate
    return sense * rate, largest


class TestBrakingForce:
    @SENSES
    def test_does_the_work_that_is_the_energy_to_take_out(self, sense: float) -> None:
        own, spin, arc = handle().own[0], 2.0, 0.6
        _plan(own, sense)
        force = braking_force(own, PARAMETERS["co_moving_couple"]["touch"], _state(sense * spin))
        energy = 0.5 * 9e-3 * (spin**2 - TOUCH.spin_left**2)
        assert 2.0 * force * LEVER * arc == pytest.approx(energy)

    @SENSES
    def test_brakes_to_the_spin_that_is_to_be_left_within_the_arc(self, sense: float) -> None:
        end, largest = _braked(sense, 2.0, 0.6, 9e-3, 9e-3)
        assert end == pytest.approx(TOUCH.spin_left, abs=0.01)
        assert largest == pytest.approx(0.5 * 9e-3 * (4.0 - 0.01) / (2.0 * LEVER * 0.6), rel=0.05)

    @pytest.mark.parametrize("part", [0.7, 1.3])
    def test_a_wrong_inertia_hardly_matters(self, part: float) -> None:
        end, largest = _braked(1.0, 2.0, 0.6, part * 9e-3, 9e-3)
        assert end == pytest.approx(TOUCH.spin_left, abs=0.02)
        assert largest <= TOUCH.force_cap

    def test_is_kept_under_the_cap_with_room_for_the_law_to_work_in(self) -> None:
        own = handle().own[0]
        _plan(own, 1.0)
        force = braking_force(own, PARAMETERS["co_moving_couple"]["touch"], _state(6.0))
        assert 0.8 * TOUCH.force_cap < force <= TOUCH.force_cap

    def test_is_kept_above_what_keeps_contact(self) -> None:
        own = handle().own[0]
        _plan(own, 1.0)
        assert braking_force(own, PARAMETERS["co_moving_couple"]["touch"], _state(0.0)) == TOUCH.least_force


@pytest.mark.parametrize("normal_angle", [0.0, 2.0])
@pytest.mark.parametrize("speed", [0.01, -0.01])
def test_the_hand_towards_which_the_target_drifts_presses_harder(speed: float, normal_angle: float) -> None:
    own, touch, mass = handle().own[0], PARAMETERS["co_moving_couple"]["touch"], 2.0
    memory = np.zeros(1, MEMORY)[0]
    _plan(own, 1.0)
    own["best"]["end_angle"] = normal_angle + 0.6
    state = _state(2.0, normal_angle)
    state["target_twist"][:2] = speed * unit(normal_angle)
    even = braking_force(own, touch, state)
    share_forces(own, memory, touch, state, mass)
    left, right = memory["wanted_force"]
    assert right - left == pytest.approx(mass * speed / TOUCH.drift_time)
    assert right + left == pytest.approx(2.0 * even)
    state["target_twist"][:2] *= 100.0
    share_forces(own, memory, touch, state, mass)
    assert memory["wanted_force"].min() == pytest.approx((1.0 - TOUCH.drift_part) * even)


def _pressing(sense: float, force: float, friction: float = 0.0) -> tuple[CoupleHandle, Record, Record, FloatArray]:
    """Both hands on faces that turn, at rest against them; each feels that force, and friction that brakes."""
    made, state, hands = handle(), _state(2.0 * sense), np.empty((2, 3))
    plan = _plan(made.own[0], sense)
    for arm in range(2):
        touch_pose(made, plan, sense, arm, 0.0, 0.0, X, Y, hands[arm])
        normal = unit(0.0 if arm == 1 else math.pi)
        along = np.array([-normal[1], normal[0]])
        on_hand = force * normal + sense * friction * force * along
        point = np.array(tip_position(ROBOT, hands[arm], touching_tip(sense))) - 0.015 * normal
        state["hand_wrench"][arm] = (*on_hand, cross(point - hands[arm, :2], on_hand))
        state["touching"][arm] = force > 0.0
    state["time"], state["tick"] = 10.0, 1  # none at which it is looked at how far the servos give way
    made.own[0]["first_touch"] = 0.0
    return made, np.zeros(1, MEMORY)[0], state, hands


def _away_from_face(sense: float, state: Record, hands: FloatArray, velocity: FloatArray) -> list[float]:
    """Speed of each touching tip against the face that moves, outwards [m/s]."""
    speeds = []
    for arm in range(2):
        normal = unit(0.0 if arm == 1 else math.pi)
        tip = np.array(tip_position(ROBOT, hands[arm], touching_tip(sense)))
        lever = tip - hands[arm, :2]
        speed = velocity[arm, :2] + velocity[arm, 2] * np.array([-lever[1], lever[0]])
        speeds.append(float((speed - face_velocity(state["target_twist"][2], tip - CENTRE)) @ normal))
    return speeds


class TestFollowingFaces:
    @SENSES
    def test_a_hand_that_does_not_touch_comes_in_slowly(self, sense: float) -> None:
        made, memory, state, hands = _pressing(sense, 0.0)
        velocity = np.zeros((2, 3))
        follow_faces(made, memory, PARAMETERS, state, hands, velocity)
        for speed in _away_from_face(sense, state, hands, velocity):
            assert -0.045 <= speed <= -0.015

    @SENSES
    def test_a_hand_yields_to_too_great_a_force_and_follows_too_small_a_one(self, sense: float) -> None:
        for error in (0.1, -0.1):
            made, memory, state, hands = _pressing(sense, 0.0)
            wanted = braking_force(made.own[0], PARAMETERS["co_moving_couple"]["touch"], state)
            made, memory, state, hands = _pressing(sense, wanted + error)
            velocity = np.zeros((2, 3))
            follow_faces(made, memory, PARAMETERS, state, hands, velocity)
            speeds = _away_from_face(sense, state, hands, velocity)
            assert speeds == pytest.approx([error / TOUCH.damping] * 2, rel=0.05)

    @SENSES
    def test_a_standing_error_is_taken_out_in_the_integral_time(self, sense: float) -> None:
        made, memory, state, hands = _pressing(sense, 0.1)
        velocity = np.zeros((2, 3))
        follow_faces(made, memory, PARAMETERS, state, hands, velocity)
        first = _away_from_face(sense, state, hands, velocity)[1]
        for _ in range(round(0.5 * TOUCH.integral_time / CONFIG.control.period)):
            follow_faces(made, memory, PARAMETERS, state, hands, velocity)
        assert _away_from_face(sense, state, hands, velocity)[1] == pytest.approx(1.5 * first, rel=0.05)

    @SENSES
    def test_friction_that_brakes_adds_to_the_lever_that_is_measured(self, sense: float) -> None:
        made, memory, state, hands = _pressing(sense, FORCE, friction=0.2)
        velocity = np.zeros((2, 3))
        for _ in range(400):
            follow_faces(made, memory, PARAMETERS, state, hands, velocity)
        assert made.own[0]["lever"] == pytest.approx(LEVER + 0.2 * 0.075, rel=0.01)

    @SENSES
    @pytest.mark.parametrize("ahead", [0.0, 0.01])
    def test_the_point_of_contact_slides_outwards_so_that_friction_brakes(self, sense: float, ahead: float) -> None:
        """Also where a tip is further out than planned: one that slid back would drive the target."""
        made, memory, state, hands = _pressing(sense, FORCE)
        made.own[0]["best"]["lever_start"] = made.own[0]["best"]["lever_end"] = LEVER - ahead
        velocity = np.zeros((2, 3))
        follow_faces(made, memory, PARAMETERS, state, hands, velocity)
        for arm in range(2):
            normal = unit(0.0 if arm == 1 else math.pi)
            out = -sense * np.array([-normal[1], normal[0]])
            point = np.array(tip_position(ROBOT, hands[arm], touching_tip(sense))) - 0.015 * normal
            lever = point - hands[arm, :2]
            speed = velocity[arm, :2] + velocity[arm, 2] * np.array([-lever[1], lever[0]])
            sliding = float((speed - face_velocity(state["target_twist"][2], point - CENTRE)) @ out)
            assert sliding >= 0.0035

    @ARMS
    def test_what_the_servos_give_way_by_under_the_wanted_force_is_commanded_against(self, arm: int) -> None:
        velocities, yielding = [], np.array([0.03, -0.02])
        for given in (0.0, 1.0):
            made, memory, state, hands = _pressing(1.0, FORCE)
            made.own[0]["yielding"][arm] = given * yielding
            velocities.append(np.zeros((2, 3)))
            follow_faces(made, memory, PARAMETERS, state, hands, velocities[-1])
        expected = np.zeros((2, 3))
        expected[arm, :2] = -memory["wanted_force"][arm] * yielding
        assert velocities[1] - velocities[0] == pytest.approx(expected)

    @ARMS
    def test_an_imposed_impedance_is_that_of_the_hand_about_the_moving_face(self, arm: int) -> None:
        mass, damping, stiffness = 0.1, 6.0, 50.0
        imposed = {"imposed_mass": mass, "imposed_damping": damping, "imposed_stiffness": stiffness}
        parameters = record_of(revised(CONFIG, {"co_moving_couple": {"touch": imposed}}))
        made, memory, state, hands = _pressing(1.0, 0.5)
        velocity, period, way, speeds = np.zeros((2, 3)), CONFIG.control.period, 0.0, []
        for _ in range(2000):
            follow_faces(made, memory, parameters, state, hands, velocity)
            speeds.append(_away_from_face(1.0, state, hands, velocity)[arm])
            way += period * speeds[-1]
        error = 0.5 - memory["wanted_force"][arm]
        assert speeds[0] == pytest.approx(period * error / mass, rel=0.1)
        assert way == pytest.approx(error / stiffness, rel=0.01)
        at, rate = 100, (speeds[101] - speeds[99]) / (2.0 * period)
        left = error - mass * rate - damping * speeds[at] - stiffness * period * sum(speeds[: at + 1])
        assert left == pytest.approx(0.0, abs=0.03 * error)


@pytest.mark.parametrize("spin", [0.4, -0.4])
def test_closing_hands_turn_with_the_target(spin: float) -> None:
    made, memory, state, hands = handle(), np.zeros(1, MEMORY)[0], _state(spin), np.empty((2, 3))
    memory["activity"] = method_of(CONFIG).activities["CLOSING"]
    corner = corner_towards(made.fixed[0]["shape"], 0.0, 0.0)
    made.own[0]["close"]["corner"] = corner
    for arm in range(2):
        hand_before_corner(arm, corner, 0.1, X, Y, hands[arm])
    velocity = np.zeros((2, 3))
    close_in(made, memory, PARAMETERS, state, hands, 0.1, 0.1, -0.02, velocity)
    for arm in range(2):
        lever = hands[arm, :2] - CENTRE
        inwards = -0.02 * lever / np.linalg.norm(lever)
        assert velocity[arm, :2] == pytest.approx(face_velocity(spin, lever) + inwards)
        assert velocity[arm, 2] == pytest.approx(spin)
