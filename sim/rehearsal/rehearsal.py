"""A rehearsal: the same futures, as it is and as it would be with changes, on threads that compiled code lets run."""

from __future__ import annotations

import math
import os
import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Any

from pydantic import Field

from sim.capture.mission import prepare
from sim.config import MissionConfig, differences
from sim.configurations import revised
from sim.control.phases import Command
from sim.errors import CaptureError, ConfigError
from sim.rehearsal.futures import Flown, fly_future, rehearsed
from sim.rehearsal.situation import Situation
from sim.rehearsal.summary import CaseResult, case_result
from sim.rehearsal.uncertainty import UncertaintyModel
from sim.rehearsal.words import Change, changes_between
from sim.snapshot import FrozenMessage
from sim.study.cores import cores

FUTURES = 100
"""Of a rehearsal that says nothing else."""

MOST_FUTURES = 2_000
"""Of each configuration: odds to 2 %; what is kept of so many until they are counted is 50 MB."""

HORIZON = 20.0
"""Mission time that a future is flown at most, of a rehearsal that says nothing else [s]."""

LONGEST_HORIZON = 120.0

SETTLE = 0.5
"""From locked arms to a future's end [s]: by then the target has met the hands that hold it."""

AS_IT_IS, AS_CHANGED = "as_it_is", "as_changed"

_PACE = 30.0
"""Futures a second on two cores, for an estimate of how long very many take."""


class RehearsalCancelled(CaptureError):
    """Nobody waits for the rehearsal any longer."""


@dataclass(frozen=True)
class Rehearsal:
    """What is to be flown. Small, and travels as a pickle."""

    situation: Situation
    cases: Mapping[str, MissionConfig]
    """`AS_IT_IS`, and `AS_CHANGED` if something is changed, as `rehearsed` gives them."""
    request: Command | None
    """None goes on with the sequence that is under way."""
    uncertainty: UncertaintyModel
    futures: int
    """Of each case."""
    seed: int
    horizon: float
    """[s]"""
    notices: tuple[str, ...] = ()
    """What who asked should know."""

    @property
    def total(self) -> int:
        """Futures of all cases."""
        return self.futures * len(self.cases)


class RehearsalResult(FrozenMessage):
    """What the futures of a state say."""

    time: float = Field(description="Mission time of the state [s]")
    tick: int = Field(description="The first one that the futures fly")
    phase: str = Field(description="Of the state")
    request: str | None = Field(description="The sequence that each begins with; null: what is under way goes on")
    method: str
    engine: str = Field(description="That the futures are flown in")
    seed: int
    horizon: float = Field(description="Mission time after which a future is unresolved [s]")
    uncertainty: UncertaintyModel
    changes: dict[str, Any] = Field(description="Full path of each changed parameter to its value as changed")
    as_it_is: CaseResult
    as_changed: CaseResult | None = Field(description="With the changes; null without any")
    compared: list[Change] = Field(description="What gets better and worse by the changes, in words")
    notices: list[str]

    def in_outline(self) -> RehearsalResult:
        """Without the single futures."""
        changed = None if self.as_changed is None else self.as_changed.in_outline()
        return self.model_copy(update={"as_it_is": self.as_it_is.in_outline(), "as_changed": changed})


def planned(
    situation: Situation,
    changes: Mapping[str, Any],
    *,
    request: Command | None,
    uncertainty: UncertaintyModel,
    futures: int = FUTURES,
    seed: int = 0,
    horizon: float = HORIZON,
) -> Rehearsal:
    """A rehearsal, checked.

    Args:
        situation: that every future begins in.
        changes: nested, to the configuration in force; empty for none.
        request: the sequence that is asked for; None goes on with the one under way.
        uncertainty: what is not known for sure.
        futures: of each case.
        seed: the same gives the same futures.
        horizon: mission time after which a future is unresolved [s].

    Raises:
        ConfigError: a value is out of bounds; the message names field, value and bound.
        MissionRefused: the request cannot begin there.

    """
    require_within(futures, seed, horizon, MOST_FUTURES)
    cases = {AS_IT_IS: rehearsed(situation.config, SETTLE)}
    if changes:
        cases[AS_CHANGED] = rehearsed(revised(situation.config, changes), SETTLE)
    for config in cases.values():
        situation.require_can_begin(config, request)
    return Rehearsal(situation, cases, request, uncertainty, futures, seed, horizon, _notices(situation, cases))


def require_within(futures: int, seed: int, horizon: float, most: int) -> None:
    """Refuse what cannot be flown, or not in a reasonable time.

    Raises:
        ConfigError: the message names field, value and bound.

    """
    if not 1 <= futures <= most:
        long = f"; so many would take about {futures / _PACE / 60.0:.0f} min" if futures > MOST_FUTURES else ""
        tip = "100 give odds to 10 %, 1000 to 3 %" if most == MOST_FUTURES else ""
        raise ConfigError(f"futures = {futures}: from 1 to {most} are flown{long}", tip=tip)
    if not 0 <= seed < 2**63:
        raise ConfigError(f"seed = {seed}: it is a whole number from 0 to 2^63 - 1")
    if not (math.isfinite(horizon) and 0.0 < horizon <= LONGEST_HORIZON):
        raise ConfigError(f"horizon = {horizon:g} s: it is above 0 and at most {LONGEST_HORIZON:g} s")


