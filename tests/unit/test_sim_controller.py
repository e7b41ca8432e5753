"""The controller's parts: rate bound, holding, absorbing, the idle arm, the beginning of a sequence."""

from __future__ import annotations

import math

import numpy as np
import pytest

import sim.method.published.method  # noqa: F401  # registers the functions of the handle
from sim.config import MissionConfig
from sim.configurations import nested, revised
from sim.control.admittance import admittance_transition
from sim.control.hand_motion import HAND_MOTION, command_joint_rates, hand_twist, hold_joints
from sim.control.memory import MEMORY, NEVER
from sim.control.phases import Phase, Sequence, Verdict
from sim.method.method import begin_sequence, decide
from sim.method.published.memory import PUBLISHED_MEMORY, Activity, PlanKind, PublishedHandle
from sim.method.published.sequence import absorb, idle_arm_is_free
from sim.model.clearance import initial_base_pose
from sim.model.generalized_jacobian import free_flying_model, momentum
from sim.model.reduced_model import CHAIN, SHAPE, set_chain, shape_of_state
from sim.model.robot import chain, initial_joint_angles, robot_model
from sim.perception.perceived import PERCEIVED
from sim.record import record_of

CONFIG = MissionConfig()
ROBOT = robot_model(CONFIG.robot)
PARAMETERS = record_of(CONFIG)
TRANSITION = admittance_transition(CONFIG.published.impedance, CONFIG.control.period)
RATES = np.array([1.0, -2.0, 0.5, 0.0, 3.0, -1.0])


OWN = PublishedHandle(np.zeros(1, PUBLISHED_MEMORY), TRANSITION)
"""The method's handle, which every test begins from nothing."""


def at_start(phase: Phase = Phase.IDLE, sequence: Sequence = Sequence.NONE):
    """Memory, state and chain of a mission that begins such a sequence."""
    memory, state = np.zeros(1, MEMORY)[0], np.zeros(1, PERCEIVED)[0]
    begin_sequence(OWN, memory, int(phase), int(sequence))
    state["base_pose"] = initial_base_pose(CONFIG)
    state["joint_angle"] = initial_joint_angles(CONFIG.robot.arm)
    state["target_pose"], state["target_twist"] = (0.0, 0.35, 0.0), (0.0, 0.0, 1.0)
    return memory, state, links_of(state)


def links_of(state):
    return chain(ROBOT, state["base_pose"], state["joint_angle"], state["mount_angle"])


def run(memory, state, parameters=PARAMETERS, verdict=Verdict.NONE):
    shape, links, motion = (np.zeros(1, kind)[0] for kind in (SHAPE, CHAIN, HAND_MOTION))
    set_chain(state["base_pose"], shape_of_state(ROBOT, state, shape), links)
    decide(OWN, memory, parameters, ROBOT, state, shape, links, motion, int(verdict))


class TestRateBound:
    def commanded(self, rates):
        memory, *_ = at_start()
        command_joint_rates(memory, PARAMETERS, np.array(rates, dtype=float))
        return memory

    def test_leaves_ordinary_rates_alone(self):
        memory = self.commanded(RATES)
        assert memory["commanded_joint_rate"].ravel().tolist() == RATES.tolist()
        assert not memory["rate_limited"]

    def test_scales_all_together_so_that_the_hand_keeps_its_course(self):
        memory = self.commanded(10.0 * RATES)
        assert memory["rate_limited"]
        assert np.abs(memory["commanded_joint_rate"]).max() == pytest.approx(10.0)
        assert memory["commanded_joint_rate"].ravel() == pytest.approx(RATES * 10.0 / 3.0)

    @pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
    def test_commands_nothing_rather_than_what_is_not_finite(self, bad):
        memory = self.commanded([1.0, bad, 0.0, 0.0, 0.0, 0.0])
        assert memory["rate_limited"]
        assert not memory["commanded_joint_rate"].any()


class TestHolding:
    @pytest.mark.parametrize("phase", [Phase.IDLE, Phase.HOLDING, Phase.STOPPED, Phase.FAULTED])
    def test_phases_at_rest_command_zero_rates(self, phase):
        memory, state, _ = at_start(phase)
        memory["commanded_joint_rate"] = 1.0
        run(memory, state)
        assert not memory["commanded_joint_rate"].any()
        assert memory["activity"] == Activity.NONE

    def test_hands_are_wanted_where_they_are(self):
        memory, _, links = at_start()
        hold_joints(memory, links.hand_pose)
        assert memory["desired_hand_pose"].tolist() == links.hand_pose.tolist()
        assert not memory["desired_hand_twist"].any()


