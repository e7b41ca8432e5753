"""How a report is set: lines that fit, tables that go on over pages, nothing that is lost on the way."""

from __future__ import annotations

import re
import zlib

import pytest

from server.reports.blocks import Beside, Column, Document, Facts, Heading, Table, Words, number
from server.reports.page import html
from server.reports.printed import BODY, _column_widths, pdf, text_width, wrapped

ROWS = [(f"row{place:03d}", f"{place / 7:.3f}") for place in range(180)]
LONG = Document(
    title="A title <with> signs & more",
    subtitle="of nothing",
    lead="It went well.",
    blocks=(
        Facts([("Name", "value"), ("Other", "more")]),
        Table((Column("Name"), Column("Number", True)), ROWS),
        Beside((Heading("Left"), Words("words at the left")), (Heading("Right"), Words("quiet words", quiet=True))),
    ),
)


def _pages(document: bytes) -> list[str]:
    """The texts of each page, as they follow one another in its content."""
    streams = re.findall(rb"/FlateDecode.*?stream\r?\n(.*?)\r?\nendstream", document, re.S)
    contents = [content for content in map(zlib.decompress, streams) if b"Tj" in content or b"TJ" in content]
    return [
        "|".join(
            "".join(part.decode("latin-1") for part in re.findall(rb"\(((?:[^()\\]|\\.)*)\)", shown))
            for shown in re.findall(rb"(?:\[.*?\] TJ|\((?:[^()\\]|\\.)*\) Tj)", content, re.S)
        )
        for content in contents
    ]


@pytest.mark.parametrize("width", [0.4, 1.0, 3.0])
def test_no_line_is_wider_than_its_room_and_no_letter_is_lost(width):
    text = "published.impedance.damping is a parameter with averyveryverylongnamewithoutanyplacetobreakit at all"
    lines = wrapped(text, width, BODY)
    assert all(text_width(line, BODY) <= width for line in lines)
    assert "".join(lines).replace(" ", "") == text.replace(" ", "")


def test_columns_share_the_room_that_narrow_ones_leave():
    table = Table((Column("a"), Column("b"), Column("c")), [("x", "long " * 60, "even longer " * 60)])
    narrow, wide, wider = _column_widths(table, 7.0)
    assert narrow == pytest.approx(text_width("x", BODY) + 0.01, abs=0.02)
    assert wide == pytest.approx(wider)
    assert narrow + wide + wider <= 7.0


def test_a_long_table_goes_on_over_pages_with_its_head_and_all_rows():
    pages = _pages(pdf(LONG))
    assert len(pages) > 2
    assert all("Number" in page for page in pages[:-1])
    words = "|".join(pages)
    assert [name for name, _ in ROWS] == re.findall(r"row\d{3}", words)
    assert all(part in pages[-1] for part in ("Left", "words at the left", "Right", "quiet words"))


def test_a_page_needs_nothing_else_and_takes_no_text_for_markup():
    page = html(LONG).decode()
    assert page.startswith("<!doctype html>")
    assert "A title &lt;with&gt; signs &amp; more" in page
    assert not re.search(r"(src|href)=.?https?:", page)
    assert page.count("<tr>") == len(ROWS) + 1


def test_numbers_as_they_are_read():
    assert [number(value) for value in (None, float("nan"), -0.12345678, 3.0)] == ["–", "–", "−0.1235", "3"]
