"""STOP by its key, from the page and from within the scene, and by its button while the mission is paused."""

from __future__ import annotations

import pytest
from playwright.sync_api import Locator, Page, expect

from .conftest import Service, press

pytestmark = pytest.mark.browser


def _start(console: Page) -> None:
    press(console, "Detumble")
    expect(_phase(console)).to_contain_text("Detumbling")


def _phase(console: Page) -> Locator:
    return console.get_by_role("list", name="Phases").locator("[aria-current=step]")


def _expect_stopped(console: Page, service: Service) -> None:
    expect(_phase(console)).to_contain_text("Stopped")
    expect(console.get_by_role("button", name="STOP")).to_be_enabled()
    assert service.ask("/mission")["phase"] == "stopped"


def test_escape_stops_while_a_field_has_the_focus(console: Page, service: Service) -> None:
    _start(console)
    console.get_by_label("Search parameters").fill("gain")
    console.keyboard.press("Escape")
    _expect_stopped(console, service)
    expect(console.get_by_role("button", name="Capture", exact=True)).to_have_attribute("aria-disabled", "true")


def test_escape_stops_from_within_the_scene(whole_console: Page, service: Service) -> None:
    console = whole_console
    scene = console.frame_locator("iframe[title='3D view of robot and target']")
    scene.locator("canvas").first.click(force=True)
    # Not by its button: where software draws the scene, the page may be held up for longer than it waits for answers.
    service.ask("/mission/commands", {"command": "detumble"})
    expect(_phase(console)).to_contain_text("Detumbling")
    console.keyboard.press("Escape")
    _expect_stopped(console, service)


def test_the_button_stops_a_paused_mission(console: Page, service: Service) -> None:
    _start(console)
    press(console, "Pause")
    expect(console.get_by_role("button", name="Run", exact=True)).to_be_visible()
    console.get_by_role("button", name="STOP").click()
    _expect_stopped(console, service)


def test_a_reset_follows(console: Page, service: Service) -> None:
    console.keyboard.press("Escape")
    _expect_stopped(console, service)
    press(console, "Reset")
    expect(_phase(console)).to_contain_text("Idle")
    expect(console.get_by_role("button", name="Capture", exact=True)).to_have_attribute("aria-disabled", "false")
