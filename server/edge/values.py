"""Values of requests that mean one thing: `false` is no number, `"7"` is none either, and an instant is one."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Annotated, Any

from pydantic import AfterValidator, AllowInfNan, BeforeValidator, Field, Strict

from server.texts import shortened
from sim.config import PARAMETERS

LONGEST_SHORT_TEXT = 200

Integer = Annotated[int, Strict()]
Number = Annotated[float, Strict(), AllowInfNan(False)]
Flag = Annotated[bool, Strict()]
ShortText = Annotated[str, Field(max_length=LONGEST_SHORT_TEXT)]
"""A name, or something to look for."""


def _instant(value: object) -> datetime:
    """The instant that a text says, in UTC; without a time zone it is said in UTC."""
    example = "write it as 2026-11-25T10:30:00Z (in an address + is %2B)"
    if not isinstance(value, str):
        raise ValueError(f"it is no text; {example}")
    try:
        instant = datetime.fromisoformat(value)
    except ValueError:
        raise ValueError(f"{shortened(value, 60)!r} is no instant of ISO 8601; {example}") from None
    try:
        return instant.replace(tzinfo=UTC) if instant.tzinfo is None else instant.astimezone(UTC)
    except OverflowError:
        raise ValueError(f"{shortened(value, 60)!r} is beyond the calendar; {example}") from None


Instant = Annotated[datetime, BeforeValidator(_instant)]
"""A moment of the wall clock, in whatever zone it is said; in UTC if it says none."""


def _said_as_it_is(changes: dict[str, Any]) -> dict[str, Any]:
    """Refuse truth values and texts where a parameter is a number."""
    waiting = [("", changes)]
    while waiting:
        group, branch = waiting.pop()
        for name, value in branch.items():
            path = f"{group}.{name}" if group else name
            if isinstance(value, dict):
                waiting.append((path, value))
            elif isinstance(value, bool | str) and path in PARAMETERS and _is_number(path):
                raise ValueError(f"{path} = {shortened(repr(value), 60)}: it is a number, not {_kind(value)}")
    return changes


def _is_number(path: str) -> bool:
    return PARAMETERS[path].annotation in (float, int)


def _kind(value: bool | str) -> str:
    return "a truth value" if isinstance(value, bool) else "a text"


Changes = Annotated[dict[str, Any], AfterValidator(_said_as_it_is)]
"""Nested changes of parameters, as JSON has them; that they fit is for `revised` to say."""
