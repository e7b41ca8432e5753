"""Every preset has the machine in the window, whatever its shape."""

import math

import numpy as np
import pytest

from server.scene import cameras
from sim.config import MissionConfig

CONFIG = MissionConfig()
SHAPES = (900 / 420, 1200 / 600, 1.0, 500 / 700)


def on_screen(view, point, aspect):
    """Where a point appears: (-1, -1) bottom left to (1, 1) top right."""
    forward = view.look_at - view.position
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    offset = np.asarray(point) - view.position
    half = math.tan(cameras.FIELD_OF_VIEW / 2) * (offset @ forward)
    return offset @ right / (half * aspect), offset @ np.cross(right, forward) / half


@pytest.mark.parametrize("aspect", SHAPES)
@pytest.mark.parametrize("preset", [cameras.perspective, cameras.top])
@pytest.mark.parametrize(
    "corner",
    [(-0.16, -0.08, 0.0), (0.16, -0.08, 0.12), (-0.40, 0.21, 0.1), (0.40, 0.40, 0.1), (0.0, 0.45, 0.13)],
)
def test_robot_and_target_are_in_the_window(preset, aspect, corner):
    x, y = on_screen(preset(CONFIG, aspect), corner, aspect)
    assert abs(x) < 1
    assert abs(y) < 1


def test_the_top_view_has_the_front_upwards():
    view = cameras.top(CONFIG, 2.0)
    assert on_screen(view, (0.0, 0.4, 0.05), 2.0)[1] > 0.3
    assert on_screen(view, (0.3, 0.17, 0.05), 2.0)[0] > 0.3


def test_a_carried_camera_keeps_its_side_and_distance():
    view = cameras.close_up((0.0, 0.3), 2.0)
    carried = cameras.carried(view.position, view.look_at, (0.2, 0.1))
    assert carried.position - carried.look_at == pytest.approx(view.position - view.look_at)
    assert carried.look_at == pytest.approx([0.2, 0.1, 0.1])


@pytest.mark.parametrize("preset", [cameras.perspective, cameras.top])
def test_the_turn_of_a_camera_has_its_axes_right_down_and_ahead(preset):
    view = preset(CONFIG, 1.5)
    w, x, y, z = cameras.orientation(view)
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    ahead = view.look_at - view.position
    assert turn[:, 2] == pytest.approx(ahead / np.linalg.norm(ahead))
    assert turn[2, 0] == pytest.approx(0.0, abs=1e-9)  # level
    assert turn[2, 1] < 0.0  # the picture's lower edge is below
