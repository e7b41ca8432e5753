"""Each fault of robot or network, with what must happen: two processes on loopback.

By when is told by the ends themselves: the message says how old the silence was when it was noticed. Beside the
deadline and one control period it may have taken as long as a thread of that process waited for the machine meanwhile,
which is measured.
"""

from __future__ import annotations

import random
import re
import signal
import time

import numpy as np
import pytest

from server.link import contract, wire
from server.link.contract import RobotMode
from server.link.reception import MODE_DEADLINE, PING_PERIOD
from server.link.zenoh_plant import ZenohPlant
from server.log.ros import ros, serialized
from sim.capture.mission import Mission
from sim.control.phases import Phase
from sim.errors import MissionRefused

from .ends import CONFIG, ROBOT_DEADLINE, SHORT, Stalled, becalm, keeping_up, taken, until

PERIOD = 1 / contract.CONTROL_RATE
SWITCH = 0.05
"""Between threads of one process, all of which want to run [s]."""


def _assert_in_time(message, deadline, waited, period=PERIOD):
    """It was noticed at the deadline, no later than a period and what a thread waited for this machine."""
    found = re.search(r"(?:no [a-z ]+ for|the same for) (\d+) ms", message)
    assert found is not None, message
    age = 1e-3 * float(found[1])
    assert age >= deadline - 0.001
    if age > deadline + period + SWITCH + waited:
        raise Stalled(message)


def _assert_held(robot, flight, words):
    """The console has faulted with these words and told the robot to stop; the robot stands still and stays so."""
    message = flight.await_fault(words)
    assert flight.mission.phase is Phase.FAULTED
    with pytest.raises(type(flight.fault)):
        flight.mission.advance(1)
    until(lambda: robot.status["mode"] in ("stopped", "waiting"), "the robot has stopped, or has restarted")
    until(robot.at_rest, "the joints rest")
    commands = robot.status["commands"]
    assert robot.at_rest()
    assert robot.status["commands"] == commands
    return message


@keeping_up
def test_a_mission_flies_and_knows_the_robots_clock(robot, link, fly):
    flight = fly()
    flight.ticks(20)
    assert flight.mission.phase is Phase.IDLE
    assert robot.status["mode"] == "following"
    assert robot.status["session"] == link.session
    assert link.other_clock.offset == pytest.approx(3.5, abs=0.05)
    assert link.reports.value("tared") == "true"
    target = flight.mission.snapshot().target
    assert target.twist[2] == pytest.approx(robot.status["target_twist"][2], abs=0.05)


@keeping_up
def test_the_robot_is_held_still_while_its_mission_is_made(robot, link):
    plant = taken(link)
    commands = robot.status["commands"]
    until(lambda: robot.status["commands"] > commands + 20, "the robot is answered")
    assert robot.at_rest()
    mission = Mission(CONFIG, plant)
    mission.advance(5)
    assert mission.phase is Phase.IDLE, mission.fault


@keeping_up
def test_a_robot_that_hangs_is_noticed_within_the_deadline(robot, fly, gaps):
    flight = fly()
    flight.capture()
    flight.notice_within(SHORT)
    robot.hang(2 * SHORT)
    message = _assert_held(robot, flight, r"no [a-z ]+ for \d+ ms")
    _assert_in_time(message, SHORT, gaps())


@keeping_up
def test_a_process_that_hangs_and_comes_back_executes_nothing_of_what_waited(robot, link, fly, gaps):
    flight = fly()
    flight.capture()
    flight.notice_within(SHORT)
    robot.process.signal(signal.SIGSTOP)
    _assert_in_time(flight.await_fault(r"no [a-z ]+ for \d+ ms"), SHORT, gaps())
    rate = np.ones((2, 3))
    for number in range(20):  # what a console that has not noticed would go on sending
        link.send_joint_rates(link.streams[contract.JOINT_STATES.key].latest + number, rate)
    robot.process.signal(signal.SIGCONT)
    _assert_held(robot, flight, r"no [a-z ]+ for \d+ ms|late")
    again = fly()  # and neither side was restarted
    again.ticks(20)
    assert robot.status["mode"] == "following"


@keeping_up
@pytest.mark.parametrize("faults", [{"delay": 3 * SHORT}, {"loss": 1.0}])
def test_a_network_that_is_too_slow_or_gone(robot, fly, faults, gaps):
    flight = fly()
    flight.capture()
    flight.notice_within(SHORT)
    robot.inject_faults(**faults)
    _assert_in_time(_assert_held(robot, flight, r"no [a-z ]+ for \d+ ms"), SHORT, gaps())
    robot.inject_faults()
    robot.restart()  # what is still under way would come late into the next flight; and the next life is not delayed


