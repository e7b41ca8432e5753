"""The documentation: a site that builds strictly and needs nothing from elsewhere; a list of licences that is whole."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from sim.config import PARAMETERS

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The site, built strictly: a link or an anchor that leads nowhere ends it."""
    folder = tmp_path_factory.mktemp("site")
    shutil.copytree(ROOT / "docs", folder / "docs")
    shutil.copy(ROOT / "zensical.toml", folder)
    done = _built(folder)
    assert done.returncode == 0, done.stderr
    return folder / "site"


def _built(folder):
    command = [sys.executable, "-m", "zensical", "build", "--strict"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def test_a_link_that_leads_nowhere_ends_the_build(site, tmp_path):
    shutil.copytree(site.parent / "docs", tmp_path / "docs")
    shutil.copy(site.parent / "zensical.toml", tmp_path)
    for target in ("nonesuch.md", "method.md#nonesuch"):
        (tmp_path / "docs" / "index.md").write_text(f"[there]({target})\n")
        assert _built(tmp_path).returncode != 0, target


def test_every_page_of_the_folder_is_on_the_site(site):
    pages = {path.relative_to(ROOT / "docs").with_suffix("") for path in (ROOT / "docs").rglob("*.md")}
    assert pages == {path.relative_to(site).with_suffix("") for path in site.rglob("*.html")} - {Path("404")}


def test_equations_are_drawn_without_a_script(site):
    method = (site / "method.html").read_text()
    assert method.count("<math") > 40
    assert "arithmatex" not in method


def test_the_site_loads_nothing_from_elsewhere(site):
    loads = re.compile(
        r'<(?:script|img|iframe)[^>]*\ssrc="(https?:[^"]*)|<link[^>]*stylesheet[^>]*href="(https?:[^"]*)'
    )
    pages = list(site.rglob("*.html"))
    assert pages
    for page in pages:
        assert not loads.findall(page.read_text()), page.name


def test_every_package_that_becalm_needs_is_among_the_licences():
    script = ROOT / "docs" / "hooks" / "licences.py"
    done = subprocess.run([sys.executable, str(script), "--check"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_the_readme_counts_the_parameters_that_there_are():
    counted = re.search(r"Any of the (\d+) parameters", (ROOT / "README.md").read_text(encoding="utf-8"))
    assert counted is not None
    assert int(counted[1]) == len(PARAMETERS)
