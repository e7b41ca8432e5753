"""What strangers write, made fit to be shown and logged: short, on one line, and nothing that a terminal obeys."""

from __future__ import annotations

import re

LONGEST_SHOWN = 120
"""Characters of a stranger's text in an answer or a line of a log."""

_UNPRINTABLE = re.compile(r"[\x00-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")


def one_line(text: str) -> str:
    """The text with every control character, and all else that would change the line around it, escaped."""
    return _UNPRINTABLE.sub(lambda found: found[0].encode("unicode_escape").decode(), text)


def shortened(text: str, longest: int = LONGEST_SHOWN) -> str:
    """The text on one line, cut after so many characters with word of how many there were."""
    if len(text) <= longest:
        return one_line(text)
    return f"{one_line(text[:longest])}... ({len(text)} characters)"
