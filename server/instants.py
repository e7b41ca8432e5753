"""Moments of the wall clock, as Becalm writes and reads them."""

from __future__ import annotations

from datetime import UTC, datetime


def instant(text: str) -> datetime:
    """A moment that ISO 8601 names with its time zone.

    Raises:
        ValueError: it names none.

    """
    moment = datetime.fromisoformat(text)
    if moment.tzinfo is None:
        raise ValueError(f"{text} has no time zone, such as +00:00")
    return moment.astimezone(UTC)


def wall_clock() -> str:
    """Now, ISO 8601 in UTC, to the millisecond."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


def day_and_time(text: str) -> str:
    """A moment as people read it, to the second: 2026-11-22 11:30:00 UTC."""
    return f"{instant(text):%Y-%m-%d %H:%M:%S} UTC"
