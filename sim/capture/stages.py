"""How far a mission has come in its sequence: which phases are done, failed, skipped or ahead."""

from __future__ import annotations

from collections.abc import Sequence as Ordered
from itertools import pairwise
from typing import Any, Literal, NamedTuple

import numpy as np

from sim.capture.events import Ticks, verdict_in_words
from sim.config import MissionConfig
from sim.control.phases import Phase
from sim.method.method import method_of
from sim.snapshot import Outcome, Stage

NOMINAL = (Phase.IDLE, Phase.DETUMBLING, Phase.CAGING, Phase.HOLDING)
"""A capture that goes as it should."""

_OFF = (Phase.STOPPED, Phase.FAULTED)


class Visit(NamedTuple):
    """A stretch of time in one phase, and how things stood in its last tick."""

    phase: Phase
    start: float
    """[s]"""
    end: float
    """[s]"""
    last: Any
    """Its last tick, one element of `TICK`."""
    config: MissionConfig
    """In force in that tick."""

    @property
    def unmet(self) -> str:
        """What the phase had failed to achieve; empty if nothing."""
        return method_of(self.config).words.unmet(self.last, self.config)


def visits_after(visits: Ordered[Visit], ticks: Ticks, config: MissionConfig) -> list[Visit]:
    """The visits, with consecutive ticks of that configuration after them."""
    known = list(visits)
    phases = ticks["phase"]
    starts = [0, *(np.flatnonzero(phases[1:] != phases[:-1]) + 1).tolist(), len(ticks)]
    for start, end in pairwise(starts):
        visit = _visit(ticks[start], ticks[end - 1], config)
        if known and known[-1].phase is visit.phase:
            visit = visit._replace(start=known.pop().start)
        elif known:
            known[-1] = known[-1]._replace(end=visit.start)
        known.append(visit)
    return known


def _visit(first: Any, last: Any, config: MissionConfig) -> Visit:
    return Visit(Phase(int(first["phase"])), float(first["time"]), float(last["time"]), last.copy(), config)


def stages(visits: Ordered[Visit], phase: Phase, outcome: Outcome | None) -> list[Stage]:
    """Each nominal phase, and the present one after them if it is none of these."""
    order = NOMINAL if phase in NOMINAL else (*NOMINAL, phase)
    found = [_stage(each, visits, phase, outcome) for each in order]
    reached = max((place for place, stage in enumerate(found) if stage.state != "ahead"), default=0)
    over = phase in _OFF or (outcome is not None and not outcome.caged)
    return [
        stage.model_copy(update={"state": "skipped", "why": "it was not flown"})
        if stage.state == "ahead" and (place < reached or over)
        else stage
        for place, stage in enumerate(found)
    ]


def _stage(phase: Phase, visits: Ordered[Visit], present: Phase, outcome: Outcome | None) -> Stage:
    places = [place for place, visit in enumerate(visits) if visit.phase is phase]
    lasted = sum(visits[place].end - visits[place].start for place in places) if places else None
    if phase is present:
        return Stage(phase=phase.label, state="now", why="", lasted=lasted or 0.0)
    if not places:
        return Stage(phase=phase.label, state="ahead", why="", lasted=None)
    last = places[-1]
    following = visits[last + 1].phase if last + 1 < len(visits) else present
    why = _failure(visits[last], following, outcome)
    state: Literal["done", "failed"] = "failed" if why else "done"
    return Stage(phase=phase.label, state=state, why=why, lasted=lasted)


def _failure(visit: Visit, following: Phase, outcome: Outcome | None) -> str:
    """Why a phase that was left had not achieved its purpose; empty if it had."""
    if visit.phase not in (Phase.DETUMBLING, Phase.CAGING):
        return ""
    judged = outcome is not None and not outcome.caged
    if visit.phase is Phase.CAGING and judged and outcome is not None:
        return verdict_in_words(outcome)
    if following in _OFF:
        return "stopped before it was done" if following is Phase.STOPPED else "a fault ended it"
    return visit.unmet
