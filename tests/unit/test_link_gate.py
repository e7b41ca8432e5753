"""What the robot's end lets through, and what it says to what it does not."""

from __future__ import annotations

import numpy as np
import pytest

from server.link.contract import RobotMode
from server.link.gate import RAMP_TIME, Gate, Limits
from server.link.wire import JointCommand, RobotCall

MS = 1_000_000
START = 1_000_000 * MS
PERIOD = 0.005
RATE = np.full((2, 3), 0.5)
ROBOT = "testbed.1f"
SECOND = f"console.2@{ROBOT}"
STRANGER = f"stranger.1@{ROBOT}"
SESSION = f"console.1@{ROBOT}"


@pytest.fixture
def gate() -> Gate:
    gate = Gate(Limits(joint_rate=2.0, deadline=0.1), ROBOT)
    assert gate.open(RobotCall(START - MS, SESSION), START).granted
    return gate


def _joint_command(stamp: int, session: str = SESSION, rate: np.ndarray = RATE) -> JointCommand:
    return JointCommand(stamp, session, rate)


def test_without_a_session_nothing_is_followed():
    gate = Gate(Limits(), ROBOT)
    assert "another session" in gate.joint_command(_joint_command(START), START).reason
    assert gate.mode is RobotMode.WAITING
    assert not gate.rates(START, PERIOD).any()


def test_its_session_is_followed(gate):
    assert gate.joint_command(_joint_command(START), START + 2 * MS).granted
    np.testing.assert_array_equal(gate.rates(START + 2 * MS, PERIOD), RATE)
    assert gate.ages == pytest.approx((0.002, 0.002))


@pytest.mark.parametrize(
    ("command", "after", "words"),
    [
        (_joint_command(START + 1, f"stranger.1@{ROBOT}"), 1, f"another session holds the robot ({SESSION})"),
        (_joint_command(START), 101, "old"),
        (_joint_command(START + 50 * MS), 1, "future"),
        (_joint_command(START + 1, rate=np.array([[0, 0, 0], [0, -2.1, 0.0]])), 1, "right_joint_2 = -2.1 rad/s"),
    ],
)
def test_what_cannot_be_followed_is_refused_with_the_reason(gate, command, after, words):
    gate.heartbeat(RobotCall(2, SESSION), START + 99 * MS)
    verdict = gate.joint_command(command, START + after * MS)
    assert not verdict.granted
    assert words in verdict.reason
    assert words in gate.last_refusal
    assert gate.refused == 1
    assert not gate.rates(START + 50 * MS, PERIOD).any()


@pytest.mark.parametrize("late", [START + 5 * MS, START + 10 * MS])
def test_a_joint_command_that_is_overtaken_is_refused(gate, late):
    assert gate.joint_command(_joint_command(START + 10 * MS, rate=RATE), START + 11 * MS).granted
    assert "out of order" in gate.joint_command(_joint_command(late, rate=-RATE), START + 12 * MS).reason
    np.testing.assert_array_equal(gate.rates(START + 12 * MS, PERIOD), RATE)


@pytest.mark.parametrize("what", ["heartbeat", "joint commands"])
def test_what_is_late_ramps_to_zero_within_the_deadline_and_says_so(gate, what):
    gate.joint_command(_joint_command(START, rate=np.full((2, 3), 2.0)), START)
    for now in range(START, START + 100 * MS, 5 * MS):
        if what == "joint commands":
            gate.heartbeat(RobotCall(now, SESSION), now)
        else:
            gate.joint_command(_joint_command(now + 1, rate=np.full((2, 3), 2.0)), now)
        assert gate.rates(now, PERIOD).max() == 2.0
    now = START + 101 * MS
    rates = [gate.rates(now + i * 5 * MS, PERIOD).max() for i in range(round(RAMP_TIME / PERIOD))]
    assert gate.mode is RobotMode.HOLDING
    assert what in gate.why
    assert rates == sorted(rates, reverse=True)
    assert 0.0 < rates[0] < 2.0
    assert rates[-1] == pytest.approx(0.0, abs=1e-12)


def test_nothing_that_waited_while_the_link_was_broken_is_executed(gate):
    later = START + 500 * MS
    gate.check(later)
    gate.heartbeat(RobotCall(later, SESSION), later)
    assert "no heartbeat for" in gate.joint_command(_joint_command(later), later).reason
    assert not gate.rates(later, PERIOD).any()
    assert not gate.open(RobotCall(later, SESSION), later).granted  # nor one for the session that was let go
    assert "old" in gate.open(RobotCall(START + 1, SECOND), later).reason  # nor an old one for a new session
    assert gate.open(RobotCall(later, SECOND), later).granted
    assert gate.joint_command(_joint_command(later + MS, SECOND), later + MS).granted


