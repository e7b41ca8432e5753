"""A researcher takes the scene of a run away, as a still and as a film, drawn by a real browser from the log."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

import pytest
from PIL import Image
from playwright.sync_api import Browser, Page, expect

from .conftest import ARTIFACTS, Service, choose, new_context

pytestmark = pytest.mark.browser

SHOWN = """async (content) => {
  const film = document.createElement("video");
  film.muted = true;
  film.src = `data:video/webm;base64,${content}`;
  await new Promise((done, fail) => {
    film.onloadeddata = done;
    film.onerror = () => fail(new Error(film.error.message));
  });
  return { width: film.videoWidth, height: film.videoHeight, duration: film.duration };
}"""
"""What a browser makes of a film."""


def _saved(page: Page, button: str, path: Path) -> Path:
    with page.expect_download() as download:
        page.get_by_role("button", name=button).click()
    download.value.save_as(path)
    return path


def test_a_still_and_a_film_of_a_replay(browser: Browser, service: Service) -> None:
    run = service.ask("/runs", {"configuration": "published", "direct": True})["id"]
    context = new_context(browser, viewport={"width": 1440, "height": 900}, accept_downloads=True)
    context.add_init_script("localStorage.setItem('becalm-scene', 'light')")
    page = context.new_page()
    page.goto(f"{service.address}/#/runs/{run}?t=3")
    replay = page.get_by_role("region", name="Replay in the scene")
    ARTIFACTS.mkdir(exist_ok=True)

    # At once: it can be saved as soon as robot and target are seen, and not before.
    replay.get_by_role("button", name="Picture").click()
    choose(page, "Size, pixels", "480 × 270")
    with Image.open(_saved(page, "Save still of 00:03.000 (PNG)", ARTIFACTS / "still.png")) as still:
        assert (still.size, still.mode) == ((480, 270), "RGBA")
        clear, solid = (sum(still.getchannel("A").histogram()[part]) for part in (slice(0, 64), slice(250, 256)))
        colours = len(still.convert("RGB").getcolors(still.width * still.height) or [])
    assert clear > 1000  # the table fades out into nothing
    assert solid > 5000  # robot and target do not
    assert colours > 500
    expect(replay.get_by_text("Loading the scene")).to_have_count(0)

    page.get_by_label("From, s").fill("3")
    page.get_by_label("To, s").fill("3.2")
    choose(page, "Speed of the film", "2 × real time")
    film = _saved(page, "Save film (WebM)", ARTIFACTS / "film.webm").read_bytes()
    shown: dict[str, Any] = context.new_page().evaluate(SHOWN, base64.b64encode(film).decode())
    assert (shown["width"], shown["height"]) == (480, 270)
    assert shown["duration"] == pytest.approx(4 / 30, abs=0.02)  # 3.000, 3.067, 3.133, 3.200
    context.close()
