"""Which values a parameter takes in a study: listed, in a range, or drawn from a distribution.

Everything here is checked when it is read, so that an invalid study is refused before anything flies.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from enum import StrEnum
from functools import cache
from typing import Annotated, Any, Self, cast

import numpy as np
import scipy
from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    JsonValue,
    TypeAdapter,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_validator,
)

from sim.compiled import FloatArray
from sim.config import PARAMETERS
from sim.configurations import bracketed_unit, unknown_parameter
from sim.parameters import Number, Points, WholeNumber
from sim.schema_history import PARAMETER_CHANGES, change_of

Value = float | int | str
"""Of a parameter: a number, a whole number, or the name of a choice."""

LONGEST_AXIS = 1_000_000
"""Values of one axis, and draws of one sample: more are taken for a typing error."""

_NEITHER = "give a list of values, or from, to and either step or count"
_DIGITS = 12
_STEP_TOLERANCE = 1e-6  # of a step: 3 steps of 0.1 end at 0.3, however they are rounded
_SMALLEST_TAIL = 1e-12  # a point at the very edge of the unit cube would be infinitely far out


class StudyModel(BaseModel):
    """Frozen, nothing unknown: the base of every part of a study's definition."""

    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=True)


class Spacing(StrEnum):
    """On which scale values are evenly spaced."""

    LINEAR = "linear"
    LOGARITHMIC = "logarithmic"


class SampleMethod(StrEnum):
    """How the points of a sample are spread over the unit cube."""

    RANDOM = "random"
    """Independent of each other."""
    LATIN_HYPERCUBE = "latin_hypercube"
    """One point in each of `count` slices of every axis (McKay, Beckman, Conover 1979)."""
    SOBOL = "sobol"
    """Scrambled Sobol sequence: low discrepancy; `count` is a power of two."""


class Axis(StudyModel):
    """The values of one parameter on a grid: a list, or a range with both ends, by `step` or by `count`.

    Values of a range are rounded to 12 significant digits, so that 0.1 times 3 is 0.3.
    """

    values: tuple[JsonValue, ...] | None = None
    start: Number | None = Field(None, alias="from")
    stop: Number | None = Field(None, alias="to")
    step: Number | None = None
    count: WholeNumber | None = None
    spacing: Spacing = Spacing.LINEAR

    @model_validator(mode="before")
    @classmethod
    def _plain_list(cls, given: Any) -> Any:
        if isinstance(given, list | tuple):
            return {"values": given}
        if not isinstance(given, Mapping | Axis):
            raise ValueError(_NEITHER)
        return given

    @model_validator(mode="after")
    def _is_a_list_or_a_range(self) -> Self:
        given = {name for name in ("start", "stop", "step", "count") if getattr(self, name) is not None}
        if self.values is not None:
            if given or not self.values:
                raise ValueError("the list of values is empty" if not given else "give a list or a range, not both")
        elif given not in ({"start", "stop", "step"}, {"start", "stop", "count"}):
            raise ValueError(_NEITHER)
        elif self._length() < 1:
            raise ValueError("the range is empty")
        elif self._length() > LONGEST_AXIS:
            raise ValueError(f"the range has {self._length():.3g} values; at most {LONGEST_AXIS} are allowed")
        else:
            _require_spacing(self.spacing, self.start, self.stop, stepped=self.step is not None)
        return self

    def listed(self) -> tuple[Any, ...]:
        """All values in their order, as they were written or as the range gives them."""
        if self.values is not None:
            return self.values
        assert self.start is not None
        assert self.stop is not None
        length = int(self._length())
        if self.step is not None:
            spread = self.start + self.step * np.arange(length)
        elif self.spacing is Spacing.LOGARITHMIC:
            spread = np.geomspace(self.start, self.stop, length)
        else:
            spread = np.linspace(self.start, self.stop, length)
        return tuple(float(f"{value:.{_DIGITS}g}") for value in spread)

    def _length(self) -> float:
        """How many values the range has; less than 1 if it is empty."""
        assert self.start is not None
        assert self.stop is not None
        if self.stop < self.start:
            return 0
        if self.count is not None:
            return self.count
        assert self.step is not None
        if self.step <= 0.0:
            return 0
        return 1.0 + float(np.floor((self.stop - self.start) / self.step + _STEP_TOLERANCE))


class Distribution(StudyModel):
    """What one parameter is drawn from.

    Uniform between `from` and `to`; or normal, if `mean` and `deviation` are given, and then cut at `from` and `to`
    where those are.
    """

    start: Number | None = Field(None, alias="from")
    stop: Number | None = Field(None, alias="to")
    spacing: Spacing = Spacing.LINEAR
    mean: Number | None = None
    deviation: Number | None = Field(None, gt=0)

    @model_validator(mode="after")
    def _is_uniform_or_normal(self) -> Self:
        if (self.mean is None) != (self.deviation is None):
            raise ValueError("a normal distribution needs mean and deviation")
        if self.mean is None and (self.start is None or self.stop is None):
            raise ValueError("give from and to for a uniform distribution, mean and deviation for a normal one")
        if self.start is not None and self.stop is not None and self.stop <= self.start:
            raise ValueError(f"the range from {self.start:g} to {self.stop:g} is empty")
        if self.mean is not None and self.spacing is not Spacing.LINEAR:
            raise ValueError("only a uniform distribution can be logarithmic")
        _require_spacing(self.spacing, self.start, self.stop, stepped=False)
        return self

    def quantiles(self, fractions: FloatArray) -> FloatArray:
        """The values below which these fractions of the distribution lie, shape as given."""
        if self.mean is not None:
            return self._normal_quantiles(np.clip(fractions, _SMALLEST_TAIL, 1.0 - _SMALLEST_TAIL))
        assert self.start is not None
        assert self.stop is not None
        if self.spacing is Spacing.LOGARITHMIC:
            return np.asarray(self.start * (self.stop / self.start) ** fractions)
        return self.start + (self.stop - self.start) * fractions

    def _normal_quantiles(self, fractions: FloatArray) -> FloatArray:
        mean, deviation = self.mean, self.deviation
        assert mean is not None
        assert deviation is not None
        if self.start is None and self.stop is None:
            return np.asarray(scipy.stats.norm.ppf(fractions, mean, deviation))
        low = -math.inf if self.start is None else (self.start - mean) / deviation
        high = math.inf if self.stop is None else (self.stop - mean) / deviation
        return np.asarray(scipy.stats.truncnorm.ppf(fractions, low, high, mean, deviation))


