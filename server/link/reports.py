"""What the robot last reported of itself, and whether that was of the present session. Pure: no clock, no network.

Reports are of low priority, so one may arrive after an acknowledgement that was sent after it. It then is about the
session before; only what the robot stamped after it granted a session says anything about that session.
"""

from __future__ import annotations

import re

from server.link.contract import RobotMode
from server.link.streams import WorstOf, clock_restarted
from server.link.wire import StatusReport


class RobotReports:
    """The newest report. Stamps [ns] are the robot's; arrivals `time.monotonic` [s]."""

    def __init__(self) -> None:
        self.latest: StatusReport | None = None
        self.at = 0.0
        """When it came."""
        self.joint_command_age = WorstOf()
        """99 % quantiles, each of the two seconds before."""
        self._granted = 0

    def take(self, report: StatusReport, at: float) -> bool:
        """Note a report that came at that instant; whether it is newer than all before."""
        latest = self.latest
        if latest is not None and report.stamp <= latest.stamp and not clock_restarted(at, self.at):
            return False
        followed = self.value("commands")
        self.latest, self.at = report, at
        quantiles = self.joint_command_ages
        if quantiles is not None and self.value("commands") != followed:  # while none come, it repeats the last ones
            self.joint_command_age.note(quantiles[1], at)
        return True

    def granted(self, stamp: int) -> None:
        """Note when the robot granted the present session, by its own clock [ns]."""
        self._granted = stamp

    @property
    def of_session(self) -> StatusReport | None:
        """The newest report, if the robot made it after it granted the present session."""
        latest = self.latest
        return latest if latest is not None and latest.stamp >= self._granted else None

    @property
    def mode(self) -> RobotMode | None:
        """The robot's, as last reported; None before, and for a word that the contract does not know."""
        latest = self.latest
        return RobotMode(latest.message) if latest is not None and latest.message in list(RobotMode) else None

    @property
    def joint_command_ages(self) -> tuple[float, float] | None:
        """Median and 99 % quantile [s] of the joint commands that the robot took last; None if it has not taken any."""
        median, most = (parse_time(self.value(f"command_age_{each}")) for each in ("p50", "p99"))
        return None if median is None or most is None else (median, most)

    def value(self, key: str) -> str:
        """One of the values that it last reported; empty if it did not."""
        return self.latest.values.get(key, "") if self.latest is not None else ""


def parse_count(text: str) -> int | None:
    """A count or a stamp as a report gives it, at most 19 digits; None if it is none."""
    return int(text) if re.fullmatch(r"[0-9]{1,19}", text) else None


def parse_time(text: str) -> float | None:
    """A time [s] as a report gives it; None if it is none."""
    return float(text) if re.fullmatch(r"[0-9]{1,9}(\.[0-9]{1,12})?", text) else None
