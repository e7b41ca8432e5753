"""Hosts and origins as what they are."""

from __future__ import annotations

import httpx
import pytest
from starlette.applications import Starlette
from starlette.responses import PlainTextResponse
from starlette.routing import Route

from server.access.origin import SameOrigin
from server.edge.authority import Authority, host_name, is_same, read_authority, read_origin
from server.settings import Settings
from sim.errors import ConfigError


@pytest.mark.parametrize(
    ("text", "host", "port"),
    [
        ("lab.example", "lab.example", None),
        ("LAB.Example.:8000", "lab.example", 8000),
        ("lab.example:", "lab.example", None),
        ("bücher.example", "xn--bcher-kva.example", None),
        ("my_host:1", "my_host", 1),
        ("127.0.0.1:443", "127.0.0.1", 443),
        ("[::1]:8000", "::1", 8000),
        ("[0:0:0:0:0:0:0:1]", "::1", None),
        ("[FD00::1]", "fd00::1", None),
    ],
)
def test_hosts(text, host, port):
    assert read_authority(text) == Authority(host, port)


@pytest.mark.parametrize(
    "text",
    ["", "[", "[]", "]", "[::1", "::1", "a b", "a/b", "a@b", "a:b", "a:99999", "a:0", "a:-1", "a..b", ".", "-a",
     "a\x00", "x" * 300, "[zz::1]", "a,b", "a\u2028b", "\ud800", "http://a", "a?b", "a#b", "a\\b", "a:1:2"],
)  # fmt: skip
def test_what_is_no_host(text):
    assert read_authority(text) is None
    assert read_origin(f"http://{text}") is None


@pytest.mark.parametrize(
    "text", ["", "null", "lab.example", "//lab.example", "http:/a", "http://a/", "http://a b", ":"]
)
def test_what_is_no_origin(text):
    assert read_origin(text) is None


@pytest.mark.parametrize(
    ("origin", "host", "scheme", "same"),
    [
        ("https://lab.example", "lab.example:443", "http", True),
        ("https://lab.example:443", "lab.example", "http", True),
        ("http://lab.example", "LAB.EXAMPLE.:80", "http", True),
        ("https://lab.example", "lab.example", "https", True),
        ("http://[::1]:8000", "[0::1]:8000", "http", True),
        ("http://bücher.example", "xn--bcher-kva.example", "http", True),
        ("https://lab.example", "lab.example:80", "http", False),
        ("http://lab.example", "lab.example:443", "http", False),
        ("http://lab.example", "lab.example", "https", False),
        ("http://lab.example", "lab.example", "wss", False),
        ("http://lab.example:8001", "lab.example:8000", "http", False),
        ("http://elsewhere.example", "lab.example", "http", False),
        ("ftp://lab.example", "lab.example", "http", False),
        ("chrome-extension://lab.example", "lab.example", "http", False),
    ],
)
def test_a_page_of_this_service(origin, host, scheme, same):
    page, asked = read_origin(origin), read_authority(host)
    assert page is not None
    assert asked is not None
    assert is_same(page, asked, scheme) is same


def test_allowed_hosts_are_kept_as_requests_name_them():
    settings = Settings.from_environment({"BECALM_ALLOWED_HOSTS": "Lab.Example., [FD00::1],bücher.example"})
    assert settings.own_hosts()[:3] == ("lab.example", "fd00::1", "xn--bcher-kva.example")
    assert host_name("FD00::1") == host_name("[fd00::1]") == "fd00::1"


@pytest.mark.parametrize("name", ["https://lab.example", "lab.example:8000", "lab.example/", "*", "a b"])
def test_allowed_hosts_that_are_none_are_named(name):
    with pytest.raises(ConfigError, match=r"allowed_hosts = .*without scheme, port and path"):
        Settings.from_environment({"BECALM_ALLOWED_HOSTS": name})


class TestSameOrigin:
    async def asked(self, method="POST", hosts=("lab.example",), **headers: str | list[str]) -> int:
        app = SameOrigin(Starlette(routes=[Route("/", _told, methods=["GET", "POST"])]), hosts)
        raw = [(name.encode(), value.encode()) for name, given in headers.items() for value in _each(given)]
        async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://x") as http:
            request = http.build_request(method, "/")
            request.headers = httpx.Headers(raw)
            return (await http.send(request)).status_code

    @pytest.mark.parametrize("method", ["GET", "HEAD", "POST"])
    @pytest.mark.parametrize(
        ("headers", "status"),
        [
            ({"host": "["}, 400),
            ({"host": ""}, 400),
            ({}, 400),
            ({"host": ["lab.example", "lab.example"]}, 400),
            ({"host": "elsewhere.example"}, 403),
            ({"host": "lab.example", "origin": "http://["}, 400),
            ({"host": "lab.example", "origin": ""}, 400),
            ({"host": "lab.example", "origin": ["http://lab.example"] * 2}, 400),
            ({"host": "lab.example", "origin": "null"}, 403),
            ({"host": "lab.example:443", "origin": "https://lab.example"}, 200),
            ({"host": "Lab.Example."}, 200),
        ],
    )
    async def test_whatever_the_headers_say_it_is_an_answer(self, method, headers, status):
        assert await self.asked(method, **headers) == status

    async def test_another_sites_page_may_read_what_its_browser_hides_from_it_and_change_nothing(self):
        foreign = {"host": "lab.example", "origin": "https://elsewhere.example"}
        assert (await self.asked("GET", **foreign), await self.asked("POST", **foreign)) == (200, 403)

    async def test_where_any_name_will_do_a_request_needs_none(self):
        assert await self.asked("GET", hosts=()) == 200
        assert await self.asked("POST", hosts=(), origin="http://lab.example") == 403


async def _told(_) -> PlainTextResponse:
    return PlainTextResponse("")


def _each(given: str | list[str]) -> list[str]:
    return [given] if isinstance(given, str) else given
