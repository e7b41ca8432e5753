"""STOP, whatever happens to the rest of the page: at every size, without the console, while anything is open."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, Route, expect

from server.access.roles import Role
from server.access.tokens import TokenStore

from .conftest import Service, new_context, running

pytestmark = pytest.mark.browser

SIZES = (
    (320, 256), (390, 844), (700, 500), (768, 1024), (1024, 768), (1180, 700), (1366, 600), (1440, 900), (1920, 1080),
    (2560, 1440), (720, 450),
)  # fmt: skip
"""Of viewports, in CSS pixels: a laptop of 1440 x 900 zoomed to 200 % is one of 720 x 450."""

PAGES = ("", "#/runs", "#/studies", "#/link")

LONG_NAME = "Wolfeschlegelsteinhausenbergerdorff-Anna"

COVERED = """() => {
  const stop = document.getElementById("stop-button");
  const {left, right, top, bottom} = stop.getBoundingClientRect();
  const inside = left >= 0 && top >= 0 && right <= innerWidth && bottom <= innerHeight;
  const places = [[left + 3, top + 3], [left + 3, bottom - 3], [right - 3, top + 3], [right - 3, bottom - 3]];
  const corners = places.map(([x, y]) => document.elementFromPoint(x, y));
  const sideways = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  const frame = document.querySelectorAll("header:has(h1) :is(a, button, h1), [aria-label^='Data:']");
  const others = [...frame].filter((each) => {
    const box = each.getBoundingClientRect();
    return !stop.parentElement.contains(each) && box.width > 0 && box.right > left && box.left < right &&
      box.bottom > top && box.top < bottom && each.checkVisibility();
  });
  if (!inside) return "not wholly in view";
  if (!corners.every((each) => each !== null && stop.contains(each))) return "covered";
  if (sideways > 0) return `the page is ${sideways} px wider than the window`;
  return others.length > 0 ? `it covers ${others[0].outerHTML.slice(0, 120)}` : null;
}"""


def _no_scene(context: BrowserContext) -> None:
    context.route("**/scene/**", lambda route: route.fulfill(body="<!doctype html><title>none</title><p>none"))


def _flying(service: Service) -> None:
    service.ask("/mission/commands", {"command": "reset", "configuration": "published_figures"})
    service.ask("/mission/commands", {"command": "run", "speed": 1})
    service.ask("/mission/commands", {"command": "detumble"})
    assert service.ask("/mission")["phase"] == "detumbling"


@pytest.fixture
def mission(service: Service) -> Iterator[Service]:
    """The service of all, left as others expect it."""
    yield service
    service.ask("/mission/commands", {"command": "reset", "configuration": "published_figures"})


def _expect_stopped(page: Page, service: Service) -> None:
    expect(page.locator("#stop-note")).to_have_attribute("data-answer", "stopped")
    assert service.ask("/mission")["phase"] == "stopped"


def test_it_is_wholly_in_view_at_every_size_with_the_longest_name(browser: Browser, tmp_path: Path) -> None:
    store = TokenStore(tmp_path / "data" / "access")
    secret = store.create(LONG_NAME, Role.OPERATOR)
    found = []
    with running(tmp_path / "data", tmp_path / "serve.log", BECALM_REQUIRE_TOKENS="true") as service:
        context = new_context(browser, viewport={"width": 1440, "height": 900})
        _no_scene(context)
        page = context.new_page()
        page.goto(service.address)
        page.get_by_label("Access token").fill(secret)
        page.get_by_role("button", name="Sign in").click()
        expect(page.get_by_role("status", name="Data: Live")).to_be_visible()
        page.get_by_role("button", name="Nobody in control").click()
        page.get_by_role("button", name="Take control").click()
        expect(page.get_by_role("button", name="You are in control")).to_be_visible()
        for address in PAGES:
            page.goto(f"{service.address}/{address}")
            for width, height in SIZES:
                page.set_viewport_size({"width": width, "height": height})
                for turn in (0, 2000):
                    page.mouse.move(width / 2, height * 0.75)
                    page.mouse.wheel(0, turn)
                    fault = page.evaluate(COVERED)
                    found += [] if fault is None else [f"{address} {width} x {height}, wheel {turn}: {fault}"]
        page.set_viewport_size({"width": 320, "height": 256})
        page.get_by_role("button", name="Menu").click()
        page.get_by_role("link", name="Link", exact=True).click()
        expect(page.get_by_role("main", name="Robot link")).to_be_visible()

        store.revoke(LONG_NAME)
        expect(page.get_by_label("Access token")).to_be_visible()
        found += [f"signed out: {fault}" for fault in (page.evaluate(COVERED),) if fault is not None]
        page.keyboard.press("Escape")
        expect(page.locator("#stop-note")).to_contain_text("STOP was refused")
        context.close()
    assert found == []


def _block(context: BrowserContext) -> None:
    context.route("**/assets/**", lambda route: route.abort())


def _throw(context: BrowserContext) -> None:
    def broken(route: Route) -> None:
        route.fulfill(body="throw new Error('at the console\\'s very beginning')", content_type="text/javascript")

    context.route("**/assets/*.js", broken)


def _give_rubbish(context: BrowserContext) -> None:
    """Everything that the pages share comes in another shape, and what the browser keeps is not to be had."""
    context.route("**/api/v1/session", lambda route: route.fulfill(json={"token_needed": False, "role": {"a": 1}}))
    context.route("**/api/v1/health", lambda route: route.fulfill(json=[]))
    context.route("**/api/v1/mission/config**", lambda route: route.fulfill(json={"parameters": 3}))
    context.add_init_script(
        "Object.defineProperty(window, 'localStorage', {get() { throw new DOMException('none', 'SecurityError'); }});"
        "window.matchMedia = () => { throw new Error('none'); };"
        "window.WebSocket = class { constructor() { throw new Error('none'); } };"
    )


@pytest.mark.parametrize("harm", [_block, _throw, _give_rubbish])
def test_it_stops_whatever_becomes_of_the_console(
    browser: Browser, mission: Service, harm: Callable[[BrowserContext], None]
) -> None:
    context = new_context(browser, viewport={"width": 1440, "height": 900})
    _no_scene(context)
    harm(context)
    page = context.new_page()
    page.goto(mission.address)
    _flying(mission)
    page.keyboard.press("Escape")
    _expect_stopped(page, mission)
    page.reload()
    _flying(mission)
    page.get_by_role("button", name="STOP").click()
    _expect_stopped(page, mission)
    context.close()


def test_it_stops_at_any_address_and_with_anything_open(browser: Browser, mission: Service) -> None:
    context = new_context(browser, viewport={"width": 1440, "height": 900})
    _no_scene(context)
    page = context.new_page()
    page.goto(f"{mission.address}/#/runs/%")
    expect(page.get_by_role("status", name="Data: Live")).to_be_visible()
    for address in ("#/runs/%E0%A4%A", "#/studies/%", "#/"):
        page.evaluate("address => { location.hash = address; }", address)
    _flying(mission)
    page.keyboard.press("Escape")
    _expect_stopped(page, mission)

    combobox = page.get_by_role("combobox", name="Simulation speed")
    for opened in (combobox, page.get_by_role("button", name="Layers"), page.get_by_role("button", name="Save as")):
        _flying(mission)
        opened.click()
        expect(page.get_by_text("Esc also stops the mission").locator("visible=true")).to_be_visible()
        page.keyboard.press("Escape")
        _expect_stopped(page, mission)
        expect(page.get_by_text("Esc also stops the mission").locator("visible=true")).to_have_count(0)
    context.close()
