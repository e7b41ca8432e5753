"""Whole missions by `Mission`: every command in every phase, stop, hold, release, a second capture, live changes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sim.capture.mission import Mission
from sim.config import MissionConfig
from sim.configurations import named_configuration, nested, revised
from sim.control.phases import Command, Phase, next_phase
from sim.errors import ConfigError, MissionRefused, PlantDiverged
from sim.method.published.memory import Activity

AT_REST = 1e-3
"""[rad/s]: what is left of joint rates of 0.5 rad/s after twenty time constants of the servo (1 ms)."""
SETTLING_TICKS = 20
"""Pymunk's iterations spread a jump of the rates along the arm within as many steps."""


def _bodies(mission: Mission) -> Any:
    """Those of the simulated plant: a test moves them as nothing else may."""
    plant: Any = mission._plant
    return plant._bodies


def mission_in(phase: Phase) -> Mission:
    """A mission that has come to that phase by commands alone."""
    mission = Mission(named_configuration("published"))
    if phase is Phase.FAULTED:
        return torn(mission)
    steps = {
        Phase.IDLE: [],
        Phase.DETUMBLING: [Command.CAPTURE],
        Phase.CAGING: [Command.CAGE],
        Phase.HOLDING: [Command.CAPTURE, Command.HOLD],
        Phase.RELEASED: [Command.CAPTURE, Command.HOLD, Command.RELEASE],
        Phase.STOPPED: [Command.CAPTURE, Command.STOP],
    }
    for command in steps[phase]:
        mission.request(command)
        mission.advance(50)
    mission.advance(5)
    assert mission.phase is phase
    return mission


def torn(mission: Mission) -> Mission:
    """A mission whose plant has lost its numbers: a link's angular velocity is not finite."""
    mission.request(Command.CAPTURE)
    _bodies(mission)[2].angular_velocity = math.nan
    mission.advance(10)
    with pytest.raises(PlantDiverged):
        mission.advance(1)
    return mission


class TestEveryCommandInEveryPhase:
    @pytest.mark.parametrize("command", list(Command))
    @pytest.mark.parametrize("phase", [phase for phase in Phase if phase is not Phase.FAULTED])
    def test_is_granted_or_refused_as_the_table_says(self, phase, command):
        mission = mission_in(phase)
        try:
            expected, _ = next_phase(phase, command)
        except MissionRefused:
            with pytest.raises(MissionRefused, match=f"{command.value} is refused in phase {phase.label}"):
                mission.request(command)
            mission.advance(3)
            assert mission.phase is phase
            return
        mission.request(command)
        assert mission.phase is expected
        rows = mission.advance(3)
        assert (rows["phase"] == int(expected)).all()
        assert np.isfinite(rows["joint_rate"]).all()

    def test_a_refusal_disturbs_nothing(self):
        asked, left_alone = mission_in(Phase.CAGING), mission_in(Phase.CAGING)
        for command in (Command.RELEASE, Command.DIRECT_CAGE, Command.DETUMBLE):
            with pytest.raises(MissionRefused):
                asked.request(command)
        assert np.array_equal(asked.advance(500)["joint_angle"], left_alone.advance(500)["joint_angle"])


class TestFault:
    def test_plant_that_is_not_finite_faults_the_mission(self):
        mission = mission_in(Phase.FAULTED)
        assert mission.phase is Phase.FAULTED
        (fault,) = [event for event in mission.take_events() if event.kind == "fault"]
        assert fault.severity == "error"

    def test_the_ticks_until_then_are_given_and_no_more_are_flown(self):
        mission = Mission(named_configuration("published"))
        mission.request(Command.CAPTURE)
        mission.advance(5)
        _bodies(mission)[2].angular_velocity = math.nan
        rows = mission.advance(10)
        assert len(rows) == 1
        assert np.isfinite(rows["base_pose"]).all()
        with pytest.raises(PlantDiverged, match="not finite"):
            mission.advance(1)

    @pytest.mark.parametrize("command", [command for command in Command if command is not Command.STOP])
    def test_a_fault_refuses_everything(self, command):
        mission = mission_in(Phase.FAULTED)
        with pytest.raises(MissionRefused, match="reset"):
            mission.request(command)

    def test_stop_is_granted_and_does_not_hide_the_fault(self):
        mission = mission_in(Phase.FAULTED)
        mission.stop()
        assert mission.phase is Phase.FAULTED


