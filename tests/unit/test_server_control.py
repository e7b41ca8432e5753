"""Who is in control, as it changes hands."""

from __future__ import annotations

import pytest

from server.mission.control import ControlDesk
from server.published import Control
from sim.errors import MissionRefused

NOW = "2026-11-25T12:00:00.000+00:00"
LATER = "2026-11-25T13:00:00.000+00:00"
BY_ANA = Control(holder="ana", since=NOW)
BY_BEN = Control(holder="ben", since=LATER)


@pytest.fixture
def free() -> ControlDesk:
    """Nobody is in control."""
    return ControlDesk()


@pytest.fixture
def anas() -> ControlDesk:
    """Ana is in control."""
    desk = ControlDesk()
    desk.take("ana", NOW)
    return desk


def test_free_control_is_anyones_and_taken_once(free):
    free.require("ana")
    free.take("ana", NOW)
    assert free.control == BY_ANA
    free.take("ana", LATER)
    assert free.control == BY_ANA


def test_what_somebody_has_is_not_taken_but_by_relieving_them(anas):
    for refused in (
        anas.require,
        anas.release,
        lambda who: anas.take(who, LATER),
        lambda who: anas.offer(who, "cy"),
    ):
        with pytest.raises(MissionRefused, match="ana is in control of the mission, since 2026-11-25T12:00"):
            refused("ben")
    assert anas.control == BY_ANA
    assert anas.change("relieve", "ben", "", LATER) == "ben is in control, ana is relieved"
    assert anas.control == BY_BEN


def test_an_offer_is_the_holders_until_the_other_one_takes_it(anas):
    anas.offer("ana", "ben")
    anas.require("ana")
    with pytest.raises(MissionRefused):
        anas.require("ben")
    with pytest.raises(MissionRefused):
        anas.take("cy", LATER)
    anas.take("ana", LATER)
    assert anas.control.offered_to == "ben"
    anas.take("ben", LATER)
    assert anas.control == BY_BEN


def test_nobody_offers_to_themselves_or_what_they_do_not_have(free, anas):
    with pytest.raises(MissionRefused, match="ana is in control already"):
        anas.offer("ana", "ana")
    with pytest.raises(MissionRefused, match="nobody is in control"):
        free.offer("ana", "ben")
    with pytest.raises(MissionRefused, match="nobody is in control"):
        free.release("ana")
    anas.release("ana")
    assert anas.control == Control()
