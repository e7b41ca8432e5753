"""Calls into pymunk's compiled library from compiled code, by the addresses of its C functions.

A 1 ms step through Python attributes costs ten times the physics itself. Addresses are passed as numbers,
so that compiled code stays valid for every process. The structs of two doubles that Chipmunk takes and
gives by value travel in two registers on x86-64 and AArch64 (System V, AAPCS64), as two doubles do.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic
from pymunk._chipmunk_cffi import ffi, lib

_DOUBLE = ir.DoubleType()
_POINTER = ir.IntType(64)
_VECTOR = ir.LiteralStructType([_DOUBLE, _DOUBLE])

FUNCTIONS = (
    "cpSpaceStep",
    "cpBodyGetPosition",
    "cpBodyGetAngle",
    "cpBodyGetVelocity",
    "cpBodyGetAngularVelocity",
    "cpBodySetForce",
    "cpBodySetTorque",
    "cpSimpleMotorSetRate",
)
STEP, POSITION, ANGLE, VELOCITY, ANGULAR_VELOCITY, SET_FORCE, SET_TORQUE, SET_RATE = range(len(FUNCTIONS))


def function_addresses() -> np.ndarray[Any, np.dtype[np.int64]]:
    """Addresses of `FUNCTIONS` in this process, shape (8,)."""
    return np.array([int(ffi.cast("intptr_t", ffi.addressof(lib, name))) for name in FUNCTIONS])


def address(pointer: Any) -> int:
    """The address that a cffi pointer holds."""
    return int(ffi.cast("intptr_t", pointer))


def _called(generator: Callable[..., Any]) -> Callable[..., Any]:
    """Numba's intrinsic, which drops the typing context from what callers pass."""
    result: Callable[..., Any] = intrinsic(generator)
    return result


def _call(builder: Any, result: Any, arguments: list[Any], values: list[Any]) -> Any:
    function = builder.inttoptr(values[0], ir.FunctionType(result, arguments).as_pointer())
    return builder.call(function, values[1:])


@_called
def get_vector(typing_context: Any, function: Any, pointer: Any) -> Any:
    """A pair of doubles from `cpVect f(pointer)`."""
    signature = types.UniTuple(types.float64, 2)(types.int64, types.int64)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        vector = _call(builder, _VECTOR, [_POINTER], values)
        return context.make_tuple(builder, signature.return_type, [builder.extract_value(vector, i) for i in range(2)])

    return signature, generate


@_called
def get_scalar(typing_context: Any, function: Any, pointer: Any) -> Any:
    """A double from `double f(pointer)`."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return _call(builder, _DOUBLE, [_POINTER], values)

    return types.float64(types.int64, types.int64), generate


@_called
def call_scalar(typing_context: Any, function: Any, pointer: Any, value: Any) -> Any:
    """`void f(pointer, double)`."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        _call(builder, ir.VoidType(), [_POINTER, _DOUBLE], values)
        return context.get_dummy_value()

    return types.void(types.int64, types.int64, types.float64), generate


@_called
def call_vector(typing_context: Any, function: Any, pointer: Any, x: Any, y: Any) -> Any:
    """`void f(pointer, cpVect)`."""

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        _call(builder, ir.VoidType(), [_POINTER, _DOUBLE, _DOUBLE], values)
        return context.get_dummy_value()

    return types.void(types.int64, types.int64, types.float64, types.float64), generate
