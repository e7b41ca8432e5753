"""Problems that the service itself has beside a mission: its clock, its disk, the recorder, the link."""

from __future__ import annotations

from typing import Literal

from server.library.recorder import Recorder
from server.link.robot_link import RobotLink
from server.mission.causes import CAUSE_WORDS
from server.mission.live_mission import LiveMission
from server.mission.pace import Pace
from server.process.disk import FAULT_TIP, DiskGuard
from server.published import Problem

CLOCK_LATE = "The clock runs late"
"""Title of that problem."""

LATE = 0.05
"""Lateness that is shown to the operator [s]."""

ERRORS = ("recorder", "data_folder")
"""Keys of the problems that are errors; the others are warnings."""


class ServiceProblems:
    """Shows them on the mission's board as they are now. Used by the mission thread only."""

    def __init__(self, pace: Pace, recorder: Recorder, disk: DiskGuard, link: RobotLink | None) -> None:
        self._pace = pace
        self._recorder = recorder
        self._disk = disk
        self._link = link

    def show(self, flying: LiveMission, now: float) -> None:
        """Show what is wrong at that monotonic time [s], and take off the board what no longer is."""
        if self._link is not None:
            self._show_link(self._link, flying, now)
        lateness = self._pace.lateness(now)
        _show(
            flying,
            "late",
            f"ticks came up to {1e3 * lateness:.0f} ms late in the last second" if lateness > LATE else None,
            CLOCK_LATE,
            "choose a lower speed, or end other programs on this machine",
        )
        _show(
            flying,
            "recorder",
            self._recorder.failure,
            "The run is not being recorded",
            "make room on the disk or choose another BECALM_DATA_DIR, then reset",
        )
        _show(flying, "data_folder", self._disk.fault, "Nothing can be kept", FAULT_TIP)
        _show(
            flying,
            "disk",
            self._disk.warning,
            "The disk is nearly full",
            "delete runs or studies; no more are queued until there is room",
        )

    @staticmethod
    def _show_link(link: RobotLink, flying: LiveMission, now: float) -> None:
        """Trouble of the link, as old as it is now."""
        trouble, age = link.trouble(), link.age(now)
        heard = "never heard" if age is None else f"last heard {age:.1f} s ago"
        unheard = age is None or age > link.settings.deadline
        if trouble is None:
            flying.problems.clear("link_now")
        else:
            message = f"{trouble.message}; robot {heard}" if unheard else trouble.message
            title = f"{CAUSE_WORDS[trouble.cause].title} now"
            _show(flying, "link_now", message, title, "reset is possible when it can be flown again")
        stop_missing = link.stop_sent is not None and link.stop_acknowledged_after is None
        _show(
            flying,
            "stop_unacknowledged",
            "the robot has not acknowledged STOP; it is sent again until it does" if stop_missing else None,
            "STOP is not acknowledged",
            "use the robot's own emergency stop",
        )
        _show(
            flying,
            "refused_sender",
            link.last_refused_sender(),
            "The robot refused somebody else",
            "see who else is on the network",
        )


def _show(flying: LiveMission, key: str, message: str | None, title: str, tip: str) -> None:
    """Show a problem of the mission's, or take it off its board where there is no message."""
    if message is None:
        flying.problems.clear(key)
    else:
        severity: Literal["warning", "error"] = "error" if key in ERRORS else "warning"
        problem = Problem(severity=severity, title=title, message=message, tip=tip, since=flying.time)
        flying.problems.show(key, problem)
