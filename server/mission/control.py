"""Who is in control of the live mission: one operator at a time, and everyone sees who.

Control is taken while it is free, also by the first command; handed over by an offer that the other one takes;
released; and taken from who does not answer, by relieving them. STOP needs no control. The mission thread decides, so
that there is one order of commands and of changes of hands.
"""

from __future__ import annotations

from typing import Literal, get_args

from server.published import Control
from sim.errors import MissionRefused

ControlCommand = Literal["take_control", "relieve", "hand_over", "release_control"]
"""The commands by which control changes hands; each decides itself who may give it."""

CONTROL_COMMANDS: tuple[ControlCommand, ...] = get_args(ControlCommand)


class ControlDesk:
    """Holds who is in control. Changed by the mission thread only."""

    def __init__(self) -> None:
        self.control = Control()
        """Replaced, never changed: for any thread to read."""

    def require(self, who: str) -> None:
        """Refuse what only the operator in control may do; free control is anyone's.

        Raises:
            MissionRefused: somebody else is in control.

        """
        holder, since = self.control.holder, self.control.since
        if holder not in (None, who):
            raise MissionRefused(
                f"{holder} is in control of the mission, since {since}",
                tip=f"ask {holder} to hand over, or relieve {holder}; STOP is never refused",
            )

    def change(self, command: ControlCommand, who: str, to: str, now: str) -> str:
        """Change hands by that command of `who`; what happened in words.

        Args:
            command: what is asked.
            who: asks.
            to: whom control is handed over to, with `hand_over`.
            now: wall clock, ISO 8601.

        Raises:
            MissionRefused: it is not theirs to take, to offer or to release.

        """
        if command == "take_control":
            self.take(who, now)
            return f"{who} is in control"
        if command == "relieve":
            relieved = "" if self.control.holder in (None, who) else f", {self.control.holder} is relieved"
            self.relieve(who, now)
            return f"{who} is in control{relieved}"
        if command == "hand_over":
            self.offer(who, to)
            return f"{who} hands control over to {to}, who has to take it"
        self.release(who)
        return f"{who} has released control"

    def take(self, who: str, now: str) -> None:
        """Give `who` what is free, theirs already, or offered to them.

        Raises:
            MissionRefused: it is somebody else's.

        """
        if self.control.offered_to != who:
            self.require(who)
        self.relieve(who, now)

    def relieve(self, who: str, now: str) -> None:
        """Give `who` control, whoever has it."""
        if self.control.holder != who:
            self.control = Control(holder=who, since=now)

    def offer(self, who: str, to: str) -> None:
        """Offer what `who` has, and keeps until it is taken, to somebody.

        Raises:
            MissionRefused: it is not theirs to offer, or to themselves.

        """
        self._require_held(who)
        if to == who:
            raise MissionRefused(f"to = {to!r}: {who} is in control already")
        self.control = self.control.model_copy(update={"offered_to": to})

    def release(self, who: str) -> None:
        """Let go what `who` has.

        Raises:
            MissionRefused: it is not theirs.

        """
        self._require_held(who)
        self.control = Control()

    def _require_held(self, who: str) -> None:
        self.require(who)
        if self.control.holder is None:
            raise MissionRefused("nobody is in control of the mission", tip="take control first")
