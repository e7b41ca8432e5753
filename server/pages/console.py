"""The built console at `/`, or where to get it."""

from __future__ import annotations

import asyncio
import gzip
import os
from functools import lru_cache
from pathlib import Path

from fastapi import FastAPI
from fastapi.responses import FileResponse, HTMLResponse
from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.responses import Response
from starlette.staticfiles import StaticFiles
from starlette.types import Receive, Scope, Send
from starlette.websockets import WebSocketClose

from server.access.headers import content_policy, inline_scripts
from server.pages import api_page

READING = ("GET", "HEAD")

COMPRESSED = (".html", ".js", ".css", ".svg", ".json", ".map", ".txt", ".webmanifest")
"""Files that are sent compressed; fonts and pictures are so already."""

OF_THE_WHOLE_FILE = ("content-length", "accept-ranges")
"""Headers that do not hold of a file that is compressed."""

STATIC = Path(__file__).parent.parent / "static"
"""Where the web build puts it."""


class ConsoleFiles(StaticFiles):
    """Pages are asked for again each time; files under `assets/` carry their content's hash and are kept."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve a file; there is no websocket here."""
        if scope["type"] == "websocket":
            await WebSocketClose()(scope, receive, send)
        else:
            await super().__call__(scope, receive, send)

    async def get_response(self, path: str, scope: Scope) -> Response:
        """The file; of another method than GET and HEAD, whether there is one.

        Raises:
            HTTPException: 404, there is none; 405, it can be read only.

        """
        if scope["method"] not in READING and not self.lookup_path(path)[0]:
            raise HTTPException(404)
        response = await super().get_response(path, scope)
        if not isinstance(response, FileResponse) or Path(response.path).suffix not in COMPRESSED:
            return response
        if "gzip" not in Headers(scope=scope).get("accept-encoding", ""):
            return response
        written = Path(response.path).stat().st_mtime_ns
        content = await asyncio.to_thread(_compressed, str(response.path), written)
        kept = {name: value for name, value in response.headers.items() if name not in OF_THE_WHOLE_FILE}
        headers = {**kept, "Content-Encoding": "gzip", "Vary": "Accept-Encoding"}
        return Response(content, response.status_code, headers)

    def file_response(
        self, full_path: os.PathLike[str] | str, stat_result: os.stat_result, scope: Scope, status_code: int = 200
    ) -> Response:
        """The file with its caching."""
        response = super().file_response(full_path, stat_result, scope, status_code)
        path = Path(full_path)
        kept = "assets" in path.parts
        response.headers["Cache-Control"] = "public, max-age=31536000, immutable" if kept else "no-cache"
        if path.suffix == ".html":
            # STOP is written within the page (docs/decisions/0007): exactly that script is allowed.
            response.headers["Content-Security-Policy"] = _policy_of(path.read_bytes())
        return response


@lru_cache(maxsize=64)
def _compressed(path: str, _written: int) -> bytes:
    """The file as it was then, compressed as well as can be: once, at its first use."""
    return gzip.compress(Path(path).read_bytes(), mtime=0)


def serve_console(app: FastAPI, static: Path = STATIC) -> None:
    """Add the API's documentation and, last of all routes, the console."""
    app.add_api_route("/docs", _docs, include_in_schema=False)
    app.router.redirect_slashes = False
    if (static / "index.html").exists():
        # Not a route at "/", which would answer for every address that is ours but takes another method.
        app.router.default = ConsoleFiles(directory=static, html=True)
    else:
        app.add_api_route("/", _not_built, include_in_schema=False)


async def _docs() -> HTMLResponse:
    return HTMLResponse(api_page.PAGE, headers={"Content-Security-Policy": _policy_of(api_page.PAGE)})


def _policy_of(page: bytes) -> str:
    """Our own files, and the scripts that are written within the page."""
    return content_policy(f"script-src 'self' {inline_scripts(page)}".rstrip())


async def _not_built() -> None:
    raise HTTPException(503, "the console is not built; `pip install .` builds it. /docs and the API work without it")
