"""Who is in control of the live mission: one operator at a time, and everyone sees who.

Control is taken while it is free, also by the first command; handed over by an offer that the other one takes;
released; and taken from who does not answer, by relieving them. STOP needs no control. The mission thread decides, so
that there is one order of commands and of changes of hands.
"""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from sim.capture.snapshot import Published
from sim.errors import MissionRefused

ControlCommand = Literal["take_control", "relieve", "hand_over", "release_control"]
"""The commands by which control changes hands; each decides itself who may give it."""


class Control(Published):
    """Who may command the mission now."""

    holder: str | None = Field(None, description="Name of the operator in control; null while nobody is")
    since: str | None = Field(None, description="When they took it, ISO 8601 in UTC")
    offered_to: str | None = Field(None, description="Name of who may take it over now; null without an offer")

    def require(self, who: str) -> None:
        """Refuse what only the operator in control may do; free control is anyone's.

        Raises:
            MissionRefused: somebody else is in control.

        """
        if self.holder not in (None, who):
            raise MissionRefused(
                f"{self.holder} is in control of the mission, since {self.since}",
                tip=f"ask {self.holder} to hand over, or relieve {self.holder}; STOP is never refused",
            )

    def changed(self, command: ControlCommand, who: str, to: str, now: str) -> tuple[Control, str]:
        """Control after that command by `who`, and what happened in words; `to` is whom it is handed over to.

        Raises:
            MissionRefused: it is not theirs to take, to offer or to release.

        """
        if command == "take_control":
            return self.taken(who, now), f"{who} is in control"
        if command == "relieve":
            relieved = "" if self.holder in (None, who) else f", {self.holder} is relieved"
            return self.relieved(who, now), f"{who} is in control{relieved}"
        if command == "hand_over":
            return self.offered(who, to), f"{who} hands control over to {to}, who has to take it"
        return self.released(who), f"{who} has released control"

    def taken(self, who: str, now: str) -> Control:
        """After `who` has taken what is free, theirs already, or offered to them.

        Raises:
            MissionRefused: it is somebody else's.

        """
        if self.offered_to != who:
            self.require(who)
        return self if self.holder == who else Control(holder=who, since=now)

    def relieved(self, who: str, now: str) -> Control:
        """After `who` has taken it, whoever had it."""
        return self if self.holder == who else Control(holder=who, since=now)

    def offered(self, who: str, to: str) -> Control:
        """After `who`, who stays in control until then, has offered it to somebody.

        Raises:
            MissionRefused: it is not theirs to offer, or to themselves.

        """
        self._require_held(who)
        if to == who:
            raise MissionRefused(f"to = {to!r}: {who} is in control already")
        return self.model_copy(update={"offered_to": to})

    def released(self, who: str) -> Control:
        """After `who` has let it go.

        Raises:
            MissionRefused: it is not theirs.

        """
        self._require_held(who)
        return Control()

    def _require_held(self, who: str) -> None:
        self.require(who)
        if self.holder is None:
            raise MissionRefused("nobody is in control of the mission", tip="take control first")
