"""The one way that numeric code is compiled: numba, cached on disk, IEEE arithmetic (no fast-math).

numba's own cache looks at the file of a function only, not at those of the functions that it calls; so the
cache's folder is named by a digest of every source that compiled code comes from, and a change compiles again.
"""

from __future__ import annotations

import hashlib
import os
import stat
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import numba
import numpy as np
import platformdirs

FloatArray = np.ndarray[Any, np.dtype[np.float64]]
"""Double-precision array; the docstring of the function that takes or returns it says its shape."""

_P = ParamSpec("_P")
_R = TypeVar("_R")


_ABOVE = ("study", "reproduction")
"""The packages that no compiled code calls into; numba tracks their own few functions itself."""


def cache_folder() -> Path:
    """Where the compiled code of these sources is kept: under NUMBA_CACHE_DIR, else the platform's cache folder.

    A user whose home is missing or read-only gets a folder of their own in the temporary directory.
    """
    room = Path(__file__).parent
    digest = hashlib.sha256()
    sources = [path for path in room.rglob("*.py") if path.relative_to(room).parts[0] not in _ABOVE]
    for path in sorted(sources):
        digest.update(path.relative_to(room).as_posix().encode() + b"\0" + path.read_bytes())
    base = os.environ.get("NUMBA_CACHE_DIR") or _users_folder() or _temporary_folder()
    return Path(base, f"compiled-{digest.hexdigest()[:16]}")


def _users_folder() -> str | None:
    """The platform's cache folder, if this user can write to it."""
    try:
        folder = platformdirs.user_cache_dir("becalm")
        os.makedirs(folder, exist_ok=True)
    except (RuntimeError, OSError):
        return None
    return folder if os.access(folder, os.W_OK | os.X_OK) else None


def _temporary_folder() -> str:
    """A folder that only this user can write to, since its code is run; shared by their processes if possible."""
    folder = Path(tempfile.gettempdir(), f"becalm-compiled-{os.getuid()}")
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        found = folder.lstat()
    except OSError:
        return tempfile.mkdtemp(prefix="becalm-compiled-")
    ours = stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and not stat.S_IMODE(found.st_mode) & 0o077
    return str(folder) if ours else tempfile.mkdtemp(prefix="becalm-compiled-")


numba.config.CACHE_DIR = str(cache_folder())  # type: ignore[attr-defined]  # numba fills its config at import


def compiled(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """A function of numbers, arrays and records, compiled at its first call.

    Bitwise repeatability over processes and machines of one architecture rests on the strict arithmetic.
    """
    result: Callable[_P, _R] = numba.njit(cache=True, error_model="numpy")(function)
    return result
