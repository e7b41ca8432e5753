"""What a parameter is: a number or a choice with unit, bounds, default and source, in a frozen group of its own.

`sim.config` puts the groups together; a method declares its own beside itself (`sim/method/*/parameters.py`).
"""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field, JsonValue

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
WholeNumber = Annotated[int, Field(strict=True)]

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
) -> Any:
    """A field of the configuration with its unit, bounds, default and source in the schema."""
    extra: dict[str, JsonValue] = {"unit": unit, "source": source, LIVE: live}
    return Field(default, description=description, json_schema_extra=extra, gt=gt, ge=ge, le=le, lt=lt)


class ConfigModel(BaseModel):
    """Frozen, nothing unknown, no NaN: the base of every part of the configuration."""

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True)


class MethodConfig(ConfigModel):
    """The parameters of a method: the base of its group."""

    target_shapes: ClassVar[tuple[str, ...] | None] = None
    """The choices of `target.shape` that the method can capture; None if it can any."""
    why_these_shapes: ClassVar[str] = ""
    """What of the method needs one of them, as the end of a refusal."""
