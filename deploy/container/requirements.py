"""Prints what a project's pyproject.toml requires, with the extras that are named: `requirements.py FILE EXTRA...`."""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path

project = tomllib.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))["project"]
extras = (project["optional-dependencies"][name] for name in sys.argv[2:])
print("\n".join([*project["dependencies"], *(each for extra in extras for each in extra)]))
