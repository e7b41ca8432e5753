"""Where a run is cut: a stretch is flown from a state of its own, so that contact cannot make chaos of the whole.

A touch lies within one stretch, with free flight before it that tells where it began from.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from sim.identification.recording import Numbers, Recording

LEAD, TAIL = 1.0, 0.3
"""Free flight before and after a touch that belong to its stretch [s]."""

LONGEST_TOUCH, LONGEST_FREE = 0.3, 4.0
"""Longer ones are cut [s]."""

SHORTEST = 0.15
"""Shorter pieces of free flight are left out [s]."""

APART = 0.15
"""Touches closer than this are flown as one [s]."""


class Stretch(NamedTuple):
    """Rows of a recording that are flown from one state."""

    first: int
    last: int
    """The row after the last."""
    touches: bool
    """Whether a hand is felt to touch in it."""
    onset: int
    """The first row that is felt to touch; `last` without one. Equal to `first` where a longer touch was cut."""
    follows: bool = False
    """Whether its first row is the last of the stretch before: what came of that is a guess of its state."""

    @property
    def rows(self) -> int:
        """How many."""
        return self.last - self.first


def stretches_of(recorded: Recording) -> tuple[Stretch, ...]:
    """All stretches of a run, in order."""
    found: list[Stretch] = []
    for segment in np.unique(recorded.segment):
        rows = np.flatnonzero(recorded.segment == segment)
        found += _of_segment(recorded, int(rows[0]), int(rows[-1]) + 1)
    return tuple(found)


def _of_segment(recorded: Recording, first: int, last: int) -> list[Stretch]:
    period = recorded.period
    found: list[Stretch] = []
    place = first
    touching = first + np.flatnonzero(recorded.touching[first:last].any(axis=1))
    for onset, end in _runs(touching, round(APART / period)):
        begin = max(place, onset - round(LEAD / period))
        found += _free(recorded, place, begin)
        place = min(last, end + 1 + round(TAIL / period))
        found += _cut_touch(begin, place, onset, round(LONGEST_TOUCH / period))
    found += _free(recorded, place, last)
    return [each for each in (_from_known(recorded, each) for each in found) if each is not None]


def _runs(rows: Numbers, apart: int) -> list[tuple[int, int]]:
    """First and last of each run of rows that are no farther apart."""
    if not len(rows):
        return []
    parts = np.split(rows, np.flatnonzero(np.diff(rows) > apart) + 1)
    return [(int(part[0]), int(part[-1])) for part in parts]


def _cut_touch(begin: int, end: int, onset: int, longest: int) -> list[Stretch]:
    """The stretch of a touch; a long one in pieces, each but the first of which begins while hands touch."""
    pieces = [Stretch(begin, min(end, onset + longest), True, onset)]
    while pieces[-1].last < end:
        start = pieces[-1].last - 1
        last = end if end - start < 2 * longest else start + longest
        pieces.append(Stretch(start, last, True, start, follows=True))
    return pieces


def _free(recorded: Recording, first: int, last: int) -> list[Stretch]:
    """Free flight: rows in which the target is nowhere near the robot."""
    longest = round(LONGEST_FREE / recorded.period)
    clear = first + np.flatnonzero(~recorded.near[first:last])
    found = []
    for start, end in _runs(clear, 1):
        edges = np.linspace(start, end + 1, max(1, -(-(end + 1 - start) // longest)) + 1).astype(int)
        found += [Stretch(a, b, False, b) for a, b in pairwise(edges.tolist()) if b > a]
    return found


def _from_known(recorded: Recording, stretch: Stretch) -> Stretch | None:
    """The stretch from its first row on whose joints are known; None if too little is left of it."""
    known = np.flatnonzero(np.isfinite(recorded.joint_angle[stretch.first : stretch.last]).all(axis=(1, 2)))
    if not len(known):
        return None
    first = stretch.first + int(known[0])
    result = stretch._replace(first=first, onset=max(first, stretch.onset))
    return result if result.rows * recorded.period >= SHORTEST else None
