"""What the paper and its authors' own simulator give, against ours (docs/method.md; figures of issue 2).

`sim/reproduction/data/authors_direct_caging.csv` is a whole run of direct caging by the authors' public simulator
(Space-Robotics-Laboratory, MATLAB_space_debri_capturing_sim, MIT licence, commit 053c3e2), for K. Uchida,
K. Uno, K. Yoshida, "Space Debris Reliable Capturing by a Dual-Arm Orbital Robot: Detumbling and Caging", iSpaRo 2024.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sim.snapshot import OutcomeClass

AUTHORS = Path(__file__).parents[2] / "sim" / "reproduction" / "data" / "authors_direct_caging.csv"

FORCE = 0.10
"""Relative: figure of the issue for the first touch and the direct run."""
TOUCH_TIME = 0.05
"""[s]: figure of the issue for the first touch."""
POSE_BEFORE_CONTACT = 1e-3
"""[m, rad]: without contact only their time step (RK4) and the lag of our servo, 1 ms of motion, differ."""
SPIN_CHANGE = 0.05
"""Relative, of what direct caging takes from the spin. Their hand velocity uses an unrotated lever arm."""
LATER_TIMES = 0.02
"""Relative, of the time since the first touch: a touch leaves drift and spin 1 % from theirs, and the target
then drifts for seconds; at finer steps the difference halves (see the last test)."""
CLOSING_TIME = 0.1
"""[s]: the first touch of `published` ends on the target's corner, where the authors' face formula jumps."""


def authors():
    lines = [line for line in AUTHORS.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return np.genfromtxt(lines, delimiter=",", names=True)


def at_their_times(ticks, theirs):
    """Our ticks at the times of their rows."""
    return ticks[np.rint(theirs["t"] / 1e-3).astype(int)]


def episodes(contacts, gap):
    """Touches (arm, start, end) with those of one arm closer than a gap [s] made one."""
    merged: list[list] = []
    for touch in contacts:
        if merged and merged[-1][0] == touch.arm and touch.start - merged[-1][2] < gap:
            merged[-1][2] = touch.end
        else:
            merged.append([touch.arm, touch.start, touch.end])
    return merged


class TestDirectCaging:
    def test_peak_force(self, fly):
        outcome = fly("published", direct=True).outcome
        assert outcome.peak_tip_force == pytest.approx(1.13, rel=FORCE)
        assert outcome.peak_tip_force_to_closure == pytest.approx(1.13, rel=FORCE)

    @pytest.mark.parametrize("arm", [0, 1], ids=["left", "right"])
    def test_peak_force_of_each_hand_is_the_authors(self, fly, arm):
        theirs = authors()["Fhand_LR"[:6] + "LR"[arm]].max()
        assert fly("published", direct=True).hand_force[:, arm].max() == pytest.approx(theirs, rel=FORCE)

    def test_motion_before_contact_is_the_authors(self, fly):
        theirs = authors()
        theirs = theirs[theirs["t"] < fly("published", direct=True).outcome.contacts[0].start]
        ours = at_their_times(fly("published", direct=True).ticks, theirs)
        pairs = {
            "base_x": ours["base_pose"][:, 0],
            "base_y": ours["base_pose"][:, 1],
            "base_yaw": ours["base_pose"][:, 2],
            "targ_yaw": ours["target_pose"][:, 2],
        }
        for arm, side in enumerate("LR"):
            for joint in range(3):
                pairs[f"q{joint + 1}{side}"] = ours["joint_angle"][:, arm, joint]
            pairs[f"manip_{side}"] = ours["manipulability"][:, arm]
        errors = {name: float(np.abs(theirs[name] - values).max()) for name, values in pairs.items()}
        assert max(errors.values()) < POSE_BEFORE_CONTACT, errors

    def test_first_contact_comes_when_the_authors_does(self, fly):
        theirs = authors()
        first = theirs["t"][np.flatnonzero(theirs["Fhand_L"] + theirs["Fhand_R"])[0]]
        assert fly("published", direct=True).outcome.contacts[0].start == pytest.approx(first, abs=0.01)

    def test_spin_after_contact_is_the_authors(self, fly):
        theirs = authors()
        after = 3.0
        expected = theirs["targ_w"][np.searchsorted(theirs["t"], after)]
        ticks = fly("published", direct=True).ticks
        spin = ticks["target_twist"][np.searchsorted(ticks["time"], after), 2]
        assert spin - 1.0 == pytest.approx(expected - 1.0, rel=SPIN_CHANGE)

    def test_it_ends_caged_without_force_reduced_by_planned_touches(self, fly):
        outcome = fly("published", direct=True).outcome
        assert outcome.caged
        assert outcome.outcome is OutcomeClass.CAGED_UNPLANNED_CONTACT


class TestPublished:
    """The representative case, m 0.10, d 1.5, k 10."""

    def test_first_touch_is_by_the_right_hand(self, fly):
        first = fly("published").outcome.contacts[0]
        assert first.arm == "right"
        assert first.start == pytest.approx(3.457, abs=TOUCH_TIME)
        assert first.planned

    def test_one_touch_until_closure(self, fly):
        """Contacts within one absorption, D = 0.35 s, are one touch: the hand has not been moved elsewhere."""
        outcome = fly("published").outcome
        before = [touch for touch in outcome.contacts if touch.start < outcome.closed_at]
        touches = episodes(before, gap=0.35)
        assert len(touches) == 1
        assert touches[0][2] == pytest.approx(4.169, abs=CLOSING_TIME)

    def test_spin_crosses_its_threshold(self, fly):
        ticks = fly("published").ticks
        crossing = ticks["time"][np.argmax(np.abs(ticks["target_twist"][:, 2]) < 0.5)]
        assert crossing == pytest.approx(3.826, abs=0.01)

    def test_spin_after_the_touch(self, fly):
        ticks = fly("published").ticks
        spin = ticks["target_twist"][np.searchsorted(ticks["time"], 5.0), 2]
        assert 0.10 < spin < 0.17

    def test_closure(self, fly):
        outcome = fly("published").outcome
        assert outcome.closed_at == pytest.approx(5.406, abs=CLOSING_TIME)
        assert outcome.at_first_closure is OutcomeClass.CAGED_FORCE_REDUCED
        assert outcome.outcome is outcome.at_locked_arms

    def test_blow_after_closure(self, fly):
        """What the paper's tables do not show: the hands strike while they finish closing."""
        flown = fly("published")
        assert flown.largest_force(flown.outcome.closed_at, 60.0) == pytest.approx(1.919, rel=FORCE)
        assert flown.outcome.peak_tip_force == pytest.approx(1.919, rel=FORCE)
        assert flown.outcome.at_locked_arms is not OutcomeClass.CAGED_FORCE_REDUCED

    def test_it_ends_in_a_true_cage(self, fly):
        outcome = fly("published").outcome
        assert outcome.caged
        assert outcome.cage_margin > 0.0


