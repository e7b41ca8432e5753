"""A fork goes on from a moment of the past: as its parent bit for bit, or on a way of its own that can be replayed."""

from __future__ import annotations

import asyncio
import threading

import numpy as np
import pytest

from becalm.replaying import replay
from server.api import mission as api
from server.mission import fork
from sim.capture.replay import flown_to
from sim.configurations import named_configuration, revised

FORK = 3600
"""In the middle of the first touch of `published`, which lasts from 3.456 s to 4.116 s after the command."""


async def _flown(console, engine="pymunk") -> str:
    """A capture to its verdict; the run's identifier."""
    changes = {"simulation": {"engine": engine}}
    config = revised(named_configuration("published"), changes)
    await asyncio.to_thread(console.services.loop._opener.prepare, config)
    await console.granted("reset", configuration="published", changes=changes)
    await console.granted("run", speed=0)
    await console.granted("capture")
    await console.until(lambda snapshot: snapshot.outcome is not None)
    run_id = (await console.snapshot())["run_id"]
    await console.until_run(run_id, "finished")
    return run_id


async def _to_the_verdict(console) -> str:
    run_id = (await console.snapshot())["run_id"]
    await console.granted("run", speed=0)
    await console.until(lambda snapshot: snapshot.run_id == run_id and snapshot.outcome is not None)
    await console.until_run(run_id, "finished")
    return run_id


def _ticks(console, run_id: str, first: int) -> np.ndarray:
    rows = np.concatenate(list(console.services.store.read(run_id).chunks()))
    return rows[rows["tick"] >= first]


@pytest.mark.parametrize("engine", ["pymunk", "reduced"])
async def test_an_unchanged_fork_is_its_parent_bit_for_bit_and_replays(console, engine, monkeypatch):
    began = []

    def watched(history, tick, on_ticks, start):
        began.append(0 if start is None else start.tick)
        return flown_to(history, tick, on_ticks, start)

    monkeypatch.setattr(fork, "flown_to", watched)
    parent = await _flown(console, engine)
    answer = await console.granted("fork", tick=FORK)
    assert "paused" in answer["message"]
    now = await console.snapshot()
    assert (now["tick"], now["plant"]["running"]) == (FORK - 1, False)
    assert (began[0] > FORK - 1100) == (engine == "reduced")  # a saved state is never farther than that
    history = (await console.http.get("/mission/history")).json()
    ticks = [row[[column["name"] for column in history["columns"]].index("mission.tick")] for row in history["rows"]]
    assert max(np.diff(ticks)) < 100  # no gap between what was shown of the parent and what was flown again
    assert ticks[-1] < FORK
    flown = await _to_the_verdict(console)
    record = (await console.http.get(f"/runs/{flown}")).json()
    assert (record["kind"], record["parent"], record["forked_at"]) == ("fork", parent, FORK)
    ours, theirs = _ticks(console, flown, FORK), _ticks(console, parent, FORK)
    assert ours["tick"][0] == FORK
    until = min(len(ours), len(theirs))
    assert until > 3000
    assert ours[:until].tobytes() == theirs[:until].tobytes()
    report = replay(console.services.store.read(flown))
    assert report["rerun"]["same"]
    await console.granted("fork", run=parent, tick=FORK + 100)  # the parent is no longer the live mission
    assert (began[1] > FORK - 1000) == (engine == "reduced")
    again = await _to_the_verdict(console)
    ours = _ticks(console, again, FORK + 100)
    until = min(len(ours), len(theirs) - 100)
    assert ours[:until].tobytes() == theirs[100 : 100 + until].tobytes()


async def test_a_fork_of_a_library_run_goes_its_own_way(console):
    parent = await _flown(console)
    await console.granted("reset")
    await console.granted("fork", run=parent, tick=FORK)
    changed = await console.http.patch("/mission/config", json={"published": {"impedance": {"damping": 6.0}}})
    assert changed.status_code == 200
    flown = await _to_the_verdict(console)
    ours, theirs = _ticks(console, flown, FORK), _ticks(console, parent, FORK)
    assert ours["target_twist"][0].tobytes() == theirs["target_twist"][0].tobytes()
    assert not np.array_equal(ours["target_twist"][1000], theirs["target_twist"][1000])
    assert replay(console.services.store.read(flown))["rerun"]["same"]
    again = (await console.granted("fork", tick=FORK + 500))["message"]
    assert flown in again


async def test_what_was_before_the_fork_stays(console):
    parent = await _flown(console)
    await console.granted("fork", tick=FORK)
    now = await console.snapshot()
    assert [touch["arm"] for touch in now["contacts"]] == ["right"]
    assert now["peak_tip_force"] > 0.0
    assert [(stage["phase"], stage["state"]) for stage in now["stages"][:2]] == [
        ("idle", "done"),
        ("detumbling", "now"),
    ]
    await console.until_run(now["run_id"], "running")
    told = {
        run: [each for each in (await console.http.get(f"/runs/{run}/events")).json() if each["tick"] < FORK]
        for run in (parent, now["run_id"])
    }
    kinds = [[each["kind"] for each in events] for events in told.values()]
    assert kinds[0] == kinds[1]
    assert {"phase", "plan", "touch"} <= set(kinds[1])
    assert all(each["message"].startswith("before the fork: ") for each in told[now["run_id"]])
    history = (await console.http.get("/mission/history")).json()
    names = [column["name"] for column in history["columns"]]
    ticks = [row[names.index("mission.tick")] for row in history["rows"]]
    assert ticks[0] < 100
    assert FORK - 100 < ticks[-1] < FORK


@pytest.mark.parametrize(
    ("wanted", "status", "words"),
    [
        ({}, 422, "tick"),
        ({"tick": 0}, 422, "tick"),
        ({"tick": 10_000_000}, 409, "has flown"),
        ({"run": "20261122T113000123-4f9a2c", "tick": 5}, 404, "does not exist"),
    ],
)
async def test_what_cannot_be_forked_is_said(console, wanted, status, words):
    answer = await console.command("fork", **wanted)
    assert answer.status_code == status
    assert words in answer.json()["detail"]


async def test_stop_is_answered_while_a_long_past_is_flown_again(console, monkeypatch):
    await console.granted("detumble")
    begun, may_end = threading.Event(), threading.Event()
    fly_again = flown_to

    def slowly(*arguments):
        begun.set()
        assert may_end.wait(180)
        return fly_again(*arguments)

    monkeypatch.setattr(fork, "flown_to", slowly)
    forking = asyncio.create_task(console.command("fork", tick=1))
    assert await asyncio.to_thread(begun.wait, 30)
    stopped = await console.http.post("/mission/stop")
    assert (stopped.status_code, stopped.json()["phase"]) == (200, "stopped")
    assert not forking.done()
    may_end.set()
    assert (await forking).status_code == 200


async def test_a_past_that_is_too_long_is_refused(console, monkeypatch):
    await console.granted("detumble")
    await console.until(lambda snapshot: snapshot.tick > 100)
    monkeypatch.setattr(fork, "LONGEST_PAST", 0.05)
    answer = await console.command("fork", tick=90)
    assert answer.status_code == 409
    assert "after the start" in answer.json()["detail"]


async def test_a_run_of_other_versions_is_not_forked(console, monkeypatch):
    parent = await _flown(console)
    await console.granted("reset")
    monkeypatch.setattr(api, "versions", lambda: {"becalm": "9"})
    answer = await console.command("fork", run=parent, tick=FORK)
    assert answer.status_code == 409
    assert "was flown by" in answer.json()["detail"]
