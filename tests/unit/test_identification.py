"""Fits find what a run was flown with from what its log holds, and say what it does not hold."""

import threading
from functools import cache

import numpy as np
import pytest

from sim.capture.mission import Mission
from sim.config import MissionConfig
from sim.configurations import named_configuration, nested, revised
from sim.control.phases import Command
from sim.errors import ConfigError, MissionRefused
from sim.identification.fit import fit, planned
from sim.identification.parameters import ALL, STAMP_ERROR, parameters_of
from sim.identification.pictures import pictures
from sim.identification.recording import commands_at, recording
from sim.identification.shooting import Shot, Weights
from sim.identification.varpro import FitCancelled, Problem
from sim.plant.engine import simulated_plant

HIDDEN = {
    "contact": {"stiffness": 1100.0, "friction": 0.2},
    "robot": {"servo": {"time_constant": 0.004}},
    "target": {"inertia": 0.0105},
    "perception": {"capture": {"stamp_error": 0.005}},
    "table": {"drag": 0.05},
}
NAMES = (
    "contact.stiffness",
    "contact.friction",
    "robot.servo.time_constant",
    "target.inertia",
    "table.drag",
    STAMP_ERROR,
)


@cache
def nominal() -> MissionConfig:
    noise = {"position": 2e-4, "angle": 1e-3, "force": 0.02, "torque": 1e-3}
    return revised(
        named_configuration("testbed"),
        {"simulation": {"engine": "reduced"}, "perception": {"source": "motion_capture", "noise": noise}},
    )


@cache
def ticks():
    """Of a run whose target is struck once, and of which a log holds what was perceived."""
    true = revised(nominal(), HIDDEN)
    mission = Mission(true, simulated_plant(true))
    mission.request(Command.CAPTURE)
    return np.concatenate([mission.advance(100) for _ in range(10)])


def log(rows):
    """The rows without what only a simulation knows."""
    kept = rows.copy()
    for name in ("base_pose", "base_twist", "target_pose", "target_twist", "hand_wrench", "tip_force", "momentum"):
        kept[name] = np.nan
    return kept


@cache
def fitted():
    return fit(planned([recording("struck", nominal(), [log(ticks())])], NAMES))


def test_hidden_values_are_found_within_their_errors():
    found = {each.name: each for each in fitted().parameters}
    true = dict(zip(NAMES, (1100.0, 0.2, 0.004, 0.0105, 0.05, 0.005), strict=True))
    for name, value in true.items():
        assert found[name].told, found[name].why_not
        assert abs(found[name].value - value) < 5.0 * found[name].standard_error, name
    for name in ("contact.stiffness", "contact.friction", "robot.servo.time_constant", "target.inertia"):
        assert found[name].value == pytest.approx(true[name], rel=0.1), name


def test_the_miss_is_taken_apart_into_parts_that_sum_up():
    miss = fitted().miss
    assert miss.measured == pytest.approx(fitted().touch_predictions[0].measured)
    assert sum(part.part for part in miss.parts) == pytest.approx(miss.fitted - miss.nominal, abs=1e-9)
    assert miss.fitted + miss.unexplained == pytest.approx(miss.measured)
    assert abs(miss.unexplained) < abs(miss.measured - miss.nominal)


def test_a_preset_keeps_what_the_configuration_has():
    assert set(fitted().preset) == set(NAMES)
    revised(nominal(), nested(fitted().preset))


def test_a_touch_of_more_than_tips_does_not_count_unless_its_law_is_fitted(monkeypatch):
    run = recording("struck", nominal(), [log(ticks())])

    def solved(names):
        problem = Problem([run], planned([run], names).parameters, threads=1)
        values = problem.values(np.zeros(len(names)))
        found = problem.solve(values, Weights(3e-4, 1.5e-3, 3e-4, 1.5e-3, 2e-5, 0.02, 1e-3))
        predict = Shot.predict
        monkeypatch.setattr(Shot, "predict", lambda *given: predict(*given)._replace(solid=True))
        problem.find_solid(values, found)
        monkeypatch.undo()
        problem.leave_out(found, 1e9)
        return problem

    counted = solved(("contact.stiffness",))
    assert counted.solid == [shot.stretch.touches for shot in counted.shots]
    assert counted.counted == [not shot.stretch.touches for shot in counted.shots]
    assert all(solved(("contact.stiffness", "contact.solid_stiffness")).counted)


def test_commands_may_come_between_two_periods():
    run = recording("struck", nominal(), [log(ticks()[:600])])
    commanded = ticks()[:600]["commanded_joint_rate"]
    period = nominal().control.period
    assert commands_at(run, 0.0)[300].tolist() == commanded[300].tolist()
    assert commands_at(run, 1.25 * period)[300] == pytest.approx(0.75 * commanded[299] + 0.25 * commanded[298])
    assert commands_at(run, -0.25 * period)[300] == pytest.approx(0.75 * commanded[300] + 0.25 * commanded[301])
    assert np.isfinite(commands_at(run, -0.25 * period)).all()


