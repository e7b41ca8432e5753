"""An operator captures the target by clicking, reads how it ended, and takes the log away."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from .conftest import choose, press

pytestmark = pytest.mark.browser

CAPTURE_TIME = 180_000
"""About 25 s of mission time at double speed, on a machine that also draws the scene in software [ms]."""

NOW_OR_DONE = re.compile("now|done")

LEAST_TOUCHES = 5
"""`published_figures` shows the method in five planned touches; the closing adds some."""


def test_a_capture_from_the_first_click_to_the_log(whole_console: Page, tmp_path: Path) -> None:
    console = whole_console
    choose(console, "Simulation speed", "2 ×")
    expect(console.get_by_role("timer", name="Mission time")).not_to_have_text("—")
    scene = console.frame_locator("iframe[title='3D view of robot and target']")
    expect(scene.locator("canvas").first).to_be_visible()

    press(console, "Capture")

    phases = console.get_by_role("list", name="Phases")
    events = console.get_by_role("log", name="Events")
    expect(events).to_contain_text("Detumbling begins")
    expect(phases.get_by_role("listitem").filter(has_text="Detumbling")).to_have_attribute("data-state", NOW_OR_DONE)
    expect(events).to_contain_text("Right hand touches", timeout=CAPTURE_TIME)

    outcome = console.get_by_role("status", name="Outcome")
    expect(outcome).to_contain_text("Caged", timeout=CAPTURE_TIME)
    for words in ("Peak to closure", "Peak to locked arms", "Cage margin", "mm"):
        expect(outcome).to_contain_text(words)
    expect(phases.locator("[aria-current=step]")).to_contain_text("Holding")
    expect(events).to_contain_text("Caging begins")
    touches = console.get_by_role("region", name="Touches").locator("tbody tr")
    assert touches.count() >= LEAST_TOUCHES

    with console.expect_download() as download:
        console.get_by_role("link", name="Download the log of this run as CSV").click()
    log = tmp_path / "log.csv"
    download.value.save_as(log)
    _check_log(log)


def _check_log(log: Path) -> None:
    with log.open(newline="", encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        header = list(rows.fieldnames or [])
        ticks = sum(1 for _ in rows)
    for column in ("mission.tick", "mission.time", "target.twist.angle", "left.hand_wrench.x", "right.joint_rate.3"):
        assert any(name.startswith(column) for name in header), f"{column} is missing in {header}"
    assert ticks > 20_000, "every tick of a capture of more than 20 s at 1 kHz"
