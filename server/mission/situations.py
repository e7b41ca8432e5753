"""Copies of the state that the live mission is in, for who rehearses from it: taken between ticks."""

from __future__ import annotations

from collections import deque
from concurrent.futures import Future

from server.library.run_state import RunState
from server.mission.live_mission import LiveMission
from sim.errors import CaptureError


class Situations:
    """Who asked for a state and waits. `answer` is the mission thread's; `ask` is anyone's."""

    def __init__(self) -> None:
        self._asked: deque[Future[RunState]] = deque()

    def ask(self) -> Future[RunState]:
        """The state as the mission thread finds it when it next turns."""
        wanted: Future[RunState] = Future()
        self._asked.append(wanted)
        return wanted

    def answer(self, flying: LiveMission) -> None:
        """Give everybody who waits the same copy."""
        if not self._asked:
            return
        waiting = [self._asked.popleft() for _ in range(len(self._asked))]
        try:
            seen = RunState(flying.run.id, flying.situation())
        except CaptureError as refusal:
            for each in waiting:
                each.set_exception(refusal)
            return
        for each in waiting:
            each.set_result(seen)
