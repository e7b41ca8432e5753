"""Arming: what sets a robot in motion takes two requests, the first of which says what the second one may do.

The mission thread holds at most one armed command. It is good once, for seconds, for who armed it, for that command
with those arguments, and in the phase and run in which it was armed; a STOP takes it back.
"""

from __future__ import annotations

import hmac
import json
from dataclasses import dataclass
from typing import NamedTuple, get_args

from server.mission.inbox import CommandName, Request
from server.published import Armed, ArmedCommand
from sim.errors import MissionRefused

ARMED_TIME = 6.0
"""How long an armed command stays armed [s]."""

TO_BE_ARMED: tuple[CommandName, ...] = get_args(ArmedCommand)


class ArmingContext(NamedTuple):
    """Where a mission stands; what is armed there is good nowhere else."""

    run_id: str
    phase: str


@dataclass(frozen=True)
class _ArmedEntry:
    token: str
    order: str
    armed: Armed
    where: ArmingContext
    until: float


class ArmedOrder:
    """The one command that is armed, if any. Times are of a monotonic clock [s]. Used by the mission thread only."""

    def __init__(self) -> None:
        self._held: _ArmedEntry | None = None

    def arm(self, request: Request, command: ArmedCommand, where: ArmingContext, now: float) -> None:
        """Hold this command, which the request names with its arguments and its token; another one is forgotten."""
        armed = Armed(command=command, by=request.who, expires_in=ARMED_TIME)
        self._held = _ArmedEntry(request.arming or "", _order(command, request), armed, where, now + ARMED_TIME)

    def disarm(self) -> None:
        """Hold nothing."""
        self._held = None

    def watch(self, where: ArmingContext, now: float) -> None:
        """Disarm what has expired, or was armed in another phase or run."""
        if self._held is not None and (now >= self._held.until or where != self._held.where):
            self.disarm()

    def shown(self, now: float) -> Armed | None:
        """What is armed, as everyone sees it."""
        held = self._held
        return None if held is None else held.armed.model_copy(update={"expires_in": max(0.0, held.until - now)})

    def redeem(self, request: Request, where: ArmingContext, now: float) -> None:
        """Use up what is armed for this request; whatever does not fit it is disarmed too.

        Raises:
            MissionRefused: nothing is armed, or another command, by somebody else, or it is not good any more.

        """
        self.watch(where, now)
        held, what = self._held, request.command
        self.disarm()
        tip = how_to_arm(what)
        if not request.arming:
            raise MissionRefused(f"{what} moves the robot or takes it again, and has not been armed", tip=tip)
        if held is None or not hmac.compare_digest(held.token.encode(), request.arming.encode()):
            raise MissionRefused(
                f"the arming of {what} is no longer good: it was used, is older than {ARMED_TIME:g} s, "
                "or was taken back by a STOP, another phase or another request",
                tip=tip,
            )
        if held.armed.by != request.who:
            raise MissionRefused(f"{held.armed.by} armed {held.armed.command}, not {request.who}", tip=tip)
        if held.order != _order(what, request):
            raise MissionRefused(f"{held.armed.command} was armed with other arguments, or not {what}", tip=tip)


def how_to_arm(command: str) -> str:
    """What to do for a command that has to be armed."""
    ask = json.dumps({"command": command})
    bring = "the header Becalm-Arming" if command == "configure" else '"arming"'
    return (
        f"POST /api/v1/mission/arming {ask} with the same arguments gives a token; "
        f"send it within {ARMED_TIME:g} s as {bring} of the request"
    )


def _order(command: str, request: Request) -> str:
    return f"{command} {request.arguments}"
