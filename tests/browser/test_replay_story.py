"""A recorded run is watched again: one clock for scene, plots and readings, by mouse and by keyboard."""

from __future__ import annotations

import re
import time
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from .conftest import Service

pytestmark = pytest.mark.browser

FLYING_TIME = 60.0


def _recorded(service: Service) -> dict[str, Any]:
    run = service.ask("/runs", {"configuration": "published", "direct": True})
    deadline = time.monotonic() + FLYING_TIME
    while run["status"] not in ("finished", "failed") and time.monotonic() < deadline:
        time.sleep(0.1)
        run = service.ask(f"/runs/{run['id']}")
    assert run["status"] == "finished"
    return dict(run)


def _clock(text: str) -> float:
    minutes, seconds = text.split(":")
    return 60 * float(minutes) + float(seconds)


def test_any_moment_of_a_run_is_shown_in_scene_plots_and_readings(console: Page, service: Service) -> None:
    run = _recorded(service)
    console.goto(f"{service.address}/#/runs/{run['id']}")
    replay = console.get_by_role("region", name="Replay in the scene")
    expect(replay.locator("iframe")).to_have_attribute("src", re.compile(r"^\./scene/playback/[0-9a-f]{16}/"))
    moment = replay.get_by_label("At this moment")
    expect(moment).to_contain_text("peak so far")

    scrubber = replay.get_by_role("slider", name="Moment of the run")
    scrubber.focus()
    scrubber.press("End")
    expect(moment.locator("[aria-current=step]")).to_contain_text("Holding")
    expect(moment).to_contain_text(f"{run['outcome']['peak_tip_force']:.3f} N")
    last = _clock(replay.locator("output").inner_text())
    assert abs(last - run["duration"]) < 2e-3

    replay.get_by_role("button", name="One tick back").click()
    assert abs(_clock(replay.locator("output").inner_text()) - (last - 1e-3)) < 1.1e-3
    scrubber.press("Home")
    expect(moment).to_contain_text("0.000 N")
    replay.get_by_role("button", name="Play").click()
    expect(replay.get_by_role("button", name="Pause")).to_be_visible()
    expect(replay.locator("output")).not_to_have_text("00:00.000")
    replay.get_by_role("button", name="Pause").click()


def test_a_click_into_a_plot_goes_to_that_moment_and_a_note_keeps_it(console: Page, service: Service) -> None:
    run = _recorded(service)
    console.goto(f"{service.address}/#/runs/{run['id']}")
    replay = console.get_by_role("region", name="Replay in the scene")
    expect(replay.get_by_label("At this moment")).not_to_contain_text("No data yet")
    console.get_by_role("region", name=f"Run {run['id']}").locator(".u-over").first.click(position={"x": 200, "y": 20})
    expect(replay.locator("output")).not_to_have_text("00:00.000")
    there = replay.locator("output").inner_text()

    console.get_by_label("A note on this run").fill("look here")
    console.get_by_role("checkbox", name=re.compile("At the time shown")).check()
    console.get_by_role("button", name="Add note").click()
    at = console.get_by_role("button", name=f"at {there}")
    expect(at).to_be_visible()
    replay.get_by_role("slider", name="Moment of the run").press("Home")
    at.click()
    expect(replay.locator("output")).to_have_text(there)


def test_layers_of_the_replay_are_its_own(console: Page, service: Service) -> None:
    run = _recorded(service)
    console.goto(f"{service.address}/#/runs/{run['id']}")
    replay = console.get_by_role("region", name="Replay in the scene")
    replay.get_by_role("button", name="Layers").click()
    trails = console.get_by_role("checkbox", name="trails")
    trails.uncheck()
    expect(trails).not_to_be_checked()
    assert service.ask("/scene")["layers"]["trails"]
