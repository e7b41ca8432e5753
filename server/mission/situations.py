"""Copies of the state that the live mission is in, for who rehearses from it: taken between ticks."""

from __future__ import annotations

import threading
from collections import deque
from concurrent.futures import Future

from server.errors import LoopSilent
from server.library.run_state import RunState
from server.mission.live_mission import LiveMission
from sim.errors import CaptureError

SITUATION_TIME = 2.0
"""How long who asks for a state waits for it [s]."""


class Situations:
    """Who asked for a state and waits. `answer` is the mission thread's; `get` is for any thread but that one."""

    def __init__(self, wake: threading.Event) -> None:
        """Of a mission thread that turns as soon as this is set."""
        self._asked: deque[Future[RunState]] = deque()
        self._wake = wake

    def get(self) -> RunState:
        """The state as the mission thread finds it when it next turns.

        Raises:
            LoopSilent: the mission thread did not give it in time.
            MissionRefused: the mission has failed.

        """
        wanted: Future[RunState] = Future()
        self._asked.append(wanted)
        self._wake.set()
        try:
            return wanted.result(SITUATION_TIME)
        except TimeoutError:
            raise LoopSilent("the mission thread gave no state", tip="see GET /api/v1/health") from None

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
