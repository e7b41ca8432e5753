"""A state of a run, for futures to begin in."""

from __future__ import annotations

from typing import NamedTuple

from sim.rehearsal.situation import Situation


class RunState(NamedTuple):
    """What is known of a state, and the run that is or was in it."""

    run: str
    situation: Situation
