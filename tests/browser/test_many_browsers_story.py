"""A lab with ten browsers at one mission: all of them live, and what one does is seen by all."""

from __future__ import annotations

import pytest
from playwright.sync_api import Browser, expect

from .conftest import Service, new_context

pytestmark = [pytest.mark.browser, pytest.mark.slow]
"""Ten pages that software draws take two processors for a minute; tests/soak has many readers at once, quickly."""

BROWSERS = 10


def test_ten_browsers_are_live_and_see_what_one_of_them_does(browser: Browser, service: Service) -> None:
    service.ask("/mission/commands", {"command": "reset"})
    context = new_context(browser, viewport={"width": 1440, "height": 900})
    context.route("**/scene/**", lambda route: route.fulfill(body="<!doctype html><title>none</title>"))
    pages = [context.new_page() for _ in range(BROWSERS)]
    for page in pages:
        page.goto(service.address)
    for page in pages:
        page.bring_to_front()  # what is hidden draws nothing
        expect(page.get_by_role("status", name="Data: Live")).to_be_visible()
    pages[0].bring_to_front()
    pages[0].keyboard.press("Escape")
    for page in pages:
        page.bring_to_front()
        phase = page.get_by_role("list", name="Phases").locator("[aria-current=step]")
        expect(phase).to_contain_text("Stopped")
        expect(page.get_by_role("log", name="Events")).to_contain_text("stopped: joint rates are zero")
    context.close()