def test_residuals_fall_to_the_noise_of_the_sensors():
    left = {each.name: each for each in fitted().channels}
    assert left["target.x"].rms == pytest.approx(2e-4, rel=0.2)
    assert left["target.x"].rms < left["target.x"].rms_nominal
    assert len(left["target.x"].time) == len(left["target.x"].predicted) > 50


def test_without_a_touch_no_contact_is_told_and_it_is_said():
    run = recording("free", nominal(), [log(ticks()[:600])])
    result = fit(planned([run], ("contact.stiffness", "robot.servo.time_constant")))
    stiffness, servo = result.parameters
    assert not stiffness.told
    assert stiffness.value == stiffness.nominal
    assert "no hand touches" in str(stiffness.why_not)
    assert servo.value == pytest.approx(0.004, rel=0.01)
    assert result.miss is None


def test_what_acts_alike_is_not_told_apart():
    run = recording("free", nominal(), [log(ticks()[:600])])
    result = fit(planned([run], ("robot.servo.time_constant", "robot.base.mass", "target.mass")))
    assert [each.name for each in result.parameters if not each.told] == ["target.mass"]


def test_a_delay_of_commands_is_seen_in_the_joints():
    rows = log(ticks()[:600])
    assert recording("prompt", nominal(), [rows]).command_delay == 0.0
    rows["commanded_joint_rate"][:-2] = rows["commanded_joint_rate"][2:].copy()
    late = recording("late", nominal(), [rows[:-2]])
    assert late.command_delay == pytest.approx(2 * nominal().control.period)


def test_pictures_are_got_back_with_white_noise():
    rows = ticks()
    seen = pictures(revised(nominal(), {}), rows).target
    true = rows["target_pose"] - 0.005 * rows["target_twist"]  # the stamps are that wrong
    left = (seen - true)[np.isfinite(seen[:, 0])]
    assert len(left) > 400
    assert left.std(axis=0) == pytest.approx([2e-4, 2e-4, 1e-3], rel=0.15)
    assert np.corrcoef(left[:-1, 0], left[1:, 0])[0, 1] == pytest.approx(0.0, abs=0.15)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda rows: rows[:50], "a fit takes 1 s or more"),
        (lambda rows: rows[:0], "it has no ticks"),
    ],
)
def test_a_run_that_says_too_little_is_refused(change, words):
    with pytest.raises(MissionRefused, match=words):
        recording("short", nominal(), [change(log(ticks()))])


@pytest.mark.parametrize("field", ["commanded_joint_rate", "target_perceived_pose", "joint_angle"])
def test_a_run_without_what_a_fit_needs_is_refused_by_name(field):
    rows = log(ticks())
    rows[field] = np.nan
    with pytest.raises(MissionRefused, match=field):
        recording("poor", nominal(), [rows])


def test_stretches_that_are_not_numbers_cost_no_more_than_themselves():
    rows = log(ticks()[:600])
    rows["target_perceived_pose"][200:260] = np.nan
    rows["joint_angle"][300:310] = np.nan
    result = fit(planned([recording("holes", nominal(), [rows])], ("robot.servo.time_constant",)))
    assert result.parameters[0].value == pytest.approx(0.004, rel=0.02)


def test_nothing_is_flown_across_a_gap():
    rows = np.concatenate([log(ticks()[:300]), log(ticks()[340:600])])
    run = recording("gap", nominal(), [rows])
    assert run.segment[-1] == 1
    assert any("1 gaps" in notice for notice in fit(planned([run], ("robot.servo.time_constant",))).notices)


def test_a_joint_state_that_was_missed_is_no_gap_and_time_goes_on():
    rows = log(ticks()[:600])
    kept = np.delete(rows, [200, 300, 301, *range(400, 410)])
    kept["tick"] = rows["tick"][: len(kept)]  # a console counts what it has got
    run = recording("missed", nominal(), [kept])
    assert len(run.time) == 590
    assert np.flatnonzero(np.diff(run.segment)).tolist() == [399]
    assert run.time[:400] == pytest.approx(rows["time"][:400])
    assert run.commanded[200].tolist() == rows["commanded_joint_rate"][199].tolist()
    assert run.joint_angle[200] == pytest.approx(rows["joint_angle"][200], abs=1e-4)
    assert np.isnan(run.wrench[[200, 300, 301]]).all()
    assert np.isfinite(run.wrench[[199, 201, 299, 302]]).all()


def test_names_are_checked():
    with pytest.raises(ConfigError, match=r"contact\.stiffnes"):
        parameters_of(nominal(), ["contact.stiffnes"])
    with pytest.raises(ConfigError, match="twice"):
        parameters_of(nominal(), ["contact.stiffness", "contact.stiffness"])
    with pytest.raises(ConfigError, match="from 1 to"):
        parameters_of(nominal(), [])
    assert all(each.low < each.high and each.spread > 0 for each in parameters_of(nominal(), ALL[:16]))


def test_a_cancelled_fit_ends():
    cancelled = threading.Event()
    cancelled.set()
    with pytest.raises(FitCancelled):
        fit(planned([recording("struck", nominal(), [log(ticks())])], NAMES), cancelled=cancelled)
