"""What the next request would do, made again every two seconds while somebody looks, and go or no-go from that."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable

from pydantic import Field

from server.errors import LoopSilent, ServiceBusy
from server.jobs.queue import JobQueue
from server.library.run_state import RunState
from server.rehearsals.jobs import LookAheadJob
from sim.config import MissionConfig
from sim.control.phases import Command, Phase
from sim.errors import MissionRefused
from sim.rehearsal.rehearsal import planned
from sim.rehearsal.summary import Odds
from sim.rehearsal.uncertainty import UncertaintyModel
from sim.snapshot import FrozenMessage

PERIOD = 2.0
"""Between two look-aheads [s]; longer where they take more than a quarter of it: a machine of two cores does other
things, too."""

STALE = 15.0
"""After so long a look-ahead says nothing about now [s]."""

FUTURES = 100

_FLIES = "its futures are being flown"

_NEXT = {Phase.IDLE: Command.CAPTURE, Phase.RELEASED: Command.CAPTURE, Phase.HOLDING: Command.CAPTURE}
"""The request that would come next, by phase; in others one is under way, or none can come."""


class LookAheadView(FrozenMessage):
    """Go or no-go for the request that would come next, and from what."""

    made: bool = Field(description="Whether there is one for the state as it is now; `reason` says why not")
    request: str | None = Field(None, description="The request that would come next")
    time: float | None = Field(None, description="Mission time of the state that it begins in [s]")
    age: float | None = Field(None, description="How long ago that was [s]")
    go: bool | None = Field(None, description="The odds and the force are as the lab wants them; null if not made")
    words: str = Field("", description="What its futures say")
    reason: str | None = Field(None, description="Why no-go, or why there is none")
    caged: Odds | None = Field(None, description="Of being caged")
    peak_force_95: float | None = Field(None, description="Peak force that 95 % of the futures stay below [N]")
    go_odds: float = Field(description="Part of the futures that must end in a cage for go")
    go_peak_force: float | None = Field(description="Force that 95 % must stay below for go [N]; null: any")


class LookAhead:
    """Asking is looking: nothing is made for nobody. For any thread."""

    def __init__(
        self,
        queue: JobQueue,
        find_state: Callable[[], RunState],
        find_phase: Callable[[], str | None],
        go_odds: float,
        go_peak_force: float | None,
    ) -> None:
        """In that queue, from that state; `find_phase` tells the mission's phase at once, None where there is none."""
        self._queue, self._find, self._find_phase = queue, find_state, find_phase
        self._go_odds, self._go_peak_force = go_odds, go_peak_force
        self._lock = threading.Lock()
        self._made: LookAheadJob | None = None
        """The last that has ended."""
        self._making: LookAheadJob | None = None
        self._why_none = _FLIES
        self._asked_at = -math.inf
        self._looked_at = self._next_at = 0.0

    def now(self) -> LookAheadView:
        """What is known by now; sees to it that more will be, unless somebody else is just doing so."""
        self._asked_at = time.monotonic()
        if self._lock.acquire(blocking=False):
            try:
                self._require_next()
                self._take_made()
                self._make()
                self._why_none = _FLIES
            except (MissionRefused, ServiceBusy, LoopSilent) as reason:
                self._made, self._why_none = None, str(reason)
            finally:
                self._lock.release()
        made = self._made
        if made is None or time.monotonic() - made.made_at > STALE:
            return self._nothing(self._why_none)
        return self._said(made)

    @property
    def is_looked_at(self) -> bool:
        """Whether somebody has asked lately."""
        return time.monotonic() - self._asked_at < STALE

    def outline(self, run: str, command: str, config: MissionConfig) -> bytes | None:
        """What the last one says in outline (JSON of a `RehearsalResult`).

        None if it is of another run, request or configuration, or too old.
        """
        made = self._made
        if made is None or made.ahead is None or time.monotonic() - made.made_at > STALE:
            return None
        request, situation = made.rehearsal.request, made.rehearsal.situation
        assert request is not None, "a look-ahead is of a request"
        same = (made.run, request.value) == (run, command) and situation.config == config
        return made.ahead.outline if same else None

    def _require_next(self) -> None:
        """Refuse where no request can come next, and let go of what is being made of the state before.

        Raises:
            MissionRefused: the message says so.

        """
        phase = self._find_phase()
        if phase is None or phase in {each.label for each in _NEXT}:
            return
        if self._making is not None:
            self._queue.remove(self._making)
            self._making = None
        raise _none_can_begin(phase)

    def _take_made(self) -> None:
        if self._making is not None and self._making.has_ended:
            self._next_at = self._looked_at + max(PERIOD, 4.0 * self._making.wall_time)
            if self._making.ahead is not None:
                self._made = self._making
            self._making = None

    def _make(self) -> None:
        """Have the next one made, if it is time.

        Raises:
            MissionRefused: no request can come next.
            ServiceBusy: there is no mission yet, or too much waits.

        """
        now = time.monotonic()
        if self._making is not None or now < self._next_at:
            return
        run, situation = self._find()
        request = _NEXT.get(situation.phase)
        if situation.mark.happened.outcome is not None:
            raise MissionRefused("this capture has its verdict; one is made again after a reset")
        if request is None:
            raise _none_can_begin(situation.phase.label)
        seed = situation.tick  # another sample with every state
        rehearsal = planned(situation, {}, request=request, uncertainty=UncertaintyModel(), futures=FUTURES, seed=seed)
        job = LookAheadJob(rehearsal, run)
        self._queue.add(job)
        self._making, self._looked_at = job, now

    def _nothing(self, reason: str) -> LookAheadView:
        return LookAheadView(made=False, reason=reason, go_odds=self._go_odds, go_peak_force=self._go_peak_force)

    def _said(self, job: LookAheadJob) -> LookAheadView:
        ahead, rehearsal = job.ahead, job.rehearsal
        assert ahead is not None, "one that is kept was made"
        assert rehearsal.request is not None, "a look-ahead is of a request"
        peak = None if ahead.peak_force is None else ahead.peak_force.high
        reason = _why_not(ahead.caged, peak, self._go_odds, self._go_peak_force)
        force = "" if peak is None else f", peak below {peak:.3g} N in 95 %"
        return LookAheadView(
            made=True,
            request=rehearsal.request.value,
            time=rehearsal.situation.time,
            age=time.monotonic() - job.made_at,
            go=reason is None,
            words=f"{rehearsal.request.value.replace('_', ' ').capitalize()}: {ahead.caged.futures} of "
            f"{rehearsal.futures} futures caged{force}",
            reason=reason,
            caged=ahead.caged,
            peak_force_95=peak,
            go_odds=self._go_odds,
            go_peak_force=self._go_peak_force,
        )


def _none_can_begin(phase: str) -> MissionRefused:
    return MissionRefused(f"no sequence can begin in phase {phase}")


def _why_not(caged: Odds, peak: float | None, go_odds: float, go_peak_force: float | None) -> str | None:
    """What is not as the lab wants it; None if all is."""
    if caged.share < go_odds:
        return f"{caged.share:.0%} of the futures end in a cage; go takes {go_odds:.0%}"
    if go_peak_force is not None and peak is not None and peak >= go_peak_force:
        return f"95 % of the futures stay below {peak:.3g} N; go takes {go_peak_force:g} N"
    return None
