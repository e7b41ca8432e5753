"""What is released: a wheel that brings the built console and needs no Node, and the sources that it is built from."""

from __future__ import annotations

import re
import subprocess
import sys
import sysconfig
import tarfile
import tomllib
import venv
import zipfile
from pathlib import Path

import httpx
import pytest

from server.versions import becalm_version

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
PATIENCE = 180.0


def _built(target: str, folder: Path) -> Path:
    command = [sys.executable, "-m", "hatchling", "build", "--target", target, "--directory", str(folder)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True, timeout=5 * PATIENCE)
    (built,) = folder.iterdir()
    return built


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """Of this tree; a console that is up to date is not built again."""
    return _built("wheel", tmp_path_factory.mktemp("wheel"))


def test_the_wheel_brings_the_console_and_nothing_else_of_the_tree(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    assert "server/static/index.html" in names
    assert any(re.fullmatch(r"server/static/assets/.*\.js", name) for name in names)
    rooms = {name.split("/")[0] for name in names}
    assert rooms == {"becalm", "sim", "server", f"becalm-{PROJECT['version']}.dist-info"}


def test_the_sources_hold_what_the_console_is_built_from(tmp_path):
    with tarfile.open(_built("sdist", tmp_path)) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    assert {"pyproject.toml", "requirements.lock", "web/package-lock.json", "web/build_hook.py", "LICENSE"} <= names
    assert "web/src/main.tsx" in names
    assert not [name for name in names if name.startswith(("server/static", "web/node_modules"))]


def test_the_version_comes_from_one_place():
    assert becalm_version() == PROJECT["version"]
    elsewhere = subprocess.run(
        ["git", "grep", "-lF", f'"{PROJECT["version"]}"', "--", "*.py", "*.toml", "*.json", "*.yml", "Dockerfile"],
        cwd=ROOT, capture_output=True, text=True, check=False,
    ).stdout.split()  # fmt: skip
    examples = {"server/api/health.py", "web/openapi.json"}
    assert {path for path in elsewhere if "package-lock" not in path} - examples == {"pyproject.toml"}


def test_the_wheel_serves_its_console_where_there_is_no_node(wheel, tmp_path):
    """Installed by pip; what it requires is lent from this environment, where it is installed as the lock says."""
    environment = tmp_path / "clean"
    venv.create(environment, with_pip=False)
    python = environment / "bin" / "python"
    pip = [sys.executable, "-m", "pip", "--python", str(python), "install", "--no-deps", "--no-index", str(wheel)]
    subprocess.run(pip, check=True, capture_output=True, timeout=PATIENCE)
    (site,) = (environment / "lib").glob("python*/site-packages")
    (site / "lent.pth").write_text(sysconfig.get_path("purelib") + "\n")
    alone = {"PATH": str(environment / "bin"), "HOME": str(tmp_path), "BECALM_DATA_DIR": str(tmp_path / "data"),
             "NUMBA_CACHE_DIR": str(tmp_path / "compiled")}  # fmt: skip
    asks = [python, "-c", "import server; print(server.__file__)"]
    where = subprocess.run(asks, env=alone, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert Path(where.stdout.strip()).is_relative_to(environment)
    command = [environment / "bin" / "becalm", "serve", "--port", "0", "--no-open"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=alone, cwd=tmp_path) as process:
        try:
            url = re.search(r"http://\S+/", process.stdout.readline())[0]
            page = httpx.get(url, timeout=PATIENCE)
            script = re.search(r'src="\./(assets/[^"]+\.js)"', page.text)[1]
            assert page.status_code == httpx.get(url + script, timeout=PATIENCE).status_code == 200
        finally:
            process.kill()
