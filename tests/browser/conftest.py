"""The real service in a process of its own, and the distribution's Chromium to look at it with."""

from __future__ import annotations

import json
import os
import re
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, BrowserContext, Locator, Page, expect

CONSOLE = Path(__file__).parents[2] / "server" / "static" / "index.html"
ARTIFACTS = Path(__file__).parents[2] / "test-artifacts"
PREPARING_TIME = 300.0
"""The controller may have to be compiled first, on a machine that does other things too [s]."""

PATIENCE = 90_000
"""For whatever a page should show or let press [ms]: reached by a hang only, also where software draws the scene."""
expect.set_options(timeout=PATIENCE)

PUBLISHED = {"BECALM_CONFIGURATION": "published_figures"}
"""What most stories are about: its touches follow one another slowly enough to be watched."""


NO_LOOK_AHEAD = {"made": False, "reason": "not in this test", "words": "", "go_odds": 0.9, "go_peak_force": None}


def new_context(browser: Browser, **options: Any) -> BrowserContext:
    """A browser of its own, as patient as everything here.

    It is told that there is no look-ahead: a hundred futures every two seconds would take the machine from the tests.
    """
    context = browser.new_context(**options)
    context.set_default_timeout(PATIENCE)
    context.route("**/rehearsals/look-ahead", lambda route: route.fulfill(json=NO_LOOK_AHEAD))
    return context


@dataclass
class Service:
    """A running `becalm serve`."""

    address: str
    process: subprocess.Popen[bytes]

    def ask(self, path: str, body: dict[str, Any] | None = None, method: str | None = None) -> Any:
        """GET, or POST if there is a body, or what is said; the JSON answer, None for an empty one."""
        data = None if body is None else json.dumps(body).encode()
        headers = {"Content-Type": "application/json"}
        request = urllib.request.Request(f"{self.address}/api/v1{path}", data, headers, method=method)
        with urllib.request.urlopen(request, timeout=60) as answer:
            content = answer.read()
            return json.loads(content) if content else None

    def reset_when_prepared(self, **request: Any) -> None:
        """Reset the mission once what it flies is compiled; until then the service answers 503."""
        deadline = time.monotonic() + PREPARING_TIME
        while True:
            try:
                self.ask("/mission/commands", {"command": "reset", **request})
                return
            except urllib.error.HTTPError as refusal:
                if refusal.code != 503 or time.monotonic() > deadline:
                    raise
            time.sleep(0.25)


def _free_port() -> int:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


def _wait_until_ready(service: Service) -> None:
    deadline = time.monotonic() + PREPARING_TIME
    status = "no answer"
    while time.monotonic() < deadline:
        assert service.process.poll() is None, f"becalm serve ended with {service.process.returncode}"
        try:
            status = service.ask("/health")["status"]
        except OSError:
            status = "no answer"
        if status == "ok":
            return
        time.sleep(0.25)
    pytest.fail(f"becalm serve is not ready after {PREPARING_TIME:g} s: {status}")


@contextmanager
def running(data: Path, log: Path, **environment: str) -> Iterator[Service]:
    """`becalm serve` on a free port with a data folder of its own, ready to fly."""
    assert CONSOLE.exists(), "the console is not built: pip install -e . builds it into server/static"
    port = _free_port()
    environment = {**os.environ, "BECALM_DATA_DIR": str(data), **PUBLISHED, **environment}
    with log.open("wb") as said:
        process = subprocess.Popen(
            [sys.executable, "-m", "becalm", "serve", "--port", str(port)], env=environment, stdout=said, stderr=said
        )
        service = Service(f"http://127.0.0.1:{port}", process)
        try:
            _wait_until_ready(service)
            yield service
        finally:
            process.terminate()
            try:
                process.wait(timeout=60)
            finally:
                process.kill()


@pytest.fixture(scope="session")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """One that everybody on this machine may use."""
    with running(tmp_path_factory.mktemp("data"), tmp_path_factory.mktemp("log") / "serve.log") as service:
        yield service


CALM = """() => new Promise((calm) => {
  const begun = performance.now();
  let [last, quick] = [begun, 0];
  const look = (now) => {
    quick = now - last < 500 ? quick + 1 : 0;
    last = now;
    if (quick > 8 || now - begun > 20_000) calm(); else requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
})"""
"""Until the page draws again: the first picture of the scene takes software seconds. A loaded machine never calms down;
there the tests must hold as it is."""

PRESSES = 20
"""A page that draws the scene in software may be held up; it then rightly holds commands back for a moment."""


def press(console: Page, command: str) -> None:
    """Press a command's button and see it accepted; again if the page held it back because its data were old."""
    button = console.get_by_role("button", name=command, exact=True)
    answer = console.locator("[data-verdict]")
    for _ in range(PRESSES):
        expect(button).to_have_attribute("aria-disabled", "false")
        button.click()
        expect(answer).to_have_attribute("data-verdict", re.compile("accepted|refused|unknown"))
        if "data are stale" not in answer.inner_text():
            break
    expect(answer).to_contain_text(f"{command} accepted")


def is_amber(button: Locator) -> bool:
    """Whether a button is filled with amber, as armed ones are; not with the green of a main button."""
    colour = button.evaluate("button => getComputedStyle(button).backgroundColor")
    red, green, blue = (int(part) for part in re.findall(r"\d+", colour)[:3])
    return red > 200 and 120 < green < 220 and blue < 90


def choose(page: Page, name: str, option: str) -> None:
    """Open the drop-down of that name and take the option of that label."""
    page.get_by_role("combobox", name=name, exact=True).click()
    page.get_by_role("listbox", name=name, exact=True).get_by_role("option", name=option, exact=True).click()


@contextmanager
def _opened_console(browser: Browser, service: Service, name: str, *, scene: bool) -> Iterator[Page]:
    """The console on a mission that has just been reset; what it looked like at the end is kept."""
    service.ask("/mission/commands", {"command": "reset", "configuration": "published_figures"})
    service.ask("/mission/commands", {"command": "run", "speed": 1})
    context = new_context(browser, viewport={"width": 1440, "height": 900}, accept_downloads=True)
    # Software has to draw the scene here; in full detail it would leave the page no time.
    context.add_init_script("localStorage.setItem('becalm-scene', 'light')")
    if not scene:
        context.route("**/scene/**", lambda route: route.fulfill(body="<!doctype html><p>no scene in this test</p>"))
    page = context.new_page()
    failures: list[str] = []
    page.on("pageerror", lambda error: failures.append(error.stack or str(error)))
    page.goto(service.address)
    expect(page.get_by_role("status", name="Data: Live")).to_be_visible()
    if scene:
        expect(page.frame_locator("iframe").first.locator("canvas").first).to_be_visible()
        page.evaluate(CALM)
    yield page
    ARTIFACTS.mkdir(exist_ok=True)
    page.screenshot(path=ARTIFACTS / f"{name}.png")
    context.close()
    assert not failures, f"the page threw: {failures}"


@pytest.fixture
def console(browser: Browser, service: Service, request: pytest.FixtureRequest) -> Iterator[Page]:
    """The console without its 3D scene, which costs seconds where there is no graphics card."""
    with _opened_console(browser, service, request.node.name, scene=False) as page:
        yield page


@pytest.fixture
def whole_console(browser: Browser, service: Service, request: pytest.FixtureRequest) -> Iterator[Page]:
    """The console as an operator sees it."""
    with _opened_console(browser, service, request.node.name, scene=True) as page:
        yield page
