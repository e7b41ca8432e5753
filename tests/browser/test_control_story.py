"""Two operators at one mission: one commands, the other sees it, takes over when asked to, or relieves."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from server.access.roles import Role
from server.access.tokens import TokenStore

from .conftest import ARTIFACTS, choose, new_context, press, running

pytestmark = pytest.mark.browser


@pytest.fixture
def operators(browser: Browser, tmp_path: Path) -> Iterator[tuple[Page, Page]]:
    """Ana's page and Ben's, signed in."""
    store = TokenStore(tmp_path / "data" / "access")
    secrets = [store.create(name, Role.OPERATOR) for name in ("ana", "ben")]
    with running(tmp_path / "data", tmp_path / "serve.log", BECALM_REQUIRE_TOKENS="true") as service:
        contexts = [new_context(browser, viewport={"width": 1440, "height": 900}) for _ in secrets]
        pages = [context.new_page() for context in contexts]
        for page, secret in zip(pages, secrets, strict=True):
            page.route("**/scene/**", lambda route: route.abort())  # what fails there, fails there only
            page.goto(service.address)
            page.get_by_label("Access token").fill(secret)
            page.get_by_role("button", name="Sign in").click()
            expect(page.get_by_role("status", name="Data: Live")).to_be_visible()
        yield pages[0], pages[1]
        for context in contexts:
            context.close()


def test_control_is_taken_by_commanding_handed_over_and_taken_back(operators: tuple[Page, Page]) -> None:
    ana, ben = operators
    capture = ben.get_by_role("button", name="Capture", exact=True)
    expect(ana.get_by_role("button", name="Nobody in control")).to_be_visible()
    press(ana, "Pause")
    expect(ana.get_by_role("button", name="You are in control")).to_be_visible()
    expect(ben.get_by_role("button", name="ana is in control")).to_be_visible()
    expect(capture).to_have_attribute("aria-disabled", "true")
    capture.click(force=True)  # it says why, to fingers too
    expect(ben.get_by_text("ana is in control; take over at the top of the page first.").first).to_be_visible()

    ana.get_by_role("button", name="You are in control").click()
    choose(ana, "Operator to hand over to", "ben")
    ana.get_by_role("button", name="Hand over").click()
    ben.get_by_role("button", name="ana hands over to you").click()
    ARTIFACTS.mkdir(exist_ok=True)
    ben.screenshot(path=ARTIFACTS / "control-offered.png")
    ben.get_by_role("button", name="Take control").click()
    expect(ben.get_by_role("button", name="You are in control")).to_be_visible()
    expect(capture).to_have_attribute("aria-disabled", "false")

    ana.get_by_role("button", name="ben is in control").click()
    ana.get_by_role("button", name="Relieve ben").click()
    ana.get_by_role("button", name="Really relieve ben?").click()
    expect(ben.get_by_role("button", name="ana is in control")).to_be_visible()
    expect(ben.get_by_role("log", name="Events")).to_contain_text("ana is in control, ben is relieved by ana")
    ben.get_by_role("button", name="STOP").click()  # whoever is in control
    phases = ana.get_by_role("list", name="Phases").locator("[aria-current=step]")
    expect(phases).to_contain_text("Stopped")