_OF_THE_START = ("target.initial_", "robot.arm.initial_")


def _notices(situation: Situation, cases: Mapping[str, MissionConfig]) -> tuple[str, ...]:
    found = []
    if situation.touching:
        found.append("a hand touches the target: its pose is taken as it is believed, and only the rest is drawn")
    changed = differences(cases[AS_IT_IS], cases[AS_CHANGED]) if AS_CHANGED in cases else {}
    idle = [path for path in changed if path.startswith(_OF_THE_START)]
    if idle:
        found.append(f"{', '.join(idle)}: of a mission's start, and changes nothing from here")
    return tuple(found)


def prepare_futures(rehearsal: Rehearsal) -> None:
    """Compile what its futures run: a minute once, cached on disk afterwards."""
    for config in rehearsal.cases.values():
        prepare(config, recorded=False)


def fly_case(
    rehearsal: Rehearsal,
    case: str,
    numbers: Iterable[int],
    *,
    threads: int,
    on_flown: Callable[[Flown], None] = lambda _: None,
    cancelled: threading.Event | None = None,
    niceness: int = 0,
) -> list[Flown]:
    """Fly the futures of these numbers, of one case; in their order, whatever thread flew which.

    Args:
        rehearsal: what they belong to.
        case: of it.
        numbers: which futures.
        threads: that fly them.
        on_flown: called by the thread that flew it, with each future.
        cancelled: set by whoever no longer waits; looked at before each future.
        niceness: of the threads, beside this process's own (Linux).

    Raises:
        RehearsalCancelled: `cancelled` was set.

    """

    def fly(number: int) -> Flown:
        if cancelled is not None and cancelled.is_set():
            raise RehearsalCancelled("the rehearsal was cancelled")
        flown = fly_future(
            rehearsal.situation,
            rehearsal.cases[case],
            rehearsal.request,
            rehearsal.uncertainty,
            rehearsal.seed,
            number,
            rehearsal.horizon,
        )
        on_flown(flown)
        return flown

    with ThreadPoolExecutor(threads, "becalm-futures", initializer=partial(_be_nice, niceness)) as pool:
        return list(pool.map(fly, numbers))


def _be_nice(niceness: int) -> None:
    if niceness and hasattr(os, "setpriority"):  # of one thread, on Linux
        native = threading.get_native_id()
        os.setpriority(os.PRIO_PROCESS, native, os.getpriority(os.PRIO_PROCESS, native) + niceness)


def rehearse(
    rehearsal: Rehearsal,
    *,
    threads: int | None = None,
    on_progress: Callable[[int], None] = lambda _: None,
    cancelled: threading.Event | None = None,
    niceness: int = 0,
) -> RehearsalResult:
    """Fly a rehearsal in threads of this process, and say what comes out.

    Args:
        rehearsal: what to fly.
        threads: how many; one a core by default.
        on_progress: called with how many futures have been flown, as each ends.
        cancelled: set by whoever no longer waits.
        niceness: of the threads.

    Raises:
        RehearsalCancelled: `cancelled` was set.

    """
    prepare_futures(rehearsal)
    lock, done = threading.Lock(), 0

    def count(_: Flown) -> None:
        nonlocal done
        with lock:
            done += 1
            on_progress(done)

    flown = {
        case: fly_case(
            rehearsal,
            case,
            range(rehearsal.futures),
            threads=threads or cores(),
            on_flown=count,
            cancelled=cancelled,
            niceness=niceness,
        )
        for case in rehearsal.cases
    }
    return result_of(rehearsal, flown)


def result_of(rehearsal: Rehearsal, flown: Mapping[str, Sequence[Flown]]) -> RehearsalResult:
    """What the flown futures of all cases say."""
    situation = rehearsal.situation
    results = {case: case_result(futures) for case, futures in flown.items()}
    as_it_is, as_changed = results[AS_IT_IS], results.get(AS_CHANGED)
    config = rehearsal.cases[AS_IT_IS]
    changed = differences(config, rehearsal.cases[AS_CHANGED]) if as_changed else {}
    return RehearsalResult(
        time=situation.time,
        tick=situation.tick,
        phase=situation.phase.label,
        request=None if rehearsal.request is None else rehearsal.request.value,
        method=config.method.value,
        engine=config.simulation.engine.value,
        seed=rehearsal.seed,
        horizon=rehearsal.horizon,
        uncertainty=rehearsal.uncertainty,
        changes={path: new for path, (_, new) in changed.items()},
        as_it_is=as_it_is,
        as_changed=as_changed,
        compared=[] if as_changed is None else changes_between(as_it_is, as_changed),
        notices=list(rehearsal.notices),
    )
