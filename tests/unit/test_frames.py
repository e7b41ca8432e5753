"""Every conversion between frames, by numbers: a sign, a swapped axis or the wrong way around fails here.

Frames stand at 30 degrees, where sine and cosine differ, and away from the origin. What is expected is written with
complex numbers, in which a turn is a product: nothing of the code under test takes part in it.
"""

from __future__ import annotations

import cmath
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from server.link.bounds import WristFrame
from server.link.imperfections import Imperfections, Sensors
from server.log.ros import store
from server.log.scene import MARKERS, scene
from server.log.topics import frame_tree, topics_of
from server.reports.drawing import draw
from server.scene.cage import corners_in_base
from server.scene.figures import base_place, tip_points
from server.scene.solids import Solid, turn
from sim.capture.caging import _clearance, _grid, _way_along
from sim.capture.tick import TICK
from sim.config import MissionConfig, TargetConfig
from sim.model.clearance import corner_overlap
from sim.model.planar import in_frame, point_velocity, rotated
from sim.model.robot import chain, robot_model, tip_position
from sim.model.shape import polygon
from sim.plant.contact import tip_contact
from sim.plant.plant import PLANT_STATE
from sim.plant.pymunk_plant import _hand_pose
from sim.record import record_of

TURN = math.pi / 6
POSE = np.array([0.3, -0.2, TURN])
"""Of a frame in the world."""
CONFIG = MissionConfig()
ROBOT = robot_model(CONFIG.robot)
ANGLES = np.array([[0.4, -0.7, 0.2], [-0.9, 0.3, 1.1]])
MOUNTS = np.array([0.05, -0.15])
WEDGE = polygon(np.array([[-0.07, -0.05], [0.11, -0.05], [-0.07, 0.07]]))
"""Another shape after every turn, and after every reflection."""


def point(number: complex) -> tuple[float, float]:
    return number.real, number.imag


def at(pose: Any, x: float, y: float) -> complex:
    """The world's point that is (x, y) in the frame of a pose."""
    return complex(pose[0], pose[1]) + cmath.rect(1.0, pose[2]) * complex(x, y)


def arm_by_hand(arm: int) -> tuple[list[complex], complex, float]:
    """Joints, hand's centre and its angle, link by link: each lies along the y axis of its own frame."""
    place = at(POSE, (-1, 1)[arm] * 0.160, 0.080 - 0.076078)
    joints, angle = [place], TURN
    for length, joint in zip((0.250, 0.180, 0.13655), ANGLES[arm], strict=True):
        angle += joint
        place += cmath.rect(length, angle + math.pi / 2)
        joints.append(place)
    angle += MOUNTS[arm]
    return joints, place + cmath.rect(0.041556, angle + math.pi / 2), angle


class TestVectorsAndPoints:
    def test_a_vector_from_a_frame_into_the_world(self):
        assert rotated(TURN, 1.0, 2.0) == pytest.approx((math.sqrt(3) / 2 - 1.0, 0.5 + math.sqrt(3)))

    def test_a_point_of_the_world_in_a_bodys_frame(self):
        assert in_frame(POSE, *point(at(POSE, 0.4, -0.1))) == pytest.approx((0.4, -0.1))
        assert in_frame(np.array([1.0, 2.0, math.pi / 2]), 1.0, 5.0) == pytest.approx((3.0, 0.0))

    def test_a_bodys_point_moves_with_its_twist(self):
        velocity = complex(0.1, -0.2) + 2.0j * (at(POSE, 0.4, -0.1) - complex(*POSE[:2]))
        found = point_velocity(POSE, np.array([0.1, -0.2, 2.0]), *point(at(POSE, 0.4, -0.1)))
        assert found == pytest.approx(point(velocity))

    def test_a_solid_of_the_scene(self):
        solid = Solid(np.array([[1.0, 2.0, 3.0]]), np.array([[0.0, 1.0, 0.0]]), np.zeros((0, 3), np.uint32))
        turned = solid.turned(turn(TURN))
        assert turned.vertices[0] == pytest.approx([*rotated(TURN, 1.0, 2.0), 3.0])
        assert turned.normals[0] == pytest.approx([-0.5, math.sqrt(3) / 2, 0.0])


