"""Arrows keep to their scale, however short."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from server.scene.arrows import HEAD_LENGTH, LARGEST_HEAD, point_arrows


def arrow(length):
    return np.array([[[0.0, 0.0, 0.0], [length, 0.0, 0.0]]])


def test_a_long_arrow_has_its_full_head():
    handle: Any = SimpleNamespace()
    point_arrows(handle, arrow(0.2))
    assert handle.visible
    assert handle.head_length == HEAD_LENGTH
    assert handle.points == pytest.approx(arrow(0.2))


def test_the_head_of_a_short_arrow_is_never_longer_than_the_arrow():
    handle: Any = SimpleNamespace()
    point_arrows(handle, np.concatenate([arrow(0.2), arrow(0.01)]))
    assert handle.head_length == pytest.approx(LARGEST_HEAD * 0.01, abs=1e-4)


def test_no_arrows_are_hidden():
    handle: Any = SimpleNamespace()
    point_arrows(handle, np.zeros((0, 2, 3)))
    assert not handle.visible
