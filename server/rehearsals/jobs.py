"""What waits for the worker: a rehearsal, an atlas or a look-ahead, as pieces that each take some tenths of a second.

Between two pieces the worker is free for what is more urgent, and a job ends that nobody waits for any longer.
"""

from __future__ import annotations

import secrets
import time
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from typing import Any, Literal, NamedTuple

from server.instants import wall_clock
from server.rehearsals import worker
from server.rehearsals.worker import Ahead, Concluded
from sim.config import MissionConfig
from sim.rehearsal.atlas import Atlas, AtlasCell
from sim.rehearsal.futures import rehearsed
from sim.rehearsal.rehearsal import Rehearsal

JobStatus = Literal["queued", "running", "finished", "failed", "cancelled", "superseded"]

PIECE = 16
"""Futures that are flown before anything else may be."""

PREPARING = "the simulation is prepared first, which takes a minute where it is compiled"
"""The note of a job that has begun and cannot fly yet."""

URGENT, SOON, IDLY = 0, 1, 2
"""Who goes first: what somebody waits for, maps that fill, and the look-ahead."""


class Piece(NamedTuple):
    """Something for the worker to do."""

    function: Callable[..., Any]
    arguments: tuple[Any, ...]


class Job:
    """One thing that was asked for. The queue's lock guards what changes."""

    kind: str
    urgency: int

    def __init__(self, asker: str, total: int) -> None:
        self.id = f"{datetime.now(UTC):%Y%m%dT%H%M%S%f}"[:-3] + f"-{secrets.token_hex(3)}"
        self.created = wall_clock()
        self.asker = asker
        self.total = total
        self.done = 0
        self.status: JobStatus = "queued"
        self.note: str | None = None
        self.restarted = False
        self._began: float | None = None
        self._ended: float | None = None
        self._pieces = self.pieces()

    @property
    def has_ended(self) -> bool:
        """Whether nothing more comes of it."""
        return self.status not in ("queued", "running")

    @property
    def wall_time(self) -> float:
        """Since it began, to its end [s]."""
        return 0.0 if self._began is None else (self._ended or time.monotonic()) - self._began

    def next_piece(self) -> Piece | None:
        """What the worker does next of it; None if that was all."""
        if self._began is None:
            self._began, self.status = time.monotonic(), "running"
        piece = next(self._pieces, None)
        self.note = PREPARING if piece is not None and piece.function is worker.prepare else None
        return piece

    def restart(self) -> None:
        """Begin again: its worker was lost, and with it what it kept."""
        self.restarted, self.done, self._pieces = True, 0, self.pieces()

    def end(self, status: JobStatus, note: str | None = None) -> None:
        """Say how it ended."""
        self.status, self.note, self._ended = status, note, time.monotonic()

    def pieces(self) -> Iterator[Piece]:
        """All that the worker does of it, in order."""
        raise NotImplementedError

    def keep(self, result: Any) -> None:
        """Take what a piece gave."""
        raise NotImplementedError

    def forgetting(self) -> Piece:
        """What lets the worker forget it, when it ends before its time."""
        return Piece(worker.forget, (self.id,))


class RehearsalJob(Job):
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


class LookAheadJob(Job):
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


class WarmUpJob(Job):
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


class AtlasJob(Job):
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
        yield Piece(worker.prepare, ([self.atlas.config],))
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
    yield Piece(worker.prepare, (list(rehearsal.cases.values()),))
    for start in range(0, rehearsal.futures, PIECE):
        numbers = range(start, min(start + PIECE, rehearsal.futures))
        for case in rehearsal.cases:
            yield Piece(worker.fly, (job, rehearsal, case, numbers))
