"""Halving the physics step must not change what the hands feel: the servo is physics, not an artefact of the step."""

from __future__ import annotations

import numpy as np
import pytest

PEAK = 0.05
"""Relative change of a peak force when the step is halved (issue 2)."""
HAMMERING = 0.06
"""Relative change of the hammering peak from 1 to 0.5 ms: the one exception to `PEAK`, measured 0.051."""
HAMMERING_FROM = 3.92
"""[s]: from here the first touch of `published` is at the target's corner, under the authors' face formula."""
FINER = {"simulation.time_step": 0.5e-3}
RADIAL = {"contact.corner": "radial"}


def test_peak_of_direct_caging(fly):
    coarse, fine = (fly("published", direct=True, changes=changes).outcome for changes in ({}, FINER))
    assert fine.peak_tip_force == pytest.approx(coarse.peak_tip_force, rel=PEAK)


def test_peak_of_published_figures(fly):
    coarse, fine = (fly("published_figures", changes=changes).outcome for changes in ({}, FINER))
    assert fine.peak_tip_force == pytest.approx(coarse.peak_tip_force, rel=PEAK)
    assert len(fine.contacts) >= 5
    assert [touch.arm for touch in fine.contacts[:5]] == [touch.arm for touch in coarse.contacts[:5]]


def test_blow_after_closure_of_published(fly):
    coarse, fine = (fly("published", changes=changes) for changes in ({}, FINER))
    blows = [flown.largest_force(flown.outcome.closed_at, 60.0) for flown in (coarse, fine)]
    assert blows[1] == pytest.approx(blows[0], rel=PEAK)


def test_first_touch_of_published_before_the_corner(fly):
    coarse, fine = (fly("published", changes=changes) for changes in ({}, FINER))
    peaks = [flown.largest_force(0.0, HAMMERING_FROM) for flown in (coarse, fine)]
    assert peaks[1] == pytest.approx(peaks[0], rel=PEAK)


def test_whole_first_touch_converges_with_a_radial_corner(fly):
    """With a normal that does not jump at the corner there is nothing left that depends on the step."""
    coarse, fine = (fly("published", changes={**RADIAL, **changes}) for changes in ({}, FINER))
    peaks = [flown.largest_force(0.0, 5.0) for flown in (coarse, fine)]
    assert peaks[1] == pytest.approx(peaks[0], rel=PEAK)
    ends = [flown.outcome.contacts[0].end for flown in (coarse, fine)]
    assert ends[1] == pytest.approx(ends[0], abs=0.01)


def test_documented_exception_the_corner_hammers_under_the_face_formula(fly):
    """Known and kept, for it is how the tables were computed: beside the corner the face formula switches faces.

    The tip is thrown between two normals a right angle apart, step by step, so the peak of those last contacts
    follows the step: 0.89 N at 1 ms, 0.94 at 0.5 ms (the authors: 0.94), 5.1 % and more than the 5 % of all
    other peaks. It stays under the bound of reduced force, so the class does not change.
    """
    face, radial = fly("published"), fly("published", changes=RADIAL)
    at_corner = face.largest_force(HAMMERING_FROM, face.outcome.closed_at)
    assert at_corner > 1.5 * radial.largest_force(HAMMERING_FROM, 5.0)
    assert at_corner < 1.12969
    fine = fly("published", changes=FINER)
    assert fine.largest_force(HAMMERING_FROM, fine.outcome.closed_at) == pytest.approx(at_corner, rel=HAMMERING)
    assert fine.outcome.at_first_closure is face.outcome.at_first_closure


def test_a_finer_control_period_keeps_the_peak_of_direct_caging(fly):
    finer = {"control.period": 0.5e-3, "simulation.time_step": 0.5e-3}
    outcome = fly("published", direct=True, changes=finer).outcome
    assert outcome.peak_tip_force == pytest.approx(fly("published", direct=True).outcome.peak_tip_force, rel=PEAK)
    assert np.isfinite(outcome.momentum_error)