class TestTracking:
    def test_hands_of_a_capture_follow_their_plan(self):
        """The commanded rates, with the base reacting, give the working hand the planned twist."""
        memory, state, _ = at_start(Phase.DETUMBLING, Sequence.CAPTURE)
        run(memory, state)
        assert memory["activity"] == Activity.APPROACHING
        assert memory["plan_kind"] == PlanKind.TOUCH
        state["time"] = 0.8
        run(memory, state)
        state["joint_rate"] = memory["commanded_joint_rate"]
        model = free_flying_model(ROBOT, state["base_pose"], links_of(state))
        state["base_twist"] = -model.base_reaction[:, :6] @ state["joint_rate"].ravel()
        twist = hand_twist(state, links_of(state), 1)
        assert np.abs(memory["desired_hand_twist"][1]).max() > 0.01
        assert twist == pytest.approx(memory["desired_hand_twist"][1], abs=1e-9)

    def test_hands_keep_their_course_on_a_robot_that_carries_momentum(self):
        """Eq. 2: what momentum alone does to the hands is taken off the wanted velocity."""
        memory, state, _ = at_start(Phase.CAGING, Sequence.CAGE_ONLY)
        run(memory, state)
        state["time"], state["base_twist"] = 0.6, (0.02, -0.01, 0.05)
        run(memory, state)
        model = free_flying_model(ROBOT, state["base_pose"], links_of(state))
        P = momentum(model.momentum_matrix, np.array([*state["base_twist"], *np.zeros(8)]))
        rates = memory["commanded_joint_rate"].ravel()
        twist = model.generalized_jacobian[:, :6] @ rates + model.momentum_map @ P
        assert twist.reshape(2, 3) == pytest.approx(memory["desired_hand_twist"], abs=1e-9)

    def test_damped_least_squares_asks_for_less_near_a_singularity(self):
        damped = record_of(revised(CONFIG, nested({"control.rates.singularity_handling": "damped_least_squares"})))
        asked = []
        for parameters in (PARAMETERS, damped):
            memory, state, _ = at_start(Phase.CAGING, Sequence.CAGE_ONLY)
            state["joint_angle"][1, 1] = 1e-3
            run(memory, state, parameters)
            state["time"] = 0.5
            run(memory, state, parameters)
            asked.append(np.abs(memory["commanded_joint_rate"]).max())
        assert asked[1] < 0.5 * asked[0]

    def test_damping_does_nothing_far_from_a_singularity(self):
        damped = record_of(revised(CONFIG, nested({"control.rates.singularity_handling": "damped_least_squares"})))
        asked = []
        for parameters in (PARAMETERS, damped):
            memory, state, _ = at_start(Phase.CAGING, Sequence.CAGE_ONLY)
            run(memory, state, parameters)
            state["time"] = 0.5
            run(memory, state, parameters)
            asked.append(memory["commanded_joint_rate"].copy())
        assert asked[1] == pytest.approx(asked[0], abs=1e-12)


class TestAbsorbing:
    def test_begins_at_rest_and_keeps_its_displacement(self):
        memory, state, links = at_start()
        own = OWN.own[0]
        own["admittance_velocity"], own["admittance_displacement"] = 9.0, 0.01
        velocity = np.zeros((2, 3))
        absorb(own, memory, TRANSITION, state, links.hand_pose, velocity)
        period, impedance = CONFIG.control.period, CONFIG.published.impedance
        fall = -impedance.stiffness * 0.01 / impedance.mass * period
        assert velocity == pytest.approx(np.full((2, 3), fall), rel=0.02)
        assert own["absorbing"]

    def test_goes_on_from_its_velocity(self):
        memory, state, links = at_start()
        velocity = np.zeros((2, 3))
        state["hand_wrench"][1, 0] = 0.5
        speeds = []
        for _ in range(5):
            absorb(OWN.own[0], memory, TRANSITION, state, links.hand_pose, velocity)
            speeds.append(velocity[1, 0])
        assert all(later > earlier for earlier, later in zip([0.0, *speeds], speeds, strict=False))
        assert not velocity[0].any()

    def test_lasts_its_part_of_d_from_the_last_contact(self):
        memory, state, _ = at_start(Phase.DETUMBLING, Sequence.CAPTURE)
        activities = {}
        state["tip_contact"][1, 0] = 1
        for time in (0.0, 0.279, 0.281, 0.349, 0.351):
            state["time"] = time
            run(memory, state)
            activities[time] = Activity(int(memory["activity"]))
            state["tip_contact"][1, 0] = 0
        assert activities == {
            0.0: Activity.ABSORBING,
            0.279: Activity.ABSORBING,
            0.281: Activity.RETREATING,
            0.349: Activity.RETREATING,
            0.351: Activity.APPROACHING,
        }
        assert memory["plan_count"] == 1


