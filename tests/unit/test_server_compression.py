"""What is sent compressed, what is not, and what a browser keeps."""

from __future__ import annotations

import os

import httpx
import pytest
from fastapi import FastAPI
from fastapi.responses import Response, StreamingResponse

from server.edge.compression import compress
from server.edge.methods import HeadAsGet
from server.pages.console import serve_console

TEXT = b"0.25,0.5,1.0\n" * 5000


def application(static) -> FastAPI:
    app = FastAPI()
    compress(app)
    app.add_middleware(HeadAsGet)

    @app.get("/answer")
    async def answer(kind: str, size: int) -> Response:
        return Response(TEXT[:size], media_type=kind)

    @app.get("/parts")
    async def parts() -> StreamingResponse:
        async def each():
            for start in range(0, len(TEXT), 13_000):
                yield TEXT[start : start + 13_000]

        return StreamingResponse(each(), media_type="text/csv")

    serve_console(app, static)
    return app


@pytest.fixture
async def http(tmp_path):
    (tmp_path / "assets").mkdir()
    (tmp_path / "index.html").write_bytes(b"<html>" + TEXT)
    (tmp_path / "assets" / "a-1234.js").write_bytes(TEXT)
    (tmp_path / "assets" / "a-1234.woff2").write_bytes(TEXT)
    transport = httpx.ASGITransport(application(tmp_path))
    async with httpx.AsyncClient(transport=transport, base_url="http://localhost") as http:
        yield http


@pytest.mark.parametrize("path", ["/answer?kind=application/json&size=60000", "/parts", "/", "/assets/a-1234.js"])
async def test_text_is_compressed_for_who_takes_it(http, path):
    packed = await http.get(path)
    plain = await http.get(path, headers={"Accept-Encoding": "identity"})
    assert packed.headers["content-encoding"] == "gzip"
    assert "content-encoding" not in plain.headers
    assert {packed.headers["vary"], plain.headers["vary"]} == {"Accept-Encoding"}
    assert packed.content == plain.content
    assert packed.num_bytes_downloaded < len(plain.content) / 5
    assert (await http.head(path)).headers["content-encoding"] == "gzip"


@pytest.mark.parametrize(
    "path",
    [
        "/answer?kind=application/json&size=900",
        "/answer?kind=application/vnd.apache.parquet&size=60000",
        "/answer?kind=application/x-mcap&size=60000",
        "/answer?kind=image/png&size=60000",
        "/assets/a-1234.woff2",
    ],
)
async def test_what_is_small_or_compressed_already_is_sent_as_it_is(http, path):
    assert "content-encoding" not in (await http.get(path)).headers


async def test_a_browser_asks_again_for_pages_and_keeps_what_its_name_tells(http):
    page, script = await http.get("/"), await http.get("/assets/a-1234.js")
    assert page.headers["cache-control"] == "no-cache"
    assert "immutable" in script.headers["cache-control"]
    for answer, path in ((page, "/"), (script, "/assets/a-1234.js")):
        again = await http.get(path, headers={"If-None-Match": answer.headers["etag"]})
        assert (again.status_code, again.content) == (304, b"")


async def test_a_file_that_was_rebuilt_is_sent_again(http, tmp_path):
    page = tmp_path / "index.html"
    assert b"new" not in (await http.get("/")).content
    page.write_bytes(b"<html>new" + TEXT)
    os.utime(page, (1, 2_000_000_000))
    assert b"new" in (await http.get("/")).content
