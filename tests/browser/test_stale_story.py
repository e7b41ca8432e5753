"""A service that hangs: old data cannot be mistaken, commands wait, and all goes on by itself."""

from __future__ import annotations

import os
import signal

import pytest
from playwright.sync_api import Page, expect

from .conftest import Service

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(not hasattr(signal, "SIGSTOP"), reason="this system cannot hold up a process"),
]


def test_old_data_are_unmistakable_and_the_page_recovers(console: Page, service: Service) -> None:
    os.kill(service.process.pid, signal.SIGSTOP)
    try:
        expect(console.get_by_role("alert")).to_contain_text("s old")
        expect(console.get_by_role("status", name="Data: Stale")).to_be_visible()
        expect(console.get_by_role("button", name="Capture", exact=True)).to_have_attribute("aria-disabled", "true")
        expect(console.get_by_role("button", name="STOP")).to_be_enabled()
    finally:
        os.kill(service.process.pid, signal.SIGCONT)
    expect(console.get_by_role("status", name="Data: Live")).to_be_visible()
    expect(console.get_by_role("alert")).to_have_count(0)
    expect(console.get_by_role("button", name="Capture", exact=True)).to_have_attribute("aria-disabled", "false")
