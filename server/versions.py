"""Which software made a run: stored with each of them, and shown by the service."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version

RECORDED = ("becalm", "numba", "numpy", "pymunk")
"""The packages whose version can change a number."""


def becalm_version() -> str:
    """The installed version of Becalm."""
    return _version("becalm")


def versions() -> dict[str, str]:
    """Python and every package that can change a number, with their versions."""
    return {"python": platform.python_version(), **{name: _version(name) for name in RECORDED}}


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"
