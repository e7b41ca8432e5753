"""What a report consists of; `server.reports.page` and `server.reports.printed` both write it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from matplotlib.figure import FigureBase


@dataclass(frozen=True)
class Heading:
    """Begins a part."""

    text: str


@dataclass(frozen=True)
class Words:
    """A paragraph."""

    text: str
    quiet: bool = False
    """Beside the matter: smaller and grey."""


@dataclass(frozen=True)
class Facts:
    """Names with their values, beside one another."""

    pairs: Sequence[tuple[str, str]]
    columns: int = 4


class Column(NamedTuple):
    """One column of a table."""

    title: str
    number: bool = False
    """Its values stand at the right."""


@dataclass(frozen=True)
class Table:
    """Rows under a head."""

    columns: Sequence[Column]
    rows: Sequence[Sequence[str]]


@dataclass(frozen=True)
class Drawing:
    """A figure: what draws it is called once for each place that it stands in."""

    width: float
    """[inch]"""
    height: float
    """[inch]"""
    draw: Callable[[FigureBase], None]
    words: str
    """What it shows, for who does not see it."""


@dataclass(frozen=True)
class Beside:
    """Two columns of blocks, none of which is broken over pages."""

    left: Sequence[Block]
    right: Sequence[Block]


Block = Heading | Words | Facts | Table | Drawing | Beside


@dataclass(frozen=True)
class Document:
    """One report."""

    title: str
    subtitle: str
    """What it is of, when, and by which version."""
    lead: str = ""
    """What came of it, in a sentence; empty if there is none."""
    blocks: Sequence[Block] = field(default_factory=tuple)


def number(value: float | None, digits: int = 4) -> str:
    """A value as it is read; a dash for none."""
    return "–" if value is None or not math.isfinite(value) else f"{value:.{digits}g}".replace("-", "\N{MINUS SIGN}")
