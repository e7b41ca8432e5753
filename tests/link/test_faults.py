"""Each fault of robot or network, with what must happen: two processes on loopback.

By when is told by the ends themselves: the console's message says how old the silence was when it was noticed, and a
deadline lies between that and zero. How long this machine took to say so is not asserted.
"""

from __future__ import annotations

import re
import signal
import time

import pytest
from ends import DEADLINE, until

from server.link import contract, wire
from server.link.session import LinkSession, Transport
from sim.control.phases import Phase

SLACK = 2.0
"""What a loaded machine may add to a deadline [s]."""


def _milliseconds(message: str) -> float:
    found = re.search(r"(\d+) ms", message)
    assert found is not None, message
    return float(found[1])


def _assert_held(robot, flight, words):
    """The console has faulted with these words and told the robot to stop; the robot stands still and stays so."""
    message = flight.await_fault()
    assert re.search(words, message), message
    assert flight.mission.phase is Phase.FAULTED
    with pytest.raises(type(flight.fault)):
        flight.mission.advance(1)
    until(robot.at_rest, "the joints rest")
    commands = robot.status["commands"]
    assert robot.status["mode"] in ("stopped", "holding", "waiting")
    assert robot.at_rest()
    assert robot.status["commands"] == commands
    return message


def test_a_mission_flies_and_knows_the_robots_clock(robot, link, fly):
    flight = fly()
    flight.ticks(100)
    assert flight.mission.phase is Phase.IDLE
    assert robot.status["mode"] == "following"
    assert robot.status["session"] == link.session
    assert link.other_clock.offset == pytest.approx(3.5, abs=0.05)
    assert link.report.values["tared"] == "true"
    target = flight.mission.snapshot().target
    assert target.twist[2] == pytest.approx(robot.status["target_twist"][2], abs=0.05)


def test_a_robot_that_hangs(robot, fly):
    flight = fly()
    flight.capture()
    flight.ticks(60)
    robot.hang(3 * DEADLINE)
    message = _assert_held(robot, flight, "late: none for")
    assert _milliseconds(message) >= 1e3 * DEADLINE - 1.0
    assert _milliseconds(message) <= 1e3 * (DEADLINE + 1 / contract.CONTROL_RATE + SLACK)


def test_a_process_that_hangs_and_comes_back_executes_nothing_of_what_waited(robot, link, fly):
    flight = fly()
    flight.capture()
    flight.ticks(60)
    robot.process.signal(signal.SIGSTOP)
    flight.await_fault()
    rate = 0.0 * flight.plant.state["joint_rate"] + 1.0
    for number in range(20):  # what a console that has not noticed would go on sending
        link.command(link.streams[contract.JOINT_STATES.key].latest + number, rate)
    robot.process.signal(signal.SIGCONT)
    _assert_held(robot, flight, "late")
    again = fly()  # and neither side was restarted
    again.ticks(20)
    assert robot.status["mode"] == "following"


@pytest.mark.parametrize("faults", [{"delay": 3 * DEADLINE}, {"loss": 1.0}])
def test_a_network_that_is_too_slow_or_gone(robot, fly, faults):
    flight = fly()
    flight.capture()
    flight.ticks(60)
    robot.suffer(**faults)
    _assert_held(robot, flight, "late|jumped|holding")


def test_some_loss_and_jitter_are_flown_through_and_shown(robot, link, fly):
    flight = fly()
    flight.ticks(20)
    robot.suffer(loss=0.2, jitter=0.004)
    flight.ticks(400)
    rate, jitter, loss = link.streams[contract.JOINT_STATES.key].measured(time.monotonic())
    assert rate < contract.CONTROL_RATE
    assert jitter > 1e-4
    assert loss > 0.05
    assert flight.fault is None


def test_a_robot_that_restarts_is_taken_again_only_when_asked(robot, link, fly):
    flight = fly()
    flight.capture()
    flight.ticks(60)
    robot.restart()
    _assert_held(robot, flight, "late|jumped|let this session go")
    again = fly()
    again.ticks(20)
    assert robot.status["session"] == link.session


@pytest.mark.parametrize(
    ("sensor", "words"),
    [
        ("left_wrist", "left wrist wrench frozen"),
        ("target", "target pose frozen"),
        ("base", "base pose frozen"),
        ("joints", "does not follow"),
    ],
)
def test_a_sensor_that_freezes(robot, fly, sensor, words):
    robot.restart()
    flight = fly()
    flight.capture()
    flight.ticks(100)
    robot.suffer(sensor_freeze=sensor)
    _assert_held(robot, flight, words)


def test_a_joint_that_is_stuck(robot, fly):
    robot.restart()
    flight = fly()
    flight.capture()
    robot.suffer(joint_stuck="right_joint_1")
    _assert_held(robot, flight, "right_joint_1 does not follow")


def test_a_console_that_falls_silent_is_held_by_the_robot(robot, fly):
    flight = fly()
    flight.capture()
    flight.ticks(60)
    flight.end()  # the process lives, its mission thread does not
    until(lambda: robot.status["mode"] == "holding", "the robot holds")
    assert _milliseconds(robot.status["why"]) >= 1e3 * DEADLINE - 1.0
    until(robot.at_rest, "the joints rest")


def test_stop_is_acknowledged_and_ends_the_session(robot, link, fly):
    flight = fly()
    flight.capture()
    flight.ticks(60)
    flight.plant.stop()
    link.stop()
    flight.mission.stop()
    assert link.await_stop(5.0) is not None
    until(lambda: robot.status["mode"] == "stopped", "the robot has stopped")
    flight.ticks(20)
    assert flight.mission.phase is Phase.STOPPED
    assert robot.at_rest()
    fly().ticks(20)
    assert robot.status["mode"] == "following"


@pytest.fixture
def stranger(robot):
    session = LinkSession(Transport(connect=(robot.endpoint,)))
    yield session
    session.close()


def test_a_strangers_command_is_refused_and_logged(robot, link, fly, stranger):
    flight = fly()
    flight.ticks(40)
    session = f"stranger-{time.time_ns()}.1"
    rate = flight.plant.state["joint_rate"] * 0 + 0.5

    def refused() -> bool:
        stamp = link.streams[contract.JOINT_STATES.key].latest
        stranger.publish(contract.JOINT_COMMAND, wire.encode_command(wire.JointCommand(stamp, session, rate)))
        stranger.publish(contract.OPEN, wire.encode_call(wire.Call(time.time_ns(), session)))
        return session in robot.status["last_refusal"]

    until(refused, "the robot refuses the stranger")
    until(lambda: session in (link.stranger() or ""), "the console is told")
    assert session in robot.process.log
    flight.ticks(20)
    assert robot.status["session"] == link.session
    assert robot.at_rest()


def test_a_strangers_stop_stops(robot, fly, stranger):
    flight = fly()
    flight.capture()
    flight.ticks(60)

    def stopped() -> bool:
        stranger.publish(contract.STOP, wire.encode_call(wire.Call(time.time_ns(), "stranger.1")))
        return flight.lost.is_set()

    until(stopped, "the stranger stops the robot")
    _assert_held(robot, flight, "the robot is stopped: STOP from stranger.1")


def test_taring_makes_the_present_reading_zero(robot, link, fly):
    flight = fly()
    flight.ticks(60)
    assert link.tare().granted
    flight.ticks(60)
    assert not flight.plant.state["hand_wrench"].any()
    assert not flight.mission.snapshot().contacts
