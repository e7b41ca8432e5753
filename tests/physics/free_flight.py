"""A minute of smooth arm motion in free flight: flown by the plant, and integrated in reduced coordinates."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from sim.compiled import FloatArray, compiled
from sim.config import Engine, MissionConfig
from sim.configurations import revised
from sim.model.generalized_jacobian import free_flying_model
from sim.model.planar import rotated
from sim.model.robot import JOINTS, LINKS, RobotModel, chain, robot_model
from sim.plant.chipmunk import ANGLE, POSITION, get_scalar, get_vector
from sim.plant.engine import simulated_plant
from sim.plant.plant import PlantHandle, advance_plant
from sim.plant.pymunk_plant import PymunkHandle, PymunkPlant, body_of
from sim.record import Record, record_of

AMPLITUDE = np.array([[0.30, 0.45, 0.60], [0.25, 0.50, 0.40]])
"""Of each joint's rate [rad/s]: a capture's arms move at up to 0.8."""
FREQUENCY = np.array([[1.3, 0.9, 1.7], [1.1, 0.7, 2.1]])
"""Of each joint's rate [rad/s]; no two alike, so that errors do not cancel over a period."""


class FreeFlight(NamedTuple):
    """A flight as recorded, one row a tick, the start first."""

    time: FloatArray
    base_pose: FloatArray
    shape: FloatArray
    """Joint angles left 1-3, right 1-3, mounts, shape (ticks, 8)."""
    momentum: FloatArray
    base_twist: FloatArray
    joint_rate: FloatArray
    """Of joints left 1-3, right 1-3, shape (ticks, 6)."""
    gap: FloatArray
    """Largest distance of two anchors that a pivot should hold together [m], shape (ticks,); zero without pivots."""


def remote_target(engine: Engine = Engine.PYMUNK) -> MissionConfig:
    """The default robot, its target at rest and out of reach."""
    target = {"initial_y": 4.0, "initial_spin": 0.0}
    return revised(MissionConfig(), {"target": target, "simulation": {"engine": engine.value}})


def fly_freely(config: MissionConfig, seconds: float) -> FreeFlight:
    """Sinusoidal joint rates on the simulated plant for that long."""
    plant = simulated_plant(config)
    ticks = round(seconds / config.control.period)
    flight = FreeFlight(
        np.zeros(ticks + 1),
        np.zeros((ticks + 1, 3)),
        np.zeros((ticks + 1, 8)),
        np.zeros((ticks + 1, 3)),
        np.zeros((ticks + 1, 3)),
        np.zeros((ticks + 1, 6)),
        np.zeros(ticks + 1),
    )
    parameters = record_of(config)
    if isinstance(plant, PymunkPlant):
        for tick in range(ticks + 1):
            _fly(plant.handle, parameters, plant.state, AMPLITUDE, FREQUENCY, flight, tick, tick + 1)
            flight.gap[tick] = largest_gap(plant.handle)
    else:
        _fly(plant.handle, parameters, plant.state, AMPLITUDE, FREQUENCY, flight, 0, ticks + 1)
    return flight


@compiled
def _fly(
    handle: PlantHandle,
    parameters: Record,
    state: Record,
    amplitude: FloatArray,
    frequency: FloatArray,
    flight: FreeFlight,
    begin: int,
    end: int,
) -> None:
    """Ticks from `begin` to before `end`; tick 0 is the start, to which nothing leads."""
    rates = np.zeros((2, JOINTS))
    for tick in range(begin, end):
        if tick > 0:
            # Sines, not cosines: the motion begins at rest, so no servo has a jump to make.
            for arm in range(2):
                for joint in range(JOINTS):
                    rates[arm, joint] = amplitude[arm, joint] * math.sin(frequency[arm, joint] * state.time)
            advance_plant(handle, parameters, rates, state)
        for arm in range(2):
            for joint in range(JOINTS):
                flight.shape[tick, JOINTS * arm + joint] = state.joint_angle[arm, joint]
                flight.joint_rate[tick, JOINTS * arm + joint] = state.joint_rate[arm, joint]
            flight.shape[tick, 2 * JOINTS + arm] = state.mount_angle[arm]
        flight.time[tick] = state.time
        flight.base_pose[tick] = state.base_pose
        flight.momentum[tick] = state.momentum
        flight.base_twist[tick] = state.base_twist


@compiled
def largest_gap(handle: PymunkHandle) -> float:
    """Largest distance [m] between the two anchors of a pivot, over all eight pivots."""
    worst = 0.0
    robot = handle.robot
    for arm in range(2):
        for link in range(LINKS):
            child = body_of(arm, link)
            parent = 0 if link == 0 else child - 1
            if link == 0:
                ax, ay = robot.shoulder_in_base[arm, 0], robot.shoulder_in_base[arm, 1]
            else:
                ax, ay = 0.0, robot.link_length[link - 1] - robot.link_centre[link - 1]
            px, py = _world(handle, parent, ax, ay)
            cx, cy = _world(handle, child, 0.0, -robot.link_centre[link])
            worst = max(worst, math.hypot(cx - px, cy - py))
    return worst


@compiled
def _world(handle: PymunkHandle, body: int, x: float, y: float) -> tuple[float, float]:
    bx, by = get_vector(handle.functions[POSITION], handle.bodies[body])
    dx, dy = rotated(get_scalar(handle.functions[ANGLE], handle.bodies[body]), x, y)
    return bx + dx, by + dy


def reference_base_pose(config: MissionConfig, flight: FreeFlight) -> FloatArray:
    """The base's last pose by the conservation of momentum, from the joint angles that the servos really gave.

    Two freedoms less than the plant has bodies for: base twist = -H_b^-1 H_bm (joint rates) at zero momentum.
    Joint angles are splined; at 1 ms and 2 rad/s a cubic spline is right to 1e-13 rad.
    """
    robot: RobotModel = robot_model(config.robot)
    spline = CubicSpline(flight.time, flight.shape)
    rates = spline.derivative()

    def base_twist(time: float, base_pose: FloatArray) -> FloatArray:
        shape = spline(time)
        links = chain(robot, base_pose, shape[:6].reshape(2, 3), shape[6:])
        return -free_flying_model(robot, base_pose, links).base_reaction @ rates(time)

    start, end = flight.time[0], flight.time[-1]
    solution = solve_ivp(base_twist, (start, end), flight.base_pose[0], method="DOP853", rtol=1e-11, atol=1e-12)
    assert solution.success, solution.message
    last: FloatArray = solution.y[:, -1]
    return last
