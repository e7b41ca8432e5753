"""The cookie that keeps a token in a browser: one for each service, whatever other cookies come along.

Browsers distinguish hosts, not ports: the cookies of two services on one host reach both. So the name holds what
distinguishes this service's data folder from every other.
"""

from __future__ import annotations

import re
import secrets
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path

from starlette.datastructures import Headers
from starlette.requests import Request
from starlette.responses import Response

from server.files import replace_file

NAME = "becalm_token_"
LIFETIME = 30 * 24 * 3600
"""After which one signs in again [s]; a token that is revoked or expires is invalid at once."""

MOST = 4
"""Cookies of our name that are looked at: a browser sends that of the longest path first."""

_IDENTITY = re.compile(r"[0-9a-f]{12}")


class SessionCookie:
    """The cookie of one data folder's service."""

    def __init__(self, folder: Path) -> None:
        """Read nothing yet."""
        self._path = folder / "service"

    @cached_property
    def name(self) -> str:
        """The cookie's name: the same after a restart, another one for every other data folder."""
        return NAME + self._identity()

    def secrets_in(self, headers: Headers) -> tuple[str, ...]:
        """The tokens that a request's cookies of our name hold."""
        found = (value for name, value in cookies(headers.getlist("cookie")) if name == self.name and value)
        return tuple(value for value, _ in zip(found, range(MOST), strict=False))

    def keep(self, request: Request, response: Response, secret: str) -> None:
        """Have the browser keep a token where no script of a page reads it, and no other site uses it."""
        response.set_cookie(
            self.name,
            secret,
            max_age=LIFETIME,
            path=_path(request),
            secure=_is_encrypted(request),
            httponly=True,
            samesite="strict",
        )

    def forget(self, request: Request, response: Response) -> None:
        """Have the browser forget it."""
        response.delete_cookie(
            self.name, path=_path(request), secure=_is_encrypted(request), httponly=True, samesite="strict"
        )

    def _identity(self) -> str:
        """What distinguishes this data folder from others; this process, if the folder cannot be written."""
        try:
            kept = self._path.read_text(errors="replace").strip()
        except OSError:
            kept = ""
        if _IDENTITY.fullmatch(kept):
            return kept
        made = secrets.token_hex(6)
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
            replace_file(self._path, made.encode(), mode=0o600)
        except OSError:
            pass
        return made


def cookies(headers: list[str]) -> Iterator[tuple[str, str]]:
    """Name and value of each cookie by itself: one that is malformed or a stranger's changes nothing of the others."""
    for header in headers:
        for part in header.split(";"):
            name, equals, value = part.partition("=")
            if equals:
                value = value.strip()
                quoted = len(value) > 1 and value[0] == value[-1] == '"'
                yield name.strip(), value[1:-1] if quoted else value


def _path(request: Request) -> str:
    return request.scope.get("root_path") or "/"


def _is_encrypted(request: Request) -> bool:
    """Whether the browser reached its page encrypted: as a trusted proxy says, or the page's own origin."""
    return request.url.scheme == "https" or request.headers.get("origin", "").lower().startswith("https://")
