"""A report as PDF, A4: blocks one below the other, as many on a page as it has room for."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple

from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.gridspec import GridSpec
from matplotlib.lines import Line2D
from matplotlib.textpath import text_to_path

from server.reports.blocks import Beside, Block, Column, Document, Drawing, Facts, Heading, Table, Words
from server.reports.style import GREY, INK, PALE, figure, look

WIDTH, HEIGHT = 8.27, 11.69
"""Of a page [inch]."""
MARGIN = 0.5
"""Of a page, on each side [inch]."""
TITLE, LEAD, HEADING, BODY, SMALL = 14.0, 10.0, 9.0, 7.2, 6.3
"""Sizes of letters [pt]."""
LINE = 1.4
"""From one line to the next, in sizes of the letters."""
GAP = 0.06
"""Between blocks [inch]."""
ABOVE_HEADING = 0.05
"""[inch]."""
ROW_GAP = 0.03
"""Between the rows of a table [inch]."""
GUTTER = 0.28
"""Between two columns of blocks [inch]."""
CELL_GAP = 0.12
"""Between two columns of a table [inch]."""
INCH = 72.0
"""[pt]"""


class _Place(NamedTuple):
    """Where on a page something may stand [inch from its left and top edge]."""

    left: float
    top: float
    width: float


class _Line(NamedTuple):
    """Text in one line, its size and looks."""

    text: str
    size: float
    colour: str = INK
    bold: bool = False

    @property
    def height(self) -> float:
        """That it takes [inch]."""
        return LINE * self.size / INCH


def pdf(document: Document) -> bytes:
    """The document, as many pages as it takes."""
    buffer = io.BytesIO()
    about = {"Title": document.title, "Creator": "Becalm", "CreationDate": None}
    with look(), PdfPages(buffer, metadata=about) as pages:
        press = _Press(pages)
        for line in _head_of(document):
            press.print(line)
        press.leave(GAP)
        for block in document.blocks:
            press.set(block)
        press.end()
    return buffer.getvalue()


def _empty_page() -> Figure:
    page = figure(WIDTH, HEIGHT)
    page.set_layout_engine("none")
    return page


def _head_of(document: Document) -> Iterator[_Line]:
    width = WIDTH - 2 * MARGIN
    for text, size, colour, bold in (
        (document.title, TITLE, INK, True),
        (document.subtitle, BODY, GREY, False),
        (document.lead, LEAD, INK, True),
    ):
        for line in wrapped(text, width, size, bold=bold) if text else ():
            yield _Line(line, size, colour, bold)


class _Press:
    """The page that is being filled, and those before it."""

    def __init__(self, pages: PdfPages) -> None:
        self._pages = pages
        self._page = _empty_page()
        self._top = MARGIN
        self._number = 1

    def print(self, line: _Line) -> None:
        """A line of the head."""
        self._require(line.height)
        _write(self._page, line, _Place(MARGIN, self._top, WIDTH - 2 * MARGIN))
        self._top += line.height

    def leave(self, height: float) -> None:
        """Leave so much empty [inch]."""
        self._top += height

    def set(self, block: Block) -> None:
        """A block below what is there; a table goes on over the page's end, all else begins the next one."""
        place = _Place(MARGIN, self._top, WIDTH - 2 * MARGIN)
        if isinstance(block, Table):
            self._set_table(block, place.width)
            return
        # A heading never stands alone at a page's end.
        self._require(_height(block, place.width) + (1.0 if isinstance(block, Heading) else 0.0))
        self._top += _set(self._page, block, place._replace(top=self._top)) + GAP

    def _set_table(self, table: Table, width: float) -> None:
        widths = _column_widths(table, width)
        heights = [_row_height(row, widths) for row in table.rows]
        start = 0
        while start < len(table.rows) or start == 0:
            head = _row_height([column.title for column in table.columns], widths)
            self._require(head + sum(heights[start : start + 2]))
            room, end = HEIGHT - MARGIN - self._top - head, start
            while end < len(heights) and heights[end] <= room:
                room -= heights[end]
                end += 1
            part = Table(table.columns, table.rows[start : max(end, start + 1)])
            self._top += _set_rows(self._page, part, widths, _Place(MARGIN, self._top, width)) + GAP
            start = max(end, start + 1)

    def _require(self, height: float) -> None:
        """Begin a page if this one has no room for so much [inch]."""
        if self._top > MARGIN and self._top + height > HEIGHT - MARGIN:
            self.end()
            self._page, self._top = _empty_page(), MARGIN
            self._number += 1

    def end(self) -> None:
        """The page is full, or the last one."""
        _write(self._page, _Line(str(self._number), SMALL, GREY), _Place(WIDTH / 2, HEIGHT - 0.4, 0.0))
        self._pages.savefig(self._page)  # type: ignore[no-untyped-call]


