"""A target whose mass does not lie in its middle: what moves, what is seen, what is refused, and what a log tells."""

import math

import numpy as np
import pytest

from server.link.imperfections import Imperfections
from server.link.perception import Perception
from server.link.testbed import EmulatedTestbed
from server.link.wire import JointSample, PlaneSample, decode_pose, decode_twist
from sim.capture.mission import Mission
from sim.capture.run import run_capture
from sim.config import Engine
from sim.configurations import named_configuration, revised
from sim.control.phases import Command
from sim.errors import ConfigError
from sim.identification.fit import fit, planned
from sim.identification.recording import recording
from sim.model.shape import inner_radius
from sim.model.target import seen_target_shape, target_shape, to_centre_of_mass, to_middle
from sim.perception.perceived import PERCEIVED
from sim.plant.engine import simulated_plant
from sim.plant.plant import PLANT_STATE
from sim.record import record_of
from sim.rehearsal.situation import Situation
from sim.rehearsal.uncertainty import UncertaintyModel, draw, true_state

OFF = {"target": {"centre_of_mass_x": 0.01, "centre_of_mass_y": -0.004}}
STILL = np.zeros((2, 3))


def test_the_middle_lies_and_moves_where_the_turned_offset_says():
    target = record_of(revised(named_configuration("becalm"), OFF).target)
    pose, twist = np.array([1.0, 2.0, math.pi / 2]), np.array([0.1, 0.2, 3.0])
    to_middle(target, pose, twist)
    # Turned by a quarter, the centre of mass is (0.004, 0.01) from the middle in the world.
    assert pose == pytest.approx([1.0 - 0.004, 2.0 - 0.01, math.pi / 2])
    assert twist == pytest.approx([0.1 + 3.0 * 0.01, 0.2 - 3.0 * 0.004, 3.0])
    to_centre_of_mass(target, pose, twist)
    assert pose == pytest.approx([1.0, 2.0, math.pi / 2])
    assert twist == pytest.approx([0.1, 0.2, 3.0])


def test_the_outline_stays_where_it_is_seen():
    target = revised(named_configuration("becalm"), OFF).target
    true, seen = target_shape(target), seen_target_shape(target)
    assert true.vertices[:4] == pytest.approx(seen.vertices[:4] - np.array([0.01, -0.004]))
    assert inner_radius(true) == pytest.approx(0.065)
    assert seen.is_square
    assert not true.is_square


@pytest.mark.parametrize("engine", list(Engine))
def test_a_free_target_turns_about_its_centre_of_mass(engine):
    config = revised(named_configuration("testbed"), OFF | {"simulation": {"engine": engine}})
    plant, record = simulated_plant(config), record_of(config.target)
    began = plant.state["target_pose"].copy()
    middles = []
    for _ in range(400):
        plant.apply_joint_rates(STILL)
        pose, twist = plant.state["target_pose"].copy(), plant.state["target_twist"].copy()
        to_middle(record, pose, twist)
        middles.append(pose)
    turned = plant.state["target_pose"][2] - began[2]
    assert turned == pytest.approx(2.0, abs=1e-6)  # 1 rad/s for 2 s
    assert plant.state["target_pose"][:2] == pytest.approx(began[:2], abs=1e-9)
    radius = [math.hypot(*(pose[:2] - began[:2])) for pose in middles]
    assert radius == pytest.approx(len(radius) * [math.hypot(0.01, 0.004)], abs=1e-9)


@pytest.mark.parametrize("name", ["becalm", "testbed"])
def test_what_is_perceived_is_the_middle(name):
    config = revised(named_configuration(name), OFF)
    mission = Mission(config)
    row = mission.advance(50)[-1]
    pose, twist = row["target_pose"].copy(), row["target_twist"].copy()
    assert not np.allclose(row["target_perceived_pose"][:2], pose[:2], atol=5e-3)
    to_middle(record_of(config.target), pose, twist)
    assert row["target_perceived_pose"] == pytest.approx(pose, abs=3e-3)
    assert row["target_perceived_twist"] == pytest.approx(twist, abs=4e-3)


