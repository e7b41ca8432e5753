"""The mission thread: the only one that touches the mission.

Each turn looks at STOP first, then at the inbox, flies the ticks that are due, answers, and publishes.
"""

from __future__ import annotations

import logging
import threading
import time
from typing import Literal

from server.errors import ServiceBusy
from server.library.recorder import BACKLOG_LIMIT, Recorder
from server.library.run_state import RunState
from server.link.robot_link import RobotLink
from server.mission.arming import ArmedOrder
from server.mission.clock import MissionClock
from server.mission.commands import Commands, arming_context
from server.mission.control import ControlDesk
from server.mission.feed import Feed
from server.mission.fork import EndedFlights, ForkParent
from server.mission.inbox import Answer, Granted, Inbox, Request
from server.mission.live_mission import LiveMission
from server.mission.live_run import CUT_OFF_NOTE
from server.mission.opening import MissionOpener
from server.mission.pace import Pace
from server.mission.publisher import ConfigView, Publisher
from server.mission.replies import Replies
from server.mission.service_problems import ServiceProblems
from server.mission.situations import Situations
from server.mission.stops import Stops
from server.mission.waking import Waking
from server.process.disk import DiskGuard
from server.process.realtime import realtime_priority
from sim.config import MissionConfig
from sim.control.phases import Phase
from sim.errors import CaptureError

LoopStatus = Literal["preparing", "ok", "faulted"]

log = logging.getLogger(__name__)


