"""How the mission thread obeys STOP."""

from __future__ import annotations

from server.link.robot_link import RobotLink
from server.mission.arming import ArmedOrder
from server.mission.clock import MissionClock
from server.mission.inbox import Granted, Inbox, Request
from server.mission.live_mission import RESTING_PHASES, LiveMission
from sim.control.phases import Phase
from sim.errors import MissionRefused

STOP_PATIENCE = 0.1
"""How long an answer to STOP waits for the robot's acknowledgement [s]."""


class Stops:
    """Stops the mission and the robot."""

    def __init__(self, inbox: Inbox, clock: MissionClock, armed: ArmedOrder, link: RobotLink | None) -> None:
        self._inbox = inbox
        self._clock = clock
        self._armed = armed
        self._link = link

    def stop_robot(self) -> None:
        """Send STOP to the robot, if one is flown, without waiting for anything; for any thread."""
        if self._link is not None:
            self._link.stop()

    def obey(self, flying: LiveMission) -> list[Granted]:
        """Stop the mission if a STOP waits, before all else that was asked for; the STOPs that are to be answered."""
        stops = self._inbox.stops()
        if not stops:
            return []
        self._armed.disarm()
        flying.stop()
        # Nothing that was asked for before a STOP may set the arms in motion after it.
        tip = "look at the robot, then ask again"
        self._inbox.refuse_requests(MissionRefused("a STOP came before this was looked at", tip=tip))
        self._clock.finish_step("stopped", flying)
        granted = []
        for request, answer in stops:
            message = f"{_stopped_words(flying)}{self._acknowledgement()}"
            flying.log_request(request, accepted=True, message=message)
            granted.append(Granted(request, answer, message))
        return granted

    def stop_at_end(self, flying: LiveMission) -> bool:
        """Stop a mission that moves, since the service ends; whether it did. The robot is stopped by `end_at_rest`."""
        if flying.phase in RESTING_PHASES:
            return False
        flying.stop()
        flying.log_request(Request("stop", who="service"), accepted=True, message="the service ends")
        return True

    def end_at_rest(self) -> None:
        """Let the last that the robot hears of the service be to stand still."""
        if self._link is not None:
            self._link.stop()
            self._link.await_stop(STOP_PATIENCE)

    def _acknowledgement(self) -> str:
        """What the robot replied to the STOP that it was sent."""
        if self._link is None:
            return ""
        after = self._link.await_stop(STOP_PATIENCE)
        if after is None:
            return "; the robot has NOT acknowledged it yet; STOP is sent again"
        return f"; acknowledged by the robot after {1e3 * after:.0f} ms"


def _stopped_words(flying: LiveMission) -> str:
    faulted = flying.phase is Phase.FAULTED
    return "the robot stays stopped; the fault is not fixed" if faulted else "stopped: joint rates are zero"
