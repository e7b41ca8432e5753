"""A newcomer finds things by name, is shown a real capture, and reads a plot and the help by keyboard."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Page, expect

from .conftest import ARTIFACTS

pytestmark = pytest.mark.browser


def test_things_are_found_shown_and_read_by_keyboard(console: Page) -> None:
    console.keyboard.press("Control+k")
    sought = console.get_by_role("combobox", name="Search everything")
    sought.fill("impedance damping")
    expect(console.get_by_role("option").first).to_contain_text("published.impedance.damping")
    sought.press("Enter")
    expect(console.get_by_label("Search parameters")).to_have_value("published.impedance.damping")

    console.keyboard.press("Control+k")
    sought.fill("hold")
    sought.press("Enter")
    expect(console.get_by_role("button", name="Hold", exact=True)).to_be_focused()  # led to, not given

    console.keyboard.press("?")
    console.get_by_role("button", name="Tour of two minutes").click()
    tour = console.get_by_role("region", name="Tour")
    for _ in range(3):
        tour.get_by_role("button", name="Next").click()
    expect(tour.get_by_role("heading", name="Capture")).to_be_visible()
    console.get_by_role("button", name="Capture", exact=True).click()
    expect(tour.get_by_role("heading", name="The scene")).to_be_visible()  # it goes on by itself
    console.screenshot(path=ARTIFACTS / "tour.png")
    tour.get_by_role("button", name="End the tour").click()

    plot = console.get_by_role("figure", name=re.compile("^Tip force"))
    chart = plot.get_by_role("application")
    chart.press("ArrowLeft")
    expect(plot.get_by_role("status")).to_have_text(re.compile(r"^at \d\d:\d\d\.\d+: Left \d.* N$"))
    chart.press("+")
    expect(console.get_by_role("button", name="Follow", exact=True)).to_be_visible()
    chart.press("Home")

    with console.expect_popup() as opened:
        console.get_by_role("link", name="Help: Mission").click()
    expect(opened.value.get_by_role("heading", name="Mission", exact=True)).to_be_in_viewport()
    opened.value.close()
    console.keyboard.press("g")
    console.keyboard.press("r")
    expect(console).to_have_url(re.compile("#/runs$"))
