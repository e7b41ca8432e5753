"""What the worker process does, a piece at a time: it keeps the futures, the service gets what they say.

So the service, whose Python the live mission needs, neither flies nor counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from server.rehearsals.rows import as_parquet
from sim.capture.mission import prepare as prepare_mission
from sim.config import MissionConfig
from sim.rehearsal.atlas import Atlas, AtlasCell, fly_atlas_cells
from sim.rehearsal.futures import Flown
from sim.rehearsal.rehearsal import Rehearsal, RehearsalResult, fly_case, result_of
from sim.rehearsal.summary import Band, Odds
from sim.study.cores import cores

_flown: dict[str, dict[str, list[Flown]]] = {}
"""Futures of the rehearsals under way, by identifier and case."""


class Concluded(NamedTuple):
    """A result, as it is sent."""

    json: bytes
    parquet: bytes
    outline: bytes
    """JSON without the single futures."""


class Ahead(NamedTuple):
    """What the futures of a look-ahead say."""

    caged: Odds
    peak_force: Band | None
    outline: bytes
    """The whole result without the single futures, as JSON."""


def prepare(configs: Sequence[MissionConfig]) -> int:
    """Compile or load what futures of these configurations run; none is flown."""
    for config in configs:
        prepare_mission(config, recorded=False)
    return 0


def fly(job: str, rehearsal: Rehearsal, case: str, numbers: Sequence[int]) -> int:
    """Fly and keep futures of a rehearsal; how many."""
    kept = _flown.setdefault(job, {each: [] for each in rehearsal.cases})[case]
    kept += fly_case(rehearsal, case, numbers, threads=cores())
    return len(numbers)


def conclude(job: str, rehearsal: Rehearsal) -> Concluded:
    """What all its futures say, which are let go of."""
    flown = _flown.pop(job)
    result = result_of(rehearsal, flown)
    return Concluded(_encoded(result), as_parquet(flown), _encoded(result.in_outline()))


def look_ahead(job: str, rehearsal: Rehearsal) -> Ahead:
    """The same, of a look-ahead."""
    result = result_of(rehearsal, _flown.pop(job))
    case = result.as_it_is
    peak = next((band for band in case.bands if band.measure == "peak_tip_force"), None)
    return Ahead(case.caged, peak, _encoded(result.in_outline()))


def _encoded(result: RehearsalResult) -> bytes:
    return result.model_dump_json().encode()


def forget(job: str) -> None:
    """Let go of the futures of a rehearsal that nobody waits for."""
    _flown.pop(job, None)


def fly_cells(atlas: Atlas, cells: Sequence[tuple[int, int]]) -> list[AtlasCell]:
    """Fly cells of an atlas."""
    return fly_atlas_cells(atlas, cells, threads=cores())
