"""The words beside the numbers: one sentence at any moment, and go or no-go for what comes next."""

from __future__ import annotations

import numpy as np
import pytest

from sim.capture.narration import description, readiness
from sim.capture.snapshot import Plan, Touch
from sim.capture.tick import TICK
from sim.config import MissionConfig
from sim.control.phases import Activity, Phase

CONFIG = MissionConfig()
POSE = (0.0, 0.0, 0.0)


def row(phase: Phase, activity: Activity = Activity.NONE, *, time=1.0, spin=1.0, closed=0):
    tick = np.zeros(1, TICK)[0]
    tick["phase"], tick["activity"], tick["time"], tick["closed"] = phase, activity, time, closed
    tick["target_twist"][2] = spin
    return tick


def plan(kind="touch", arm="right", until=3.0) -> Plan:
    poses = [POSE, POSE]
    return Plan(
        kind=kind,
        times=[0.0, until],
        left=poses if arm in ("left", "both") else [],
        right=poses if arm in ("right", "both") else [],
        target_at_end=POSE,
    )


def told(*args, planned: Plan | None = None, touches=(), **kwargs) -> str:
    return description(row(*args, **kwargs), CONFIG, planned, list(touches), None)


class TestDescription:
    @pytest.mark.parametrize("phase", list(Phase))
    @pytest.mark.parametrize("activity", list(Activity))
    def test_is_a_sentence_at_any_moment(self, phase, activity):
        words = told(phase, activity)
        assert words[0].isupper()
        assert words.endswith(".")

    def test_names_the_hand_that_approaches_and_its_time(self):
        words = told(Phase.DETUMBLING, Activity.APPROACHING, planned=plan(arm="left", until=3.0), time=1.0)
        assert "left hand" in words
        assert "2.0 s" in words

    def test_names_the_hand_that_absorbs(self):
        touch = Touch(arm="left", start=1.0, end=None, peak=0.1, planned=True)
        words = told(Phase.DETUMBLING, Activity.ABSORBING, planned=plan(arm="right"), touches=[touch])
        assert "left hand" in words

    def test_tells_the_spin(self):
        assert "0.73 rad/s" in told(Phase.IDLE, spin=0.73)


class TestReadiness:
    def test_says_which_phase_would_come_next(self):
        assert readiness(row(Phase.IDLE, spin=1.0), CONFIG, None).next == "detumbling"
        assert readiness(row(Phase.IDLE, spin=0.1), CONFIG, None).next == "caging"
        assert readiness(row(Phase.CAGING), CONFIG, None).next == "holding"
        assert readiness(row(Phase.STOPPED), CONFIG, None).next == "reset"

    @pytest.mark.parametrize(("spin", "go"), [(0.6, False), (0.4, True), (-0.4, True), (-0.6, False)])
    def test_of_caging_follows_the_spin(self, spin, go):
        found = readiness(row(Phase.DETUMBLING, Activity.RETREATING, spin=spin), CONFIG, None)
        assert found.go == go
        assert f"{abs(spin):.2f} rad/s" in found.reasons[0]

    def test_of_caging_waits_for_the_touch_to_be_absorbed(self):
        found = readiness(row(Phase.DETUMBLING, Activity.ABSORBING, spin=0.1), CONFIG, None)
        assert not found.go
        assert len(found.reasons) == 2

    @pytest.mark.parametrize(
        ("activity", "closed", "go"),
        [(Activity.CLOSING, 1, False), (Activity.WAITING, 0, False), (Activity.WAITING, 1, True)],
    )
    def test_of_holding_needs_closed_tips_and_a_finished_motion(self, activity, closed, go):
        assert readiness(row(Phase.CAGING, activity, closed=closed), CONFIG, None).go == go

    @pytest.mark.parametrize("phase", list(Phase))
    def test_always_gives_a_reason(self, phase):
        assert readiness(row(phase), CONFIG, None).reasons
