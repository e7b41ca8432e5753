"""The caging test: the paper's at the present angle, and the true one over all motions of the square."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from sim.capture.caging import cage, tips_enclose
from sim.compiled import FloatArray, compiled
from sim.config import MissionConfig
from sim.model.clearance import hand_outline
from sim.model.planar import in_frame, rotated
from sim.model.robot import robot_model
from sim.model.shape import Shape, signed_distance
from sim.model.target import target_shape

CONFIG = MissionConfig()
ROBOT = robot_model(CONFIG.robot)
SQUARE = target_shape(CONFIG.target)
CAPTURE_DISTANCE = 0.0939
"""x_cap: where the published closing ends, hand centres from the target's centre [m]."""
DIAGONAL = math.pi / 4
GRID = 2.5e-3
"""How much a margin may change when hands and target are moved together [m]: the search's own stated error."""

LEGS, STEPS = 20_000, 400
"""Of an escape attempt: straight flights until something bars the way, of steps that cannot jump a finger."""
STRIDE = 1e-3
"""Of one of those steps [m]; turning moves a corner by no more."""
AWAY = 0.35
"""Distance of the target from the hands' middle at which it has escaped [m]."""


def facing(distance: float, turn: float = 0.0):
    """Both hands facing each other across the origin, shape (2, 3)."""
    x, y = distance * math.cos(turn), distance * math.sin(turn)
    return np.array([[-x, -y, turn - math.pi / 2], [x, y, turn + math.pi / 2]])


def square(angle: float, x: float = 0.0, y: float = 0.0):
    return np.array([x, y, angle])


class TestKnownCases:
    def test_a_corner_in_each_hand_is_caged(self):
        found = cage(CONFIG, facing(CAPTURE_DISTANCE), square(DIAGONAL))
        assert found.caged
        assert 0.004 < found.margin < 0.010

    def test_the_same_hands_let_a_square_out_that_lies_flat_between_them(self):
        found = cage(CONFIG, facing(CAPTURE_DISTANCE), square(0.0))
        assert not found.caged
        assert found.margin <= 0.0

    def test_far_hands_do_not_cage(self):
        assert not cage(CONFIG, facing(0.20), square(DIAGONAL)).caged

    def test_hands_beside_the_target_do_not_cage(self):
        assert not cage(CONFIG, facing(CAPTURE_DISTANCE), square(DIAGONAL, y=0.5)).caged

    def test_one_hand_alone_does_not_cage(self):
        hands = facing(CAPTURE_DISTANCE)
        hands[0, 0] = -2.0
        assert not cage(CONFIG, hands, square(DIAGONAL)).caged

    def test_enclosed_at_the_present_angle_is_less_than_caged(self):
        """The paper's test passes where turning still opens a way: a cage at one angle is not a cage."""
        hands = facing(0.11)
        assert tips_enclose(ROBOT, SQUARE, hands, square(DIAGONAL))
        assert not cage(CONFIG, hands, square(DIAGONAL)).caged


class TestMargin:
    def test_falls_as_the_hands_open(self):
        margins = [
            cage(CONFIG, facing(distance), square(DIAGONAL)).margin for distance in np.arange(0.0939, 0.13, 0.003)
        ]
        assert all(later < earlier for earlier, later in pairwise(margins))
        assert margins[0] > 0.0 > margins[-1]

    def test_falls_as_the_target_shrinks(self):
        margins = []
        for side in (0.150, 0.147, 0.144, 0.140):
            config = CONFIG.model_copy(update={"target": CONFIG.target.model_copy(update={"side": side})})
            margins.append(cage(config, facing(CAPTURE_DISTANCE), square(DIAGONAL)).margin)
        assert margins == sorted(margins, reverse=True)

    @pytest.mark.parametrize("angle", [0.3, -1.2, 2.0])
    def test_does_not_depend_on_where_all_of_it_is(self, angle):
        still = cage(CONFIG, facing(CAPTURE_DISTANCE), square(DIAGONAL))
        shift = np.array([0.4, -0.3])
        hands = facing(CAPTURE_DISTANCE, angle)
        hands[:, :2] += shift
        moved = cage(CONFIG, hands, square(DIAGONAL + angle, *shift))
        assert moved.caged == still.caged
        assert moved.margin == pytest.approx(still.margin, abs=GRID)

    @pytest.mark.parametrize("quarters", [-1, 1, 2, 7])
    def test_a_square_turned_by_quarters_is_the_same_square(self, quarters):
        turned = square(DIAGONAL + quarters * math.pi / 2)
        assert cage(CONFIG, facing(CAPTURE_DISTANCE), turned).margin == pytest.approx(
            cage(CONFIG, facing(CAPTURE_DISTANCE), square(DIAGONAL)).margin, abs=GRID
        )

    def test_is_the_same_wherever_in_its_cage_the_target_lies(self):
        middle = cage(CONFIG, facing(CAPTURE_DISTANCE), square(DIAGONAL))
        aside = cage(CONFIG, facing(CAPTURE_DISTANCE), square(DIAGONAL + 0.05, 0.004, -0.003))
        assert aside.margin == pytest.approx(middle.margin, abs=GRID)


