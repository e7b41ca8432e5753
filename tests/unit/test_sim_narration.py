"""The words beside the numbers: one sentence at any moment, and go or no-go for what comes next."""

from __future__ import annotations

import numpy as np
import pytest

from sim.capture.narration import description, readiness
from sim.capture.stages import Visit, stages, visits_after
from sim.capture.tick import TICK
from sim.config import MissionConfig
from sim.control.phases import Phase
from sim.method.published.memory import Activity
from sim.snapshot import Outcome, OutcomeClass, Plan, Touch

CONFIG = MissionConfig()
POSE = (0.0, 0.0, 0.0)


def row(phase: Phase, activity: Activity = Activity.NONE, *, time=1.0, spin=1.0, closed=0):
    tick = np.zeros(1, TICK)[0]
    tick["phase"], tick["activity"], tick["time"] = phase, activity, time
    tick["closed"] = tick["perceived_closed"] = closed
    tick["target_twist"][2] = tick["target_perceived_twist"][2] = spin
    return tick


def plan(kind="touch", arm="right", until=3.0) -> Plan:
    poses = [POSE, POSE]
    return Plan(
        kind=kind,
        times=[0.0, until],
        left=poses if arm in ("left", "both") else [],
        right=poses if arm in ("right", "both") else [],
        target_at_end=POSE,
        predicted=None,
        touch=None,
    )


def told(*args, planned: Plan | None = None, touches=(), **kwargs) -> str:
    return description(row(*args, **kwargs), CONFIG, args[0], planned, list(touches), None)


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


def ready(phase: Phase, *args, outcome=None, **kwargs):
    return readiness(row(phase, *args, **kwargs), CONFIG, phase, outcome)


def met(found) -> dict[str, bool]:
    return {condition.name: condition.met for condition in found.conditions}


class TestReadiness:
    def test_says_which_phase_would_come_next(self):
        assert ready(Phase.IDLE, spin=1.0).next == "detumbling"
        assert ready(Phase.IDLE, spin=0.1).next == "caging"
        assert ready(Phase.CAGING).next == "holding"
        assert ready(Phase.STOPPED).next == "reset"

    @pytest.mark.parametrize(("spin", "go"), [(0.6, False), (0.4, True), (-0.4, True), (-0.6, False)])
    def test_of_caging_follows_the_spin(self, spin, go):
        found = ready(Phase.DETUMBLING, Activity.RETREATING, spin=spin)
        assert found.go == go
        assert met(found) == {"spin": go, "absorbed": True}
        condition = found.conditions[0]
        assert (condition.value, condition.bound, condition.unit) == (abs(spin), 0.5, "rad/s")
        assert f"{abs(spin):.2f} rad/s" in condition.words

    def test_of_caging_waits_for_the_touch_to_be_absorbed(self):
        found = ready(Phase.DETUMBLING, Activity.ABSORBING, spin=0.1)
        assert not found.go
        assert met(found) == {"spin": True, "absorbed": False}

    @pytest.mark.parametrize(
        ("activity", "closed", "go"),
        [(Activity.CLOSING, 1, False), (Activity.WAITING, 0, False), (Activity.WAITING, 1, True)],
    )
    def test_of_holding_needs_closed_tips_and_a_finished_motion(self, activity, closed, go):
        assert ready(Phase.CAGING, activity, closed=closed).go == go

    @pytest.mark.parametrize("phase", [Phase.STOPPED, Phase.FAULTED])
    def test_is_never_go_after_a_stop_or_a_fault(self, phase):
        found = ready(phase, spin=0.1)
        assert not found.go
        assert found.blocked
        assert "only a reset" in found.blocked

    @pytest.mark.parametrize("phase", [Phase.HOLDING, Phase.STOPPED, Phase.IDLE])
    def test_is_blocked_after_a_capture_that_failed(self, phase):
        found = ready(phase, outcome=outcome(caged=False))
        assert (found.go, found.next) == (False, "reset")
        assert found.blocked

    def test_of_releasing_is_go_once_caged_with_its_margin(self):
        found = ready(Phase.HOLDING, outcome=outcome(caged=True))
        assert found.go
        assert "5.0 mm" in found.conditions[0].words
        assert not ready(Phase.HOLDING).go

    @pytest.mark.parametrize("phase", list(Phase))
    @pytest.mark.parametrize("activity", list(Activity))
    def test_always_gives_a_reason_and_is_go_only_if_all_are_met(self, phase, activity):
        found = ready(phase, activity)
        assert found.conditions or found.blocked
        assert found.go == (found.blocked is None and all(met(found).values()))


