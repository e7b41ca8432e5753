"""An operator rehearses an edit, sees what is foreseen before a capture, and takes values from the atlas."""

from __future__ import annotations

import re
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from .conftest import NO_LOOK_AHEAD, PRESSES, Service

pytestmark = pytest.mark.browser

FUTURES = 6


def _odds(case: dict[str, Any]) -> str:
    return f"{case['caged']['futures']} of {FUTURES} caged"


def test_an_edit_is_rehearsed_beside_what_is_in_force(console: Page, service: Service) -> None:
    form = console.locator("section", has=console.get_by_role("heading", name="Parameters"))
    form.get_by_label("Damping").first.fill("6")
    console.get_by_label("Futures", exact=True).fill(str(FUTURES))
    staged = console.get_by_role("region", name="Staged changes")
    with console.expect_response(
        lambda answer: answer.request.method == "POST" and "/rehearsals" in answer.url
    ) as begun:
        staged.get_by_role("button", name="Rehearse").click()

    panel = console.get_by_role("region", name="Rehearsal")
    expect(panel.get_by_role("region", name="What the changes do")).to_be_visible()
    result = service.ask(f"/rehearsals/{begun.value.json()['id']}")["result"]
    assert result["changes"] == {"published.impedance.damping": 6.0}
    expect(panel.get_by_role("group", name=f"As it is: {_odds(result['as_it_is'])}")).to_be_visible()
    expect(panel.get_by_role("group", name=f"As changed: {_odds(result['as_changed'])}")).to_be_visible()
    for change in result["compared"]:
        expect(panel).to_contain_text(change["words"])
    assert service.ask("/mission")["phase"] == "idle"  # nothing has moved

    predicted = console.get_by_text("Predicted")
    expect(predicted.locator("xpath=ancestor::*[@title][1]")).to_have_attribute("title", re.compile("as it is"))
    staged.get_by_role("button", name="Apply").click()
    expect(predicted.locator("xpath=ancestor::*[@title][1]")).to_have_attribute("title", re.compile("as changed"))
    console.get_by_role("button", name="Take the prediction out of the plots").click()
    expect(predicted).to_be_hidden()


def test_a_capture_that_is_no_go_takes_a_second_press_with_the_reason(console: Page, service: Service) -> None:
    foreseen = {"made": True, "request": "capture", "go": False, "words": "Capture: 12 of 100 futures caged"}
    answer = {**NO_LOOK_AHEAD, **foreseen, "reason": "12 % of the futures end in a cage; go takes 90 %"}
    console.route("**/rehearsals/look-ahead", lambda route: route.fulfill(json=answer))
    expect(console.get_by_text("Capture: 12 of 100 futures caged")).to_be_visible()
    console.get_by_role("button", name="Capture", exact=True).click()
    expect(console.locator("[data-verdict=armed]")).to_contain_text("12 % of the futures end in a cage")
    assert service.ask("/mission")["phase"] == "idle"
    verdict = console.locator("[data-verdict]")
    for _ in range(PRESSES):  # a press too soon is the second half of a double click
        console.get_by_role("button", name=re.compile("^(Go: )?Capture$")).click()
        expect(verdict).not_to_have_attribute("data-verdict", "waiting")
        if verdict.get_attribute("data-verdict") == "accepted":
            break
    expect(verdict).to_contain_text("Capture accepted")


def test_a_cell_of_the_atlas_stages_its_values(console: Page) -> None:
    console.get_by_role("link", name="Atlas").click()
    form = console.locator("section", has=console.get_by_role("heading", name="New atlas"))
    for axis in range(2):
        form.get_by_label("Values").nth(axis).fill("2")
    form.get_by_label("Futures a cell").fill("1")
    form.get_by_role("button", name="Map").click()
    atlas = console.get_by_role("region", name="Atlas")
    expect(atlas.get_by_role("status")).to_contain_text("4 of 4 cells")
    cells = atlas.locator("[data-cell]")
    expect(cells).to_have_count(4)
    for cell in cells.all():
        expect(cell).not_to_have_attribute("data-shown", "empty")
    cells.first.click()
    console.get_by_role("link", name="Mission", exact=True).click()
    expect(console.get_by_role("region", name="Staged changes")).to_contain_text("2 changes staged")
