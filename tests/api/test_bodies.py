"""Every error is a problem document: too large, not JSON, unknown addresses and methods, what nobody expected."""

from __future__ import annotations

import httpx
import pytest

from server.edge.bodies import LARGEST_BODY, JsonBodies


def problem(answer: httpx.Response, status: int) -> dict:
    assert answer.status_code == status
    assert answer.headers["content-type"] == "application/problem+json"
    document = answer.json()
    assert document["status"] == status
    assert document["title"]
    return document


async def test_a_body_that_is_too_large_is_not_read(console):
    headers = {"Content-Type": "application/json"}
    large = b" " * (LARGEST_BODY + 1)
    document = problem(await console.http.post("/runs", content=large, headers=headers), 413)
    assert str(LARGEST_BODY) in document["detail"]

    async def parts():
        for _ in range(3):
            yield b" " * (LARGEST_BODY // 2)

    problem(await console.http.post("/runs", content=parts(), headers=headers), 413)


@pytest.mark.parametrize("kind", ["text/plain", "multipart/form-data; boundary=x", "application/x-www-form-urlencoded"])
async def test_a_body_that_is_not_json_is_refused(console, kind):
    answer = await console.http.post("/mission/commands", content=b"command=capture", headers={"Content-Type": kind})
    assert "application/json" in problem(answer, 415)["tip"]


async def test_unknown_addresses_and_methods(console):
    problem(await console.http.get("/nothing"), 404)
    problem(await console.http.put("/mission"), 405)


async def test_a_body_that_is_no_json_names_where(console):
    answer = await console.http.post("/runs", content=b"{", headers={"Content-Type": "application/json"})
    problem(answer, 422)


async def test_what_nobody_expected_can_be_found_in_the_log(console, monkeypatch, caplog):
    monkeypatch.setattr(console.services.store, "read", lambda _: 1 / 0)
    with pytest.raises(ZeroDivisionError):  # the transport of the tests passes it on after it was answered
        await console.http.get("/runs/20261122T113000123-4f9a2c")
    assert "an unexpected error" in caplog.text


async def test_half_a_request_is_none():
    came: list[str] = []

    async def app(scope, _receive, _send):
        came.append(scope["path"])

    parts = iter([{"type": "http.request", "body": b"{", "more_body": True}, {"type": "http.disconnect"}])

    async def receive():
        return next(parts)

    async def send(message):
        came.append(message["type"])

    scope = {"type": "http", "method": "POST", "path": "/stop", "headers": []}
    await JsonBodies(app)(scope, receive, send)
    assert came == []
