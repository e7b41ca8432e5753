"""Writes `docs/licences.md`, what Becalm needs to run and under which licences; `--check` only looks at it."""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Iterator
from importlib.metadata import PackageMetadata, distribution
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "licences.md"
EXTRAS = ("", "cluster", "dataframe")

HEAD = """# Licences

Becalm is under the MIT licence. It contains no code of others; these are what it needs to run, with the
versions of `requirements.lock`, as their authors state their licences.
The page is written by `python docs/hooks/licences.py` and checked by the tests.
"""


def needed(name: str, extras: tuple[str, ...] = ("",), found: set[str] | None = None) -> set[str]:
    """The names of all packages that this one needs on this machine, itself included."""
    found = set() if found is None else found
    if (canonical := canonicalize_name(name)) in found:
        return found
    found.add(canonical)
    for text in distribution(name).requires or []:
        requirement = Requirement(text)
        if requirement.marker is None or any(requirement.marker.evaluate({"extra": extra}) for extra in extras):
            needed(requirement.name, ("", *requirement.extras), found)
    return found


def licence(about: PackageMetadata) -> str:
    """What a package says its licence is: as an expression, by its classifiers, or in words."""
    expression = about.get("License-Expression")
    if expression:
        return expression
    classified = [each.split(" :: ")[-1] for each in about.get_all("Classifier", []) if each.startswith("License ::")]
    words = (about.get("License") or "").strip().splitlines()
    return ", ".join(each for each in classified if each != "OSI Approved") or (words[0] if words else "not stated")


def python_rows() -> Iterator[tuple[str, str, str]]:
    """Name, version and licence of every Python package."""
    for name in sorted(needed("becalm", EXTRAS) - {"becalm"}):
        found = distribution(name)
        yield name, found.version, licence(found.metadata)


def web_rows() -> Iterator[tuple[str, str, str]]:
    """The same of every package that the built console may contain."""
    packages = json.loads((ROOT / "web" / "package-lock.json").read_text(encoding="utf-8"))["packages"]
    own = packages[""]["dependencies"]
    for path, about in sorted(packages.items()):
        name = path.removeprefix("node_modules/")
        if name in own:
            yield name, about["version"], about.get("license", "not stated")


def page() -> str:
    """The whole page."""
    parts = [HEAD]
    for title, rows in (("Python", python_rows()), ("The console in the browser", web_rows())):
        lines = [f"| {name} | {version} | {said} |" for name, version, said in rows]
        parts += [f"## {title}\n", "| package | version | licence |\n|---|---|---|", *lines, ""]
    return "\n".join(parts)


def listed(text: str) -> set[str]:
    """The names of the packages on a page."""
    return set(re.findall(r"^\| (\S+) \| \d", text, re.M))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="say what is not on the page, and write nothing")
    if parser.parse_args().check:
        missing = listed(page()) - listed(PAGE.read_text(encoding="utf-8"))
        sys.exit(f"not on {PAGE.name}: {', '.join(sorted(missing))}" if missing else 0)
    PAGE.write_text(page(), encoding="utf-8")
