"""The interface of a plant: `PLANT_STATE` out, commanded joint rates in, once a control period.

A plant is a value of the protocol `Plant`. One that compiled code can step has a *handle*, a named tuple of its own
class, and registers with `register_kernel` what a step of that handle does; `advance_plant` is generic in it: numba
makes one version for each class of handle, and keeps it on disk like all compiled code.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import numpy as np
from numba.extending import overload

from sim.compiled import INLINE, FloatArray, compiled_inline
from sim.config import TableConfig
from sim.model.generalized_jacobian import is_finite
from sim.model.reduced_model import shape_of_state
from sim.record import Record

GRAVITY = 9.81
"""[m/s2]"""

_NEAR = 10.0
"""From the world's origin no body of a testbed is farther [m]."""

PLANT_STATE = np.dtype(
    [
        ("tick", np.int64),  # control periods since the start
        ("time", np.float64),  # [s]
        ("base_pose", np.float64, (3,)),  # of the centre of mass
        ("base_twist", np.float64, (3,)),
        ("joint_angle", np.float64, (2, 3)),
        ("joint_rate", np.float64, (2, 3)),
        ("mount_angle", np.float64, (2,)),  # of the hands on link 3
        ("mount_rate", np.float64, (2,)),
        ("target_pose", np.float64, (3,)),
        ("target_twist", np.float64, (3,)),
        ("hand_wrench", np.float64, (2, 3)),  # target on hand, about the hand centre, world axes
        ("tip_force", np.float64, (2, 2, 2)),  # target on tip, world axes
        ("tip_contact", np.int64, (2, 2)),
        ("base_contact", np.int64),  # solid contact of the target with the base, now
        ("arm_contact", np.int64),  # ... with a link or the back of a hand, now
        ("momentum", np.float64, (3,)),  # robot and target, about the world's origin
    ],
    align=True,
)
"""What a plant reports; SI, world axes; arrays lead with the arm (left, right)."""


def copy_state(into: Record, source: Record) -> None:
    """Give one element of `PLANT_STATE` the values of another."""
    for name in PLANT_STATE.names or ():
        into[name] = source[name]


PlantHandle = Any
"""What compiled code steps a plant by: a named tuple of a class of the plant's own."""


class SavedState(NamedTuple):
    """Where a plant stood."""

    own: np.ndarray[Any, np.dtype[Any]]
    """What its next step follows from: an array of one element of a type of the plant's own."""
    state: Record
    """One element of `PLANT_STATE`."""


class CopyablePlant(Protocol):
    """A plant that can return to where it stood."""

    def save(self) -> SavedState:
        """A copy of where the plant stands."""
        ...

    def restore(self, saved: SavedState) -> None:
        """Return to where the plant stood: from there the same commanded rates give the same states, bit for bit.

        Args:
            saved: of a plant of the same configuration.

        """
        ...


class Plant(Protocol):
    """Anything that can be flown, tick by tick: observe, decide, apply joint rates."""

    @property
    def state(self) -> Record:
        """The latest state, one element of `PLANT_STATE`; always the same element, changed in place."""
        ...

    @property
    def perceived(self) -> Record | None:
        """What the plant's own sensors make of that state, one element of `PERCEIVED`; None: they are simulated."""
        ...

    @property
    def next_tick(self) -> int:
        """The tick that is decided next: what is granted now takes effect at it."""
        ...

    @property
    def handle(self) -> PlantHandle | None:
        """What compiled code steps the plant by; None for a plant that keeps its own time."""
        ...

    @property
    def copyable(self) -> CopyablePlant | None:
        """The plant itself, if it can return to where it stood; else None."""
        ...

    def observe(self) -> None:
        """Wait for the state of the next tick; a simulated plant has it already.

        Raises:
            PlantError: the plant can no longer be trusted.

        """
        ...

    def apply_joint_rates(self, joint_rate: FloatArray) -> None:
        """Apply joint rates [rad/s], shape (2, 3), for one control period; a plant in real time does not wait for it.

        Raises:
            PlantError: the plant can no longer be trusted.

        """
        ...


class AirTable(NamedTuple):
    """What an air-bearing testbed adds to free floating; nothing, unless given."""

    drag: float = 0.0
    """Part of every body's velocity that is lost in a second, for small ones [1/s]."""
    slope_x: float = 0.0
    """Acceleration that the table's tilt gives every body, world axes [m/s2]."""
    slope_y: float = 0.0
    """Likewise."""


def air_table(config: TableConfig) -> AirTable:
    """The configured table."""
    return AirTable(config.drag, GRAVITY * math.sin(config.tilt_x), GRAVITY * math.sin(config.tilt_y))


class _PlantKernel(NamedTuple):
    """Compiled functions of one class of handles."""

    step: Callable[..., None]
    momentum_size: Callable[..., float]
    shape: Callable[..., Record]


_KERNELS: dict[type, _PlantKernel] = {}


@compiled_inline
def _shape_from_state(handle: PlantHandle, robot: Record, state: Record, shape: Record) -> Record:
    """The shape of a robot whose plant does not have it."""
    return shape_of_state(robot, state, shape)


