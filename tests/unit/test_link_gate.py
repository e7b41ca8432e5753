"""What the robot's end lets through, and what it says to what it does not."""

from __future__ import annotations

import numpy as np
import pytest

from server.link.contract import RobotMode
from server.link.gate import RAMP_TIME, Gate, Limits
from server.link.wire import Call, JointCommand

MS = 1_000_000
START = 1_000_000 * MS
PERIOD = 0.005
RATE = np.full((2, 3), 0.5)
SESSION = "console.1"


@pytest.fixture
def gate() -> Gate:
    gate = Gate(Limits(joint_rate=2.0, deadline=0.1))
    assert gate.open(Call(1, SESSION), START).granted
    return gate


def _command(stamp: int, session: str = SESSION, rate: np.ndarray = RATE) -> JointCommand:
    return JointCommand(stamp, session, rate)


def test_without_a_session_nothing_is_followed():
    gate = Gate(Limits())
    assert "another session" in gate.command(_command(START), START).reason
    assert gate.mode is RobotMode.WAITING
    assert not gate.rates(START, PERIOD).any()


def test_its_session_is_followed(gate):
    assert gate.command(_command(START), START + 2 * MS).granted
    np.testing.assert_array_equal(gate.rates(START + 2 * MS, PERIOD), RATE)
    assert gate.ages == pytest.approx((0.002, 0.002))


@pytest.mark.parametrize(
    ("command", "after", "words"),
    [
        (_command(START + 1, "stranger.1"), 1, "another session holds the robot (console.1)"),
        (_command(START), 101, "old"),
        (_command(START + 50 * MS), 1, "future"),
        (_command(START + 1, rate=np.array([[0, 0, 0], [0, -2.1, 0.0]])), 1, "right_joint_2 = -2.1 rad/s"),
    ],
)
def test_what_cannot_be_followed_is_refused_with_the_reason(gate, command, after, words):
    gate.heartbeat(Call(2, SESSION), START + 99 * MS)
    verdict = gate.command(command, START + after * MS)
    assert not verdict.granted
    assert words in verdict.reason
    assert words in gate.last_refusal
    assert gate.refused == 1
    assert not gate.rates(START + 50 * MS, PERIOD).any()


@pytest.mark.parametrize("late", [START + 5 * MS, START + 10 * MS])
def test_a_command_that_is_overtaken_is_refused(gate, late):
    assert gate.command(_command(START + 10 * MS, rate=RATE), START + 11 * MS).granted
    assert "out of order" in gate.command(_command(late, rate=-RATE), START + 12 * MS).reason
    np.testing.assert_array_equal(gate.rates(START + 12 * MS, PERIOD), RATE)


@pytest.mark.parametrize("what", ["heartbeat", "commands"])
def test_what_is_late_ramps_to_zero_within_the_deadline_and_says_so(gate, what):
    gate.command(_command(START, rate=np.full((2, 3), 2.0)), START)
    for now in range(START, START + 100 * MS, 5 * MS):
        if what == "commands":
            gate.heartbeat(Call(now, SESSION), now)
        else:
            gate.command(_command(now + 1, rate=np.full((2, 3), 2.0)), now)
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
    gate.heartbeat(Call(later, SESSION), later)
    assert "heartbeat late" in gate.command(_command(later), later).reason
    assert not gate.rates(later, PERIOD).any()
    assert not gate.open(Call(3, SESSION), later).granted  # nor an old request for the session
    assert gate.open(Call(4, "console.2"), later).granted
    assert gate.command(_command(later + MS, "console.2"), later + MS).granted


def test_stop_is_anyones_and_ends_only_with_a_new_session(gate):
    gate.command(_command(START), START)
    assert gate.stop(Call(9, "stranger.1")).granted
    assert not gate.rates(START, PERIOD).any()
    assert "stopped" in gate.command(_command(START + MS), START + MS).reason
    assert gate.open(Call(10, "console.2"), START + 2 * MS).granted
    assert gate.mode is RobotMode.FOLLOWING
    assert not gate.rates(START + 2 * MS, PERIOD).any()


def test_a_stranger_takes_the_robot_only_when_its_holder_is_gone(gate):
    assert "held by console.1" in gate.open(Call(1, "stranger.1"), START + MS).reason
    gate.check(START + 200 * MS)
    assert gate.open(Call(2, "stranger.1"), START + 200 * MS).granted
