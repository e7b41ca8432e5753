"""A researcher starts a study, watches its map fill, takes it away, and opens one of its cells in the scene."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from .conftest import ARTIFACTS, Service

pytestmark = pytest.mark.browser

STUDY_TIME = 180_000
"""Three captures, flown at a low priority on a machine that also runs the browser [ms]."""


def test_a_study_from_its_form_to_a_cell_in_the_scene(console: Page, service: Service, tmp_path: Path) -> None:
    console.get_by_role("link", name="Studies").click()
    expect(console.get_by_role("button", name="STOP")).to_be_enabled()
    console.get_by_role("button", name="Custom study").click()
    console.get_by_label("Name").fill("three dampings")
    console.get_by_role("combobox", name="Grid, values 1").fill("0,5")
    expect(console.get_by_text("write 0.5")).to_be_visible()
    expect(console.get_by_role("button", name="Start")).to_be_disabled()
    console.get_by_role("combobox", name="Grid, values 1").fill("3 .. 6 by 1.5")
    expect(console.get_by_text("3 cells, about")).to_be_visible()
    console.get_by_role("button", name="Start").click()

    head = console.get_by_role("region", name="Study three dampings")
    expect(head.get_by_role("status")).to_contain_text("finished, 3 of 3 cells", timeout=STUDY_TIME)
    cells = console.locator("[data-cell]")
    expect(cells).to_have_count(3)
    study = service.ask("/studies")["studies"][0]["id"]
    rows = service.ask(f"/studies/{study}/rows")["rows"]
    for row in rows:
        expect(console.locator(f"[data-cell='{row['cell']}']")).to_have_attribute("data-shown", row["outcome"])

    with console.expect_download() as download:
        console.get_by_role("button", name="Export the map").click()
        console.get_by_role("menuitem", name="SVG").click()
    picture = tmp_path / "map.svg"
    download.value.save_as(picture)
    root = ET.parse(picture).getroot()
    assert root.tag.endswith("svg")
    words = "".join(root.itertext())
    assert "three dampings: outcome" in words
    assert "configuration published · 3 cells" in words

    console.get_by_text("Each parameter", exact=True).click()
    alone = console.get_by_role("img", name="outcome over impedance damping [N·s/m]")
    expect(alone.locator("title")).to_have_count(3)
    other = service.ask("/studies", {"study": {"name": "the other", "grid": {"published.impedance.damping": [3.0]}}})[
        "id"
    ]
    console.get_by_role("link", name="Compare: the other").click()
    expect(console).to_have_url(re.compile(f"#/studies/{study}/{other}$"))
    expect(console.get_by_role("region", name="Study the other")).to_be_visible()
    expect(console.get_by_role("heading", name="Comparison")).to_be_visible()
    console.get_by_role("link", name="End comparison").click()
    head.get_by_text("Map", exact=True).click()
    with console.expect_download() as report:
        console.get_by_role("link", name="Download the report of this study as PDF").click()
    assert report.value.path().read_bytes().startswith(b"%PDF")

    console.locator("[data-cell='1']").click()
    chosen = next(row for row in rows if row["cell"] == 1)
    cell = console.locator("section", has=console.get_by_role("heading", name="Cell 1"))
    expect(cell).to_contain_text(f"{chosen['peak_tip_force']:.3f} N")
    console.screenshot(path=ARTIFACTS / "studies.png")
    service.reset_when_prepared(changes={"simulation": {"engine": "reduced"}})  # as the study flew it
    service.ask("/mission/commands", {"command": "reset", "configuration": "published_figures"})  # no edit to be lost
    cell.get_by_role("button", name="Set up as live mission").click()
    expect(console).to_have_url(re.compile("#/mission|/$"))
    assert service.ask("/mission")["phase"] == "idle"  # an operator flies it
    flown = service.ask("/mission/config")["config"]
    assert flown["published"]["impedance"]["damping"] == chosen["published.impedance.damping"]
    assert flown["simulation"]["seed"] == chosen["seed"]
