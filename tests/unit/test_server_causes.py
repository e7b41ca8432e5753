"""Each fault by its own name: title and tip go by the cause that was given where it was found, not by its words."""

from __future__ import annotations

import pytest

from server.mission.causes import CAUSE_WORDS
from server.mission.problems import problem_of
from sim.capture.events import Event, fault_event
from sim.errors import Cause, LinkLost, PlantDiverged, PlantError


def test_every_cause_has_a_title_of_its_own_and_a_tip():
    assert CAUSE_WORDS.keys() == set(Cause)
    assert len({words.title for words in CAUSE_WORDS.values()}) == len(Cause)
    assert all("reset" in words.tip for words in CAUSE_WORDS.values())


@pytest.mark.parametrize("cause", Cause)
def test_the_words_of_a_message_are_free(cause):
    message = "the robot is silent; target pose refused: jumped"
    problem = problem_of(Event(time=1.0, tick=200, kind="link", severity="error", message=message, cause=cause))
    assert problem is not None
    assert (problem.title, problem.tip, problem.message) == (*CAUSE_WORDS[cause], message)


@pytest.mark.parametrize(
    ("fault", "kind", "cause"),
    [
        (LinkLost("late", cause=Cause.STREAM_LATE), "link", Cause.STREAM_LATE),
        (PlantDiverged("not finite"), "fault", Cause.DIVERGED),
        (PlantError("no longer to be trusted"), "fault", Cause.PLANT_FAILED),
    ],
)
def test_a_fault_of_the_plant_is_an_event_with_its_cause(fault, kind, cause):
    event = fault_event(fault, 2.0, 0.001)
    assert (event.kind, event.tick, event.cause, event.message) == (kind, 2000, cause, str(fault))


def test_what_is_no_fault_is_no_problem():
    assert problem_of(Event(time=1.0, tick=1, kind="touch", severity="warning", message="Left hand touches")) is None
