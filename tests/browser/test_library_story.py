"""A researcher finds a run in the library, reads it, stars and annotates it, and deletes another."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Page, expect

from .conftest import ARTIFACTS, Service, choose, is_amber, press

pytestmark = pytest.mark.browser


def _flown(service: Service, **request: object) -> str:
    run = service.ask("/runs", {"configuration": "published", **request})["id"]
    return str(run)


def test_runs_are_found_read_annotated_and_deleted(console: Page, service: Service) -> None:
    direct, seeded = _flown(service, direct=True), _flown(service, seed=11)
    console.get_by_role("link", name="Runs", exact=True).click()
    expect(console.get_by_role("button", name="STOP")).to_be_enabled()
    table = console.get_by_role("region", name="Table of runs")
    choose(console, "Kind", "scripted")
    mine = table.locator(f"[data-run='{direct}']")
    expect(mine.locator("[data-column=outcome]")).to_contain_text(re.compile("caged|collision|ejection"))
    mine.get_by_role("link").first.click()
    library = console.get_by_role("list", name="Runs", exact=True)

    view = console.get_by_role("region", name=f"Run {direct}")
    expect(view.get_by_role("status").first).to_contain_text("finished")
    expect(view.get_by_role("log", name="Events")).to_contain_text("Caged with a margin")
    expect(view.get_by_role("heading", name="Caged after unplanned contact")).to_be_visible()
    view.get_by_role("button", name="Star this run").click()
    view.get_by_label("A note on this run").fill("the comparison of the paper")
    view.get_by_role("button", name="Add note").click()
    expect(view.get_by_text("the comparison of the paper")).to_be_visible()
    console.screenshot(path=ARTIFACTS / "library.png")
    kept = service.ask(f"/runs/{direct}")
    assert (kept["starred"], kept["notes"][0]["text"]) == (True, "the comparison of the paper")

    items = library.get_by_role("listitem")
    console.get_by_label("Search runs").fill("COMPARISON")
    expect(items).to_have_count(1)
    console.reload()
    expect(items).to_have_count(1)  # the address keeps what is asked for
    console.get_by_label("Search runs").fill("")
    console.get_by_label("Starred only").click()
    expect(items).to_have_count(1)
    console.get_by_label("Starred only").click()
    expect(items.filter(has=console.locator(f"a[href^='#/runs/{seeded}']"))).to_have_count(1)

    library.locator(f"a[href^='#/runs/{seeded}']").first.click()
    other = console.get_by_role("region", name=f"Run {seeded}")
    expect(other.get_by_role("status").first).to_contain_text("finished")

    entry = library.get_by_role("listitem").filter(has=console.locator(f"a[href^='#/runs/{direct}']"))
    entry.hover()
    entry.get_by_role("link", name="Compare").click()
    both = other.get_by_role("region", name="Comparison")
    expect(both.get_by_role("row", name=re.compile("^Seed"))).to_contain_text("11")
    expect(both.get_by_role("row", name=re.compile("^Peak to closure"))).to_be_visible()
    curves = other.get_by_role("figure", name=re.compile("^Tip force")).locator("i")
    expect(curves).to_have_count(2)  # the second run's readings beside the first's
    expect(curves.first).to_have_text(re.compile(r"^\d"))
    console.screenshot(path=ARTIFACTS / "compared.png")
    both.get_by_role("link", name="End comparison").click()
    expect(curves).to_have_count(0)

    other.get_by_role("button", name="Delete").click()
    other.get_by_role("button", name="Delete permanently?").click()
    expect(table.locator(f"[data-run='{direct}']")).to_be_visible()
    expect(table.locator(f"[data-run='{seeded}']")).to_have_count(0)
    assert seeded not in [run["id"] for run in service.ask("/runs")["runs"]]


def test_many_runs_are_read_and_tagged_together(console: Page, service: Service) -> None:
    runs = [_flown(service, direct=True), _flown(service, seed=12)]
    console.goto(f"{service.address}/#/runs?sort=-started")
    table = console.get_by_role("region", name="Table of runs")
    for run in runs:
        expect(table.locator(f"[data-run='{run}'] [data-column=outcome]")).to_contain_text("caged")
        table.get_by_role("checkbox", name=f"Select run {run}").click()
    selected = console.get_by_role("region", name="2 runs selected")
    expect(selected.get_by_role("row", name=re.compile("^Peak force"))).to_contain_text("2")
    selected.get_by_role("button", name="Tag", exact=True).click()
    console.get_by_label("Tags for the selected runs").fill("pair")
    console.get_by_role("button", name="Add", exact=True).click()
    expect(selected.get_by_text("2 runs tagged.")).to_be_visible()
    assert [service.ask(f"/runs/{run}")["tags"] for run in runs] == [["pair"], ["pair"]]

    selected.get_by_role("button", name="Plot together").click()
    plot = console.get_by_role("application", name=re.compile("hand_force"))
    expect(plot.locator("path[stroke-width='1.6']")).to_have_count(2)
    console.get_by_role("combobox", name="Upright").fill("target.twist.angle * ")
    expect(console.get_by_text("it ends too early")).to_be_visible()
    console.get_by_role("combobox", name="Upright").fill("target.twist.angle * 2")
    expect(console.get_by_role("application", name="target.twist.angle * 2, rad/s over")).to_be_visible()
    plot = console.get_by_role("application")
    plot.press("ArrowRight")
    expect(console.get_by_role("region", name="2 runs", exact=True).locator("output").last).to_have_text(
        re.compile(r"\d")
    )
    console.screenshot(path=ARTIFACTS / "overlay.png")

    console.goto(f"{service.address}/#/runs/{runs[0]}?t=2.5&from=2&to=3")
    view = console.get_by_role("region", name=f"Run {runs[0]}")
    expect(view.get_by_role("group", name="Replay").locator("output")).to_have_text("00:02.500")
    expect(view.get_by_role("button", name="Whole run")).to_be_visible()
    view.get_by_role("button", name="One tick forward").click()
    expect(console).to_have_url(re.compile(r"t=2\.501&from=2&to=3$"))


def test_a_paused_mission_goes_back_and_a_run_goes_on_from_a_moment(console: Page, service: Service) -> None:
    press(console, "Detumble")
    clock = console.get_by_role("timer", name="Mission time")
    press(console, "Pause")
    choose(console, "Ticks per step", "100 ticks")
    press(console, "Step")
    parent = service.ask("/mission")
    expect(clock).to_contain_text(f"{parent['time']:06.3f}")  # from what is seen it goes back
    press(console, "Back")
    expect(clock).to_contain_text(f"{parent['time'] - 0.1:06.3f}")
    fork = service.ask("/mission")
    assert (fork["tick"], fork["phase"]) == (parent["tick"] - 100, "detumbling")
    assert service.ask(f"/runs/{fork['run_id']}")["parent"] == parent["run_id"]

    run = _flown(service, direct=True)
    console.goto(f"{service.address}/#/runs/{run}")
    view = console.get_by_role("region", name=f"Run {run}")
    expect(view.get_by_role("status").first).to_contain_text("finished")
    view.get_by_label("Moment of the run in seconds").fill("1.5")
    view.get_by_role("button", name="Fork here", exact=True).click()
    asked = view.get_by_role("region", name="Fork from a moment").get_by_role("status")
    expect(asked).to_contain_text("The mission in progress will end.")
    go = view.get_by_role("button", name="Go: Fork here")
    assert is_amber(go)
    expect(go).to_have_text(re.compile("[1-5] s"))  # later than the second half of a double click
    go.click()
    expect(console.get_by_role("list", name="Phases").locator("[aria-current=step]")).to_contain_text("Caging")
    expect(clock).to_contain_text("01.499")
    console.screenshot(path=ARTIFACTS / "fork.png")
