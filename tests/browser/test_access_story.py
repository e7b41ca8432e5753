"""A console that asks who one is: a wrong token, a viewer who may only stop, and signing out."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from server.access.roles import Role
from server.access.tokens import TokenStore

from .conftest import ARTIFACTS, new_context, running

pytestmark = pytest.mark.browser


def test_a_viewer_signs_in_sees_stops_and_signs_out(browser: Browser, tmp_path: Path) -> None:
    store = TokenStore(tmp_path / "data" / "access")
    secret = store.create("vic", Role.VIEWER)
    with running(tmp_path / "data", tmp_path / "serve.log", BECALM_REQUIRE_TOKENS="true") as service:
        context = new_context(browser, viewport={"width": 1440, "height": 900})
        page = context.new_page()
        refused: list[str] = []
        page.on("console", lambda said: refused.append(said.text) if "Content Security Policy" in said.text else None)
        page.goto(service.address)
        field = page.get_by_label("Access token")
        field.fill("a guess")
        page.get_by_role("button", name="Sign in").click()
        expect(page.get_by_text("is unknown, has expired or was revoked")).to_be_visible()
        ARTIFACTS.mkdir(exist_ok=True)
        page.screenshot(path=ARTIFACTS / "sign-in.png")
        field.fill(secret)
        page.get_by_role("button", name="Sign in").click()

        expect(page.get_by_role("status", name="Data: Live")).to_be_visible()
        expect(page.get_by_text("vic viewer")).to_be_visible()
        scene = page.frame_locator("iframe[title='3D view of robot and target']")
        expect(scene.locator("canvas").first).to_be_visible()
        capture = page.get_by_role("button", name="Capture", exact=True)
        expect(capture).to_have_attribute("aria-disabled", "true")
        page.get_by_role("button", name="STOP").click()
        phases = page.get_by_role("list", name="Phases").locator("[aria-current=step]")
        expect(phases).to_contain_text("Stopped")
        assert refused == [], "the policy of the pages forbids what they need"

        store.revoke("vic")
        expect(page.get_by_label("Access token")).to_be_visible()
        expect(page.get_by_role("button", name=re.compile("Capture"))).to_have_count(0)
        context.close()