def _height(block: Block, width: float) -> float:
    """Of a block in a column of that width [inch]."""
    return _MEASURES[type(block)](block, width)


def _set(page: Figure, block: Block, place: _Place) -> float:
    """Set a block there; its height [inch]."""
    _SETTERS[type(block)](page, block, place)
    return _height(block, place.width)


def _heading_height(_: Heading, __: float) -> float:
    return ABOVE_HEADING + LINE * HEADING / INCH


def _set_heading(page: Figure, block: Heading, place: _Place) -> None:
    _write(page, _Line(block.text, HEADING, INK, bold=True), place._replace(top=place.top + ABOVE_HEADING))


def _lines_of(block: Words, width: float) -> list[_Line]:
    size, colour = (SMALL, GREY) if block.quiet else (BODY, INK)
    return [_Line(line, size, colour) for line in wrapped(block.text, width, size)]


def _words_height(block: Words, width: float) -> float:
    return sum(line.height for line in _lines_of(block, width))


def _set_words(page: Figure, block: Words, place: _Place) -> None:
    _write_lines(page, _lines_of(block, place.width), place)


def _fact_lines(pair: tuple[str, str], width: float) -> list[_Line]:
    name, value = pair
    return [_Line(name, SMALL, GREY), *(_Line(line, BODY) for line in wrapped(value, width, BODY))]


def _fact_rows(block: Facts, width: float) -> Iterator[tuple[float, list[list[_Line]]]]:
    """Each row of facts: its height [inch] and the lines of each fact."""
    own = _fact_width(block, width)
    for start in range(0, len(block.pairs), block.columns):
        row = [_fact_lines(pair, own) for pair in block.pairs[start : start + block.columns]]
        yield max(sum(line.height for line in lines) for lines in row) + 0.04, row


def _fact_width(block: Facts, width: float) -> float:
    return (width - CELL_GAP * (block.columns - 1)) / block.columns


def _facts_height(block: Facts, width: float) -> float:
    return sum(height for height, _ in _fact_rows(block, width))


def _set_facts(page: Figure, block: Facts, place: _Place) -> None:
    step, top = _fact_width(block, place.width) + CELL_GAP, place.top
    for height, row in _fact_rows(block, place.width):
        for column, lines in enumerate(row):
            _write_lines(page, lines, _Place(place.left + column * step, top, step - CELL_GAP))
        top += height


def _table_height(block: Table, width: float) -> float:
    widths = _column_widths(block, width)
    return sum(_row_height(row, widths) for row in ([column.title for column in block.columns], *block.rows))


def _set_table(page: Figure, block: Table, place: _Place) -> None:
    _set_rows(page, block, _column_widths(block, place.width), place)


def _set_rows(page: Figure, block: Table, widths: Sequence[float], place: _Place) -> float:
    """The head and all rows; their height [inch]."""
    top = place.top
    titles = [column.title for column in block.columns]
    for row, colour in ((titles, GREY), *((each, INK) for each in block.rows)):
        _set_row(page, row, block.columns, widths, colour, place._replace(top=top))
        top += _row_height(row, widths)
        rule = ((place.left / WIDTH, (place.left + sum(widths) + CELL_GAP * (len(widths) - 1)) / WIDTH), _up(top))
        page.add_artist(Line2D(rule[0], (rule[1], rule[1]), color=PALE, linewidth=0.5))
    return top - place.top


def _set_row(
    page: Figure, row: Sequence[str], columns: Sequence[Column], widths: Sequence[float], colour: str, place: _Place
) -> None:
    left = place.left
    for text, column, width in zip(row, columns, widths, strict=True):
        for at, line in enumerate(wrapped(text, width, BODY)):
            top = place.top + ROW_GAP / 2 + at * LINE * BODY / INCH
            _write(page, _Line(line, BODY, colour), _Place(left, top, width), right=column.number)
        left += width + CELL_GAP


def _row_height(row: Sequence[str], widths: Sequence[float]) -> float:
    lines = max(len(wrapped(text, width, BODY)) for text, width in zip(row, widths, strict=True))
    return ROW_GAP + lines * LINE * BODY / INCH