def register_kernel(
    handle: type,
    *,
    step: Callable[..., None],
    momentum_size: Callable[..., float],
    shape: Callable[..., Record] = _shape_from_state,
) -> None:
    """Register what a step of a plant with that class of handle is.

    Args:
        handle: the named tuple's class.
        step: compiled, `(handle, parameters, joint_rate, state)`: one physics step under joint rates [rad/s], shape
            (2, 3); the state is read back.
        momentum_size: compiled, `(handle) -> float`: the sum of the sizes of all bodies' momenta [N s, with N m s at
            1 m], by which a jump of the total is judged.
        shape: compiled, `(handle, robot, state, shape) -> shape`: the robot's shape at the state, a record of `SHAPE`:
            the one given, once it is set, or one that the plant has already.

    """
    _KERNELS[handle] = _PlantKernel(step, momentum_size, shape)


def kernels_in(module: str) -> list[Callable[..., Any]]:
    """The compiled functions that the plants of a module have registered."""
    return [function for handle, kernel in _KERNELS.items() if handle.__module__ == module for function in kernel]


def _step(handle: PlantHandle, parameters: Record, joint_rate: FloatArray, state: Record) -> None:
    """One physics step of the plant whose handle it is; compiled only."""
    raise NotImplementedError


def _momentum_size(handle: PlantHandle) -> float:
    """The sum of the sizes of its bodies' momenta; compiled only."""
    raise NotImplementedError


def robot_shape(handle: PlantHandle, robot: Record, state: Record, shape: Record) -> Record:
    """The robot's shape at a plant's state, a record of `SHAPE`; the one given is for plants that have none."""
    raise NotImplementedError


def _overloads(function: Callable[..., Any]) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Numba's `overload`, which has no types of its own."""
    result: Callable[[Callable[..., Any]], Callable[..., Any]] = overload(function, jit_options=INLINE)
    return result


@_overloads(_step)
def _step_of(handle: Any, parameters: Any, joint_rate: Any, state: Any) -> Any:
    kernel_step = _KERNELS[handle.instance_class].step

    def step(handle: Any, parameters: Any, joint_rate: Any, state: Any) -> None:
        kernel_step(handle, parameters, joint_rate, state)

    return step


@_overloads(_momentum_size)
def _momentum_size_of(handle: Any) -> Any:
    kernel_momentum_size = _KERNELS[handle.instance_class].momentum_size

    def momentum_size(handle: Any) -> Any:
        return kernel_momentum_size(handle)

    return momentum_size


@_overloads(robot_shape)
def _robot_shape_of(handle: Any, robot: Any, state: Any, shape: Any) -> Any:
    kernel_shape = _KERNELS[handle.instance_class].shape

    def robot_shape(handle: Any, robot: Any, state: Any, shape: Any) -> Any:
        return kernel_shape(handle, robot, state, shape)

    return robot_shape


@compiled_inline
def _given_by_table(parameters: Record, size: float) -> float:
    """What an air table may change total momentum by in a control period, generously [N s, and N m s within `_NEAR`].

    Args:
        parameters: record of the configuration.
        size: of all bodies' momenta.

    """
    table, robot = parameters.table, parameters.robot
    if table.drag == 0.0 and table.tilt_x == 0.0 and table.tilt_y == 0.0:
        return 0.0
    arm = robot.arm
    mass = robot.base.mass + parameters.target.mass
    mass += 2.0 * (arm.link_1.mass + arm.link_2.mass + arm.link_3.mass + arm.hand.mass)
    slope = GRAVITY * (abs(table.tilt_x) + abs(table.tilt_y))
    return float(parameters.control.period * (_NEAR * mass * slope + table.drag * size))


@compiled_inline
def advance_plant(handle: PlantHandle, parameters: Record, joint_rate: FloatArray, state: Record) -> bool:
    """Step a plant through one control period under joint rates [rad/s], shape (2, 3).

    The state is read back after every step. Returns False if it can no longer be trusted: it is not finite, or
    total momentum has jumped.
    """
    before_x, before_y, before_angular = state.momentum[0], state.momentum[1], state.momentum[2]
    steps = round(parameters.control.period / parameters.simulation.time_step)
    for _ in range(steps):
        _step(handle, parameters, joint_rate, state)
    state.tick += 1
    state.time = state.tick * parameters.control.period
    size = _momentum_size(handle)
    limit = parameters.simulation.momentum_jump_limit * size + _given_by_table(parameters, size)
    kept = (
        abs(state.momentum[0] - before_x) <= limit
        and abs(state.momentum[1] - before_y) <= limit
        and abs(state.momentum[2] - before_angular) <= limit
    )
    return bool(
        kept
        and is_finite(state.base_pose)
        and is_finite(state.target_pose)
        and is_finite(state.joint_rate[0])
        and is_finite(state.joint_rate[1])
    )


def diverged_at(time: float) -> str:
    """The message about a simulated plant that can no longer be trusted from that mission time on [s]."""
    return f"the simulated state is not finite, or its momentum jumped, at {time:.3f} s"
