"""A researcher saves plots for a paper: of the mission that flies, and of two runs beside one another."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
import zlib
from pathlib import Path

import pytest
from PIL import Image
from playwright.sync_api import Locator, Page, expect

from .conftest import ARTIFACTS, Service, press

pytestmark = pytest.mark.browser

SVG = "{http://www.w3.org/2000/svg}"
WIDTH, HEIGHT = 720, 356
"""Of a figure, in CSS pixels."""
LEGEND, LETTER = "55", 6.4
"""Where its legend stands, and how wide a letter is."""
PNG_SCALE = 3
POINTS = 0.75


def _saved(page: Page, plot: Locator, kind: str) -> Path:
    with page.expect_download() as download:
        plot.get_by_role("button", name=re.compile("^Export")).click()
        page.get_by_role("menuitem", name=kind).click()
    ARTIFACTS.mkdir(exist_ok=True)
    path = ARTIFACTS / download.value.suggested_filename
    download.value.save_as(path)
    return path


def _words(drawing: Path) -> str:
    return " | ".join(ET.parse(drawing).getroot().itertext())


def _curves(drawing: Path) -> list[str]:
    """The ways of the curves that were drawn."""
    return [path.get("d", "") for path in ET.parse(drawing).getroot().iter(f"{SVG}path") if path.get("d")]


def _pdf_words(document: Path) -> str:
    """What a PDF without encryption or strange encodings says."""
    content = document.read_bytes()
    assert content.startswith(b"%PDF-")
    box = re.search(rb"/MediaBox \[0 0 ([\d.]+)\s+([\d.]+)\s*\]", content)
    assert box is not None
    assert [float(side) for side in box.groups()] == pytest.approx([POINTS * WIDTH, POINTS * HEIGHT], abs=0.1)
    pages = [
        zlib.decompress(each) for each in re.findall(rb"FlateDecode.*?stream\r?\n(.*?)\r?\nendstream", content, re.S)
    ]
    return " | ".join(
        re.sub(r"\\(.)", r"\1", text.decode("cp1252"))
        for page in pages
        for text in re.findall(rb"\(((?:[^()\\]|\\.)*)\) Tj", page)
    )


def _assert_on_white(picture: Path) -> None:
    with Image.open(picture) as image:
        assert image.size == (PNG_SCALE * WIDTH, PNG_SCALE * HEIGHT)
        pixels = image.convert("RGB")
        assert pixels.getpixel((2, 2)) == pixels.getpixel((image.width - 3, image.height - 3)) == (255, 255, 255)
        colours = {colour for _, colour in pixels.getcolors(image.width * image.height) or []}
        assert {(0, 114, 178), (213, 94, 0)} <= colours  # both hands' curves


def test_a_plot_of_the_mission_that_flies_and_of_two_runs(console: Page, service: Service) -> None:
    press(console, "Capture")
    forces = console.get_by_role("figure", name=re.compile("^Tip force"))
    expect(forces.locator("b").first).not_to_have_text("—")
    run = service.ask("/mission")["run_id"]
    live = {kind: _saved(console, forces, kind) for kind in ("SVG", "PNG", "PDF")}
    for words in (_words(live["SVG"]), _pdf_words(live["PDF"])):
        for said in (
            "Tip force, felt / asked for",
            f"Run {run}, in progress",
            "Force, N",
            "Mission time, s",
            "Left",
            "Right",
        ):
            assert said in words
    assert len(_curves(live["SVG"])) == 2
    assert "NaN" not in live["SVG"].read_text()
    _assert_on_white(live["PNG"])

    one, other = (
        service.ask("/runs", {"configuration": "published", "direct": True, "seed": seed})["id"] for seed in (1, 2)
    )
    console.goto(f"{service.address}/#/runs/{one}/{other}")
    view = console.get_by_role("region", name=f"Run {one}")
    compared = view.get_by_role("figure", name=re.compile("^Tip force"))
    expect(compared.locator("i")).to_have_count(2)
    expect(compared.locator("i").first).not_to_have_text("—")
    both = {kind: _saved(console, compared, kind) for kind in ("SVG", "PNG", "PDF")}
    for words in (_words(both["SVG"]), _pdf_words(both["PDF"])):
        for said in (f"Run {one}, published (edited), seed 1; other run {other}", "other run, thinner"):
            assert said in words
    assert len(_curves(both["SVG"])) == 4
    _assert_on_white(both["PNG"])
    view.get_by_text("Joints", exact=True).click()
    joints = _saved(console, view.get_by_role("figure", name=re.compile("^Left joint rates")), "SVG")
    assert len(_curves(joints)) == 12
    legend = [each for each in ET.parse(joints).getroot().iter(f"{SVG}text") if each.get("y") == LEGEND]
    assert [each.text for each in legend][-1] == "other run, thinner"
    assert all(float(each.get("x", 0)) + LETTER * len(each.text or "") < WIDTH for each in legend)
