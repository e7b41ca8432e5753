"""The glossary of docs/conventions.md names code that is there."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]


def _rows() -> list[list[str]]:
    """The rows of the table under the heading: their cells, without the heading and the rule below it."""
    text = (ROOT / "docs" / "conventions.md").read_text()
    section = text.split("## Glossary", 1)[1].split("\n## ", 1)[0]
    lines = [line for line in section.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]


def _source(place: str) -> str:
    path = ROOT / place
    files = sorted(path.rglob("*.py")) if path.is_dir() else [path]
    return "\n".join(file.read_text() for file in files)


def test_each_term_stands_once_and_is_explained():
    rows = _rows()
    terms = [row[0] for row in rows]
    assert len(terms) == len(set(terms)) > 30
    assert all(len(row) == 6 and row[1] for row in rows)


def test_a_name_is_in_the_file_that_is_given_for_it():
    places = [found for row in _rows() for found in re.findall(r"`([\w.]+)` \(`(sim/[\w/.]+)`\)", row[3])]
    assert len(places) > 15
    for name, place in places:
        assert re.search(rf"\b{name.split('.')[-1]}\b", _source(place)), f"{name} is not in {place}"