class TestEvents:
    def test_contact_is_remembered_in_detumbling_and_caging_only(self):
        for phase, remembered in ((Phase.DETUMBLING, True), (Phase.CAGING, True), (Phase.HOLDING, False)):
            memory, state, _ = at_start(phase, Sequence.CAPTURE)
            state["time"], state["tip_contact"][0, 1] = 2.0, 1
            run(memory, state)
            assert (OWN.own[0]["last_contact"] == 2.0) == remembered

    def test_first_slow_instant_is_kept(self):
        memory, state, _ = at_start(Phase.DETUMBLING, Sequence.CAPTURE)
        for time, spin in ((1.0, 0.51), (2.0, -0.49), (3.0, 0.6), (4.0, 0.1)):
            state["time"], state["target_twist"][2] = time, spin
            run(memory, state)
        assert OWN.own[0]["slow_since"] == 2.0

    @pytest.mark.parametrize(
        ("sequence", "following"), [(Sequence.CAPTURE, Phase.CAGING), (Sequence.DETUMBLE_ONLY, Phase.HOLDING)]
    )
    def test_detumbling_ends_d_after_the_spin_is_slow(self, sequence, following):
        memory, state, _ = at_start(Phase.DETUMBLING, sequence)
        OWN.own[0]["slow_since"] = 1.0
        for time, phase in ((1.349, Phase.DETUMBLING), (1.352, following)):
            state["time"] = time
            run(memory, state)
            assert memory["phase"] == phase

    def test_caging_locks_when_the_plan_is_done_and_the_tips_enclose(self):
        memory, state, _ = at_start(Phase.CAGING, Sequence.CAGE_ONLY)
        run(memory, state)
        assert memory["activity"] == Activity.CLOSING
        state["time"] = 60.0
        run(memory, state)
        assert (memory["phase"], memory["activity"]) == (Phase.CAGING, Activity.WAITING)
        state["closed"] = 1
        run(memory, state)
        assert memory["phase"] == Phase.HOLDING

    def test_a_contact_in_caging_makes_a_new_plan_unless_closed(self):
        for closed, plans in ((0, 2), (1, 1)):
            memory, state, _ = at_start(Phase.CAGING, Sequence.CAGE_ONLY)
            run(memory, state)
            state["time"], state["tip_contact"][0, 0] = 0.5, 1
            run(memory, state)
            state["tip_contact"][0, 0], state["closed"], state["time"] = 0, closed, 0.851
            run(memory, state)
            assert memory["plan_count"] == plans

    def test_direct_caging_plans_once(self):
        memory, state, _ = at_start(Phase.CAGING, Sequence.DIRECT_CAGE)
        for time, contact in ((0.0, 0), (0.5, 1), (1.0, 0), (2.0, 0)):
            state["time"], state["tip_contact"][0, 0] = time, contact
            run(memory, state)
        assert memory["plan_count"] == 1


class TestIdleArm:
    def free(self, state=None, **changes):
        memory, start, _ = at_start(Phase.DETUMBLING, Sequence.CAPTURE)
        memory["plan_arm"] = 1
        state = start if state is None else state
        parameters = record_of(revised(CONFIG, nested(changes))) if changes else PARAMETERS
        return idle_arm_is_free(memory, parameters, ROBOT, state, links_of(state).hand_pose)

    def test_is_free_at_the_start(self):
        assert self.free()

    def test_is_not_while_its_tips_are_near_the_target(self):
        _, state, _ = at_start()
        state["target_pose"][0] = -0.1
        assert not self.free(state)

    @pytest.mark.parametrize(("arm", "joint"), [(0, 1), (0, 2), (1, 1), (1, 2)])
    def test_is_not_while_an_elbow_or_wrist_is_nearly_straight(self, arm, joint):
        _, state, _ = at_start()
        state["joint_angle"][arm, joint] = math.radians(29)
        assert not self.free(state)


@pytest.mark.parametrize(
    ("verdict", "phase"),
    [
        (Verdict.EJECTION, Phase.HOLDING),
        (Verdict.BASE_COLLISION, Phase.STOPPED),
        (Verdict.TIME_LIMIT, Phase.HOLDING),
        (Verdict.LOCKED, Phase.HOLDING),
    ],
)
def test_a_verdict_ends_the_sequence_with_the_joints_held(verdict, phase):
    memory, state, _ = at_start(Phase.DETUMBLING, Sequence.CAPTURE)
    run(memory, state)
    state["time"] = 0.5
    run(memory, state)
    assert memory["commanded_joint_rate"].any()
    run(memory, state, verdict=verdict)
    assert (memory["phase"], memory["activity"], memory["sequence"]) == (phase, Activity.NONE, Sequence.NONE)
    assert not memory["commanded_joint_rate"].any()


def test_a_sequence_begins_with_nothing_left_of_the_last():
    memory, own = np.zeros(1, MEMORY)[0], OWN.own[0]
    memory["plan_kind"], memory["plan_knots"] = PlanKind.CAGE, 3
    own["cage_planned"], own["absorbing"] = 1, 1
    own["admittance_displacement"], own["slow_since"], own["last_contact"] = 0.1, 3.0, 4.0
    begin_sequence(OWN, memory, int(Phase.DETUMBLING), int(Sequence.CAPTURE))
    assert memory["plan_kind"] == PlanKind.NONE
    assert memory["plan_knots"] == own["cage_planned"] == own["absorbing"] == 0
    assert not own["admittance_displacement"].any()
    assert own["slow_since"] == math.inf
    assert own["last_contact"] == NEVER