def _column_widths(table: Table, width: float) -> list[float]:
    """Of its columns [inch]: what they need, the widest ones less where that is more than there is."""
    rows = [[column.title for column in table.columns], *table.rows]
    wanted = [max(text_width(row[at], BODY) for row in rows) + 0.01 for at in range(len(table.columns))]
    room = width - CELL_GAP * (len(wanted) - 1)
    if sum(wanted) <= room:
        return wanted
    # Narrow columns keep what they need; the others share what is left of the room alike.
    left, cap = room, 0.0
    for place, need in enumerate(sorted(wanted)):
        cap = left / (len(wanted) - place)
        if need > cap:
            break
        left -= need
    return [min(need, cap) for need in wanted]


def _drawing_height(block: Drawing, width: float) -> float:
    return block.height * min(1.0, width / block.width)


def _set_drawing(page: Figure, block: Drawing, place: _Place) -> None:
    """Draw it within the page: a grid whose middle cell is the place.

    Where its axes stand is found out in a figure by itself: on a page the drawings would be laid out together.
    """
    scale = min(1.0, place.width / block.width)
    width, height = block.width * scale, block.height * scale
    alone = figure(width, height)
    block.draw(alone)
    alone.draw_without_rendering()
    grid = GridSpec(
        3,
        3,
        page,
        width_ratios=[place.left, width, WIDTH - place.left - width],
        height_ratios=[place.top, height, HEIGHT - place.top - height],
    )
    drawn = page.add_subfigure(grid[1, 1])
    block.draw(drawn)
    for axes, other in zip(drawn.axes, alone.axes, strict=True):
        axes.set_position(other.get_position(original=True))


def _beside_height(block: Beside, width: float) -> float:
    own = (width - GUTTER) / 2
    return max(sum(_height(each, own) + GAP for each in side) for side in (block.left, block.right)) - GAP


def _set_beside(page: Figure, block: Beside, place: _Place) -> None:
    own = (place.width - GUTTER) / 2
    for left, side in ((place.left, block.left), (place.left + own + GUTTER, block.right)):
        top = place.top
        for each in side:
            top += _set(page, each, _Place(left, top, own)) + GAP


def _write_lines(page: Figure, lines: Sequence[_Line], place: _Place) -> None:
    top = place.top
    for line in lines:
        _write(page, line, place._replace(top=top))
        top += line.height


def _write(page: Figure, line: _Line, place: _Place, *, right: bool = False) -> None:
    page.text(
        (place.left + (place.width if right else 0.0)) / WIDTH,
        _up(place.top + 0.5 * line.height),
        line.text,
        fontsize=line.size,
        color=line.colour,
        fontweight="bold" if line.bold else "normal",
        ha="right" if right else "left",
        va="center_baseline",
        parse_math=False,
    )


def _up(top: float) -> float:
    """That distance from the page's upper edge [inch] as matplotlib counts."""
    return 1.0 - top / HEIGHT


@lru_cache(maxsize=8192)
def text_width(text: str, size: float, *, bold: bool = False) -> float:
    """Of one line [inch]."""
    font = FontProperties(family="DejaVu Sans", size=size, weight="bold" if bold else "normal")
    width, _, _ = text_to_path.get_text_width_height_descent(text or " ", font, ismath=False)
    return float(width) / INCH


def wrapped(text: str, width: float, size: float, *, bold: bool = False) -> list[str]:
    """The text in lines of at most that width [inch]; a word that is longer is broken."""
    lines = [""]
    for word in text.split():
        joined = f"{lines[-1]} {word}".strip()
        if text_width(joined, size, bold=bold) <= width:
            lines[-1] = joined
            continue
        first, *further = _broken(word, width, size, bold=bold)
        if lines[-1]:
            lines.append(first)
        else:
            lines[-1] = first
        lines += further
    return lines


def _broken(word: str, width: float, size: float, *, bold: bool) -> list[str]:
    parts = [""]
    for letter in word:
        if parts[-1] and text_width(parts[-1] + letter, size, bold=bold) > width:
            parts.append("")
        parts[-1] += letter
    return parts


_MEASURES: dict[type, Callable[..., float]] = {
    Heading: _heading_height,
    Words: _words_height,
    Facts: _facts_height,
    Table: _table_height,
    Drawing: _drawing_height,
    Beside: _beside_height,
}
_SETTERS: dict[type, Callable[..., None]] = {
    Heading: _set_heading,
    Words: _set_words,
    Facts: _set_facts,
    Table: _set_table,
    Drawing: _set_drawing,
    Beside: _set_beside,
}
