"""The cookie of a service, among others."""

from __future__ import annotations

import pytest
from starlette.datastructures import Headers

from server.access.cookie import NAME, SessionCookie


@pytest.fixture
def cookie(tmp_path):
    return SessionCookie(tmp_path / "access")


def shown(cookie, *headers: str) -> tuple[str, ...]:
    raw = [(b"cookie", header.replace("NAME", cookie.name).encode("latin-1")) for header in headers]
    return cookie.secrets_in(Headers(raw=raw))


@pytest.mark.parametrize(
    ("header", "found"),
    [
        ("NAME=t", ("t",)),
        ('ipt={"v":1}; NAME=t', ("t",)),
        ("a=1,2; ;;=; =x; b; NAME=t; c=\xff", ("t",)),
        ('NAME="t"', ("t",)),
        ("NAME=", ()),
        ("NAME", ()),
        ('NAME=""', ()),
        ("NAME=old; NAME=t", ("old", "t")),
        ("xNAME=t; NAMEx=t; name=NAME=t", ()),
        (f"{NAME}000000000000=other; becalm_token=old", ()),
        ("", ()),
    ],
)
def test_each_cookie_by_itself(cookie, header, found):
    assert shown(cookie, header) == found


def test_headers_may_be_several_and_a_flood_of_ours_is_cut(cookie):
    assert shown(cookie, "a={", "NAME=t") == ("t",)
    assert len(shown(cookie, "NAME=x; " * 1000)) < 10


def test_each_data_folder_has_its_own_and_keeps_it(tmp_path):
    names = [SessionCookie(tmp_path / folder / "access").name for folder in ("a", "b", "a")]
    assert names[0] == names[2] != names[1]


@pytest.mark.parametrize("content", [b"", b"\xff\xfe", b"../../x; a=b"])
def test_a_damaged_name_is_rebuilt(tmp_path, content):
    (tmp_path / "service").write_bytes(content)
    made = SessionCookie(tmp_path).name
    assert made.removeprefix(NAME).isalnum()
    assert SessionCookie(tmp_path).name == made


def test_a_folder_that_cannot_be_written_costs_a_sign_in_only(tmp_path):
    (tmp_path / "access").write_text("a file in its place")
    cookie = SessionCookie(tmp_path / "access")
    assert cookie.name == cookie.name != SessionCookie(tmp_path / "access").name
