"""Copies of the state that the live mission is in, for who rehearses from it: taken between ticks."""

from __future__ import annotations

from collections import deque
from concurrent.futures import Future

from server.mission.live_mission import LiveMission
from sim.errors import CaptureError
from sim.rehearsal.situation import Situation


class Situations:
    """Who asked for a state and waits. `answer` is the mission thread's; `ask` is anyone's."""

    def __init__(self) -> None:
        self._asked: deque[Future[Situation]] = deque()

    def ask(self) -> Future[Situation]:
        """The state as the mission thread finds it when it next turns."""
        wanted: Future[Situation] = Future()
        self._asked.append(wanted)
        return wanted

    def answer(self, flying: LiveMission) -> None:
        """Give everybody who waits the same copy."""
        if not self._asked:
            return
        waiting = [self._asked.popleft() for _ in range(len(self._asked))]
        try:
            situation = flying.situation()
        except CaptureError as refusal:
            for each in waiting:
                each.set_exception(refusal)
            return
        for each in waiting:
            each.set_result(situation)
