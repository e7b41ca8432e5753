"""Which robot is at the other end, and whether it is the only one. Pure: no clock, no network.

The first that is heard is the robot, or the one that the settings name; another one on the same keys is refused, and
while it is heard nothing is flown, because poses and wrenches do not say whose they are.
"""

from __future__ import annotations

from server.link.trouble import Trouble
from sim.errors import Cause

SILENCE = 1.0
"""A robot that was not heard for so long is gone [s]."""
MOST_OTHERS = 8
"""Robots that are remembered by name; there are more only if somebody draws them."""


class Identity:
    """The robot at the other end. Instants are `time.monotonic` [s]."""

    def __init__(self, name: str | None = None) -> None:
        """The robot of that name; without one, the first that is heard."""
        self.name = name
        self.robot = ""
        """Its identity; empty before it was heard."""
        self._heard = 0.0
        self._others: dict[str, float] = {}

    def refusal(self, robot: str, at: float) -> str:
        """Note that a robot was heard; why it is not the one at the other end, empty if it is."""
        if self.name is not None and robot.partition(".")[0] != self.name:
            self._note(robot, at)
            return f"it is from {robot}, and this console flies {self.name}"
        if robot != self.robot:
            if self.robot and at - self._heard <= SILENCE:
                self._note(robot, at)
                return f"it is from another robot, {robot}, beside {self.robot}"
            self.robot = robot
            self._others.pop(robot, None)
        self._heard = at
        return ""

    def others(self, now: float) -> tuple[str, ...]:
        """The robots that are heard beside it."""
        return tuple(each for each, at in list(self._others.items()) if now - at <= SILENCE)

    def trouble(self, now: float) -> Trouble | None:
        """Why no robot can be flown while others are heard."""
        others = ", ".join(self.others(now))
        if not others:
            return None
        if not self.robot or now - self._heard > SILENCE:
            words = f"another robot answers: {others}, and this console flies {self.name or self.robot}"
        else:
            words = f"two robots answer on the same keys, {self.robot} and {others}: none is flown"
        return Trouble(Cause.SEVERAL_ROBOTS, words)

    def _note(self, robot: str, at: float) -> None:
        if robot not in self._others and len(self._others) >= MOST_OTHERS:
            self._others.pop(min(self._others, key=lambda each: self._others[each]))
        self._others[robot] = at
