"""What a method is: its parameters, its memory, and four compiled functions that the tick asks.

A method decides from what the controller knows. It has a record of its own (`Method.memory`) in a *handle*, a named
tuple of its own class, and registers with `register_kernel` what the four functions are for that class:

- `begin`: a sequence begins; forget the last one.
- `react`: what follows from time, measurement and a verdict: phase, activity, and the kind of plan to make now.
- `plan`: make it, into the memory.
- `hand_twist`: the twists that the hands should have, and which hands that is about.

`decide` is the tick of every method; it alone writes the phase, and limits come last. numba makes one version of it
for each method.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from importlib import import_module
from typing import Any, NamedTuple, Protocol

import numpy as np
from numba.extending import overload

from sim.compiled import INLINE, FloatArray, compiled, compiled_inline
from sim.config import MissionConfig
from sim.control.hand_motion import NO_HANDS, command_hand_twists, hold_joints
from sim.control.memory import NO_PLAN
from sim.control.phases import AT_REST, Command, Phase, Verdict
from sim.control.phases import Sequence as MissionSequence
from sim.method.registry import MethodName
from sim.model.robot import Chain, RobotModel
from sim.record import Record
from sim.snapshot import Condition, Plan, Touch

MethodHandle = Any
"""What compiled code asks a method by: a named tuple of a class of the method's own."""


class Words(NamedTuple):
    """What a method says about itself."""

    phase: Mapping[Phase, str]
    """Of the phases that it fills: the message of the event when one begins."""
    plan: Mapping[int, str]
    """By activity: the message of the event when a plan for it is made."""
    trouble: Mapping[int, str]
    """By code of the memory's `trouble`: why a sequence was broken off or found no plan, to stand after a colon."""
    motion: Callable[[Any, Plan | None, Sequence[Touch]], str]
    """What is happening at a tick (one element of `TICK`) of a phase in which something moves: one sentence."""
    next_step: Callable[[Any, MissionConfig, Phase], tuple[str, list[Condition]]]
    """The phase or command that comes next at a tick, and what speaks for or against it."""
    unmet: Callable[[Any, MissionConfig], str]
    """What a phase has failed to achieve, at its last tick; empty if nothing."""


class Refusal(Protocol):
    """What speaks against a command before anything moves."""

    def __call__(self, command: Command, config: MissionConfig, row: Any, *, on_robot: bool) -> str:
        """Why it cannot end well from the last tick (one element of `TICK`) on, with numbers; empty if it can.

        Args:
            command: that is asked.
            config: of the mission.
            row: the last tick.
            on_robot: whether it is a real robot that would fly.

        """
        ...


@dataclass(frozen=True)
class Method:
    """One way to capture a target."""

    title: str
    memory: np.dtype[Any]
    """What only this method remembers, as a record."""
    activities: type[IntEnum]
    """What the hands may be doing; 0 is `AT_REST`."""
    plan_kinds: type[IntEnum]
    """What a plan may be for; 0 is `NO_PLAN`."""
    closing: tuple[int, ...]
    """The activities of a phase of caging in which the hands close, or wait where they have closed."""
    commands: frozenset[Command]
    """What an operator may ask of it beside STOP."""
    handle: Callable[[MissionConfig, np.ndarray[Any, np.dtype[Any]]], MethodHandle]
    """The handle for a configuration and an array of one `memory`."""
    spin_threshold: Callable[[MissionConfig], float | None]
    """The target's spin below which caging may begin [rad/s]; None if it may at any."""
    refusal: Refusal
    enclosure: Callable[[MissionConfig], FloatArray] | None
    """Poses of both hands that enclose a target at the world's origin, shape (2, 3), as far out as the method lets
    them be when it locks; None where the method does not choose them."""
    words: Words


def method_of(config: MissionConfig) -> Method:
    """The method that the configuration names."""
    return method_named(config.method)


def method_named(name: MethodName) -> Method:
    """The method of that name."""
    method: Method = import_module(f"sim.method.{name.value}.method").METHOD
    return method


class _MethodKernel(NamedTuple):
    """Compiled functions of one class of handles."""

    begin: Callable[..., None]
    react: Callable[..., tuple[int, int, int]]
    plan: Callable[..., None]
    hand_twist: Callable[..., int]


_KERNELS: dict[type, _MethodKernel] = {}


def register_kernel(
    handle: type,
    *,
    begin: Callable[..., None],
    react: Callable[..., tuple[int, int, int]],
    plan: Callable[..., None],
    hand_twist: Callable[..., int],
) -> None:
    """Say what the functions of the method with that class of handle are; all compiled.

    Args:
        handle: the named tuple's class.
        begin: `(handle, memory)`.
        react: `(handle, memory, parameters, state, verdict)`; gives phase, activity and kind of plan (`NO_PLAN`).
        plan: `(handle, memory, parameters, state, hand_pose, kind)`.
        hand_twist: `(handle, memory, parameters, robot, state, links, velocity)`: fills the velocity, shape (2, 3)
            [m/s, rad/s] in world axes; gives an arm, `BOTH_ARMS` or `NO_HANDS`.

    """
    _KERNELS[handle] = _MethodKernel(begin, react, plan, hand_twist)


