"""Headers that tell a browser what our pages may do: nothing but their own files, and in nobody else's frame."""

from __future__ import annotations

import base64
import hashlib
from functools import lru_cache
from html.parser import HTMLParser

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

_COMMON = (
    "default-src 'self'",
    "img-src 'self' data: blob:",
    "font-src 'self' data:",
    # Components set styles on their elements; styles cannot run anything.
    "style-src 'self' 'unsafe-inline'",
    "object-src 'none'",
    "base-uri 'none'",
    "form-action 'self'",
    "frame-ancestors 'self'",
)

FIXED = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "same-origin",
    "Permissions-Policy": "camera=(), geolocation=(), microphone=(), payment=(), usb=()",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}


def content_policy(*more: str) -> str:
    """The policy of a page; scripts from our files only, unless `more` says what else."""
    scripts = () if any(part.startswith("script-src") for part in more) else ("script-src 'self'",)
    return "; ".join(part.strip() for part in (*_COMMON, *scripts, *more))  # a header must not end in a space


@lru_cache(maxsize=8)
def inline_scripts(page: bytes) -> str:
    """Sources that allow exactly the scripts written within a page."""
    reader = _ScriptReader()
    reader.feed(page.decode().replace("\r\n", "\n").replace("\r", "\n"))  # browsers do so before they take the digest
    reader.close()
    digests = (base64.b64encode(hashlib.sha256(script.encode()).digest()) for script in reader.scripts)
    return " ".join(f"'sha256-{digest.decode()}'" for digest in digests)


class _ScriptReader(HTMLParser):
    """Collects the texts of the scripts that have no address."""

    def __init__(self) -> None:
        super().__init__()
        self.scripts: list[str] = []
        self._inside = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._inside = tag == "script" and "src" not in dict(attrs)
        if self._inside:
            self.scripts.append("")

    def handle_data(self, data: str) -> None:
        if self._inside:
            self.scripts[-1] += data

    def handle_endtag(self, _tag: str) -> None:
        self._inside = False


class SecurityHeaders:
    """Adds them to every answer that does not set its own."""

    def __init__(self, app: ASGIApp) -> None:
        """Around `app`."""
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on one connection."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in {**FIXED, "Content-Security-Policy": content_policy()}.items():
                    headers.setdefault(name, value)
            await send(message)

        await self._app(scope, receive, send_with_headers)
