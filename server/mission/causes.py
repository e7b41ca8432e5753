"""What a fault is called, and what to do about it, by its cause: one table, read by the words that tell of it.

Where a fault is found its message names stream, joint and figure; here it gets the title and the tip of its kind.
"""

from __future__ import annotations

import re
from typing import NamedTuple


class Cause(NamedTuple):
    """A kind of fault."""

    words: re.Pattern[str]
    """Of the messages that tell of it."""
    title: str
    tip: str


_STOPPED = "the robot was sent a STOP; nothing resumes by itself"
_LOOK = "the page Link shows every stream"


def _cause(words: str, title: str, tip: str) -> Cause:
    return Cause(re.compile(words), title, tip)


LINK_CAUSES = (
    _cause(
        "does not follow",
        "A joint does not follow",
        f"see whether that joint is blocked, at its end or without power, then reset; {_STOPPED}",
    ),
    _cause(
        "two robots|another robot",
        "More than one robot answers",
        f"leave one on these keys, then reset; {_STOPPED}",
    ),
    _cause(
        "let this session go|held by",
        "Somebody else holds the robot",
        f"see on the page Link who does; when they have let go, reset; {_STOPPED}",
    ),
    _cause(
        "the robot is (waiting|holding|stopped)",
        "The robot stopped by itself",
        f"fix what it names, then reset; {_STOPPED}",
    ),
    _cause(
        "did not acknowledge|was lost after",
        "The robot does not answer",
        f"see that it runs and that its network is well, then reset; {_STOPPED}",
    ),
    _cause(" refused: ", "A sensor cannot be trusted", f"fix what the message names ({_LOOK}), then reset; {_STOPPED}"),
    _cause(
        "jumped",
        "A measurement jumped",
        f"see what moved or misread it ({_LOOK}), then reset; {_STOPPED}",
    ),
    _cause("frozen", "A sensor repeats itself", f"restart that sensor ({_LOOK}), then reset; {_STOPPED}"),
    _cause(
        r"^no joint states for|the robot is silent",
        "The robot is silent",
        f"see that it runs and that its network is well, then reset; {_STOPPED}",
    ),
    _cause(
        r" late: |^no .* for \d+ ms|none has come yet",
        "A stream from the robot is late",
        f"see what sends it, and how busy network and machines are ({_LOOK}), then reset; {_STOPPED}",
    ),
)
"""Of a robot that cannot be flown; the first that fits holds."""

LINK = _cause("", "The robot cannot be flown", f"fix what the message names ({_LOOK}), then reset; {_STOPPED}")
"""Of a robot whose fault is none of these."""

PLANT_CAUSES = (
    _cause(
        "not finite|momentum jumped",
        "The simulation diverged",
        "reset; a lower contact.stiffness or control.impedance.stiffness, or a shorter simulation.time_step, helps",
    ),
    _cause(
        "^[A-Z][A-Za-z]*(Error|Exception|Warning): ",
        "Becalm failed",
        "please report it, with the service's log; reset starts a new mission, and the run keeps what happened",
    ),
)
"""Of a plant that is no robot, and of Becalm itself."""

PLANT = _cause("", "The plant failed", "reset starts a new mission; the run keeps what happened until now")

VERDICT_CAUSES = (
    _cause(
        "left the robot's reach",
        "The target got away",
        "reset for the next try; touches that are softer or earlier send it off less",
    ),
    _cause(
        "struck the base",
        "The target struck the base",
        "reset for the next try; a lower control.impedance.damping keeps the target from following the hands",
    ),
    _cause(
        "time was up",
        "Not caged in time",
        "the events tell what it waited for; reset for the next try, if it was on its way with more judging.time_limit",
    ),
)

VERDICT = _cause("", "Not caged", "the log of the run tells how it came to this; reset for the next try")


def cause_of(kind: str, message: str) -> Cause:
    """The cause that an event of that kind, `link`, `fault` or `verdict`, tells of with these words."""
    known, other = {"link": (LINK_CAUSES, LINK), "fault": (PLANT_CAUSES, PLANT), "verdict": (VERDICT_CAUSES, VERDICT)}[
        kind
    ]
    return next((cause for cause in known if cause.words.search(message)), other)