class TestTipsEnclose:
    def test_a_corner_in_each_hand(self):
        assert tips_enclose(ROBOT, SQUARE, facing(CAPTURE_DISTANCE), square(DIAGONAL))

    @pytest.mark.parametrize("distance", [0.15, 0.2, 0.5])
    def test_not_from_afar(self, distance):
        assert not tips_enclose(ROBOT, SQUARE, facing(distance), square(DIAGONAL))

    def test_not_a_square_that_lies_flat(self):
        assert not tips_enclose(ROBOT, SQUARE, facing(CAPTURE_DISTANCE), square(0.0))

    def test_not_with_the_target_outside(self):
        assert not tips_enclose(ROBOT, SQUARE, facing(CAPTURE_DISTANCE), square(DIAGONAL, y=0.3))

    @pytest.mark.parametrize("quarters", [-3, -1, 1, 2])
    def test_quarter_turns_change_nothing(self, quarters):
        turned = square(DIAGONAL + quarters * math.pi / 2)
        assert tips_enclose(ROBOT, SQUARE, facing(CAPTURE_DISTANCE), turned)

    @pytest.mark.parametrize("turn_deg", [-44, -20, 20, 44])
    def test_turned_together(self, turn_deg):
        turn = math.radians(turn_deg)
        assert tips_enclose(ROBOT, SQUARE, facing(CAPTURE_DISTANCE, turn), square(DIAGONAL + turn))

    @pytest.mark.parametrize("turn_deg", [-120, -50, 50, 90, 180])
    def test_turned_together_by_more_than_an_eighth(self, turn_deg):
        turn = math.radians(turn_deg)
        assert tips_enclose(ROBOT, SQUARE, facing(CAPTURE_DISTANCE, turn), square(DIAGONAL + turn))


class TestSoundness:
    """What is called caged cannot be led out: an explorer that knows nothing of the search tries to."""

    @pytest.mark.parametrize("seed", range(4))
    def test_nothing_escapes_from_a_cage(self, seed):
        assert not escapes(facing(CAPTURE_DISTANCE), square(DIAGONAL), seed)

    @pytest.mark.parametrize(
        ("distance", "angle"), [(0.13, DIAGONAL), (CAPTURE_DISTANCE, 0.0)], ids=["open hands", "flat between the hands"]
    )
    def test_the_explorer_finds_its_way_out_of_what_is_no_cage(self, distance, angle):
        assert any(escapes(facing(distance), square(angle), seed) for seed in range(4))

    @pytest.mark.parametrize("seed", range(12))
    def test_nothing_escapes_from_imperfect_cages(self, seed):
        """Hands off their places by millimetres and degrees, as a real closing leaves them."""
        random = np.random.default_rng(seed)
        hands = facing(CAPTURE_DISTANCE) + random.normal(0.0, [0.003, 0.003, 0.03], (2, 3))
        target = square(DIAGONAL + random.normal(0.0, 0.03))
        if cage(CONFIG, hands, target).caged:
            assert not escapes(hands, target, seed)

    def test_some_of_those_imperfect_cages_are_cages(self):
        verdicts = []
        for seed in range(12):
            random = np.random.default_rng(seed)
            hands = facing(CAPTURE_DISTANCE) + random.normal(0.0, [0.003, 0.003, 0.03], (2, 3))
            verdicts.append(cage(CONFIG, hands, square(DIAGONAL + random.normal(0.0, 0.03))).caged)
        assert sum(verdicts) >= 3


def escapes(hands, target, seed: int) -> bool:
    """Whether a square of the target's size finds its way out from between tips and fingers at those poses."""
    outline = hand_outline(CONFIG.robot.arm)
    points = np.array([[np.array(rotated(pose[2], *p)) + pose[:2] for p in outline] for pose in hands])
    finger, tip = CONFIG.robot.arm.hand.finger_radius, CONFIG.robot.arm.hand.tip_radius
    return bool(_explored(points, finger, tip, SQUARE, target.astype(float), seed))


@compiled
def _explored(points: FloatArray, finger: float, tip: float, shape: Shape, start: FloatArray, seed: int) -> bool:
    np.random.seed(seed)
    pose = start.copy()
    middle_x, middle_y = points[:, :, 0].mean(), points[:, :, 1].mean()
    for _ in range(LEGS):
        heading, spin = np.random.uniform(0.0, 2.0 * math.pi), np.random.uniform(-1.0, 1.0)
        for _ in range(STEPS):
            following = pose.copy()
            following[0] += STRIDE * math.cos(heading)
            following[1] += STRIDE * math.sin(heading)
            following[2] += spin * STRIDE / shape.corner_circle
            if not _free(points, finger, tip, shape, following):
                break
            pose = following
        if math.hypot(pose[0] - middle_x, pose[1] - middle_y) > AWAY:
            return True
    return False


@compiled
def _free(points: FloatArray, finger: float, tip: float, shape: Shape, pose: FloatArray) -> bool:
    """Whether a square overlaps neither tips nor fingers: capsules along the outline, exact at corners and sides."""
    for hand in range(points.shape[0]):
        for end in (0, points.shape[1] - 1):
            x, y = in_frame(pose, points[hand, end, 0], points[hand, end, 1])
            if signed_distance(shape, x, y) < tip:
                return False
        for place in range(points.shape[1] - 1):
            ax, ay = in_frame(pose, points[hand, place, 0], points[hand, place, 1])
            bx, by = in_frame(pose, points[hand, place + 1, 0], points[hand, place + 1, 1])
            for part in range(33):
                x, y = ax + part / 32 * (bx - ax), ay + part / 32 * (by - ay)
                if signed_distance(shape, x, y) < finger:
                    return False
    return True