class MissionLoop:
    """Flies the live mission in a thread of its own, at the pace that the operator chose."""

    def __init__(
        self,
        configuration: str,
        config: MissionConfig,
        feed: Feed,
        recorder: Recorder,
        disk: DiskGuard,
        link: RobotLink | None = None,
    ) -> None:
        """A loop that flies the robot at the other end of the link, or without one the simulation."""
        self._feed, self._recorder = feed, recorder
        self._inbox, self._replies = Inbox(), Replies()
        self._situations = Situations(self._inbox.wake)
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._live, name="becalm-mission", daemon=True)
        self._mission: LiveMission | None = None
        self._flown_at: float | None = None
        self.failure: str | None = None
        self.desk = ControlDesk()
        self.ended_flights = EndedFlights()
        self._armed = ArmedOrder()
        self._clock = MissionClock(config.control.period, self._replies, real_time=link is not None)
        self._waking = Waking(self._inbox.wake, self.pace, feed, robot=link is not None)
        self._stops = Stops(self._inbox, self._clock, self._armed, link)
        self._opener = MissionOpener(recorder, feed, link)
        problems = ServiceProblems(self.pace, recorder, disk, link)
        self._publisher = Publisher((configuration, config), feed, self._clock, self.desk, self._armed, problems, link)
        self._commands = Commands(
            self._clock,
            self.desk,
            self._armed,
            self._opener,
            self._publisher,
            self._begin,
            arming_needed=link is not None,
        )

    def start(self) -> None:
        """Start the thread; it prepares the simulation first."""
        self._thread.start()

    def end_soon(self) -> None:
        """Stop the robot, answer who waits, and close the run, all at the next turn; does not wait for it."""
        self._closing.set()
        self._inbox.wake.set()

    def shutdown(self, timeout: float = 2.0) -> None:
        """Stop the robot, close the run and end the thread."""
        self.end_soon()
        self._opener.shutdown()
        if self._mission is not None:  # compiling cannot be interrupted, and has no run to close
            self._thread.join(timeout)

    @property
    def status(self) -> LoopStatus:
        """Whether there is a mission to ask something of."""
        latest = self._feed.latest
        if self.failure or (latest and latest.phase == Phase.FAULTED.label):
            return "faulted"
        return "ok" if latest else "preparing"

    @property
    def prepared(self) -> float:
        """How much of what the mission runs is compiled, from 0 to 1; 1 where there is a mission."""
        return 1.0 if self._feed.latest else min(self._opener.prepared_share(self.view.config), 0.99)

    @property
    def ending(self) -> bool:
        """Whether the service ends."""
        return self._closing.is_set()

    @property
    def tick_age(self) -> float | None:
        """Wall time since the last tick was flown [s]."""
        return None if self._flown_at is None else time.monotonic() - self._flown_at

    @property
    def pace(self) -> Pace:
        """The clock, for readers of its counters in other threads."""
        return self._clock.pace

    @property
    def view(self) -> ConfigView:
        """The configuration in force; for any thread."""
        return self._publisher.view

    @property
    def waiting(self) -> int:
        """Requests that have not been looked at."""
        return self._inbox.waiting

    @property
    def flight(self) -> ForkParent:
        """What the mission has flown until now; for any thread.

        Raises:
            ServiceBusy: there is no mission yet.

        """
        flying = self._mission
        if flying is None:
            raise self.not_ready()
        return ForkParent(
            flying.run.id, flying.configuration, flying.history, flying.tick + 1, flying.states, self._feed.history
        )

    def situation(self) -> RunState:
        """What is known of the state that the mission is in now, and its run; for any thread but its own.

        Raises:
            LoopSilent: the mission thread did not give it in time.
            MissionRefused: the mission has failed.
            ServiceBusy: there is no mission yet.

        """
        if self._feed.latest is None or self._closing.is_set():
            raise self.not_ready()
        return self._situations.get()

    def ask(self, request: Request) -> Answer:
        """Put a request before the mission thread.

        Raises:
            ServiceBusy: the inbox is full, or there is no mission yet.

        """
        if request.command == "stop":
            self._stops.stop_robot()  # STOP does not wait for the mission thread, nor for there to be a mission
        if self._feed.latest is None or self._closing.is_set():
            raise self.not_ready()
        return self._inbox.put(request)

    def not_ready(self) -> ServiceBusy:
        """Why there is no mission to show or to command."""
        return _not_ready(self.failure, self._opener.awaited, ending=self._closing.is_set())

    @realtime_priority()
    def _live(self) -> None:
        configuration, _, config = self.view
        try:
            self._opener.prepare(config)
            if (first := self._opener.first(configuration, config, self._closing)) is None:
                return
            self._begin(first)
        except Exception as error:
            log.exception("the simulation could not be prepared")
            self.failure = f"{type(error).__name__}: {error}"
            return
        while not self._closing.is_set():
            self._waking.sleep(self._flying)
            self._turn_guarded()
        self._end()

    def _end(self) -> None:
        self._clock.finish_step("the service ended", self._flying)
        self._replies.deliver()
        self._inbox.refuse_all(self.not_ready())
        try:
            self._leave_at_rest()
        except Exception as error:
            self._flying.fail(error)
        self._flying.close(CUT_OFF_NOTE)

    def _leave_at_rest(self) -> None:
        """The last that the robot hears of the service is to stand still."""
        if not self._stops.stop_at_end(self._flying):
            return
        if self.pace.running:
            self._fly(1, time.monotonic())
        self._stops.end_at_rest()
        self._publisher.publish(self._flying, time.monotonic())

    @property
    def _flying(self) -> LiveMission:
        assert self._mission is not None, "the mission thread has begun one"
        return self._mission

    def _begin(self, following: LiveMission) -> None:
        """Fly this mission from now on."""
        if self._mission is not None:
            self.ended_flights.remember(self.flight)
        self._mission = following
        following.begin()
        now = time.monotonic()
        self._clock.restart(following.config.control.period, now)
        self._feed.begin(following.run.id, following.fork.past if following.fork else None)
        if following.fork is None:  # a fork stands where it was forked until the clock runs
            self._fly(1, now)
        self._publisher.publish(following, now)

    def _turn_guarded(self) -> None:
        try:
            self._turn()
        except Exception as error:
            # The thread outlives every fault: the operator must see it, and be able to reset.
            self._flying.fail(error)

    def _turn(self) -> None:
        granted = [*self._stops.obey(self._flying), *self._obey_requests()]
        now = time.monotonic()
        due = self._waking.due(self._flying, now)
        if granted and self.pace.running:
            due = max(due, 1)  # what was granted begins with this tick, and the answer names it
        self._fly(due, now)
        flying = self._flying
        self._armed.watch(arming_context(flying), now)
        self._situations.answer(flying)
        for request, answer, message in granted:
            self._replies.grant(request, answer, message, flying)
        if self._replies.pending or self._publisher.is_due(now):
            self._publisher.publish(flying, now)
        self._replies.deliver()  # after publishing: who has the answer finds it in the snapshot

    def _obey_requests(self) -> list[Granted]:
        granted = []
        for request, answer in self._inbox.requests():
            flying = self._flying
            try:
                message = self._commands.carry_out(request, flying)
            except CaptureError as refusal:
                flying.log_request(request, accepted=False, message=str(refusal))
                answer.set_exception(refusal)
                continue
            except Exception as error:
                # What asked is at fault, not the mission: it flies on, and the asker gets the error.
                log.exception("%s could not be carried out", request.command)
                answer.set_exception(error)
                continue
            if flying is self._mission:  # else it was logged in the run that it ended
                flying.log_request(request, accepted=True, message=message)
            if request.command == "step":
                self._clock.begin_step(request, answer, flying.tick)
            else:
                granted.append(Granted(request, answer, message))
        return granted

    def _fly(self, ticks: int, now: float) -> None:
        if ticks > 0 and self._recorder.backlog < BACKLOG_LIMIT:
            flown = self._flying.advance(ticks)
            self.pace.flown(flown or ticks, now)
            self._flown_at = time.monotonic()
        self._clock.finish_whole_step(self._flying)


def _not_ready(failure: str | None, awaited: str, *, ending: bool) -> ServiceBusy:
    """Why there is no mission: its preparation failed, the service ends, its robot is not there, or it is prepared."""
    if failure:
        return ServiceBusy(f"the simulation could not be prepared: {failure}", tip="restart the service")
    if ending:
        return ServiceBusy("the service is ending", tip="start it again")
    if awaited:
        return ServiceBusy(f"the mission waits for its robot: {awaited}", tip="GET /api/v1/link says more")
    return ServiceBusy(
        "the simulation is being prepared",
        tip="its first start compiles for about half a minute; try again, or let the request wait with wait=true",
    )
