"""Rehearsals, atlases and look-aheads as jobs of a worker beside the live mission."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any

from server.jobs.job import IDLY, SOON, URGENT, Job, Piece
from server.rehearsals import worker
from server.rehearsals.worker import Ahead, Concluded
from sim.config import MissionConfig
from sim.rehearsal.atlas import Atlas, AtlasCell
from sim.rehearsal.futures import rehearsed
from sim.rehearsal.rehearsal import Rehearsal

NICENESS = 12
"""Of their worker: the live mission comes first, and studies give way to it less than this."""

PIECE = 16
"""Futures that are flown before anything else may be."""

PREPARING = "the simulation is prepared first, which takes a minute where it is compiled"
"""The note of a job that has begun and cannot fly yet."""


class _FuturesJob(Job):
    """A job whose worker keeps the futures that it has flown."""

    def forgetting(self) -> Piece:
        """What lets the worker forget them."""
        return Piece(worker.forget, (self.id,))


class RehearsalJob(_FuturesJob):
    """A rehearsal."""

    kind, urgency = "rehearsal", URGENT

    def __init__(
        self,
        asker: str,
        rehearsal: Rehearsal,
        run: str | None,
        on_concluded: Callable[[Rehearsal, bytes], None] = lambda _rehearsal, _outline: None,
    ) -> None:
        """From that run's state, or without one from the live mission's.

        `on_concluded` is called with it and its result in outline, as JSON; it returns at once.
        """
        self.rehearsal, self.run, self._on_concluded = rehearsal, run, on_concluded
        self.concluded: Concluded | None = None
        super().__init__(asker, rehearsal.total)

    def pieces(self) -> Iterator[Piece]:
        """Its futures, case by case in turn, and what they say."""
        yield from _futures(self.id, self.rehearsal)
        yield Piece(worker.conclude, (self.id, self.rehearsal))

    def keep(self, result: Any) -> None:
        """Take how many futures were flown, or what all say."""
        if isinstance(result, Concluded):
            self.concluded = result
            self._on_concluded(self.rehearsal, result.outline)
        else:
            self.done += result


class LookAheadJob(_FuturesJob):
    """What the next request would do."""

    kind, urgency = "look-ahead", IDLY

    def __init__(
        self,
        rehearsal: Rehearsal,
        run: str,
        asker: str = "",
        on_made: Callable[[Ahead], None] = lambda _ahead: None,
    ) -> None:
        """From that run's state; `on_made` is called with what comes out, and returns at once."""
        self.rehearsal, self.run, self._on_made = rehearsal, run, on_made
        self.ahead: Ahead | None = None
        self.made_at = time.monotonic()
        super().__init__(asker, rehearsal.total)

    def pieces(self) -> Iterator[Piece]:
        """Its futures, and what they say."""
        yield from _futures(self.id, self.rehearsal)
        yield Piece(worker.look_ahead, (self.id, self.rehearsal))

    def keep(self, result: Any) -> None:
        """Likewise."""
        if isinstance(result, Ahead):
            self.ahead = result
            self._on_made(result)
        else:
            self.done += result


class WarmUpJob(_FuturesJob):
    """Nothing to fly: the worker starts, and loads what futures of a configuration run."""

    kind, urgency = "warm-up", IDLY

    def __init__(self, config: MissionConfig) -> None:
        self._config = config
        super().__init__("", 0)

    def pieces(self) -> Iterator[Piece]:
        """All at once."""
        yield Piece(worker.prepare, ([rehearsed(self._config)],))

    def keep(self, result: Any) -> None:
        """Nothing is kept."""


class AtlasJob(_FuturesJob):
    """An atlas, whose cells are there as they come."""

    kind, urgency = "atlas", SOON

    def __init__(self, asker: str, atlas: Atlas, run: str | None) -> None:
        self.atlas = atlas
        self.run = run
        self.cells: list[AtlasCell] = []
        super().__init__(asker, atlas.total)

    def pieces(self) -> Iterator[Piece]:
        """Its cells, coarse first."""
        cells = self.atlas.cells()
        yield Piece(worker.prepare, ([self.atlas.config],), PREPARING)
        together = max(2, PIECE // self.atlas.futures)
        for start in range(0, len(cells), together):
            yield Piece(worker.fly_cells, (self.atlas, cells[start : start + together]))

    def keep(self, result: Any) -> None:
        """Take cells."""
        self.cells += result or []
        self.done = len(self.cells)

    def restart(self) -> None:
        """Begin again."""
        self.cells = []
        super().restart()


def _futures(job: str, rehearsal: Rehearsal) -> Iterator[Piece]:
    """The futures of all cases side by side: who looks early sees both."""
    yield Piece(worker.prepare, (list(rehearsal.cases.values()),), PREPARING)
    for start in range(0, rehearsal.futures, PIECE):
        numbers = range(start, min(start + PIECE, rehearsal.futures))
        for case in rehearsal.cases:
            yield Piece(worker.fly, (job, rehearsal, case, numbers))
