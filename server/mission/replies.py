"""Replies that wait for the snapshot that shows what they say."""

from __future__ import annotations

import itertools

from server.mission.inbox import Answer, CommandAnswer, Request
from server.mission.live_mission import LiveMission


class Replies:
    """Granted requests whose answers are sent after the next snapshot. Used by the mission thread only."""

    def __init__(self) -> None:
        self._numbers = itertools.count(1)
        self._waiting: list[tuple[Answer, CommandAnswer]] = []

    @property
    def pending(self) -> bool:
        """Whether any reply waits for a snapshot."""
        return bool(self._waiting)

    def grant(self, request: Request, answer: Answer, message: str, flying: LiveMission) -> None:
        """Answer a request with this message, and with where the mission stands now."""
        reply = CommandAnswer(
            id=f"{flying.run.id}/{next(self._numbers)}",
            command=request.command,
            accepted=True,
            phase=flying.phase.label,
            tick=flying.tick,
            time=flying.time,
            message=message,
        )
        self._waiting.append((answer, reply))

    def deliver(self) -> None:
        """Send all that wait, but for those whose asker has given up."""
        waiting, self._waiting = self._waiting, []
        for answer, reply in waiting:
            if not answer.cancelled():
                answer.set_result(reply)
