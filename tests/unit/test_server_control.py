"""Who is in control, as it changes hands."""

from __future__ import annotations

import pytest

from server.mission.control import Control
from sim.errors import MissionRefused

NOW = "2026-11-25T12:00:00.000+00:00"
LATER = "2026-11-25T13:00:00.000+00:00"
FREE = Control()
by_ana = FREE.taken("ana", NOW)


def test_free_control_is_anyones_and_taken_once():
    FREE.require("ana")
    assert by_ana == Control(holder="ana", since=NOW)
    assert by_ana.taken("ana", LATER) == by_ana


def test_what_somebody_has_is_not_taken_but_by_relieving_them():
    for refused in (
        by_ana.require,
        by_ana.released,
        lambda who: by_ana.taken(who, LATER),
        lambda who: by_ana.offered(who, "cy"),
    ):
        with pytest.raises(MissionRefused, match="ana is in control of the mission, since 2026-11-25T12:00"):
            refused("ben")
    assert by_ana.relieved("ben", LATER) == Control(holder="ben", since=LATER)


def test_an_offer_is_the_holders_until_the_other_one_takes_it():
    offered = by_ana.offered("ana", "ben")
    offered.require("ana")
    with pytest.raises(MissionRefused):
        offered.require("ben")
    with pytest.raises(MissionRefused):
        offered.taken("cy", LATER)
    assert offered.taken("ben", LATER) == Control(holder="ben", since=LATER)
    assert offered.taken("ana", LATER).offered_to == "ben"


def test_nobody_offers_to_themselves_or_what_they_do_not_have():
    with pytest.raises(MissionRefused, match="ana is in control already"):
        by_ana.offered("ana", "ana")
    with pytest.raises(MissionRefused, match="nobody is in control"):
        FREE.offered("ana", "ben")
    with pytest.raises(MissionRefused, match="nobody is in control"):
        FREE.released("ana")
    assert by_ana.released("ana") == FREE
