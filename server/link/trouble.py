"""Why a robot cannot be flown, in words and by its cause."""

from __future__ import annotations

from typing import NamedTuple

from sim.errors import Cause


class Trouble(NamedTuple):
    """What speaks against flying a robot now."""

    cause: Cause
    message: str
    """Names stream, joint and figure."""
