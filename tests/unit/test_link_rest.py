"""The emulator's own REST is for those on its machine, and for no page from elsewhere."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from server.link.faults import Faults
from server.link.robot_rest import create_robot_app

PORT = 8123


class Emulator:
    """What the REST asks of one."""

    faults = Faults()
    injected: Faults | None = None

    def inject_faults(self, faults: Faults) -> None:
        self.injected = faults


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({}, 200),
        ({"host": f"localhost:{PORT}"}, 200),
        ({"host": f"[::1]:{PORT}"}, 200),
        ({"origin": f"http://127.0.0.1:{PORT}"}, 200),
        ({"host": "evil.example"}, 403),
        ({"host": f"evil.example:{PORT}"}, 403),
        ({"host": "["}, 400),
        ({"origin": "http://evil.example"}, 403),
        ({"origin": "null"}, 403),
        ({"origin": "http://127.0.0.1:1"}, 403),
    ],
)
async def test_only_its_own_address_and_no_other_page_is_served(headers, status):
    emulator: Any = Emulator()
    transport = httpx.ASGITransport(create_robot_app(emulator))
    async with httpx.AsyncClient(transport=transport, base_url=f"http://127.0.0.1:{PORT}") as client:
        answer = await client.put("/faults", json={"delay": 0.5}, headers=headers)
    assert answer.status_code == status
    assert (emulator.injected is not None) == (status == 200)


@pytest.mark.parametrize("path", ["/faults", "/hang", "/restart"])
@pytest.mark.parametrize(
    ("body", "status"),
    [
        (b'{"loss":true,"duration":true,"pause":true}', 422),
        (b"NaN", 422),
        (b'{"loss":NaN}', 422),
        (b'{"seed":1e400}', 422),
        (b'{"a":"\\ud800"}', 422),
        (b"[" * 2000, 422),
    ],
)
async def test_a_body_that_does_not_mean_one_thing_is_refused_in_words(path, body, status):
    emulator: Any = Emulator()
    transport = httpx.ASGITransport(create_robot_app(emulator))
    headers = {"content-type": "application/json"}
    async with httpx.AsyncClient(transport=transport, base_url=f"http://127.0.0.1:{PORT}") as client:
        answer = await client.request("PUT" if path == "/faults" else "POST", path, content=body, headers=headers)
    assert (answer.status_code, answer.headers["content-type"]) == (status, "application/problem+json")
    assert emulator.injected is None
