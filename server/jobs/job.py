"""One thing that was asked for, as pieces that each take some tenths of a second.

Between two pieces the worker is free for what is more urgent, and a job ends that nobody waits for any longer.
"""

from __future__ import annotations

import secrets
import time
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from typing import Any, Literal, NamedTuple

from server.instants import wall_clock

JobStatus = Literal["queued", "running", "finished", "failed", "cancelled", "superseded"]

URGENT, SOON, IDLY = 0, 1, 2
"""Who goes first: what somebody waits for, what fills or is found in minutes, and what nobody has asked for."""


class Piece(NamedTuple):
    """Something for the worker to do."""

    function: Callable[..., Any]
    arguments: tuple[Any, ...]
    note: str | None = None
    """What a job says of itself while this is done."""


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
        self.note = None if piece is None else piece.note
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
        raise NotImplementedError
