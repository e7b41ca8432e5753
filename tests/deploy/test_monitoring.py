"""The files for Prometheus and Grafana ask for metrics that the service really has."""

from __future__ import annotations

import json
import re
from pathlib import Path

import httpx
import pytest
import yaml
from prometheus_client.parser import text_string_to_metric_families

from server.app import create_app
from server.settings import Settings

DEPLOY = Path(__file__).parents[2] / "deploy"
BOARD = json.loads((DEPLOY / "grafana" / "becalm.json").read_text())
NOT_YET = {
    "becalm_phase", "becalm_problems", "becalm_worst_tick_lateness_seconds", "becalm_tick_age_seconds",
    "becalm_runs", "becalm_disk_free_bytes", "becalm_link_age_seconds",
}  # fmt: skip
"""What there is once the service runs, or with a mission, a run or a link only."""


@pytest.fixture
async def names(tmp_path):
    """What a service says before its mission has begun."""
    app = create_app(Settings(data_dir=tmp_path, configuration="published_figures"))
    async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://localhost") as http:
        text = (await http.get("/metrics")).text
    return {sample.name for family in text_string_to_metric_families(text) for sample in family.samples}


def test_every_panel_asks_for_what_there_is(names):
    asked = set()
    for panel in BOARD["panels"]:
        for target in panel["targets"]:
            asked |= set(re.findall(r"\b(?:becalm|process)_[a-z_]+(?=\{instance)", target["expr"]))
    assert len(asked) > 12
    assert asked - names == NOT_YET


def test_panels_do_not_overlap():
    places = [panel["gridPos"] for panel in BOARD["panels"]]
    cells = [(x, y) for at in places for x in _span(at["x"], at["w"]) for y in _span(at["y"], at["h"])]
    assert len(cells) == len(set(cells))
    assert max(x for x, _ in cells) < 24


def _span(start: int, length: int) -> range:
    return range(start, start + length)


def test_prometheus_asks_at_the_right_address():
    (job,) = yaml.safe_load((DEPLOY / "prometheus" / "becalm.yml").read_text())
    assert job.get("metrics_path", "/metrics") == "/metrics"
    assert job["static_configs"][0]["targets"] == [f"127.0.0.1:{Settings().port}"]
