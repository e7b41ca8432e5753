"""The path of another site under which a proxy shows the service."""

from __future__ import annotations

import httpx
import pytest
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse, RedirectResponse
from starlette.routing import Route

from server.edge.prefix import ForwardedPrefix


async def _told(request: Request) -> PlainTextResponse:
    return PlainTextResponse(f"{request.scope.get('root_path', '')} {request.url.path}")


async def _redirecting(request: Request) -> RedirectResponse:
    return RedirectResponse(request.query_params["to"])


APP = ForwardedPrefix(Starlette(routes=[Route("/told", _told), Route("/redirecting", _redirecting)]))


async def _asked(path: str, prefix: str) -> httpx.Response:
    async with httpx.AsyncClient(transport=httpx.ASGITransport(APP), base_url="http://localhost") as http:
        return await http.get(path, headers={"X-Forwarded-Prefix": prefix})


@pytest.mark.parametrize(("prefix", "root"), [("/becalm", "/becalm"), ("/becalm/", "/becalm"), ("/a/b.c", "/a/b.c")])
async def test_the_same_page_is_found_and_knows_where_it_is(prefix, root):
    answer = await _asked("/told", prefix)
    assert answer.text == f"{root} {root}/told"


@pytest.mark.parametrize("prefix", ["", "/", "becalm", "//elsewhere.example", "/..", "/a b", "/a?b", "https://x/"])
async def test_what_is_no_path_is_ignored(prefix):
    assert (await _asked("/told", prefix)).text == " /told"


async def test_redirections_stay_under_the_path():
    within = await _asked("/redirecting?to=/told", "/becalm")
    assert within.headers["location"] == "/becalm/told"
    elsewhere = await _asked("/redirecting?to=https://elsewhere.example/x", "/becalm")
    assert elsewhere.headers["location"] == "https://elsewhere.example/x"
