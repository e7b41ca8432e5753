"""What each cause is called, and what to do about it. Its message names stream, joint and figure."""

from __future__ import annotations

from typing import NamedTuple

from sim.errors import Cause


class CauseWords(NamedTuple):
    """Of one cause, for the operator."""

    title: str
    tip: str


_STOPPED = "the robot was sent a STOP; nothing resumes by itself"
_LOOK = "the page Link shows every stream"

CAUSE_WORDS: dict[Cause, CauseWords] = {
    Cause.DIVERGED: CauseWords(
        "The simulation diverged",
        "reset; a lower contact.stiffness or published.impedance.stiffness, or a shorter simulation.time_step, helps",
    ),
    Cause.PLANT_FAILED: CauseWords(
        "The plant failed", "reset starts a new mission; the run keeps what happened until now"
    ),
    Cause.BECALM_FAILED: CauseWords(
        "Becalm failed",
        "please report it, with the service's log; reset starts a new mission, and the run keeps what happened",
    ),
    Cause.JOINT_BLOCKED: CauseWords(
        "A joint does not follow",
        f"see whether that joint is blocked, at its end or without power, then reset; {_STOPPED}",
    ),
    Cause.SEVERAL_ROBOTS: CauseWords("More than one robot answers", f"leave one on these keys, then reset; {_STOPPED}"),
    Cause.SESSION_TAKEN: CauseWords(
        "Somebody else holds the robot",
        f"see on the page Link who does; when they have let go, reset; {_STOPPED}",
    ),
    Cause.ROBOT_STOPPED: CauseWords("The robot stopped by itself", f"fix what it names, then reset; {_STOPPED}"),
    Cause.NO_ANSWER: CauseWords(
        "The robot does not answer", f"see that it runs and that its network is well, then reset; {_STOPPED}"
    ),
    Cause.READING_REFUSED: CauseWords(
        "A sensor cannot be trusted", f"fix what the message names ({_LOOK}), then reset; {_STOPPED}"
    ),
    Cause.READING_JUMPED: CauseWords(
        "A measurement jumped", f"see what moved or misread it ({_LOOK}), then reset; {_STOPPED}"
    ),
    Cause.CLOCK_JUMPED: CauseWords(
        "The robot's clock jumped", f"let nothing set its clock while it is flown, then reset; {_STOPPED}"
    ),
    Cause.SENSOR_FROZEN: CauseWords(
        "A sensor repeats itself", f"restart that sensor ({_LOOK}), then reset; {_STOPPED}"
    ),
    Cause.ROBOT_SILENT: CauseWords(
        "The robot is silent", f"see that it runs and that its network is well, then reset; {_STOPPED}"
    ),
    Cause.STREAM_LATE: CauseWords(
        "A stream from the robot is late",
        f"see what sends it, and how busy network and machines are ({_LOOK}), then reset; {_STOPPED}",
    ),
    Cause.TARGET_EJECTED: CauseWords(
        "The target got away", "reset for the next try; touches that are softer or earlier send it off less"
    ),
    Cause.BASE_STRUCK: CauseWords(
        "The target struck the base",
        "reset for the next try; a lower published.impedance.damping keeps the target from following the hands",
    ),
    Cause.TIME_UP: CauseWords(
        "Not caged in time",
        "the events say what it waited for; reset for the next try, if it was on its way with more judging.time_limit",
    ),
}
