"""The impedance is edited in stages: seen as differences, bounded at the field, applied together."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Locator, Page, expect

from .conftest import PRESSES, Service, choose, press

pytestmark = pytest.mark.browser


def test_edits_are_staged_bounded_and_applied_together(console: Page, service: Service) -> None:
    form = console.locator("section", has=console.get_by_role("heading", name="Parameters"))

    def field(name: str) -> Locator:
        return form.get_by_label(name).first

    before = service.ask("/mission/config")["config"]["published"]["impedance"]
    field("Mass").fill("0")
    field("Damping").fill("3")
    staged = console.get_by_role("region", name="Staged changes")
    expect(console.get_by_text("must be greater than 1e-4 kg")).to_be_visible()
    expect(staged.get_by_role("button", name="Apply")).to_be_disabled()
    assert service.ask("/mission/config")["config"]["published"]["impedance"] == before

    field("Mass").fill("0.3")
    expect(staged).to_contain_text("2 changes staged")
    staged.get_by_role("button", name="Apply").click()
    expect(staged).to_be_hidden()
    expect(console.get_by_text("published_figures (edited)")).to_be_visible()
    after = service.ask("/mission/config")["config"]["published"]["impedance"]
    assert (after["mass"], after["damping"], after["stiffness"]) == (0.3, 3.0, before["stiffness"])


def test_a_preset_outlives_a_reset_which_asks_before_it_loses_edits(console: Page, service: Service) -> None:
    service.ask("/mission/config", {"published": {"impedance": {"damping": 0.3}}}, "PATCH")
    expect(console.get_by_text("published_figures (edited)")).to_be_visible()
    console.get_by_role("button", name="Save as").click()
    console.get_by_label("Preset name").fill("soft hands")
    console.get_by_role("button", name="Save", exact=True).click()
    expect(console.get_by_text("Saved by operator; it will be replaced.")).to_be_visible()
    console.get_by_label("Preset name").press("Tab")
    console.get_by_role("heading", name="Parameters").click()  # closes what was opened

    console.get_by_role("button", name="Reset", exact=True).click()
    expect(console.locator("[data-verdict=armed]")).to_contain_text("Edited parameters will be lost")
    assert service.ask("/mission")["configuration"] == "published_figures (edited)"
    answer = console.locator("[data-verdict]")
    for _ in range(PRESSES):  # a press too soon is the second half of a double click
        console.get_by_role("button", name=re.compile("^(Go: )?Reset$")).click()
        expect(answer).not_to_have_attribute("data-verdict", "waiting")
        if answer.get_attribute("data-verdict") == "accepted":
            break
    expect(console.get_by_text("published_figures (edited)")).to_be_hidden()

    choose(console, "Preset to stage", "soft hands")
    staged = console.get_by_role("region", name="Staged changes")
    expect(staged).to_contain_text("1 change staged")
    staged.get_by_role("button", name="Apply").click()
    expect(staged).to_be_hidden()
    assert service.ask("/mission/config")["config"]["published"]["impedance"]["damping"] == 0.3


def test_a_parameter_that_takes_a_reset_is_refused_at_its_field(console: Page) -> None:
    press(console, "Detumble")
    console.get_by_label("Search parameters").fill("target initial spin")
    console.get_by_label("Initial spin").fill("1.2")
    staged = console.get_by_role("region", name="Staged changes")
    staged.get_by_role("button", name="Apply").click()
    expect(staged.get_by_role("alert")).to_contain_text("target.initial_spin")
    staged.get_by_role("button", name="Discard").click()
    expect(staged).to_be_hidden()
