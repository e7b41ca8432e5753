"""Commands: granted, refused with the reason, and STOP in every phase."""

from __future__ import annotations

import asyncio
import threading
import time

import pytest

from server.mission.inbox import Request
from sim.errors import MissionRefused

ACTIVE = {"capture": "detumbling", "detumble": "detumbling", "cage": "caging", "direct_cage": "caging"}


async def test_mission_starts_running_and_idle(console):
    first = await console.snapshot()
    later = await console.until(lambda snapshot: snapshot.tick > first["tick"])
    assert first["phase"] == "idle"
    assert first["outcome"] is None
    assert first["plant"]["running"]
    assert later.target.pose[2] > first["target"]["pose"][2]  # it spins


@pytest.mark.parametrize("command", ACTIVE)
async def test_answer_says_what_the_loop_did(console, command):
    answer = await console.granted(command)
    assert answer["accepted"]
    assert answer["command"] == command
    assert answer["phase"] == ACTIVE[command]
    assert (await console.snapshot())["phase"] == ACTIVE[command]


@pytest.mark.parametrize("command", ["hold", "release"])
async def test_refused_with_the_reason_that_the_snapshot_gives(console, command):
    reason = (await console.snapshot())["commands"][command]
    answer = await console.command(command)
    problem = answer.json()
    assert answer.status_code == 409
    assert answer.headers["content-type"] == "application/problem+json"
    assert problem["detail"] == reason
    assert problem["tip"]
    assert (await console.snapshot())["phase"] == "idle"


async def test_whole_capture_ends_with_an_outcome(console):
    await console.granted("run", speed=0)
    await console.granted("capture")
    snapshot = await console.until(lambda snapshot: snapshot.outcome is not None)
    assert snapshot.phase in ("holding", "stopped")
    assert snapshot.outcome.contacts
    assert snapshot.outcome.duration > 0


async def test_full_speed_is_for_a_mission_that_does_something(console):
    await console.granted("run", speed=0)
    before, began = (await console.snapshot())["time"], time.monotonic()
    await console.until(lambda snapshot: snapshot.time > before + 1.0)
    assert time.monotonic() - began > 0.5  # at full speed a mission's second takes some milliseconds


async def _lead_to(console, phase: str) -> None:
    steps = {
        "idle": [],
        "detumbling": ["capture"],
        "caging": ["direct_cage"],
        "holding": ["capture", "hold"],
        "released": ["capture", "hold", "release"],
        "stopped": ["stop"],
    }
    for command in steps[phase]:
        answer = await console.http.post("/mission/stop") if command == "stop" else await console.command(command)
        assert answer.status_code == 200, answer.text
    assert (await console.snapshot())["phase"] == phase


@pytest.mark.parametrize("paused", [False, True])
@pytest.mark.parametrize("phase", ["idle", "detumbling", "caging", "holding", "released", "stopped"])
async def test_stop_in_every_phase(console, phase, paused):
    await _lead_to(console, phase)
    if paused:
        await console.granted("pause")
    before = (await console.snapshot())["tick"]
    answer = await console.http.post("/mission/stop")
    after = await console.snapshot()
    assert answer.status_code == 200
    assert answer.json()["phase"] == "stopped"
    assert after["phase"] == "stopped"
    if paused:
        assert after["tick"] == before  # it did not run on


async def test_stop_comes_before_what_waits(console):
    await console.granted("pause")
    step = asyncio.create_task(console.command("step", ticks=100_000))
    await console.until(lambda snapshot: snapshot.commands["step"] == "a step is under way")
    assert (await console.http.post("/mission/stop")).json()["phase"] == "stopped"
    assert "stopped" in (await step).json()["message"]


async def test_after_stop_only_reset(console):
    await console.http.post("/mission/stop")
    assert (await console.command("capture")).status_code == 409
    answer = await console.granted("reset")
    assert answer["phase"] == "idle"
    await console.granted("capture")


async def test_pause_holds_the_clock_and_run_lets_it_go(console):
    paused = await console.granted("pause")
    snapshot = await console.snapshot()
    assert snapshot["tick"] == paused["tick"]
    assert not snapshot["plant"]["running"]
    await console.granted("run")
    await console.until(lambda snapshot: snapshot.tick > paused["tick"])


async def test_command_while_paused_begins_when_the_clock_runs(console):
    await console.granted("pause")
    answer = await console.granted("capture")
    assert "when the clock runs" in answer["message"]
    await console.granted("run")
    await console.until(lambda snapshot: snapshot.phase == "detumbling" and snapshot.activity != "none")


@pytest.mark.parametrize("ticks", [1, 10, 700])
async def test_step_flies_exactly_that_many_ticks(console, ticks):
    paused = await console.granted("pause")
    answer = await console.granted("step", ticks=ticks)
    assert answer["tick"] == paused["tick"] + ticks
    assert (await console.snapshot())["tick"] == paused["tick"] + ticks


async def test_step_is_refused_while_the_clock_runs(console):
    answer = await console.command("step")
    assert answer.status_code == 409
    assert "pause" in answer.json()["tip"]


@pytest.mark.parametrize("speed", [0.1, 4.0])
async def test_speed_is_a_multiple_of_real_time(console, speed):
    await console.granted("run", speed=speed)
    # The factor is that of the last second, and a machine may stop for longer: some second will do.
    snapshot = await console.until(lambda now: now.plant.real_time_factor == pytest.approx(speed, rel=0.25))
    assert snapshot.plant.speed == speed


