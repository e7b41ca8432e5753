"""A page that is opened after a restart is sent the run that the restart cut off."""

from __future__ import annotations

import asyncio
import json

import httpx
from websockets.asyncio.client import connect

PATIENCE = 180.0


async def _hello(served) -> dict:
    """What a joining page is sent first, once there is a mission."""
    async with connect(served.telemetry, open_timeout=PATIENCE) as page, asyncio.timeout(PATIENCE):
        hello = json.loads(await page.recv())
        while json.loads(await page.recv())["type"] != "snapshot":
            pass
    assert hello["type"] == "hello"
    return hello


async def _command(served, command: str, **fields) -> dict:
    async with httpx.AsyncClient(timeout=PATIENCE) as http:
        answer = await http.post(f"{served.api}/mission/commands", json={"command": command, **fields})
    assert answer.status_code == 200, answer.text
    return answer.json()


async def test_the_run_that_was_cut_off_is_in_what_a_new_page_gets(serving, settings):
    with serving(settings) as before:
        assert (await _hello(before))["cut_off"] is None
        await _command(before, "capture")
        run_id = before.services.feed.latest.snapshot.run_id
    with serving(settings) as after:
        for _ in range(2):  # every page that opens, not only the first
            cut_off = (await _hello(after))["cut_off"]
            assert (cut_off["run_id"], cut_off["phase"]) == (run_id, "detumbling")
            assert cut_off["time"] > 0
        await _command(after, "reset")
        assert (await _hello(after))["cut_off"] is None


async def test_a_restart_that_cut_nothing_off_is_silent(serving, settings):
    with serving(settings) as before:
        await _hello(before)
        await _command(before, "capture")
        await _command(before, "reset")
    with serving(settings) as after:
        assert (await _hello(after))["cut_off"] is None
