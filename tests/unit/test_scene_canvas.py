"""Nothing goes out that has not changed."""

import math
from typing import Any

import pytest

from server.scene.canvas import ANGLE_TOLERANCE, LENGTH_TOLERANCE, ChangeDetector, Moving


class RecordingHandle:
    """A node that remembers what was assigned to it."""

    def __init__(self):
        object.__setattr__(self, "assigned", [])

    def __setattr__(self, name, value):
        self.__dict__["assigned"].append((name, value))


def test_a_node_is_put_where_it_belongs():
    handle: Any = RecordingHandle()
    Moving(handle, height=0.1).move((1.0, 2.0, math.pi / 2))
    (position, place), (orientation, quaternion) = handle.assigned
    assert (position, place) == ("position", (1.0, 2.0, 0.1))
    assert orientation == "wxyz"
    assert quaternion == pytest.approx((math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)))


def test_only_real_moves_and_turns_are_sent():
    handle: Any = RecordingHandle()
    node = Moving(handle)
    node.move((0.0, 0.0, 0.0))
    handle.assigned.clear()
    node.move((0.9 * LENGTH_TOLERANCE, 0.0, 0.9 * ANGLE_TOLERANCE))
    assert handle.assigned == []
    node.move((1.1 * LENGTH_TOLERANCE, 0.0, 0.0))
    node.turn(1.1 * ANGLE_TOLERANCE)
    assert [name for name, _ in handle.assigned] == ["position", "wxyz"]


def test_a_slow_drift_is_not_lost():
    handle: Any = RecordingHandle()
    node = Moving(handle)
    for step in range(101):
        node.move((step * LENGTH_TOLERANCE / 10, 0.0, 0.0))
    last = [value for name, value in handle.assigned if name == "position"][-1]
    assert last[0] == pytest.approx(10 * LENGTH_TOLERANCE, abs=1.1 * LENGTH_TOLERANCE)


def test_a_watch_lets_changes_through():
    watch = ChangeDetector(0.1)
    assert watch.changed((1.0, 2.0))
    assert not watch.changed((1.05, 2.0))
    assert watch.changed((1.2, 2.0))
    assert watch.changed((1.2,))