@pytest.mark.parametrize(
    ("body", "field"),
    [
        ({"command": "fly"}, "command"),
        ({}, "command"),
        ({"command": "run", "speed": -1}, "speed"),
        ({"command": "run", "speed": 0.05}, "speed"),
        ({"command": "run", "speed": 101}, "speed"),
        ({"command": "capture", "speed": 1}, "speed"),
        ({"command": "step", "ticks": 0}, "ticks"),
        ({"command": "step", "ticks": 100_001}, "ticks"),
        ({"command": "reset", "configuration": "nonesuch"}, "configuration"),
        ({"command": "capture", "now": True}, "now"),
    ],
)
async def test_bad_request_names_the_field(console, body, field):
    answer = await console.http.post("/mission/commands", json=body)
    problem = answer.json()
    assert answer.status_code == 422
    assert answer.headers["content-type"] == "application/problem+json"
    assert problem["errors"][0]["field"] == field
    assert problem["errors"][0]["message"]


async def test_reset_begins_a_new_mission_and_run(console):
    await console.granted("capture")
    await console.until(lambda snapshot: snapshot.tick > 1000)  # an idle mission may be 120 ticks ahead of the clock
    before = await console.snapshot()
    await console.granted("reset", configuration="as_printed")
    after = await console.snapshot()
    assert after["run_id"] != before["run_id"]
    assert after["configuration"] == "as_printed"
    assert after["phase"] == "idle"
    assert after["tick"] < before["tick"]


async def test_reset_keeps_the_configuration_in_force(console):
    await console.http.patch("/mission/config", json={"published": {"impedance": {"damping": 2.5}}})
    await console.granted("reset")
    body = (await console.http.get("/mission/config")).json()
    assert body["config"]["published"]["impedance"]["damping"] == 2.5
    assert body["name"] == "published_figures (edited)"


async def test_a_client_that_goes_away_does_no_harm(console):
    await console.granted("pause")
    step = asyncio.create_task(console.command("step", ticks=20_000))
    await console.until(lambda snapshot: snapshot.commands["step"] == "a step is under way")
    step.cancel()
    given_up = console.services.loop.ask(Request("capture"))
    given_up.cancel()
    await console.until(lambda snapshot: snapshot.commands["step"] is None)
    assert (await console.granted("run"))["phase"] in ("idle", "detumbling")


async def test_every_command_is_logged_with_its_answer(console):
    await console.command("release")
    await console.granted("capture")
    run_id = (await console.snapshot())["run_id"]
    await console.granted("reset")
    await console.until_run(run_id, "cancelled")
    events = (await console.http.get(f"/runs/{run_id}/events")).json()
    logged = [(event["command"], event["accepted"], event["who"]) for event in events if event["kind"] == "command"]
    assert logged == [("release", False, "operator"), ("capture", True, "operator"), ("reset", True, "operator")]


async def test_a_failing_tick_is_a_fault_that_a_reset_ends(console, monkeypatch):
    def broken(_mission, _ticks):
        raise ZeroDivisionError("for the test")

    await console.granted("capture")
    with monkeypatch.context() as patch:
        patch.setattr("sim.capture.mission.Mission.advance", broken)
        faulted = await console.until(lambda snapshot: snapshot.phase == "faulted")
    (problem,) = [each for each in faulted.problems if each.title == "Becalm failed"]
    assert "for the test" in problem.message
    assert "reset" in problem.tip
    assert (await console.http.get("/health")).json()["status"] == "faulted"
    assert (await console.command("capture")).status_code == 409
    assert (await console.http.post("/mission/stop")).status_code == 200
    run = await console.until_run(faulted.run_id, "failed")
    assert "for the test" in run["note"]
    await console.granted("reset")
    assert (await console.snapshot())["phase"] == "idle"


async def test_a_plant_that_diverges_is_a_fault_and_its_run_failed(console, monkeypatch):
    """The real path: the plant answers that its state cannot be trusted, and nothing raises."""

    def diverging(*arguments):
        arguments[-1][:1] = 0  # the row of the tick that it flies
        return 1, False

    await console.granted("capture")
    with monkeypatch.context() as patch:
        patch.setattr("sim.capture.mission.fly", diverging)
        faulted = await console.until(lambda snapshot: snapshot.phase == "faulted")
    run = await console.until_run(faulted.run_id, "failed")
    assert "not finite" in run["note"]
    events = (await console.http.get(f"/runs/{faulted.run_id}/events")).json()
    assert "fault" in [event["kind"] for event in events]


async def test_nothing_asked_before_a_stop_moves_the_arms_after_it(console, monkeypatch):
    """Reset, capture and STOP wait together: without care the STOP would hit the mission that the reset ends."""
    loop = console.services.loop
    held, go_on = threading.Event(), threading.Event()
    asleep = loop._waking.sleep

    def hold_the_turn(_flying):
        held.set()
        assert go_on.wait(180)

    with monkeypatch.context() as patch:
        patch.setattr(loop._waking, "sleep", hold_the_turn)
        assert await asyncio.to_thread(held.wait, 10)
        waiting = [loop.ask(Request("reset")), loop.ask(Request("capture"))]
        stop = loop.ask(Request("stop"))
        patch.setattr(loop._waking, "sleep", asleep)
        go_on.set()
        assert (await asyncio.wrap_future(stop)).phase == "stopped"
        for answer in waiting:
            with pytest.raises(MissionRefused, match="STOP"):
                await asyncio.wrap_future(answer)
    assert (await console.snapshot())["phase"] == "stopped"
