"""viser's page as the console shows it: dark from the first paint, without panels, and telling how far it is.

What is put into its head tells the page around it (`postMessage`, `{"scene": ...}`) when viser's program has arrived
(`arrived`), when it makes its canvas (`begun`) and when the first picture with all solids that the scene has has been
drawn (`drawn`). A picture that was asked for by name (`server.scene.doorway`) is given to that page, too, as PNG
without a background (`picture`, with `name` and `content`, which is empty if it could not be drawn); it goes nowhere
else. It is drawn once all solids that were told before it are there.
"""

from __future__ import annotations

import hashlib
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

HEAD = Path(__file__).with_name("scene_head.html").read_text(encoding="utf-8").rstrip("\n")
"""What is put at the top of the page's head."""


class ScenePage(NamedTuple):
    """The page, and its mark in caches."""

    body: bytes
    etag: str


@lru_cache(maxsize=2)
def page_with_head(page: bytes) -> ScenePage:
    """That page with `HEAD` at the top of its head."""
    body = page.replace(b"<head>", b"<head>" + HEAD.encode(), 1)
    return ScenePage(body, f'"{hashlib.sha256(body).hexdigest()[:32]}"')
