"""What an operator must see of the live mission, and what to do about it."""

from __future__ import annotations

from server.mission.causes import CAUSE_WORDS
from server.published import Problem
from sim.capture.events import Event

_TIPS = {
    "solid_contact": "reset, then raise published.caging.close_margin or lower the target's spin before the next try",
    "base_overlap": "stop, then reset; a lower published.impedance.damping keeps the target from following the hands",
    "rate_limit": "an arm is near a singularity; watch its manipulability, or set "
    "control.rates.singularity_handling to damped_least_squares and reset",
    "manipulability": "an arm is near a singularity; hold, and release, or set "
    "control.rates.singularity_handling to damped_least_squares and reset",
}

_TITLES = {
    "solid_contact": "Unplanned contact",
    "base_overlap": "Target at the base",
    "rate_limit": "Joint rates at their limit",
    "manipulability": "Manipulability low",
}


def problem_of(event: Event) -> Problem | None:
    """The event as a problem with a title and a tip; None if there is nothing to do about it."""
    if event.severity == "info":
        return None
    if event.cause is not None:
        title, tip = CAUSE_WORDS[event.cause]
    elif event.kind in _TITLES:
        title, tip = _TITLES[event.kind], _TIPS[event.kind]
    else:
        return None
    return Problem(severity=event.severity, title=title, message=event.message, tip=tip, since=event.time)


class ProblemBoard:
    """The problems of a mission that the operator has to see now; one of each key."""

    def __init__(self) -> None:
        self._problems: dict[str, Problem] = {}

    def show(self, key: str, problem: Problem) -> None:
        """Show a problem; one that is shown already keeps the time when it began."""
        present = self._problems.get(key)
        since = present.since if present else problem.since
        self._problems[key] = problem.model_copy(update={"since": since})

    def clear(self, key: str) -> None:
        """Take a problem off the board, if it is there."""
        self._problems.pop(key, None)

    def shown(self) -> tuple[Problem, ...]:
        """All of them, the oldest first."""
        return tuple(self._problems.values())
