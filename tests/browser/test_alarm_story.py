"""An operator sets a limit, is told that it is gone beyond, acknowledges and shelves it, and tells the next shift."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Page, expect

from .conftest import ARTIFACTS, Service, choose

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