def test_motion_capture_of_the_emulated_robot_sees_the_middle():
    config = revised(named_configuration("testbed"), OFF)
    perfect = Imperfections(**dict.fromkeys(Imperfections.model_fields, 0.0))
    testbed, record = EmulatedTestbed(config, perfect, 0), record_of(config.target)
    testbed.move(STILL)
    told = {each.channel.key: each.payload for each in [*testbed.measure(1, "r"), *testbed.measure(2, "r")]}
    pose, twist = testbed.state["target_pose"].copy(), testbed.state["target_twist"].copy()
    to_middle(record, pose, twist)
    assert decode_pose(told["becalm/target/pose"]).value == pytest.approx(pose, abs=1e-9)
    assert decode_twist(told["becalm/target/twist"]).value == pytest.approx(twist, abs=1e-9)


def test_the_state_of_a_robot_has_its_targets_centre_of_mass():
    config = revised(named_configuration("testbed"), OFF)
    perception, period = Perception(config), 5_000_000
    for count in range(1, 9):
        stamp = count * period
        perception.take_base(PlaneSample(stamp, "world", np.zeros(3)))
        perception.take_target(PlaneSample(stamp, "world", np.array([0.0, 0.35, 0.0])))
        perception.take_joints(JointSample(stamp, np.zeros((2, 3)), np.zeros((2, 3))))
    state, known = np.zeros(1, PLANT_STATE)[0], np.zeros(1, PERCEIVED)[0]
    perception.write_state(state, known)
    assert known["target_pose"] == pytest.approx([0.0, 0.35, 0.0], abs=1e-6)
    assert state["target_pose"] == pytest.approx([0.01, 0.346, 0.0], abs=1e-6)


def test_a_future_begins_with_the_centre_of_mass_where_it_is():
    config = revised(named_configuration("becalm"), OFF)
    mission = Mission(config)
    mission.advance(50)
    situation = Situation.of(mission)
    drawn = draw(situation, config, UncertaintyModel(), 1, 0)
    state = true_state(situation, drawn.model_copy(update={"values": dict.fromkeys(drawn.values, 0.0)}))
    true = mission.advance(1)[-1]
    assert state["target_pose"] == pytest.approx(true["target_pose"], abs=3e-3)
    assert state["target_twist"] == pytest.approx(true["target_twist"], abs=4e-3)


@pytest.mark.parametrize("engine", list(Engine))
def test_our_method_cages_a_target_whose_mass_lies_off_its_middle(engine):
    changes = OFF | {"simulation": {"engine": engine}}
    found = run_capture(revised(named_configuration("becalm"), changes))
    assert found.outcome.caged
    assert found.monitor["peak"].max() < 0.3


def test_a_centre_of_mass_outside_of_the_outline_is_refused():
    with pytest.raises(ConfigError, match=r"target.centre_of_mass_x, _y = 0\.1, 0 m: it lies 0\.025 m outside"):
        revised(named_configuration("becalm"), {"target": {"centre_of_mass_x": 0.1}})


def test_a_log_tells_where_the_centre_of_mass_is():
    noise = {"position": 2e-4, "angle": 1e-3, "force": 0.02, "torque": 1e-3}
    changes = {"simulation": {"engine": "reduced"}, "perception": {"source": "motion_capture", "noise": noise}}
    nominal = revised(named_configuration("testbed"), changes)
    true = revised(nominal, OFF)
    mission = Mission(true, simulated_plant(true))
    mission.request(Command.CAPTURE)
    ticks = np.concatenate([mission.advance(100) for _ in range(6)])
    for name in ("base_pose", "base_twist", "target_pose", "target_twist", "hand_wrench", "tip_force", "momentum"):
        ticks[name] = np.nan  # a log holds what was perceived
    names = ("target.centre_of_mass_x", "target.centre_of_mass_y")
    found = {each.name: each for each in fit(planned([recording("off", nominal, [ticks])], names)).parameters}
    for name, value in zip(names, (0.01, -0.004), strict=True):
        assert found[name].told, found[name].why_not
        assert found[name].value == pytest.approx(value, abs=5e-4)
        assert abs(found[name].value - value) < 5.0 * (found[name].standard_error or 0.0)
