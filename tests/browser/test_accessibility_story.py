"""Every page as axe-core reads it: roles, labels, contrast, in both themes, with runs and a study to show."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from .conftest import Service, new_context

pytestmark = pytest.mark.browser

AXE = Path(__file__).parents[2] / "web" / "node_modules" / "axe-core" / "axe.min.js"

FOUND = """async () => {
  const trusted = () => document.querySelector("[data-trust]").dataset.trust === "live";
  const before = trusted();
  const {violations} = await axe.run(document, {iframes: false, resultTypes: ["violations"]});
  if (!before || !trusted()) return null;
  return violations.flatMap(({id, help, nodes}) => nodes.map(({html}) => `${id}: ${help}: ${html.slice(0, 200)}`));
}"""
"""Null if the data were old meanwhile: then they are greyed, as they must be."""

TRIES = 30


@pytest.fixture(scope="module")
def addresses(service: Service) -> dict[str, str]:
    """What is on each page, by the page's address."""
    one, other = (
        service.ask("/runs", {"configuration": "published", "direct": True, "seed": seed})["id"] for seed in (1, 2)
    )
    grid = {"published.impedance.mass": {"values": [0.05, 0.1]}, "published.impedance.damping": {"values": [1.0, 2.0]}}
    study = service.ask("/studies", {"study": {"grid": grid}})["id"]
    service.ask("/mission/commands", {"command": "detumble"})
    return {
        "/": "Tip force",
        "/#/runs": "Paper's verdict: all",
        f"/#/runs/{one}/{other}": "Comparison",
        f"/#/runs/overlay?runs={one},{other}": "first touch",
        f"/#/studies/{study}": "finished",
        "/#/atlas": "New atlas",
        "/#/alarms": "Who is watching",
        "/#/link": "simulation",
    }


def _read(page: Page, words: str) -> list[str]:
    expect(page.get_by_text(words).locator("visible=true").first).to_be_visible()
    page.evaluate(AXE.read_text())
    for _ in range(TRIES):
        expect(page.get_by_role("status", name="Data: Live")).to_be_visible()
        found: list[str] | None = page.evaluate(FOUND)
        if found is not None:
            return found
    pytest.fail("the page's data were old at every look")


@pytest.mark.skipif(not AXE.exists(), reason="the console was built without what checks it: make check installs that")
@pytest.mark.parametrize("theme", [pytest.param("dark", marks=pytest.mark.slow), "light"])  # each a minute
def test_no_page_breaks_a_rule_of_axe(
    browser: Browser, service: Service, addresses: dict[str, str], theme: str
) -> None:
    context = new_context(browser, viewport={"width": 1440, "height": 900})
    context.add_init_script(f"localStorage.setItem('mantine-color-scheme-value', '{theme}')")
    context.route("**/scene/**", lambda route: route.fulfill(body="<!doctype html><html lang=en><title>none</title>"))
    page = context.new_page()
    broken = []
    for address, words in addresses.items():
        page.goto(service.address + address)
        broken += [f"{address} {what}" for what in _read(page, words)]
    context.close()
    assert broken == []


def test_on_a_tablet_everything_is_within_reach(browser: Browser, service: Service) -> None:
    context = new_context(browser, viewport={"width": 1024, "height": 768}, has_touch=True)
    context.route("**/scene/**", lambda route: route.fulfill(body="<!doctype html><title>none</title>"))
    page = context.new_page()
    page.goto(service.address)
    expect(page.get_by_role("status", name="Data: Live")).to_be_visible()
    sideways = page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
    assert sideways <= 0, "the page is wider than the tablet"
    for name in ("Capture", "Hold", "Reset", "Layers"):
        button = page.get_by_role("button", name=name, exact=True)
        button.scroll_into_view_if_needed()
        expect(button).to_be_in_viewport(ratio=1)
        expect(page.get_by_role("button", name="STOP")).to_be_in_viewport(ratio=1)
    page.get_by_role("figure", name=re.compile("^Tip force")).scroll_into_view_if_needed()
    expect(page.get_by_role("button", name="STOP")).to_be_in_viewport(ratio=1)
    page.get_by_role("button", name="STOP").tap()
    expect(page.get_by_role("list", name="Phases").locator("[aria-current=step]")).to_contain_text("Stopped")
    context.close()
