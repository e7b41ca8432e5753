"""An operator sets a limit, is told that it is gone beyond, acknowledges and shelves it, and tells the next shift."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Browser, Page, expect

from .conftest import ARTIFACTS, Service, choose, new_context

pytestmark = pytest.mark.browser


def test_a_limit_that_is_gone_beyond_is_told_everywhere_until_it_is_seen(console: Page, service: Service) -> None:
    console.goto(f"{service.address}/#/alarms")
    limits = console.get_by_role("region", name="Limits of the signals")
    limits.get_by_label("Spin of the target: warning").fill("0.9")
    limits.get_by_label("Spin of the target: watch").fill("5")
    limits.get_by_role("button", name="Save").click()
    expect(console.get_by_role("alert")).to_contain_text("must be above watch, which is 5")
    limits.get_by_label("Spin of the target: warning").fill("0.9")
    limits.get_by_label("Spin of the target: watch").fill("0.5")
    limits.get_by_label("Spin of the target: critical").fill("")
    limits.get_by_role("button", name="Save").click()

    alarm = console.get_by_role("list", name="Alarms").get_by_role("listitem").filter(has_text="Spin of the target")
    expect(alarm).to_contain_text("1 rad/s, above 0.9 rad/s")
    expect(console).to_have_title(re.compile(r"^\(\d !\)"))
    console.screenshot(path=ARTIFACTS / "alarms.png")
    console.get_by_role("link", name="Runs", exact=True).click()
    state = console.get_by_role("link", name=re.compile("^Alarms: "))
    expect(state).to_contain_text("to acknowledge")
    state.click()
    alarm.get_by_role("button", name="Acknowledge: Spin of the target").click()
    expect(alarm).to_contain_text("seen by operator")
    choose(console, "Shelve: Spin of the target", "for 5 min")
    expect(alarm).to_contain_text("shelved by operator until")
    alarm.get_by_role("button", name="Unshelve: Spin of the target").click()
    history = console.get_by_role("region", name="Records of alarms")
    expect(history.get_by_role("row").filter(has_text="acknowledged by operator").first).to_be_visible()

    limits.get_by_role("button", name="Spin of the target: back to the default limits").click()
    expect(alarm).to_have_count(0)
    assert "Spin of the target" not in [each["title"] for each in service.ask("/alarms")]

    console.get_by_label("A note for the next shift").fill("Floor levelled.")
    console.reload()  # a draft outlives it
    console.get_by_role("button", name="Note", exact=True).click()
    expect(console.get_by_role("list", name="Shift log")).to_contain_text("Floor levelled.")
    expect(console.get_by_role("list", name="Who is watching")).to_contain_text("operator")


OBSERVED = """
window.tones = [];
const make = AudioContext.prototype.createOscillator;
AudioContext.prototype.createOscillator = function () {
  const oscillator = make.call(this);
  const start = oscillator.start;
  oscillator.start = (when) => {
    window.tones.push([oscillator.frequency.value, this.state]);
    start.call(oscillator, when);
  };
  return oscillator;
};
window.notices = [];
window.Notification = class extends Notification {
  constructor(title, options) {
    super(title, options);
    window.notices.push(options.body);
  }
};
"""
"""Notes what is sounded and shown by the browser's own sound and notifications."""

BEHIND = "Object.defineProperty(document, 'hidden', { configurable: true, get: () => true })"
"""As in a tab behind another: a browser without a window shows all of them."""


def test_an_alarm_is_heard_and_noticed_by_who_does_not_look(browser: Browser, service: Service) -> None:
    context = new_context(browser, permissions=["notifications"])
    context.add_init_script(OBSERVED)
    context.route("**/scene/**", lambda route: route.fulfill(body="<!doctype html><p>no scene in this test</p>"))
    page = context.new_page()
    service.ask("/mission/commands", {"command": "reset", "configuration": "published_figures"})
    page.goto(f"{service.address}/#/alarms")
    expect(page.get_by_role("status", name="Data: Live")).to_be_visible()
    page.get_by_role("switch", name="Sound").click()
    page.get_by_role("switch", name="Notifications").click()
    page.evaluate(BEHIND)
    usual = next(each["limits"] for each in service.ask("/alarms/limits") if each["name"] == "target_spin")
    critical = {"watch": 0.3, "warning": 0.5, "critical": 0.9, "hysteresis": 0.05}
    service.ask("/alarms/limits/target_spin", critical, method="PUT")
    try:
        expect(page).to_have_title(re.compile("^.*‼"))
        assert page.evaluate("window.notices") == ["Critical: Spin of the target, 1 rad/s"]
        tones = page.evaluate("window.tones")
        assert tones[-3:] == [[880, "running"]] * 3, "three tones say that it is critical"
    finally:
        service.ask("/alarms/limits/target_spin", usual, method="PUT")
        context.close()
