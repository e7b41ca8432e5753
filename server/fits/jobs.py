"""A fit as a job of the worker beside the live mission."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from server.fits import worker
from server.fits.worker import Looked
from server.jobs.job import SOON, Job, Piece
from sim.identification.fit import FitPlan
from sim.identification.result import FitResult

NICENESS = 16
"""Of its worker: rehearsals come first."""

STEPS = 1000
"""Into which its progress is divided."""


class FitJob(Job):
    """A fit."""

    kind, urgency = "fit", SOON

    def __init__(self, asker: str, plan: FitPlan) -> None:
        self.plan = plan
        self.result: FitResult | None = None
        super().__init__(asker, STEPS)

    def pieces(self) -> Iterator[Piece]:
        """Its beginning, and looks at it until it has ended: rehearsals go on between them."""
        yield Piece(worker.begin, (self.id, self.plan))
        while self.result is None:
            yield Piece(worker.look, (self.id,))

    def keep(self, result: Any) -> None:
        """Take how far it is, or what it found."""
        if isinstance(result, Looked):
            self.note, self.result = result.words or None, result.result
            self.done = STEPS if self.result is not None else round(STEPS * result.part)

    def next_piece(self) -> Piece | None:
        """The next look; its note stays what is being done."""
        note = self.note
        piece = super().next_piece()
        self.note = note if piece is not None else None
        return piece

    def forgetting(self) -> Piece:
        """What ends it in the worker."""
        return Piece(worker.forget, (self.id,))
