"""The console under a path of another site, behind TLS: page, telemetry, scene and STOP all find their way."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.conftest import Service, new_context
from tests.deploy.nginx import needs_nginx, site

pytestmark = [pytest.mark.browser, needs_nginx]


@pytest.fixture
def proxied(browser: Browser, service: Service, tmp_path: Path) -> Iterator[Page]:
    """The console as nginx shows it under /becalm/."""
    service.ask("/mission/commands", {"command": "reset", "configuration": "published_figures"})
    service.ask("/mission/commands", {"command": "run", "speed": 1})
    port = urlsplit(service.address).port
    assert port is not None
    with site(tmp_path, "becalm-under-a-path.conf", "127.0.0.1", port) as shown:
        context = new_context(browser, ignore_https_errors=True)
        context.add_init_script("localStorage.setItem('becalm-scene', 'light')")
        page = context.new_page()
        page.goto(f"https://127.0.0.1:{shown.port}/becalm")
        yield page
        context.close()


def test_the_console_works_under_a_path_of_another_site(proxied: Page, service: Service) -> None:
    elsewhere: list[str] = []
    proxied.on("request", lambda asked: None if "/becalm/" in asked.url else elsewhere.append(asked.url))
    proxied.reload()
    expect(proxied.get_by_role("status", name="Data: Live")).to_be_visible()
    proxied.get_by_role("button", name="STOP").click()
    phase = proxied.get_by_role("list", name="Phases").locator("[aria-current=step]")
    expect(phase).to_contain_text("Stopped")
    assert service.ask("/mission")["phase"] == "stopped"
    expect(proxied.frame_locator("iframe").first.locator("canvas").first).to_be_visible()
    assert not [url for url in elsewhere if url.startswith("http")]
