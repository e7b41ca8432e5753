"""What the robot last told of itself, whatever order it arrives in."""

from __future__ import annotations

from server.link.contract import RobotMode
from server.link.reports import RobotReports
from server.link.streams import SILENCE
from server.link.wire import StatusReport

SECOND = 1_000_000_000


def _report(stamp: int, session: str = "console.1", mode: str = "following") -> StatusReport:
    return StatusReport(stamp, "testbed.1", "robot", True, mode, {"session": session})


def test_before_the_first_nothing_is_known():
    reports = RobotReports()
    assert (reports.latest, reports.mode, reports.of_session) == (None, None, None)
    assert reports.value("session") == ""


def test_the_newest_counts_and_not_the_last_that_came():
    reports = RobotReports()
    assert reports.take(_report(5 * SECOND, mode="stopped"), 10.0)
    assert not reports.take(_report(2 * SECOND), 10.1)
    assert reports.mode is RobotMode.STOPPED
    assert reports.at == 10.0


def test_only_what_was_told_after_a_session_was_granted_is_of_that_session():
    reports = RobotReports()
    reports.take(_report(5 * SECOND, "console.1"), 10.0)
    reports.granted(6 * SECOND)
    reports.take(_report(6 * SECOND - 1, "console.1"), 12.0)  # long after, but told before
    assert reports.value("session") == "console.1"
    assert reports.of_session is None
    reports.take(_report(6 * SECOND, "console.2"), 12.1)
    assert reports.of_session is reports.latest is not None


def test_a_robot_whose_clock_has_restarted_is_heard():
    reports = RobotReports()
    reports.take(_report(5 * SECOND), 10.0)
    assert reports.take(_report(1, "", "waiting"), 10.1 + SILENCE)
    assert reports.mode is RobotMode.WAITING


def test_a_word_that_the_contract_does_not_know_is_no_mode():
    reports = RobotReports()
    reports.take(_report(1, mode="dancing"), 0.0)
    assert reports.mode is None


def test_joint_command_ages_are_those_that_the_robot_reported():
    reports = RobotReports()
    reports.take(_report(1), 10.0)
    assert reports.joint_command_ages is None
    reported = {"command_age_p50": "0.003000", "command_age_p99": "0.004500", "commands": "7"}
    for number in range(20):  # the last ones are repeated while none come
        reports.take(_report(2 + number)._replace(values=reported), 10.1 + number)
    assert reports.joint_command_ages == (0.003, 0.0045)
    assert list(reports.joint_command_age.ago(30.0).values()) == [0.0045]
