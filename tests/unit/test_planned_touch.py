"""What our own method shows of the touch that it has planned, and how far it has come."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from server.scene.touches import marks_of
from sim.capture.mission import Mission
from sim.configurations import named_configuration, revised
from sim.control.phases import Command


def flown(spin=1.0, method="becalm"):
    """The snapshots of a capture, every 10 ms, to its end."""
    config = revised(
        named_configuration(method), {"simulation": {"engine": "reduced"}, "target": {"initial_spin": spin}}
    )
    mission = Mission(config)
    mission.request(Command.CAPTURE)
    snapshots = []
    while mission.outcome is None:
        mission.advance(10)
        snapshots.append(mission.snapshot())
    return snapshots


@cache
def captured():
    return flown()


def _turn(one, other):
    """The third component of their cross product."""
    return float(one[0] * other[1] - one[1] * other[0])


@pytest.mark.parametrize("spin", [1.0, -1.0])
def test_each_hand_presses_on_one_of_two_opposite_sides_where_it_brakes(spin):
    touch = next(
        each.plan.touch for each in (captured() if spin > 0.0 else flown(spin)) if each.plan and each.plan.touch
    )
    torque = 0.0
    for side, point in ((touch.left_side, touch.left_point), (touch.right_side, touch.right_point)):
        start, end, at = np.array(side[0]), np.array(side[1]), np.array(point)
        assert np.linalg.norm(end - start) == pytest.approx(0.15)
        along = (end - start) / 0.15
        assert abs(_turn(along, at - start)) < 1e-12  # on the side, between its ends
        assert 0.0 < along @ (at - start) < 0.15
        inwards = -(start + end) / np.linalg.norm(start + end)
        torque += _turn(at, inwards)
    assert np.array(touch.left_side) == pytest.approx(-np.array(touch.right_side))
    assert np.sign(torque) == -np.sign(spin)
    assert marks_of(touch) == ((*touch.left_side, touch.left_point), (*touch.right_side, touch.right_point))


def test_the_arc_runs_out_while_both_hands_press_and_the_lever_stays_near_the_plan():
    touching = [each.plan.touch for each in captured() if each.activity == "touching"]
    arcs = [touch.arc_left for touch in touching]
    assert all(later <= earlier for earlier, later in pairwise(arcs))
    assert arcs[0] > 0.3 > arcs[-1]
    assert all(0.05 < touch.lever < 0.1 for touch in touching)


def test_it_is_told_while_it_lasts():
    told = next(each for each in captured() if each.activity == "touching" and each.left.in_contact)
    assert f"lever {1e3 * told.plan.touch.lever:.0f} mm, " in told.description
    assert "degrees of arc left" in told.description


def test_a_closing_and_the_published_method_press_on_no_two_sides():
    assert all(each.plan.touch is None for each in captured() if each.activity == "closing")
    assert marks_of(None) == ()
    published = flown(method="published")
    assert any(each.plan for each in published)
    assert all(each.plan is None or each.plan.touch is None for each in published)