@keeping_up
def test_what_was_on_its_way_when_a_session_began_says_nothing_of_it(link, fly, stranger, caplog):
    told = []
    stranger.subscribe(contract.MODE, told.append)
    fly().ticks(20)
    former = link.session
    overtaken = until(lambda: next((each for each in told if _session_of(each) == former), None), "its mode is told")
    flight = fly()
    stranger.publish(contract.MODE, overtaken)

    def marked() -> bool:  # what comes after it on the same way is taken after it
        latest = link.reports.latest
        mark = latest._replace(stamp=latest.stamp + 1, values=latest.values | {"last_refusal": "a mark"})
        stranger.publish(contract.MODE, wire.encode_report(mark))
        return "the robot refused a mark" in caplog.text

    until(marked, "what came after it was taken")
    flight.ticks(20)
    assert link.reports.value("session") == link.session != former


def _session_of(mode):
    return wire.decode_report(mode).values["session"]


@keeping_up
def test_some_loss_and_jitter_are_flown_through_and_shown(robot, link, fly):
    flight = fly()
    robot.inject_faults(loss=0.2, jitter=0.004)
    joints = link.streams[contract.JOINT_STATES.key]

    def shown():
        rate, jitter, loss = joints.measured(time.monotonic())
        return rate < contract.CONTROL_RATE and (jitter or 0.0) > 1e-4 and (loss or 0.0) > 0.05

    flight.until(shown)
    flight.ticks(40)


@keeping_up
def test_a_robot_that_restarts_is_taken_again_only_when_asked(robot, link, fly):
    flight = fly()
    flight.capture()
    robot.restart()
    _assert_held(robot, flight, "late|jumped|let this session go|does not follow")
    again = fly()
    again.ticks(20)
    assert robot.status["session"] == link.session
    assert link.reports.value("tared") == "true"


@keeping_up
@pytest.mark.parametrize(
    ("sensor", "words"),
    [
        ("left_wrist", "left wrist wrench frozen"),
        ("target", "target pose frozen"),
        ("base", "base pose frozen"),
    ],
)
def test_a_sensor_that_freezes(robot, fly, sensor, words, gaps):
    flight = fly()
    robot.inject_faults(sensor_freeze=sensor)
    flight.notice_within(SHORT)
    _assert_in_time(_assert_held(robot, flight, words), SHORT, gaps(), 1 / contract.MOTION_CAPTURE_RATE)


@keeping_up
@pytest.mark.parametrize(
    ("key", "later"),
    [
        ("joint_states", 0.0),
        ("left_wrist/wrench", 0.0),
        ("base/pose", 0.0),
        ("target/pose", 0.0),
        ("robot/mode", MODE_DEADLINE),
        ("robot/heartbeat", PING_PERIOD),
    ],
)
def test_one_message_that_comes_no_more_among_all_others(robot, fly, key, later, gaps):
    flight = fly()
    flight.capture()
    flight.notice_within(SHORT)
    robot.inject_faults(mute=key)
    name = key.replace("/", " ").replace("_", " ")
    message = _assert_held(robot, flight, f"no {name} for")
    _assert_in_time(message, SHORT + later, gaps(), 1 / contract.MOTION_CAPTURE_RATE)


@keeping_up
def test_joint_states_that_jump(robot, link, fly, stranger):
    flight = fly()

    def jumped() -> bool:
        latest = link.await_joints(0, SHORT)
        sample = latest._replace(stamp=latest.stamp + 1, angle=latest.angle + 0.5)
        stranger.publish(contract.JOINT_STATES, wire.encode_joints(sample))
        return flight.lost.wait(0.05)

    until(jumped, "what jumped is noticed")
    _assert_held(robot, flight, r"joint states: \w+_joint_\d jumped by 0.5")


@keeping_up
@pytest.mark.parametrize("fault", [{"sensor_freeze": "joints"}, {"joint_stuck": "right_joint_3"}])
def test_joints_that_do_not_follow(robot, fly, fault):
    robot.restart()
    flight = fly()
    flight.capture()
    robot.inject_faults(**fault)
    message = _assert_held(robot, flight, "_joint_. does not follow")
    assert fault.get("joint_stuck", "joint") in message


@keeping_up
def test_a_console_that_falls_silent_is_held_by_the_robot_within_its_deadline(robot, fly):
    flight = fly()
    flight.capture()
    flight.end()  # the process lives, its mission thread does not
    if flight.fault is not None:
        raise Stalled(flight.fault)
    held = until(lambda: s if (s := robot.status)["mode"] == "holding" else None, "the robot holds")
    _assert_in_time(held["why"], ROBOT_DEADLINE, held["lateness"])
    until(robot.at_rest, "the joints rest")