def _begin(handle: MethodHandle, memory: Record) -> None:
    raise NotImplementedError


def _react(
    handle: MethodHandle, memory: Record, parameters: Record, state: Record, verdict: int
) -> tuple[int, int, int]:
    raise NotImplementedError


def _plan(
    handle: MethodHandle, memory: Record, parameters: Record, state: Record, hand_pose: FloatArray, kind: int
) -> None:
    raise NotImplementedError


def _hand_twist(
    handle: MethodHandle,
    memory: Record,
    parameters: Record,
    robot: RobotModel,
    state: Record,
    links: Chain,
    velocity: FloatArray,
) -> int:
    raise NotImplementedError


@overload(_begin, jit_options=INLINE)
def _begin_of(handle: Any, memory: Any) -> Any:
    function = _KERNELS[handle.instance_class].begin

    def begin(handle: Any, memory: Any) -> None:
        function(handle, memory)

    return begin


@overload(_react, jit_options=INLINE)
def _react_of(handle: Any, memory: Any, parameters: Any, state: Any, verdict: Any) -> Any:
    function = _KERNELS[handle.instance_class].react

    def react(handle: Any, memory: Any, parameters: Any, state: Any, verdict: Any) -> Any:
        return function(handle, memory, parameters, state, verdict)

    return react


@overload(_plan, jit_options=INLINE)
def _plan_of(handle: Any, memory: Any, parameters: Any, state: Any, hand_pose: Any, kind: Any) -> Any:
    function = _KERNELS[handle.instance_class].plan

    def plan(handle: Any, memory: Any, parameters: Any, state: Any, hand_pose: Any, kind: Any) -> None:
        function(handle, memory, parameters, state, hand_pose, kind)

    return plan


@overload(_hand_twist, jit_options=INLINE)
def _hand_twist_of(handle: Any, memory: Any, parameters: Any, robot: Any, state: Any, links: Any, velocity: Any) -> Any:
    function = _KERNELS[handle.instance_class].hand_twist

    def hand_twist(handle: Any, memory: Any, parameters: Any, robot: Any, state: Any, links: Any, velocity: Any) -> Any:
        return function(handle, memory, parameters, robot, state, links, velocity)

    return hand_twist


@compiled_inline
def enter_phase(memory: Record, phase: int, activity: int, sequence: int) -> None:
    """The one function that writes the phase, with what is done in it and how far the phases follow one another."""
    memory.phase, memory.activity, memory.sequence = phase, activity, sequence


@compiled
def begin_sequence(method: MethodHandle, memory: Record, phase: int, sequence: int) -> None:
    """Put the memory at the start of a phase that an operator asked for; a plan under way is dropped."""
    enter_phase(memory, phase, AT_REST, sequence)
    memory.plan_kind, memory.plan_knots, memory.trouble = NO_PLAN, 0, 0
    _begin(method, memory)


@compiled_inline
def decide(
    method: MethodHandle,
    memory: Record,
    parameters: Record,
    robot: RobotModel,
    state: Record,
    shape: Record,
    links: Record,
    motion: Record,
    verdict: int,
) -> None:
    """One tick of the controller.

    Args:
        method: handle of the method.
        memory: one element of `MEMORY`; changed. `commanded_joint_rate` is the result [rad/s].
        parameters: record of `MissionConfig`.
        robot: the robot's model.
        state: what is known, one element of `PERCEIVED`.
        shape: the robot's as it is believed to be, one element of `SHAPE`.
        links: the chain likewise, one element of `CHAIN`.
        motion: one element of `HAND_MOTION`, to work with.
        verdict: that has fallen in this tick, `Verdict.NONE` for none.

    """
    phase, activity, kind = _react(method, memory, parameters, state, verdict)
    enter_phase(memory, phase, activity, memory.sequence if verdict == Verdict.NONE else MissionSequence.NONE)
    if kind != NO_PLAN:
        _plan(method, memory, parameters, state, links.hand_pose, kind)
    memory.rate_limited, memory.joint_rate_share = 0, 1.0
    memory.expects_contact[:] = 0
    memory.wanted_force[:] = 0.0
    motion.hand_velocity[:] = 0.0
    arm = _hand_twist(method, memory, parameters, robot, state, links, motion.hand_velocity)
    if arm == NO_HANDS:
        hold_joints(memory, links.hand_pose)
    else:
        command_hand_twists(memory, parameters, state, shape, links, motion, arm)