def test_stop_is_anyones_and_ends_only_with_a_new_session(gate):
    gate.joint_command(_joint_command(START), START)
    assert gate.stop(RobotCall(9, "stranger.1"), START + MS).granted
    assert not gate.rates(START, PERIOD).any()
    assert "stopped" in gate.joint_command(_joint_command(START + MS), START + MS).reason
    assert "before the STOP" in gate.open(RobotCall(START + MS, SECOND), START + 2 * MS).reason
    assert gate.open(RobotCall(START + 2 * MS, SECOND), START + 2 * MS).granted
    assert gate.mode is RobotMode.FOLLOWING
    assert not gate.rates(START + 2 * MS, PERIOD).any()


def test_a_stranger_takes_the_robot_only_when_its_holder_is_gone(gate):
    assert f"held by {SESSION}" in gate.open(RobotCall(START + MS, STRANGER), START + MS).reason
    gate.check(START + 200 * MS)
    assert gate.open(RobotCall(START + 200 * MS, STRANGER), START + 200 * MS).granted


def test_a_request_for_another_robot_is_refused(gate):
    gate.check(START + 200 * MS)
    other = Gate(Limits(), "testbed.2a")
    assert "this robot is testbed.2a" in other.open(RobotCall(START, SESSION), START).reason
    assert other.mode is RobotMode.WAITING
    assert "another session" in other.joint_command(_joint_command(START), START).reason


def test_a_console_is_not_locked_out_by_whoever_uses_its_name(gate):
    imposter = f"console.99999@{ROBOT}"
    assert gate.open(RobotCall(START + MS, imposter), START + MS).granted  # without users anyone may say so
    assert gate.open(RobotCall(START + 2 * MS, SECOND), START + 2 * MS).granted
    assert gate.session == SECOND


def test_a_request_that_is_sent_again_changes_nothing(gate):
    gate.joint_command(_joint_command(START), START)
    assert gate.open(RobotCall(START, SESSION), START + MS).granted
    np.testing.assert_array_equal(gate.rates(START + MS, PERIOD), RATE)


@pytest.mark.parametrize("ahead", [-200, 50, 3_600_000])
def test_a_session_is_opened_by_what_is_of_now(gate, ahead):
    later = START + 500 * MS
    gate.check(later)
    reason = gate.open(RobotCall(later + ahead * MS, SECOND), later).reason
    assert ("old" if ahead < 0 else "future") in reason


@pytest.mark.parametrize(
    "session",
    [
        *("", ".", "console", "console.", ".1", "console.\u00b2", "console.\u0661", "console.1"),
        f"console.{'9' * 5000}",
        *(f"console.\u00b2@{ROBOT}", f"console.{'9' * 19}@{ROBOT}", f"{'c' * 65}.1@{ROBOT}", f"console.1@{ROBOT}\n"),
    ],
)
def test_what_is_no_session_is_refused(gate, session):
    assert not gate.open(RobotCall(START + MS, session), START + MS).granted
    assert gate.session == SESSION
    assert len(gate.last_refusal) < 200
    assert gate.last_refusal.isprintable()


def test_a_heartbeat_from_the_future_does_not_make_the_holders_look_old(gate):
    gate.heartbeat(RobotCall(7, SESSION), START)
    gate.heartbeat(RobotCall(7 + 3_600_000 * MS, SESSION), START + MS)
    assert "jumped ahead" in gate.last_refusal
    for after in range(5, 150, 5):
        now = START + after * MS
        gate.heartbeat(RobotCall(7 + after * MS, SESSION), now)
        gate.joint_command(_joint_command(now), now)
        gate.check(now)
    assert gate.mode is RobotMode.FOLLOWING


def test_a_stop_that_cannot_be_read_stops(gate):
    gate.joint_command(_joint_command(START), START)
    gate.stop(None, START + MS)
    assert gate.why == "STOP from unknown"
    assert not gate.rates(START + MS, PERIOD).any()


@pytest.mark.parametrize(
    ("stamp", "session", "rate", "words"),
    [
        (START, STRANGER, 0.0, "another session"),
        (START - 200 * MS, SESSION, 0.0, "old"),
        (START + MS, SESSION, 0.5, "the arms move"),
        (START + MS, SESSION, 0.0, ""),
    ],
)
def test_wrists_are_tared_by_their_holder_at_rest(gate, stamp, session, rate, words):
    gate.joint_command(_joint_command(START, rate=np.full((2, 3), rate)), START)
    gate.rates(START, PERIOD)
    reason = gate.refuse_tare(RobotCall(stamp, session), START + MS)
    assert words in reason
    assert bool(reason) == bool(words)


def test_refusals_are_counted_and_told_once_a_second(gate, caplog):
    for number in range(300):
        gate.joint_command(_joint_command(START, STRANGER), START + number * MS)
    assert gate.refused == 300
    assert len(caplog.records) == 1
    gate.joint_command(_joint_command(START, STRANGER), START + 1001 * MS)
    assert "(299 more" in caplog.text
