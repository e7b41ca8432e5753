"""Configuration models as numeric records, which compiled code reads by the same names."""

from __future__ import annotations

from enum import StrEnum
from functools import lru_cache
from typing import Any

import numpy as np
from pydantic import BaseModel

from sim.compiled import FloatArray, compiled_inline
from sim.parameters import Points
from sim.schema_history import VERSION

Record = Any
"""One element of a structured array: fields by name, in Python as `record["name"]`, compiled as `record.name`."""


@compiled_inline
def copy_vector(into: FloatArray, source: FloatArray) -> None:
    """Copy an array of one axis: `into[:] = source` asks first whether both overlap, which takes longer."""
    for place in range(into.shape[0]):
        into[place] = source[place]


@compiled_inline
def copy_rows(into: FloatArray, source: FloatArray) -> None:
    """Copy an array of two axes, as `copy_vector`."""
    for row in range(into.shape[0]):
        for place in range(into.shape[1]):
            into[row, place] = source[row, place]


@lru_cache
def dtype_of(model: type[BaseModel]) -> np.dtype[Any]:
    """The record type of a configuration model: floats, integers, choices as the order of their enum, nested models.

    Lists of points are left out: compiled code reads what is made of them (`sim.model.shape`).
    """
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
    return _codes(type(choice))[choice]


@lru_cache
def _codes(choices: type[StrEnum]) -> dict[StrEnum, int]:
    return {choice: place for place, choice in enumerate(choices)}


def packed(values: Any) -> np.ndarray[Any, np.dtype[Any]]:
    """Numbers, arrays and named tuples of them as one record, shape (1,), by the same names.

    Compiled code hands a record on as one address; a named tuple, array by array.
    """
    result = np.zeros(1, _packed_dtype(values))
    _fill(result, values)
    return result


def _fill(record: np.ndarray[Any, np.dtype[Any]], values: Any) -> None:
    for name, value in zip(values._fields, values, strict=True):
        if isinstance(value, tuple):
            _fill(record[name], value)
        else:
            record[name] = value


def _packed_dtype(values: Any) -> np.dtype[Any]:
    fields: list[tuple[Any, ...]] = []
    for name, value in zip(values._fields, values, strict=True):
        if isinstance(value, tuple):
            fields.append((name, _packed_dtype(value)))
        elif isinstance(value, np.ndarray):
            fields.append((name, np.float64, value.shape))
        else:
            fields.append((name, np.int64 if isinstance(value, int) else np.float64))
    return np.dtype(fields, align=True)


@lru_cache
def _names(model: type[BaseModel]) -> tuple[str, ...]:
    """The fields that are numbers, choices or groups; the version of the parameters' names is none of them."""
    return tuple(name for name, field in model.model_fields.items() if name != VERSION and field.annotation != Points)


def _values(model: BaseModel) -> tuple[Any, ...]:
    values: list[Any] = []
    for name in _names(type(model)):
        value = getattr(model, name)
        if isinstance(value, BaseModel):
            values.append(_values(value))
        else:
            values.append(code_of(value) if isinstance(value, StrEnum) else value)
    return tuple(values)
