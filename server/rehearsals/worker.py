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
from sim.rehearsal.rehearsal import AS_IT_IS, Rehearsal, fly_case, result_of
from sim.rehearsal.summary import Band, Odds, case_result
from sim.study.cores import cores

_flown: dict[str, dict[str, list[Flown]]] = {}
"""Futures of the rehearsals under way, by identifier and case."""


class Concluded(NamedTuple):
    """A result, as it is sent."""

    json: bytes
    parquet: bytes


class Ahead(NamedTuple):
    """What the futures of a look-ahead say."""

    caged: Odds
    peak_force: Band | None


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
    return Concluded(result_of(rehearsal, flown).model_dump_json().encode(), as_parquet(flown))


def look_ahead(job: str) -> Ahead:
    """The same, of a look-ahead."""
    result = case_result(_flown.pop(job)[AS_IT_IS])
    return Ahead(result.caged, next((band for band in result.bands if band.measure == "peak_tip_force"), None))


def forget(job: str) -> None:
    """Let go of the futures of a rehearsal that nobody waits for."""
    _flown.pop(job, None)


def fly_cells(atlas: Atlas, cells: Sequence[tuple[int, int]]) -> list[AtlasCell]:
    """Fly cells of an atlas."""
    return fly_atlas_cells(atlas, cells, threads=cores())
