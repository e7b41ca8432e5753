"""A researcher asks a recorded run which numbers are behind it, beside others, and keeps what is found."""

from __future__ import annotations

import re
import time

import pytest
from playwright.sync_api import Page, expect

from .conftest import ARTIFACTS, PREPARING_TIME, Service

pytestmark = pytest.mark.browser

STRUCK = {
    "configuration": "testbed",
    "changes": {"simulation": {"engine": "reduced"}, "judging": {"time_limit": 5.0}, "contact": {"stiffness": 950.0}},
}
"""A run of one touch, by the right hand."""


CHOSEN = ("contact.stiffness", "robot.servo.time_constant")


def flown(service: Service, seed: int) -> str:
    """A run of the library."""
    run = str(service.ask("/runs", {**STRUCK, "seed": seed})["id"])
    deadline = time.monotonic() + PREPARING_TIME
    while (ended := service.ask(f"/runs/{run}"))["status"] in ("queued", "running"):
        assert time.monotonic() < deadline, f"run {run} is {ended['status']}"
        time.sleep(0.25)
    assert ended["status"] == "finished", ended["note"]
    return run


def test_a_run_is_fitted_with_others_and_what_is_found_is_kept(console: Page, service: Service) -> None:
    run, other, held = (flown(service, seed) for seed in (1, 2, 3))
    console.goto(f"{service.address}/#/runs/{run}")
    panel = console.get_by_role("region", name="Fit", exact=True)
    panel.get_by_text("Parameters").click()
    for box in panel.get_by_role("checkbox").all():
        box.set_checked(box.evaluate("box => box.labels[0].textContent") in CHOSEN)
    panel.get_by_text("Other runs").click()
    panel.get_by_label(re.compile(f"Fit too: .*{other[-6:]}")).check()
    panel.get_by_label(re.compile(f"Hold out: .*{held[-6:]}")).check()
    expect(panel.get_by_text("1 fitted too, 1 held out")).to_be_visible()
    with console.expect_response(lambda answer: answer.request.method == "POST" and "/fits" in answer.url) as begun:
        panel.get_by_role("button", name="Fit", exact=True).click()
    fit = str(begun.value.json()["id"])
    expect(panel.get_by_role("progressbar", name="Progress of the fit")).to_be_visible()
    console.reload()  # whoever leaves the page and comes back finds it again

    row = panel.get_by_role("row").filter(has=console.get_by_role("rowheader", name=re.compile("contact.stiffness")))
    expect(row).to_contain_text("950")
    found = service.ask(f"/fits/{fit}")
    assert (found["runs"], found["held_out"]) == ([run, other], [held])
    expect(panel.get_by_role("rowheader", name=re.compile(f"{held[-6:]}.*held out"))).to_be_visible()
    panel.get_by_label("Name of the preset").fill("as it struck")
    panel.get_by_role("button", name="Keep as preset").click()
    expect(panel.get_by_text("Kept as as it struck.")).to_be_visible()
    stiffness = next(each for each in found["result"]["parameters"] if each["name"] == "contact.stiffness")["value"]
    kept = next(each for each in service.ask("/presets") if each["name"] == "as it struck")
    assert kept["config"]["contact"]["stiffness"] == stiffness
    service.ask("/presets/as%20it%20struck", method="DELETE")
    panel.get_by_role("button", name="Use as the uncertainty model").click()
    expect(panel.get_by_text("Rehearsals take these errors")).to_be_visible()
    panel.screenshot(path=ARTIFACTS / "fit-panel.png")