class TestRobot:
    @pytest.mark.parametrize("arm", [0, 1])
    def test_base_joints_and_hand(self, arm):
        links = chain(ROBOT, POSE, ANGLES, MOUNTS)
        joints, hand, angle = arm_by_hand(arm)
        assert links.joint[arm] == pytest.approx(np.array([point(joint) for joint in joints]))
        assert links.hand_pose[arm] == pytest.approx([*point(hand), angle])

    @pytest.mark.parametrize("tip", [0, 1])
    def test_hand_to_tip(self, tip):
        expected = point(at(POSE, (-1, 1)[tip] * 0.039749, 0.0))
        assert tip_position(ROBOT, POSE, tip) == pytest.approx(expected)
        assert tip_points(POSE.tolist(), 0.039749)[tip] == pytest.approx(expected)

    def test_hands_centre_from_its_centre_of_mass(self):
        ahead = 0.041556 - 0.02078
        assert _hand_pose(ROBOT, POSE) == pytest.approx([*point(at(POSE, 0.0, ahead)), TURN])

    def test_bases_middle_from_its_centre_of_mass(self):
        assert base_place(POSE.tolist(), 0.076078) == pytest.approx((*point(at(POSE, 0.0, -0.076078)), TURN))


class TestShapesAtPoses:
    def test_a_corner_of_one_in_another(self):
        """A wedge's right corner lies 7 mm within the left side of another, which stands turned."""
        other = np.array([-0.4, 0.1, -0.8])
        corner = at(other, -0.07 + 0.007, 0.01)
        place = corner - cmath.rect(1.0, TURN) * complex(0.11, -0.05)
        assert corner_overlap(WEDGE, np.array([*point(place), TURN]), WEDGE, other) == pytest.approx(0.007)

    def test_contact_pushes_along_the_targets_side_normal(self):
        """A tip 4 mm into the slanting side: its normal in the target's frame, turned into the world."""
        record, still = record_of(MissionConfig().contact), np.zeros(3)
        normal = complex(0.12, 0.18) / abs(complex(0.12, 0.18))
        middle = complex(0.02, 0.01) + (0.015 - 0.004) * normal
        tip = at(POSE, *point(middle))
        contact = tip_contact(record, WEDGE, 0.015, *point(tip), np.array([*point(tip), 0.0]), still, POSE, still)
        push = 800.0 * 0.004 * cmath.rect(1.0, TURN) * normal
        assert (contact.force_x, contact.force_y) == pytest.approx(point(push))

    def test_discs_around_a_target(self):
        """At a place of the grid that is searched for a way out, aside and turned."""
        pose = np.array([0.05, -0.03, 7 * 2.0 * math.pi / 12])
        far, near = [5.0, 5.0, 0.01], [*point(at(pose, -0.07 - 0.03, 0.01)), 0.01]
        discs, least = np.array([far, near]), np.empty(2)
        grid = _grid(discs, WEDGE, 41, 0.01, 12)
        found, nearest = _clearance(discs, WEDGE, grid, 20 + 5, 20 - 3, 7, 0, least)
        assert found == pytest.approx(0.02)
        assert nearest == 1

    def test_hands_around_a_target(self):
        """Tip, finger, palm: the left hand's in the target's frame."""
        hands = np.array([[-0.1, 0.4, -1.2], [0.2, 0.3, 1.4]])
        way = [*_way_along(ROBOT, hands[0], POSE), *_way_along(ROBOT, hands[1], POSE)]
        for arm in range(2):
            for place, (x, y) in enumerate([(-1, 0), (-1, -1), (1, -1), (1, 0)]):
                in_world = at(hands[arm], x * 0.039749, y * 0.041556)
                in_frame = (in_world - complex(*POSE[:2])) * cmath.rect(1.0, -TURN)
                assert way[4 * arm + place] == pytest.approx(point(in_frame))


class TestWrists:
    def test_a_wrench_of_the_world_in_a_hands_axes(self):
        state = np.zeros(1, PLANT_STATE)[0]
        state["hand_wrench"][1] = 0.3, -1.7, 0.05
        sensors = Sensors(Imperfections(**dict.fromkeys(Imperfections.model_fields, 0.0)), 0)
        sensors.sense(state, np.array([0.0, TURN]))
        measured = sensors.wrenches(0)[1].value
        assert measured == pytest.approx([*point(complex(0.3, -1.7) * cmath.rect(1.0, -TURN)), 0.05])

    @pytest.mark.parametrize("sign", [1, -1])
    def test_a_sensors_wrench_about_the_hands_centre(self, sign):
        """Sensor's axes stand at 30 degrees in the hand's, its origin beside the hand's centre."""
        frame = WristFrame(frame="sensor", angle=TURN, x=0.02, y=-0.05, sign=sign)
        force = sign * complex(0.3, -1.7) * cmath.rect(1.0, TURN)
        torque = sign * 0.05 + (complex(0.02, -0.05).conjugate() * force).imag
        assert frame.in_hand(np.array([0.3, -1.7, 0.05])) == pytest.approx([*point(force), torque])


