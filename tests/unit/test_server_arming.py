"""What is armed: once, for seconds, for one person, one command and one moment of one mission."""

from __future__ import annotations

from dataclasses import replace

import pytest

from server.mission.arming import ARMED_TIME, TO_BE_ARMED, ArmedOrder, ArmingContext
from server.mission.inbox import Request, arguments_of
from sim.errors import MissionRefused

IDLE = ArmingContext("run-1", "idle")
CAPTURE = Request("capture", who="ana", arming="token")
RESET = Request(
    "reset", who="ana", arguments=arguments_of("testbed", {"target": {"mass": 2.0, "side": 0.1}}), arming="token"
)


def armed(request: Request = CAPTURE, at: float = 100.0) -> ArmedOrder:
    order = ArmedOrder()
    order.arm(replace(request, command="arm", arms=request.command), request.command, IDLE, at)  # type: ignore[arg-type]
    return order


def test_what_is_armed_is_carried_out_once():
    order = armed()
    order.redeem(CAPTURE, IDLE, 100.0 + ARMED_TIME - 0.001)
    with pytest.raises(MissionRefused, match="it was used"):
        order.redeem(CAPTURE, IDLE, 100.1)


def test_arguments_are_part_of_it():
    same = arguments_of("testbed", {"target": {"side": 0.1, "mass": 2.0}})
    armed(RESET).redeem(replace(RESET, arguments=same), IDLE, 101.0)


@pytest.mark.parametrize(
    ("request_", "where", "now", "words"),
    [
        (replace(CAPTURE, arming=None), IDLE, 101.0, "has not been armed"),
        (replace(CAPTURE, arming=""), IDLE, 101.0, "has not been armed"),
        (replace(CAPTURE, arming="tokem"), IDLE, 101.0, "no longer good"),
        (replace(CAPTURE, arming="tökén"), IDLE, 101.0, "no longer good"),
        (CAPTURE, IDLE, 100.0 + ARMED_TIME, "older than 6 s"),
        (CAPTURE, ArmingContext("run-1", "holding"), 101.0, "another phase"),
        (CAPTURE, ArmingContext("run-2", "idle"), 101.0, "no longer good"),
        (replace(CAPTURE, who="ben"), IDLE, 101.0, "ana armed capture, not ben"),
        (replace(CAPTURE, command="cage"), IDLE, 101.0, "or not cage"),
    ],
)
def test_what_does_not_fit_is_refused_and_disarms(request_, where, now, words):
    order = armed()
    with pytest.raises(MissionRefused, match=words) as refused:
        order.redeem(request_, where, now)
    assert f'{{"command": "{request_.command}"}}' in refused.value.tip
    with pytest.raises(MissionRefused):
        order.redeem(CAPTURE, IDLE, 101.0)


@pytest.mark.parametrize(
    "other",
    [arguments_of(), arguments_of("testbed"), arguments_of("published", {"target": {"mass": 2.0, "side": 0.1}})],
)
def test_other_arguments_are_another_command(other):
    with pytest.raises(MissionRefused, match="other arguments"):
        armed(RESET).redeem(replace(RESET, arguments=other), IDLE, 101.0)


def test_a_phase_that_was_left_and_came_back_has_disarmed():
    order = armed()
    order.watch(ArmingContext("run-1", "stopped"), 100.1)
    order.watch(IDLE, 100.2)
    with pytest.raises(MissionRefused):
        order.redeem(CAPTURE, IDLE, 100.3)


def test_everyone_sees_what_is_armed_and_for_how_long_but_not_its_token():
    order = armed()
    shown = order.shown(102.0)
    assert shown is not None
    assert (shown.command, shown.by) == ("capture", "ana")
    assert shown.expires_in == pytest.approx(ARMED_TIME - 2.0)
    assert "token" not in shown.model_dump_json()
    order.watch(IDLE, 100.0 + ARMED_TIME)
    assert order.shown(107.0) is None


def test_stop_and_hold_need_none():
    assert not {"stop", "hold"} & set(TO_BE_ARMED)