class TestStop:
    @pytest.mark.parametrize("moving", [Phase.DETUMBLING, Phase.CAGING, Phase.RELEASED])
    def test_joint_rates_are_zero_at_once(self, moving):
        mission = mission_in(moving)
        before = mission.advance(200)[-1]
        assert np.abs(before["commanded_joint_rate"]).max() > 1e-3
        mission.stop()
        rows = mission.advance(100)
        assert not rows["commanded_joint_rate"].any()
        assert (rows["phase"] == int(Phase.STOPPED)).all()
        assert np.abs(rows["joint_rate"][SETTLING_TICKS:]).max() < AT_REST

    def test_during_a_touch(self):
        mission = Mission(named_configuration("published"))
        mission.request(Command.CAPTURE)
        mission.advance(3600)
        assert mission.activity is Activity.ABSORBING
        mission.stop()
        assert not mission.advance(500)["commanded_joint_rate"].any()

    def test_stays_until_a_reset(self):
        mission = mission_in(Phase.STOPPED)
        assert not mission.advance(2000)["commanded_joint_rate"].any()
        for command in (Command.CAPTURE, Command.HOLD, Command.RELEASE):
            with pytest.raises(MissionRefused, match="reset"):
                mission.request(command)


class TestHold:
    def test_drops_the_plan_and_holds_the_joints(self):
        mission = mission_in(Phase.DETUMBLING)
        mission.advance(500)
        mission.request(Command.HOLD)
        rows = mission.advance(1000)
        assert not rows["commanded_joint_rate"].any()
        assert np.ptp(rows["joint_angle"][SETTLING_TICKS:], axis=0).max() < AT_REST
        assert mission.snapshot().plan is None

    def test_detumbling_may_go_on_from_there(self):
        mission = mission_in(Phase.HOLDING)
        mission.request(Command.CAPTURE)
        rows = mission.advance(500)
        assert np.abs(rows["commanded_joint_rate"]).max() > 0.01


class TestACaptureAndAfter:
    @pytest.fixture
    def captured(self):
        mission = Mission(named_configuration("published"))
        mission.request(Command.DIRECT_CAGE)
        while mission.outcome is None:
            mission.advance(1000)
        return mission

    def test_release_draws_the_hands_back_and_a_new_capture_is_judged_again(self, captured):
        assert captured.outcome.caged
        assert captured.phase.label == "holding"
        first = captured.outcome

        captured.request(Command.RELEASE)
        rows = captured.advance(2500)
        apart = np.hypot(*(rows["hand_pose"][:, 1, :2] - rows["hand_pose"][:, 0, :2]).T)
        assert apart[-1] > apart[0] + 0.15
        assert captured.phase is Phase.RELEASED
        assert not rows[-1]["commanded_joint_rate"].any()
        assert not captured.cage().caged

        captured.request(Command.CAPTURE)
        assert captured.outcome is None
        captured.advance(100)
        assert captured.snapshot().contacts == []
        while captured.outcome is None:
            captured.advance(1000)
        assert captured.outcome is not first
        assert captured.outcome.duration <= captured.config.judging.time_limit + 0.01

    def test_the_mission_flies_on_after_its_verdict(self):
        mission = Mission(revised(named_configuration("published"), nested({"judging.time_limit": 1.0})))
        mission.request(Command.CAPTURE)
        assert len(mission.advance(5000)) == 1001
        assert mission.outcome is not None
        assert len(mission.advance(500)) == 500
        assert mission.phase is Phase.HOLDING

    def test_detumbling_alone_ends_in_holding(self):
        mission = Mission(named_configuration("published"))
        mission.request(Command.DETUMBLE)
        mission.advance(6000)
        assert mission.phase is Phase.HOLDING
        assert abs(mission.snapshot().spin) < mission.config.published.caging.spin_threshold
        assert mission.outcome is None

    def test_time_is_ticks_times_the_period(self):
        mission = mission_in(Phase.DETUMBLING)
        row = mission.advance(2345)[-1]
        assert row["time"] == pytest.approx(row["tick"] * 1e-3, abs=1e-9)
        assert mission.time == pytest.approx((row["tick"] + 1) * 1e-3, abs=1e-9)


