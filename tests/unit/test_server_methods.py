"""HEAD as GET without a body, and what an address takes, told to whoever asks otherwise."""

from __future__ import annotations

import asyncio

import httpx
import pytest
from fastapi import APIRouter, FastAPI
from fastapi.responses import StreamingResponse

from server.edge import problem_json
from server.edge.methods import HeadAsGet
from server.pages.console import serve_console

MADE: list[int] = []


def application(static) -> FastAPI:
    router = APIRouter()

    @router.get("/things")
    async def things() -> dict[str, str]:
        return {"a": "b"}

    @router.post("/things")
    async def make() -> None: ...

    @router.post("/things/go")
    async def go() -> None: ...

    @router.get("/things/{name}")
    async def thing(name: str) -> str:
        return name

    @router.delete("/things/{name}")
    async def remove(name: str) -> None: ...

    @router.get("/endless")
    async def endless() -> StreamingResponse:
        async def parts():
            for each in range(10**9):
                MADE.append(each)
                yield b"x"
                await asyncio.sleep(0)

        return StreamingResponse(parts(), media_type="text/csv")

    app = FastAPI()
    problem_json.install(app)
    app.add_middleware(HeadAsGet)
    app.include_router(router, prefix="/api")
    serve_console(app, static)
    return app


@pytest.fixture
async def http(tmp_path):
    (tmp_path / "index.html").write_text("<html>")
    (tmp_path / "assets").mkdir()
    (tmp_path / "assets" / "a.js").write_text("x()")
    transport = httpx.ASGITransport(application(tmp_path))
    async with httpx.AsyncClient(transport=transport, base_url="http://localhost") as http:
        yield http


@pytest.mark.parametrize("path", ["/api/things", "/api/things/x", "/", "/assets/a.js", "/docs", "/api/nothing"])
async def test_head_is_get_without_its_body(http, path):
    whole, head = await http.get(path), await http.head(path)
    assert head.status_code == whole.status_code
    assert head.headers == whole.headers
    assert head.content == b""
    assert whole.content != b""


async def test_no_more_is_made_of_a_long_answer_than_its_head_takes(http):
    head = await http.head("/api/endless")
    assert (head.status_code, head.headers["content-type"]) == (200, "text/csv; charset=utf-8")
    assert len(MADE) < 100


@pytest.mark.parametrize(
    ("method", "path", "allowed"),
    [
        ("PUT", "/api/things", {"GET", "HEAD", "POST", "OPTIONS"}),
        ("GET", "/api/things/go", {"GET", "HEAD", "POST", "DELETE", "OPTIONS"}),
        ("PATCH", "/api/things/x", {"GET", "HEAD", "DELETE", "OPTIONS"}),
        ("POST", "/", {"GET", "HEAD", "OPTIONS"}),
        ("DELETE", "/assets/a.js", {"GET", "HEAD", "OPTIONS"}),
        ("BREW", "/docs", {"GET", "HEAD", "OPTIONS"}),
    ],
)
async def test_another_method_is_told_which_there_are(http, method, path, allowed):
    answer, options = await http.request(method, path), await http.options(path)
    if path != "/api/things/go":  # GET is there, for a thing of that name
        assert answer.status_code == 405
        assert set(answer.headers["allow"].split(", ")) == allowed
        assert answer.headers["content-type"] == "application/problem+json"
    assert (options.status_code, set(options.headers["allow"].split(", "))) == (204, allowed)


@pytest.mark.parametrize("method", ["GET", "POST", "OPTIONS", "DELETE"])
async def test_what_is_not_there_takes_nothing(http, method):
    assert (await http.request(method, "/nothing")).status_code == 404
