"""An operator lays the mission page out, shares that, takes an Apply back without being asked, and finds events."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Page, expect

from .conftest import ARTIFACTS, Service, choose, press

pytestmark = pytest.mark.browser


def test_the_page_is_laid_out_and_shared_by_its_address(console: Page, service: Service) -> None:
    divider = console.get_by_role("separator", name="Width of the left column")
    divider.press("ArrowRight")
    expect(divider).to_have_attribute("aria-valuenow", "312")
    console.reload()
    expect(divider).to_have_attribute("aria-valuenow", "312")  # kept
    console.goto(f"{service.address}/#/mission?view=wall")
    spin = console.get_by_role("group", name="Target spin")
    expect(spin).to_contain_text("1.00 rad/s")
    expect(console.get_by_role("button", name="STOP")).to_be_in_viewport(ratio=1)
    console.screenshot(path=ARTIFACTS / "wall.png")
    console.get_by_role("button", name="View: Wall").click()
    console.get_by_text("Everything", exact=True).click()
    expect(console.get_by_role("button", name="Capture", exact=True)).to_be_visible()
    console.get_by_role("button", name="Usual layout").click()
    expect(divider).to_have_attribute("aria-valuenow", "296")


def _panels(page: Page, column: str) -> list[str]:
    return page.locator(f"[data-column={column}] [data-panel]").evaluate_all(
        "all => all.map(({dataset}) => dataset.panel)"
    )


def test_panels_are_moved_by_keys_and_mouse_and_keep_what_was_typed(console: Page, service: Service) -> None:
    console.get_by_role("textbox", name="Search events").fill("kept")
    handle = console.get_by_role("button", name="Move the panel Events")
    handle.press("ArrowUp")
    expect(handle).to_be_focused()
    handle.press("ArrowLeft")
    assert _panels(console, "see") == ["events"]
    expect(console.get_by_role("textbox", name="Search events")).to_have_value("kept")
    console.reload()
    expect(handle).to_be_visible()
    assert _panels(console, "see") == ["events"]  # kept

    problems = console.get_by_role("button", name="Move the panel Problems").bounding_box()
    commands = console.locator(
        "section", has=console.get_by_role("heading", name="Commands", exact=True)
    ).bounding_box()
    assert problems is not None
    assert commands is not None
    console.mouse.move(problems["x"] + 5, problems["y"] + 8)
    console.mouse.down()
    console.mouse.move(commands["x"] + 40, commands["y"] + 2, steps=4)
    console.screenshot(path=ARTIFACTS / "moving.png")
    console.mouse.up()
    assert _panels(console, "act") == ["problems", "commands", "parameters"]
    other = console.context.new_page()
    other.goto(f"{service.address}/#/mission?panels=outcome_commands_events.problems")
    expect(other.get_by_role("button", name="Move the panel Events")).to_be_visible()
    assert [_panels(other, column) for column in ("act", "see", "know")] == [
        ["outcome", "parameters"],
        ["commands"],
        ["events", "problems", "rehearsal"],
    ]
    other.get_by_role("button", name="View: Everything").click()
    other.get_by_role("button", name="Usual layout").click()
    expect(other.locator("[data-column=see] [data-panel]")).to_have_count(0)


def test_an_apply_is_taken_back_and_its_events_are_found(console: Page, service: Service) -> None:
    was = service.ask("/mission/config")["config"]["published"]["impedance"]["damping"]
    console.get_by_label("Search parameters").fill("published.impedance.damping")
    form = console.locator("section", has=console.get_by_role("heading", name="Parameters"))
    field = form.get_by_role("textbox", name=re.compile("amping"))
    field.fill("4.25")
    console.reload()  # what is staged outlives it
    expect(console.get_by_role("status", name="Data: Live")).to_be_visible()
    expect(console.get_by_label("Estimating time")).to_be_attached()  # the form is whole
    console.get_by_role("button", name="Apply").click()
    undo = console.get_by_role("region", name="Applied changes")
    expect(undo).to_contain_text("4.25")
    undo.get_by_role("button", name="Undo").click()
    expect(undo).to_have_count(0)
    assert service.ask("/mission/config")["config"]["published"]["impedance"]["damping"] == was

    press(console, "Detumble")
    log = console.get_by_role("log", name="Events")
    expect(log).to_contain_text("4.25")
    console.get_by_role("textbox", name="Search events").fill("damping 4.25")
    expect(log.get_by_role("listitem").first).to_contain_text("4.25")
    choose(console, "Kind of events", "Phases, verdicts")
    expect(log).to_contain_text("No matching events.")
    with console.expect_download() as saved:
        console.get_by_role("textbox", name="Search events").fill("")
        console.get_by_role("button", name="Export these events as CSV").click()
    assert "Detumbling" in saved.value.path().read_text()
    service.ask("/mission/stop", {})