class TestPublishedFigures:
    """m 0.2, d 0.1, k 0.1: the repeated touches of the paper's figures."""

    AUTHORS_TOUCHES = (("right", 3.46), ("left", 7.09), ("left", 11.52), ("right", 16.58), ("right", 17.06))
    AUTHORS_CLOSURE = 21.0

    @staticmethod
    def planned_times(outcome):
        return [touch for touch in outcome.contacts if touch.start < outcome.closed_at]

    def test_five_touches_by_the_same_arms(self, fly):
        touches = self.planned_times(fly("published_figures").outcome)
        assert [touch.arm for touch in touches] == [arm for arm, _ in self.AUTHORS_TOUCHES]

    def test_times_of_touch(self, fly):
        touches = self.planned_times(fly("published_figures").outcome)
        first = self.AUTHORS_TOUCHES[0][1]
        for touch, (_, time) in zip(touches, self.AUTHORS_TOUCHES, strict=True):
            assert touch.start == pytest.approx(time, abs=TOUCH_TIME + LATER_TIMES * (time - first))

    def test_closure(self, fly):
        since_first = self.AUTHORS_CLOSURE - self.AUTHORS_TOUCHES[0][1]
        closed_at = fly("published_figures").outcome.closed_at
        assert closed_at == pytest.approx(self.AUTHORS_CLOSURE, abs=TOUCH_TIME + LATER_TIMES * since_first)

    def test_peak_force_over_the_whole_sequence(self, fly):
        outcome = fly("published_figures").outcome
        assert outcome.peak_tip_force == pytest.approx(0.615, rel=FORCE)
        assert outcome.peak_tip_force_to_closure == pytest.approx(0.615, rel=FORCE)

    def test_spin_falls_with_every_touch_until_the_threshold(self, fly):
        flown = fly("published_figures")
        touches = self.planned_times(flown.outcome)
        ticks = flown.ticks
        spins = [ticks["target_twist"][np.searchsorted(ticks["time"], touch.end + 0.01), 2] for touch in touches]
        assert all(later < earlier for earlier, later in zip([1.0, *spins[:-1]], spins, strict=True))
        assert spins[-1] < 0.5 < spins[-2]

    def test_it_ends_in_a_true_cage(self, fly):
        outcome = fly("published_figures").outcome
        assert outcome.caged
        assert outcome.cage_margin > 0.0

    def test_a_finer_physics_step_comes_nearer_to_the_authors(self, fly):
        """Their times are not tuned for: what separates us from them is the discretisation of the contact."""
        finer = {"simulation.time_step": 0.5e-3}
        gaps = []
        for changes in ({}, finer):
            touches = self.planned_times(fly("published_figures", changes=changes).outcome)
            gaps.append(abs(touches[4].start - self.AUTHORS_TOUCHES[4][1]))
        assert gaps[1] < 0.7 * gaps[0]
