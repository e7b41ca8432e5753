"""The one way that numeric code is compiled: numba, cached on disk, IEEE arithmetic (no fast-math)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

import numba
import numpy as np

FloatArray = np.ndarray[Any, np.dtype[np.float64]]
"""Double-precision array; the docstring of what takes or gives it tells its shape."""

_P = ParamSpec("_P")
_R = TypeVar("_R")


def compiled(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """A function of numbers, arrays and records, compiled at its first call.

    Bitwise repeatability over processes and machines of one architecture rests on the strict arithmetic.
    """
    result: Callable[_P, _R] = numba.njit(cache=True, error_model="numpy")(function)
    return result
