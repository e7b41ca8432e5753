"""An entry of the shift log."""

from __future__ import annotations

from pydantic import Field

from sim.snapshot import FrozenMessage

LONGEST_TEXT = 2000
"""Letters of an entry."""


class ShiftEntry(FrozenMessage):
    """What somebody noted, and about what."""

    at: str = Field(description="ISO 8601 in UTC")
    who: str
    text: str = Field(max_length=LONGEST_TEXT)
    run_id: str = Field(description="That was flown then; empty if none was")
    time: float = Field(description="Mission time [s]")
