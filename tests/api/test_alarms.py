"""Limits over REST, alarms of the live mission, and the shift log."""

from __future__ import annotations

import asyncio
import json

import pytest

PATIENCE = 180.0
"""Bound on every wait [s]: reached by a hang only."""


async def _alarm(console, key, fits):
    async with asyncio.timeout(PATIENCE):
        while True:
            found = {each["key"]: each for each in (await console.http.get("/alarms")).json()}
            if fits(found.get(key)):
                return found.get(key)
            await asyncio.sleep(0.05)


async def test_a_signal_beyond_its_limit_is_an_alarm_until_it_is_over_and_seen(console):
    limits = {"watch": 0.1, "warning": 0.5, "critical": 50.0, "hysteresis": 0.01}
    kept = await console.http.put("/alarms/limits/target_spin", json=limits)
    assert (kept.status_code, kept.json()["limits"]) == (200, limits)
    subscriber = console.services.feed.subscribe(60)
    raised = await _alarm(console, "limit:target_spin", lambda alarm: alarm is not None)
    assert (raised["level"], raised["active"], raised["bound"], raised["unit"]) == ("warning", True, 0.5, "rad/s")
    assert raised["value"] == pytest.approx(1.0, abs=1e-6)  # the target's spin at the start
    async with asyncio.timeout(PATIENCE):
        while (frame := await subscriber.next()).kind != "alarms":
            pass
    assert json.loads(frame.text)["alarms"][0]["key"] == "limit:target_spin"
    console.services.feed.unsubscribe(subscriber)

    shelved = await console.http.post("/alarms/shelve", json={"alarm": "limit:target_spin", "minutes": 5})
    assert shelved.json()[0]["shelved_by"] == "operator"
    unshelved = await console.http.post("/alarms/unshelve", json={"alarm": "limit:target_spin"})
    assert unshelved.json()[0]["shelved_by"] is None
    seen = await console.http.post("/alarms/acknowledge", json={"alarm": "limit:target_spin"})
    assert seen.json()[0]["acknowledged_by"] == "operator"
    assert (await console.http.delete("/alarms/limits/target_spin")).status_code == 204
    assert await _alarm(console, "limit:target_spin", lambda alarm: alarm is None) is None
    history = (await console.http.get("/alarms/history")).json()
    happened = [record["happening"] for record in history if record["key"] == "limit:target_spin"]
    assert happened == ["over", "acknowledged", "unshelved", "shelved", "raised"]


async def test_limits_are_told_with_their_defaults_and_refused_out_of_order(console):
    told = {each["name"]: each for each in (await console.http.get("/alarms/limits")).json()}
    assert told["manipulability"]["side"] == "below"
    assert told["tip_force"]["limits"] == told["tip_force"]["default"]
    refused = await console.http.put("/alarms/limits/tip_force", json={"watch": 3.0, "warning": 1.0})
    assert (refused.status_code, refused.json()["detail"]) == (422, "warning = 1: must be above watch, which is 3")
    unknown = await console.http.put("/alarms/limits/weather", json={})
    assert (unknown.status_code, unknown.json()["detail"][:32]) == (422, "signal = 'weather': nothing of t")
    gone = await console.http.post("/alarms/acknowledge", json={"alarm": "limit:weather"})
    assert gone.status_code == 409


async def test_the_shift_log_keeps_who_said_what_about_which_run(console):
    await console.until(lambda snapshot: snapshot.tick > 0)
    noted = await console.http.post("/shift-log", json={"text": "  wrists tared  "})
    assert noted.status_code == 201
    (entry,) = (await console.http.get("/shift-log")).json()
    assert (entry["text"], entry["who"]) == ("wrists tared", "operator")
    assert entry["run_id"] == (await console.snapshot())["run_id"]
    empty = await console.http.post("/shift-log", json={"text": "   "})
    assert empty.status_code == 422


async def test_who_watches_is_told_by_name_and_pages(console):
    feed = console.services.feed
    subscribers = [feed.subscribe(60, name) for name in ("ana", "ana", "ben")]
    assert (await console.http.get("/mission/control")).json()["watching"] == {"ana": 2, "ben": 1}
    for subscriber in subscribers:
        feed.unsubscribe(subscriber)
    assert (await console.http.get("/mission/control")).json()["watching"] == {}
