"""What a parameter is: a number or a choice with unit, bounds, default and source, in a frozen group of its own.

`sim.config` puts the groups together; a method declares its own beside itself (`sim/method/*/parameters.py`).
"""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field, JsonValue

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
WholeNumber = Annotated[int, Field(strict=True)]

FARTHEST = 10.0
"""Largest coordinate of a point, either way [m]."""
Coordinate = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-FARTHEST, le=FARTHEST)]
Points = tuple[Annotated[tuple[Coordinate, ...], Field(min_length=2, max_length=2)], ...]
"""A list of points (x, y) [m]: the one kind of parameter that is no single number or choice."""

LIVE = "live"
"""Marks a parameter that may change while a mission flies; the others require a reset."""


def parameter(
    default: Any,
    description: str,
    *,
    unit: str,
    source: str,
    live: bool = False,
    gt: float | None = None,
    ge: float | None = None,
    le: float | None = None,
    lt: float | None = None,
    fewest: int | None = None,
    most: int | None = None,
) -> Any:
    """A field of the configuration with its unit, bounds, default and source in the schema.

    Bounds are of a number, `fewest` and `most` of how many points a list of them has.
    """
    extra: dict[str, JsonValue] = {"unit": unit, "source": source, LIVE: live}
    return Field(
        default,
        description=description,
        json_schema_extra=extra,
        gt=gt,
        ge=ge,
        le=le,
        lt=lt,
        min_length=fewest,
        max_length=most,
    )


def points_text(points: Points) -> str:
    """Points as they are written in a field and after `--set`, such as `0, 0; 0.2, 0; 0, 0.1`."""
    return "; ".join(f"{x:.7g}, {y:.7g}" for x, y in points)


class ConfigModel(BaseModel):
    """Frozen, nothing unknown, no NaN: the base of every part of the configuration."""

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True)


class MethodConfig(ConfigModel):
    """The parameters of a method: the base of its group."""

    target_shapes: ClassVar[tuple[str, ...] | None] = None
    """The choices of `target.shape` that the method can capture; None if it can any."""
    why_these_shapes: ClassVar[str] = ""
    """What of the method needs one of them, as the end of a refusal."""
    opposite_sides: ClassVar[bool] = False
    """Whether a polygon must have a side opposite each, so that `target.sides` must be even."""