class TestLiveChanges:
    """A change of m, d, k during a touch does not jump the commanded hand velocity (ros2_controllers 1169, 1178)."""

    CHANGE_AT = 3600

    def absorbing(self) -> Mission:
        mission = Mission(named_configuration("published"))
        mission.request(Command.CAPTURE)
        mission.advance(self.CHANGE_AT)
        assert mission.activity is Activity.ABSORBING
        return mission

    @pytest.mark.parametrize(
        ("mass", "damping", "stiffness"),
        [(0.5, 15.0, 100.0), (0.01, 0.0, 0.0), (0.01, 15.0, 100.0), (0.5, 0.0, 10.0), (0.05, 1.5, 100.0)],
    )
    def test_of_the_impedance_are_bumpless(self, mass, damping, stiffness):
        """Bound: one period of the acceleration that the new impedance gives at this force, speed and displacement."""
        mission = self.absorbing()
        before = mission.advance(1)[0]
        changes = {"mass": mass, "damping": damping, "stiffness": stiffness}
        mission.configure(revised(mission.config, {"published": {"impedance": changes}}))
        after = mission.advance(1)[0]

        period = mission.config.control.period
        speed = before["desired_hand_twist"]
        displacement = mission._own[0]["admittance_displacement"]
        drive = np.abs(after["hand_wrench"]) + damping * np.abs(speed) + stiffness * np.abs(displacement)
        bound = period * drive / mass
        jump = np.abs(after["desired_hand_twist"] - speed)
        assert (jump <= bound + 1e-12).all()

    def test_without_a_difference_they_change_nothing(self):
        changed, left_alone = self.absorbing(), self.absorbing()
        changed.configure(revised(changed.config, {}))
        assert np.array_equal(changed.advance(400)["joint_rate"], left_alone.advance(400)["joint_rate"])

    def test_of_a_fixed_parameter_are_refused_by_name(self):
        mission = self.absorbing()
        heavier = revised(mission.config, nested({"target.mass": 3.0, "published.impedance.damping": 3.0}))
        with pytest.raises(MissionRefused, match=r"target\.mass"):
            mission.configure(heavier)
        assert mission.config == named_configuration("published")

    def test_of_the_spin_threshold_take_effect(self):
        mission = self.absorbing()
        mission.configure(revised(mission.config, nested({"published.caging.spin_threshold": 0.9})))
        mission.advance(400)
        assert mission.phase is Phase.CAGING


def test_a_target_that_overlaps_the_robot_starts_no_mission():
    overlapping = MissionConfig().target.model_copy(update={"initial_y": 0.12})
    with pytest.raises(ConfigError, match=r"target\.initial_y = 0\.12 m.*overlaps"):
        Mission(MissionConfig().model_copy(update={"target": overlapping}))


class TestMomentumThatJumps:
    """Nothing pushes from outside: a change of total momentum is a plant that can no longer be trusted."""

    def test_is_a_fault_that_keeps_the_ticks_so_far(self):
        mission = mission_in(Phase.DETUMBLING)
        _bodies(mission)[-1].velocity = (0.05, 0.0)
        rows = mission.advance(10)
        assert len(rows) >= 1
        assert mission.phase is Phase.FAULTED
        assert [event.severity for event in mission.take_events() if event.kind == "fault"] == ["error"]
        with pytest.raises(PlantDiverged, match="momentum jumped"):
            mission.advance(1)

    def test_is_bounded_by_the_configuration(self):
        config = revised(MissionConfig(), nested({"simulation.momentum_jump_limit": 10.0}))
        mission = Mission(config)
        mission.request(Command.CAPTURE)
        mission.advance(5)
        _bodies(mission)[-1].velocity = (0.05, 0.0)
        mission.advance(10)
        assert mission.phase is Phase.DETUMBLING
