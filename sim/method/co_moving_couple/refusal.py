"""What the co-moving couple says against a capture before anything moves: too fast, too large, too far."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from sim.config import Estimator, MissionConfig, RobotConfig, TargetShape
from sim.control.phases import Command
from sim.method.co_moving_couple.geometry import closed_radius, half_side, round_torque
from sim.method.co_moving_couple.parameters import CoMovingCoupleConfig, TouchConfig
from sim.method.co_moving_couple.planner import ARCS, mean_lever
from sim.method.method import method_of
from sim.method.registry import MethodName
from sim.model.planar import rotated
from sim.model.robot import RobotModel, robot_model
from sim.model.target import Outline, seen_target_shape
from sim.record import Record, packed, record_of

BRAKING = (Command.CAPTURE, Command.DETUMBLE)
CLOSING = (Command.CAPTURE, Command.CAGE)
LEAST_LEVER = 0.012
"""Of a tip's force along the shortest arc [m]: with 7 mm (an octagon of 60 mm sides) 19 of 30 cases are caged."""
_LINES = np.linspace(0.0, 2.0 * math.pi, 72, endpoint=False)
"""Directions of the line of both hands [rad]."""


def refusal(command: Command, config: MissionConfig, row: Record, *, on_robot: bool) -> str:
    """Why a command cannot end well from a tick on (one element of `TICK`), with numbers; empty if it can."""
    del on_robot  # what the geometry forbids, it forbids in the simulation, too
    if config.target.shape is TargetShape.CIRCLE:
        against = _too_smooth(command, config, row)
    else:
        against = (_too_short(config, row) or _too_fast(config, row)) if command in BRAKING else ""
    return against or (_too_far(config, row) if command in CLOSING else "")


def _too_smooth(command: Command, config: MissionConfig, row: Record) -> str:
    """Friction alone brakes a round target, while both hands hold it: too slowly, or it is asked for without them."""
    method, spin = config.co_moving_couple, abs(float(row["target_perceived_twist"][2]))
    if command is Command.DETUMBLE and spin > method.touch.no_touch_spin:
        return "friction brakes a round target while both hands enclose it: ask for the capture as a whole"
    estimated = config.perception.estimator is Estimator.MODEL_BASED
    inertia = float(row["target_perceived_inertia"]) if estimated else config.perception.assumed_inertia
    force, friction = min(method.touch.planned_cap, method.touch.force_cap), method.touch.assumed_friction
    shape = packed(seen_target_shape(config.target))[0]
    torque = round_torque(robot_model(config.robot), shape, force, friction)
    most = method.touch.spin_left + torque * method.search.patience / inertia
    if spin <= most:
        return ""
    return (
        f"the target spins at {spin:.2f} rad/s: it is round, so that friction alone brakes it, and hands that press "
        f"with {force:g} N (co_moving_couple.touch.planned_cap) brake {most:.2f} rad/s in "
        f"{method.search.patience:g} s (.search.patience) with a friction of {friction:g} (.touch.assumed_friction)"
    )


def _too_short(config: MissionConfig, row: Record) -> str:
    """No lever to brake with: the sides end where a tip should press."""
    touch, spin = config.co_moving_couple.touch, abs(float(row["target_perceived_twist"][2]))
    half = _longest_half(Outline.of(config.target))
    outward = config.robot.arm.hand.tip_radius + touch.slip * half
    lever = half - touch.edge_distance - 0.5 * outward * min(ARCS)
    if spin <= touch.no_touch_spin or lever >= LEAST_LEVER:
        return ""
    return (
        f"the target's sides reach {1e3 * half:.0f} mm to one side: a tip that ends "
        f"{1e3 * touch.edge_distance:g} mm from the corner brakes with a lever of {1e3 * lever:.0f} mm, and "
        f"{1e3 * LEAST_LEVER:.0f} mm are needed"
    )


@lru_cache(maxsize=64)
def _longest_half(outline: Outline) -> float:
    """From the foot of the centre on a side to its end, of the longest [m]."""
    shape = packed(seen_target_shape(outline.target()))[0]
    return max(half_side(shape, side, sense) for side in range(int(shape["corners"])) for sense in (-1.0, 1.0))


def _too_fast(config: MissionConfig, row: Record) -> str:
    """More touches would be needed than are allowed, from work and energy: F = I (w^2 - w0^2) / (4 L arc)."""
    touch, spin = config.co_moving_couple.touch, abs(float(row["target_perceived_twist"][2]))
    estimated = config.perception.estimator is Estimator.MODEL_BASED
    inertia = float(row["target_perceived_inertia"]) if estimated else config.perception.assumed_inertia
    energy = inertia * (spin**2 - touch.no_touch_spin**2)
    in_one = energy / (4.0 * _lever(config.robot, Outline.of(config.target), touch) * ARCS[0])
    cap = min(touch.planned_cap, touch.force_cap)
    if in_one <= cap * touch.most_touches:
        return ""
    return (
        f"the target spins at {spin:.2f} rad/s: one touch would take {in_one:.2f} N, and touches of {cap:g} N "
        f"(co_moving_couple.touch.planned_cap) would have to be {math.ceil(in_one / cap)}, of at most "
        f"{touch.most_touches} (.most_touches); allow more force, or more touches"
    )


@lru_cache(maxsize=64)
def _lever(robot: RobotConfig, outline: Outline, braking: TouchConfig) -> float:
    """The longest lever that a side offers [m]; kept, because every snapshot asks for it."""
    couple = CoMovingCoupleConfig(touch=braking)
    config = MissionConfig(
        method=MethodName("co_moving_couple"), robot=robot, target=outline.target(), co_moving_couple=couple
    )
    method = method_of(config)
    handle, touch = method.handle(config, np.zeros(1, method.memory)), record_of(config)["co_moving_couple"]["touch"]
    sides = range(int(handle.fixed[0]["shape"]["corners"]))
    return max(mean_lever(handle, touch, side, sense, ARCS[0]) for side in sides for sense in (-1.0, 1.0))


def _too_far(config: MissionConfig, row: Record) -> str:
    """Whatever the direction of the line of both hands, one wrist would be out of its arm's reach."""
    robot, radius = robot_model(config.robot), _closed_radius(config.robot, Outline.of(config.target))
    reach = float(robot.link_length[0] + robot.link_length[1])
    needed = _least_reach(robot, row, radius + float(robot.link_length[2] + robot.link_length[3]))
    if needed <= reach:
        return ""
    return (
        f"both hands would close on the target {1e3 * radius:.0f} mm from its centre, which takes a wrist "
        f"{1e3 * needed:.0f} mm from its shoulder; the arms reach {1e3 * reach:.0f} mm"
    )


@lru_cache(maxsize=64)
def _closed_radius(robot: RobotConfig, outline: Outline) -> float:
    """Of both hands about the target's centre where all tips touch [m]."""
    return closed_radius(robot_model(robot), seen_target_shape(outline.target()))


def _least_reach(robot: RobotModel, row: Record, far: float) -> float:
    """The longer of both ways from shoulder to wrist, with wrists opposite so far from the target's centre [m].

    The least over all directions of their line.
    """
    base, target = row["base_perceived_pose"], row["target_perceived_pose"]
    x, y = rotated(-base[2], target[0] - base[0], target[1] - base[1])
    way = far * np.stack([np.cos(_LINES), np.sin(_LINES)], axis=1)
    ways = [np.array([x, y]) + side * way - robot.shoulder_in_base[arm] for arm, side in enumerate((-1.0, 1.0))]
    return float(np.maximum(*(np.hypot(*each.T) for each in ways)).min())
