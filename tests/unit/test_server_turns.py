"""Requests are begun in turn, and STOP before all that wait."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest

from server.edge.turns import Turns


def scope(method, path, kind="http"):
    return {"type": kind, "path": path} | ({"method": method} if kind == "http" else {})


@pytest.mark.parametrize("path", ["/api/v1/mission/stop", "/lab/becalm/api/v1/mission/stop"])
async def test_stop_is_begun_before_all_that_came_earlier(path):
    begun = []

    async def app(scope, _receive, _send):
        begun.append(scope["path"])

    turns: Any = Turns(app)  # nothing is read or sent
    earlier = [scope("GET", "/api/v1/mission"), scope("", "/scene", "websocket"), scope("GET", path)] * 10
    await asyncio.gather(*(turns(each, None, None) for each in [*earlier, scope("POST", path)]))
    assert begun[0] == path
    assert begun[1:] == [each["path"] for each in earlier]


async def test_one_is_begun_with_each_turn_so_that_what_comes_meanwhile_is_seen():
    begun = []

    async def app(scope, _receive, _send):
        begun.append(scope["path"])

    turns: Any = Turns(app)  # nothing is read or sent
    waiting = [asyncio.create_task(turns(scope("GET", f"/{number}"), None, None)) for number in range(20)]
    while len(begun) < 3:
        await asyncio.sleep(0)
    assert len(begun) == 3
    await turns(scope("POST", "/api/v1/mission/stop"), None, None)
    assert begun[3] == "/api/v1/mission/stop"
    await asyncio.gather(*waiting)
    assert begun[-1] == "/19"


async def test_who_goes_while_waiting_costs_nobody_else_a_turn():
    begun = []

    async def app(scope, _receive, _send):
        begun.append(scope["path"])

    turns: Any = Turns(app)  # nothing is read or sent
    waiting = [asyncio.create_task(turns(scope("GET", f"/{number}"), None, None)) for number in range(4)]
    await asyncio.sleep(0)
    for task in waiting[:3]:
        task.cancel()
    await asyncio.wait_for(waiting[3], 60)
    assert begun == ["/3"]
