"""Two operators and an observer at one mission: one commands, all see who, everyone may stop."""

from __future__ import annotations

import contextlib
import time

import pytest

import becalm
from becalm.calls import ServiceRefused
from server.access.roles import Role
from server.access.tokens import TokenStore
from server.settings import Settings

PATIENCE = 60.0
"""Bound on a wait for the disk [s]."""


@pytest.fixture(scope="module")
def crew(tmp_path_factory, serving):
    settings = Settings(
        data_dir=tmp_path_factory.mktemp("data"), require_tokens=True, configuration="published_figures"
    )
    store = TokenStore(settings.data_dir / "access")
    roles = {"ana": Role.OPERATOR, "ben": Role.OPERATOR, "vic": Role.VIEWER}
    secrets = {name: store.create(name, role) for name, role in roles.items()}
    with serving(settings) as served:
        address = f"http://127.0.0.1:{served.port}"
        clients = {name: becalm.Client(address, secret) for name, secret in secrets.items()}
        clients["vic"].watch().__next__()  # there is a mission now
        yield clients
        for client in clients.values():
            client.close()


@pytest.fixture(autouse=True)
def _free(crew):
    yield
    crew["ana"].control("relieve")
    crew["ana"].command("reset")
    crew["ana"].control("release_control")


def refusal(ask, *args, **fields) -> str:
    with pytest.raises(ServiceRefused) as refused:
        ask(*args, **fields)
    assert refused.value.status == 409
    return str(refused.value)


def commands_of(client, run: str, last: str) -> list[tuple[str, str, bool]]:
    """The last four commands of a run, once its recorder has written the one that is named."""
    deadline = time.monotonic() + PATIENCE
    told: list[tuple[str, str, bool]] = []
    while not told or told[-1][1] != last:
        assert time.monotonic() < deadline, told
        with contextlib.suppress(ServiceRefused):  # the run may not be on disk yet
            events = (event for event in client.events(run) if event["kind"] == "command")
            told = [(event["who"], event["command"], event["accepted"]) for event in events]
    return told[-4:]


def test_the_first_who_commands_is_in_control_and_others_are_refused_everything_but_stop(crew):
    crew["ana"].command("capture")
    control = crew["vic"].mission().control
    assert (control.holder, control.offered_to) == ("ana", None)
    for ask, argument in (
        (crew["ben"].command, "hold"),
        (crew["ben"].change, {"published": {"impedance": {"mass": 1}}}),
    ):
        assert "ana is in control of the mission" in refusal(ask, argument)
    assert crew["ben"].mission().phase == "detumbling"
    assert crew["vic"].stop().accepted
    assert crew["ben"].mission().control.holder == "ana"


def test_a_command_that_is_refused_takes_no_control(crew):
    refusal(crew["ben"].command, "release")
    assert crew["vic"].mission().control.holder is None


def test_control_is_handed_over_by_an_offer_that_is_taken(crew):
    crew["ana"].control("take_control")
    crew["ana"].control("hand_over", to="ben")
    assert crew["vic"].mission().control.offered_to == "ben"
    crew["ana"].command("pause")  # until it is taken, it is ana's
    assert "ana is in control" in refusal(crew["ben"].command, "run")
    assert crew["ben"].control("take_control").message == "ben is in control"
    assert "ben is in control" in refusal(crew["ana"].command, "run")
    crew["ben"].command("run")


def test_an_operator_who_does_not_answer_is_relieved_and_the_log_says_by_whom(crew):
    crew["ana"].command("capture")
    run = crew["ana"].mission().run_id
    assert "ana is in control" in refusal(crew["ben"].control, "take_control")
    assert crew["ben"].control("relieve").message == "ben is in control, ana is relieved"
    crew["ben"].command("hold")
    assert commands_of(crew["vic"], run, "hold") == [
        ("ana", "capture", True),
        ("ben", "take_control", False),
        ("ben", "relieve", True),
        ("ben", "hold", True),
    ]


def test_control_stays_with_its_holder_when_a_new_mission_begins(crew):
    crew["ana"].command("reset")
    assert crew["vic"].mission().control.holder == "ana"
    crew["ana"].control("release_control")
    assert crew["vic"].mission().control.holder is None


def test_an_observer_cannot_be_given_control_nor_take_it(crew):
    crew["ana"].control("take_control")
    assert "to = 'vic' is no operator; known: ana, ben" in refusal(crew["ana"].control, "hand_over", to="vic")
    with pytest.raises(ServiceRefused) as refused:
        crew["vic"].control("take_control")
    assert refused.value.status == 403


async def test_without_tokens_there_is_one_operator(console):
    assert (await console.http.get("/mission/control")).json()["operators"] == []
    answer = await console.http.post("/mission/control", json={"action": "hand_over", "to": "ben"})
    assert answer.status_code == 409
    assert "there is one operator only" in answer.json()["detail"]
    answer = await console.http.post("/mission/control", json={"action": "take_control", "to": "ben"})
    assert answer.status_code == 422
    assert "hand_over, and only that, says to whom" in answer.text
