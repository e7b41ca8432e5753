"""Configuration models as numeric records, which compiled code reads by the same names."""

from __future__ import annotations

from enum import StrEnum
from typing import Any

import numpy as np
from pydantic import BaseModel

from sim.schema_history import VERSION

Record = Any
"""One element of a structured array: fields by name, in Python as `record["name"]`, compiled as `record.name`."""


def dtype_of(model: type[BaseModel]) -> np.dtype[Any]:
    """The record type of a configuration model: floats, integers, choices as the order of their enum, nested models."""
    fields: list[tuple[str, Any]] = []
    for name in _names(model):
        annotation = model.model_fields[name].annotation
        if isinstance(annotation, type) and issubclass(annotation, BaseModel):
            fields.append((name, dtype_of(annotation)))
        elif isinstance(annotation, type) and issubclass(annotation, StrEnum):
            fields.append((name, np.int64))
        else:
            fields.append((name, np.int64 if annotation is int else np.float64))
    return np.dtype(fields, align=True)


def record_of(model: BaseModel) -> Record:
    """The values of a configuration model as one record; choices become `code_of`."""
    return np.array([_values(model)], dtype=dtype_of(type(model)))[0]


def code_of(choice: StrEnum) -> int:
    """The place of a choice in its enumeration, by which compiled code knows it."""
    return list(type(choice)).index(choice)


def _names(model: type[BaseModel]) -> list[str]:
    """The fields that are numbers or choices; the version of their names is neither."""
    return [name for name in model.model_fields if name != VERSION]


def _values(model: BaseModel) -> tuple[Any, ...]:
    values: list[Any] = []
    for name in _names(type(model)):
        value = getattr(model, name)
        if isinstance(value, BaseModel):
            values.append(_values(value))
        else:
            values.append(code_of(value) if isinstance(value, StrEnum) else value)
    return tuple(values)
