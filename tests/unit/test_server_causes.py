"""Each fault by its own name: what tells of it in words has the title and the tip of its kind."""

from __future__ import annotations

import pytest

from server.mission.causes import LINK, LINK_CAUSES, PLANT, PLANT_CAUSES, VERDICT, VERDICT_CAUSES, cause_of
from server.mission.problems import problem_of
from sim.capture.events import Event

TOLD = {
    "left_joint_2 does not follow: 0.091 rad behind": "A joint does not follow",
    "two robots answer on the same keys, a and b: none is flown": "More than one robot answers",
    "another robot answers: b, and this console flies a": "More than one robot answers",
    "the robot has let this session go; it is held by x.1": "Somebody else holds the robot",
    "the robot is holding: no heartbeat for 120 ms": "The robot stopped by itself",
    "the robot did not acknowledge session/open within 1 s": "The robot does not answer",
    "the robot was lost after it granted a session": "The robot does not answer",
    "left wrist wrench refused: not finite": "A sensor cannot be trusted",
    "target pose refused: frame 'camera', not in 'world'": "A sensor cannot be trusted",
    "left_joint_2 jumped by 0.200 rad": "A measurement jumped",
    "joint states jumped by 300 ms": "A measurement jumped",
    "base pose jumped: it has been where it cannot be for 110 ms": "A measurement jumped",
    "target pose frozen: the same for 130 ms": "A sensor repeats itself",
    "no joint states for 103 ms": "The robot is silent",
    "the robot is silent": "The robot is silent",
    "joint states late: what arrives is 140 ms old": "A stream from the robot is late",
    "no base pose for 103 ms": "A stream from the robot is late",
    "right wrist wrench: none has come yet": "A stream from the robot is late",
    "no robot heartbeat for 300 ms": "A stream from the robot is late",
    "anything else": "The robot cannot be flown",
}


@pytest.mark.parametrize(("message", "title"), TOLD.items())
def test_of_the_link(message, title):
    problem = problem_of(Event(time=1.0, tick=200, kind="link", severity="error", message=message))
    assert problem is not None
    assert (problem.title, problem.message) == (title, message)
    assert "reset" in problem.tip


def test_every_cause_is_told_apart():
    assert {cause_of("link", message) for message in TOLD} == {*LINK_CAUSES, LINK}
    everything = [*LINK_CAUSES, LINK, *PLANT_CAUSES, PLANT, *VERDICT_CAUSES, VERDICT]
    assert len({cause.title for cause in everything}) == len(everything)


@pytest.mark.parametrize(
    ("kind", "message", "title"),
    [
        ("fault", "the simulated state is not finite, or its momentum jumped, at 1.000 s", "The simulation diverged"),
        ("fault", "ZeroDivisionError: float division by zero", "Becalm failed"),
        ("fault", "the plant can no longer be trusted", "The plant failed"),
        ("verdict", "Failed: the target left the robot's reach; peak force 0.60 N", "The target got away"),
        ("verdict", "Failed: the target struck the base; peak force 0.60 N", "The target struck the base"),
        ("verdict", "Failed: not caged when the time was up; peak force 0.60 N", "Not caged in time"),
        ("verdict", "something else", "Not caged"),
    ],
)
def test_of_the_plant_and_of_the_verdict(kind, message, title):
    assert cause_of(kind, message).title == title
