"""Arming over REST, where a simulation flies: a script that arms flies robot and simulation alike."""

from __future__ import annotations

import becalm


async def armed(console, **body) -> dict:
    answer = await console.http.post("/mission/arming", json=body)
    assert answer.status_code == 200, answer.text
    return answer.json()


async def test_an_armed_command_is_granted_once(console):
    arming = await armed(console, command="detumble")
    shown = (await console.snapshot())["armed"]
    assert shown["command"] == "detumble"
    assert 0.0 < shown["expires_in"] <= arming["expires_in"]
    await console.granted("detumble", arming=arming["token"])
    assert (await console.snapshot())["armed"] is None
    await console.granted("hold")
    again = await console.command("detumble", arming=arming["token"])
    assert again.status_code == 409
    assert "no longer good" in again.json()["detail"]
    assert (await console.snapshot())["phase"] == "holding"
    events = await _until_commands(console, 4)
    assert [event["command"] for event in events] == ["arm", "detumble", "hold", "detumble"]


async def _until_commands(console, count: int) -> list[dict]:
    """The commands of the run under way, once the thread that writes it has kept so many."""
    run = (await console.snapshot())["run_id"]
    await console.until_run(run, "running", "finished", "cancelled")
    events = await console.until_events(run, lambda events: len(_commands(events)) >= count)
    return _commands(events)


def _commands(events: list[dict]) -> list[dict]:
    return [event for event in events if event["kind"] == "command"]


async def test_a_stop_and_any_other_command_take_it_back(console):
    for other in ("pause", "run"):
        arming = await armed(console, command="capture")
        await console.granted(other)
        assert (await console.command("capture", arming=arming["token"])).status_code == 409
    arming = await armed(console, command="capture")
    await console.http.post("/mission/stop")
    assert (await console.snapshot())["armed"] is None
    assert (await console.command("capture", arming=arming["token"])).status_code == 409


async def test_what_the_phase_does_not_allow_cannot_be_armed(console):
    answer = await console.http.post("/mission/arming", json={"command": "release"})
    assert answer.status_code == 409
    assert answer.json()["detail"] == (await console.snapshot())["commands"]["release"]


async def test_a_reset_with_changes_is_one_request(console):
    changes = {"target": {"initial_spin": 0.8}}
    arming = await armed(console, command="reset", configuration="published", changes=changes)
    await console.granted("reset", configuration="published", changes=changes, arming=arming["token"])
    config = (await console.http.get("/mission/config")).json()
    assert config["edited"] == {"target.initial_spin": {"from": 1.0, "to": 0.8}}
    refused = await console.command("reset", changes={"target": {"initial_spin": "fast"}})
    assert refused.status_code == 422
    assert (await console.command("capture", changes={})).status_code == 422


async def test_arguments_of_other_commands_are_refused(console):
    for body in (
        {"command": "hold"},
        {"command": "capture", "configuration": "published"},
        {"command": "capture", "changes": {"target": {"mass": 2.0}}},
        {"command": "capture", "token": "x"},
    ):
        assert (await console.http.post("/mission/arming", json=body)).status_code == 422


def test_the_client_arms_what_is_meant(served):
    with becalm.Client(f"http://127.0.0.1:{served.port}") as service:
        service.command("reset", configuration="published", changes={"target": {"mass": 2.0}}, armed=True)
        service.change({"target": {"mass": 2.1}}, armed=True)
        assert service.config().config.target.mass == 2.1
        service.command("detumble", armed=True)
        assert service.command("hold", armed=True).phase == "holding"  # which needs no arming