class TestLog:
    def test_transforms_compose_to_where_links_and_hands_are(self):
        ticks = self._ticks()
        (topic,) = [topic for topic in topics_of(CONFIG) if topic.name == "/tf"]
        numbers = topic.numbers(ticks).reshape(-1, 7)
        places = {"world": (0j, 1.0 + 0j)}
        for (parent, child), (x, y, z, *turned) in zip(frame_tree(), numbers.tolist(), strict=True):
            assert (z, turned[0], turned[1]) == (0.0, 0.0, 0.0)
            origin, axes = places[parent]
            places[child] = origin + axes * complex(x, y), axes * complex(turned[3], turned[2]) ** 2
        for arm, name in enumerate(("left", "right")):
            joints, hand, angle = arm_by_hand(arm)
            for link in range(3):
                assert places[f"{name}_link_{link + 1}"][0] == pytest.approx(joints[link])
            along = places[f"{name}_link_3"]
            assert along[0] + along[1] * 0.13655j == pytest.approx(joints[3])
            assert np.array(places[f"{name}_hand"]) == pytest.approx(np.array([hand, cmath.rect(1.0, angle)]))
            assert np.array(places[f"{name}_hand_world_axes"]) == pytest.approx(np.array([hand, 1.0]))
        assert np.array(places["target"]) == pytest.approx(np.array([-0.4 + 0.5j, cmath.rect(1.0, -0.6)]))

    def test_markers_stand_where_their_frames_have_the_body(self):
        markers = store().deserialize_cdr(scene(CONFIG), MARKERS).markers
        found = {(each.header.frame_id, each.type): each for each in markers}
        middle = found["base", 1].pose.position
        assert (middle.x, middle.y) == pytest.approx((0.0, -0.076078))
        link = found["left_link_2", 3]
        assert (link.pose.position.x, link.pose.position.y) == pytest.approx((0.0, 0.09))
        lean = link.pose.orientation  # a cylinder's z axis onto the link's y axis: -90 degrees about x
        assert (lean.w, lean.x) == pytest.approx((math.sqrt(0.5), -math.sqrt(0.5)))
        tips = [each.pose.position for each in markers if each.header.frame_id == "left_hand" and each.type == 2]
        assert [(tip.x, tip.y) for tip in tips] == [pytest.approx((x, 0.0)) for x in (-0.039749, 0.039749)]

    @staticmethod
    def _ticks() -> np.ndarray:
        ticks = np.zeros(1, TICK)
        ticks["base_pose"], ticks["joint_angle"], ticks["mount_angle"] = POSE, ANGLES, MOUNTS
        ticks["hand_pose"] = chain(ROBOT, POSE, ANGLES, MOUNTS).hand_pose
        ticks["target_pose"] = -0.4, 0.5, -0.6
        return ticks


class TestDrawings:
    def test_a_cage_in_the_bases_frame(self):
        hands = [at(POSE, x, 0.3) for x in (-0.1, 0.15)]
        left, right = (SimpleNamespace(hand_pose=(*point(hand), TURN + 0.5)) for hand in hands)
        shown: Any = SimpleNamespace(base=SimpleNamespace(pose=POSE.tolist()), left=left, right=right)
        corners = corners_in_base(shown, CONFIG.robot.base, 0.04)
        across = cmath.rect(0.04, 0.5)
        expected = {complex(x, 0.3 + 0.076078) + sign * across for x in (-0.1, 0.15) for sign in (-1, 1)}
        for x, y in corners[:4].tolist():
            assert min(abs(complex(x, y) - each) for each in expected) < 1e-12
        assert len({tuple(corner) for corner in np.round(corners[:4], 9).tolist()}) == 4

    def test_a_reports_target_and_base(self):
        drawn: list[np.ndarray] = []
        axes: Any = SimpleNamespace(
            set=lambda **_: None,
            spines={},
            plot=lambda *_, **__: None,
            annotate=lambda *_, **__: None,
            add_patch=lambda patch: drawn.append(patch.get_xy() if hasattr(patch, "get_xy") else np.empty((0, 2))),
        )
        vertices = ((0.0, 0.0), (0.18, 0.0), (0.0, 0.12))
        config = CONFIG.model_copy(update={"target": TargetConfig(shape="polygon", vertices=vertices)})
        draw(axes, config, TestLog._ticks()[0])
        base = [point(at(POSE, x, y - 0.076078)) for x, y in ((0.16, -0.08), (0.16, 0.08), (-0.16, 0.08))]
        wedge = [point(at((-0.4, 0.5, -0.6), x, y)) for x, y in ((-0.06, -0.04), (0.12, -0.04), (-0.06, 0.08))]
        assert drawn[0][:3] == pytest.approx(np.array(base))
        assert drawn[2][:3] == pytest.approx(np.array(wedge))