@keeping_up
def test_stop_is_acknowledged_and_ends_the_session(robot, link, fly):
    flight = fly()
    flight.capture()
    link.stop()  # at once, whatever the mission's thread is at
    assert link.await_stop(5.0) is not None
    until(lambda: link.reports.mode is RobotMode.STOPPED, "the robot says that it has stopped")
    flight.ticks(20)
    flight.plant.stop()
    flight.mission.stop()
    flight.ticks(20)
    assert flight.mission.phase is Phase.STOPPED
    assert robot.at_rest()
    fly().ticks(20)
    assert robot.status["mode"] == "following"


@keeping_up
def test_a_strangers_command_is_refused_and_logged(robot, link, fly, stranger):
    flight = fly()
    session = f"stranger-{time.time_ns()}.1@{robot.status['robot']}"
    rate = np.full((2, 3), 0.5)

    def refused() -> bool:
        stamp = link.streams[contract.JOINT_STATES.key].latest
        stranger.publish(contract.JOINT_COMMAND, wire.encode_joint_command(wire.JointCommand(stamp, session, rate)))
        stranger.publish(contract.OPEN, wire.encode_call(wire.RobotCall(time.time_ns(), session)))
        return session in robot.status["last_refusal"]

    until(refused, "the robot refuses the stranger")
    until(lambda: session in (link.last_refused_sender() or ""), "the console is told")
    assert session in robot.process.log
    flight.ticks(20)
    assert robot.status["session"] == link.session
    assert robot.at_rest()


@keeping_up
def test_a_strangers_stop_stops(robot, fly, stranger):
    flight = fly()
    flight.capture()

    def stopped() -> bool:
        stranger.publish(contract.STOP, wire.encode_call(wire.RobotCall(time.time_ns(), "stranger.1")))
        return flight.lost.is_set()

    until(stopped, "the stranger stops the robot")
    _assert_held(robot, flight, "the robot is stopped: STOP from stranger.1")


@keeping_up
def test_taring_makes_the_present_reading_zero(link, fly):
    flight = fly()
    assert link.tare().granted
    flight.ticks(60)
    assert not flight.plant.state["hand_wrench"].any()
    assert not flight.mission.snapshot().contacts


@keeping_up
def test_a_blow_that_a_wrist_only_tells_moves_no_arm(robot, link, fly, stranger):
    flight = fly()
    flight.capture()

    def told() -> bool:
        stamp = link.streams[contract.WRENCHES[0].key].latest + 1
        blow = wire.PlaneSample(stamp, contract.WRENCHES[0].frame, np.array([20.0, 0.0, 0.0]))
        stranger.publish(contract.WRENCHES[0], wire.encode_wrench(blow))
        return flight.lost.wait(0.05)

    until(told, "the blow is told")
    _assert_held(robot, flight, "left wrist wrench: force jumped by")


@keeping_up
def test_a_second_robot_on_the_same_keys_grounds_both(robot, link, fly, tmp_path):
    flight = fly()
    flight.ticks(20)
    moved = robot.status["commands"]
    with becalm(tmp_path, "robot", "--name", "second", "--connect", robot.endpoint, *robot.credentials) as second:
        message = flight.await_fault("two robots answer on the same keys, emulator.*second")
        assert "none is flown" in message
        with pytest.raises(MissionRefused, match="two robots answer"):
            ZenohPlant(link, CONFIG)
        status = second.http.get("/status").raise_for_status().json()
        assert status["commands"] == 0
        assert status["mode"] in ("waiting", "stopped")
    assert moved > 0
    fly().ticks(20)


@keeping_up
def test_nothing_that_a_stranger_sends_ends_either_end(robot, link, fly, stranger):
    flight = fly()
    flight.ticks(20)
    random_ = random.Random(3)

    def sent() -> bool:  # on, until both ends have refused enough: a busy network may drop any of them
        for channel in contract.CHANNELS:
            if channel is not contract.STOP:
                stranger.publish(channel, random_.randbytes(random_.randrange(200)))
        return link.reception.refusals[contract.BASE_POSE.key].count >= 20 and robot.status["refused"] >= 60

    until(sent, "console and robot refuse")
    for session in ("\u00b2", f"{link.console}.\u00b2", f"{link.console}.99999"):
        stranger.publish(contract.OPEN, wire.encode_call(wire.RobotCall(time.time_ns(), session)))
    names = [f"joint_{number}" for number in range(300_000)]
    huge = ros("sensor_msgs/msg/JointState", wire._header(0, link.session), names, *[np.zeros(0)] * 3)
    stranger.publish(contract.JOINT_COMMAND, serialized(huge, "sensor_msgs/msg/JointState"))
    flight.ticks(40)
    assert "Traceback" not in robot.process.log