class Samples(StudyModel):
    """Points drawn over several parameters at once; the study's seed decides which."""

    method: SampleMethod = SampleMethod.LATIN_HYPERCUBE
    count: WholeNumber = Field(ge=1, le=LONGEST_AXIS)
    over: dict[str, Distribution] = Field(min_length=1)

    @field_validator("count")
    @classmethod
    def _sobol_takes_powers_of_two(cls, count: int, given: ValidationInfo) -> int:
        below = 2 ** (count.bit_length() - 1)
        if given.data.get("method") is SampleMethod.SOBOL and count != below:
            raise ValueError(f"sobol needs a power of two, such as {below} or {2 * below}")
        return count

    def points(self, generator: np.random.Generator) -> FloatArray:
        """The drawn values; shape (count, parameters), columns in the order of `over`."""
        cube = self._cube(generator)
        columns = [of.quantiles(cube[:, place]) for place, of in enumerate(self.over.values())]
        return np.column_stack(columns)

    def _cube(self, generator: np.random.Generator) -> FloatArray:
        width = len(self.over)
        if self.method is SampleMethod.RANDOM:
            return generator.random((self.count, width))
        if self.method is SampleMethod.SOBOL:
            return np.asarray(scipy.stats.qmc.Sobol(width, rng=generator).random_base2(self.count.bit_length() - 1))
        return np.asarray(scipy.stats.qmc.LatinHypercube(width, rng=generator).random(self.count))


def _require_spacing(spacing: Spacing, start: float | None, stop: float | None, *, stepped: bool) -> None:
    if spacing is Spacing.LINEAR:
        return
    if stepped:
        raise ValueError("a logarithmic range takes a count, not a step")
    if start is None or stop is None or start <= 0.0:
        raise ValueError("a logarithmic range begins above 0")


@cache
def _adapter(path: str) -> TypeAdapter[Any]:
    field = PARAMETERS[path]
    bounded: Any = Annotated[(field.annotation, *field.metadata)] if field.metadata else field.annotation
    return TypeAdapter(bounded)


def is_whole(path: str) -> bool:
    """Whether that parameter takes whole numbers only."""
    return path in PARAMETERS and PARAMETERS[path].annotation is int


def is_number(path: str) -> bool:
    """Whether that parameter takes any number between its bounds; of a removed one any value is kept."""
    return path not in PARAMETERS or PARAMETERS[path].annotation is float


def why_gone(path: str) -> str | None:
    """Why a former parameter was removed; None for one that exists, and for one that never did."""
    change = change_of(path, PARAMETER_CHANGES)
    return None if change is None or change.new is not None else change.why


def require_parameter(path: str, where: str) -> None:
    """Refuse a path that is not a parameter.

    Raises:
        ValueError: it is not; the message names the nearest one.

    """
    if path not in PARAMETERS:
        raise ValueError(f"{where}.{unknown_parameter(path)}")


def require_axis(path: str, where: str) -> None:
    """Refuse a path that is not a parameter, or whose values a table has no column for.

    Raises:
        ValueError: the message says why.

    """
    require_parameter(path, where)
    if PARAMETERS[path].annotation == Points:
        raise ValueError(
            f"{where}.{path} cannot vary within a study: it is a list of points, and a column of the table holds one "
            f"number or choice; give it under changes, in a study of its own for each"
        )


def checked(path: str, value: Any, where: str) -> Value:
    """The value as that parameter keeps it: within its bounds, and of its type; unchanged for a removed one.

    Raises:
        ValueError: it is not; the message names parameter, value, bound and unit.

    """
    if path not in PARAMETERS:
        return cast(Value, value)
    if is_whole(path) and isinstance(value, float) and value.is_integer():
        value = int(value)
    try:
        kept = _adapter(path).validate_python(value)
    except ValidationError as error:
        problem = error.errors(include_url=False)[0]["msg"]
        raise ValueError(f"{where}.{path} = {value!r}: {problem}{bracketed_unit(path)}") from None
    return kept.value if isinstance(kept, StrEnum) else kept


def parameter_words(path: str) -> tuple[str, str]:
    """Unit and description of that parameter; of a removed one why it was."""
    if path not in PARAMETERS:
        return "1", f"No longer a parameter: {why_gone(path)}"
    field = PARAMETERS[path]
    return field.json_schema_extra["unit"], field.description