def outcome(*, caged: bool) -> Outcome:
    kind = OutcomeClass.CAGED_FORCE_REDUCED if caged else OutcomeClass.EJECTION
    return Outcome.model_construct(
        outcome=kind,
        at_first_closure=kind,
        at_locked_arms=kind,
        caged=caged,
        cage_margin=0.005 if caged else None,
        peak_tip_force=0.6,
        peak_tip_force_to_closure=0.6,
        closed_at=None,
        locked_at=None,
        duration=1.0,
        contacts=[],
        final_target_spin=0.0,
        min_manipulability=0.02,
        momentum_error=0.0,
    )


def flown(*parts: tuple[Phase, float, int], outcome: Outcome | None = None, now: Phase | None = None) -> list[str]:
    """Stages after half a second in each phase, with that spin and closure at its end."""
    rows = [row(phase, time=0.5 * place, spin=spin, closed=closed) for place, (phase, spin, closed) in enumerate(parts)]
    visits: list[Visit] = []
    for each in rows:
        visits = visits_after(visits, np.array([each]), CONFIG)
    found = stages(visits, now or parts[-1][0], outcome)
    return [f"{stage.phase} {stage.state}" for stage in found]


IDLE, SLOWED, SPINNING = (Phase.IDLE, 1.0, 0), (Phase.DETUMBLING, 0.4, 0), (Phase.DETUMBLING, 0.8, 0)
CLOSED, OPEN, HELD = (Phase.CAGING, 0.1, 1), (Phase.CAGING, 0.1, 0), (Phase.HOLDING, 0.0, 1)


class TestStages:
    def test_of_a_capture_that_goes_as_it_should(self):
        assert flown(IDLE, SLOWED) == ["idle done", "detumbling now", "caging ahead", "holding ahead"]
        assert flown(IDLE, SLOWED, CLOSED, HELD) == ["idle done", "detumbling done", "caging done", "holding now"]

    def test_what_was_never_flown_was_skipped(self):
        assert flown(IDLE, CLOSED) == ["idle done", "detumbling skipped", "caging now", "holding ahead"]

    @pytest.mark.parametrize("end", [Phase.STOPPED, Phase.FAULTED])
    def test_a_stop_and_a_fault_fail_what_was_under_way(self, end):
        expected = ["idle done", "detumbling failed", "caging skipped", "holding skipped", f"{end.label} now"]
        assert flown(IDLE, SPINNING, (end, 0.8, 0)) == expected
        assert flown(IDLE, SPINNING, now=end) == expected  # before a tick shows it

    def test_a_phase_that_was_left_too_early_has_failed(self):
        assert flown(IDLE, SPINNING, HELD)[1] == "detumbling failed"
        assert flown(IDLE, SPINNING, CLOSED)[1] == "detumbling failed"
        assert flown(IDLE, SLOWED, OPEN, HELD)[2] == "caging failed"

    def test_the_verdict_has_the_last_word(self):
        failed = flown(IDLE, SLOWED, CLOSED, HELD, outcome=outcome(caged=False))
        assert failed == ["idle done", "detumbling done", "caging failed", "holding now"]

    def test_they_tell_how_long_and_why(self):
        visits = visits_after(
            [],
            np.array(
                [row(*each[:1], time=t, spin=each[1]) for t, each in ((0.0, IDLE), (1.0, SPINNING), (3.5, SPINNING))]
            ),
            CONFIG,
        )
        found = stages(visits, Phase.STOPPED, None)
        assert [stage.lasted for stage in found] == [1.0, 2.5, None, None, 0.0]
        assert found[1].why == "stopped before it was done"
        assert found[2].why == "it was not flown"
