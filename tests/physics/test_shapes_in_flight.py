"""A target of any shape that drifts into the right hand, in each engine: momentum, spin, depth."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest

from sim.compiled import FloatArray
from sim.config import Engine, MissionConfig
from sim.model.planar import in_frame
from sim.model.robot import chain, robot_model, tip_position
from sim.model.shape import signed_distance
from sim.model.target import target_shape
from sim.plant.engine import simulated_plant

SHAPES: dict[str, dict[str, Any]] = {
    "rectangle": {"shape": "rectangle", "width": 0.18, "depth": 0.09},
    "hexagon": {"shape": "regular_polygon", "sides": 6, "side": 0.08},
    "circle": {"shape": "circle", "radius": 0.075},
    "wedge": {"shape": "polygon", "vertices": [[0.0, 0.0], [0.14, 0.0], [0.11, 0.10], [0.0, 0.13]]},
}
TICKS = 1200
every_engine = pytest.mark.parametrize("engine", Engine)
every_shape = pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)


class Drift(NamedTuple):
    """What a flight showed."""

    momentum: FloatArray
    """Of robot and target, shape (ticks, 3)."""
    spin: FloatArray
    """Of the target [rad/s], shape (ticks,)."""
    speed: FloatArray
    """Of the target along x [m/s], shape (ticks,)."""
    touched: bool
    deepest: float
    """Of a tip in the target [m]."""


def drift(shape: dict[str, Any], engine: Engine, **contact: float) -> Drift:
    """Joint rates zero while the target comes at 0.15 m/s."""
    target = {"initial_velocity_x": 0.15, "initial_spin": 0.4, **shape}
    config = MissionConfig.model_validate(
        {"target": target, "contact": contact, "simulation": {"engine": engine.value}}
    )
    plant, robot, outline = simulated_plant(config), robot_model(config.robot), target_shape(config.target)
    state = plant.state
    momentum, spin, speed = np.zeros((TICKS, 3)), np.zeros(TICKS), np.zeros(TICKS)
    touched, deepest = False, 0.0
    for tick in range(TICKS):
        plant.observe()
        momentum[tick], spin[tick], speed[tick] = state["momentum"], state["target_twist"][2], state["target_twist"][0]
        links = chain(robot, state["base_pose"], state["joint_angle"], state["mount_angle"])
        for arm in range(2):
            for tip in range(2):
                x, y = in_frame(state["target_pose"], *tip_position(robot, links.hand_pose[arm], tip))
                deepest = max(deepest, robot.tip_radius - signed_distance(outline, x, y))
        touched = touched or bool(state["tip_contact"].any())
        plant.apply_joint_rates(np.zeros((2, 3)))
    return Drift(momentum, spin, speed, touched, deepest)


@every_engine
@every_shape
def test_a_touch_keeps_momentum_and_lets_no_tip_in(shape: dict[str, Any], engine: Engine) -> None:
    flown = drift(shape, engine)
    assert flown.touched
    assert np.abs(flown.momentum - flown.momentum[0]).max() < 1e-4
    assert flown.deepest < 0.006
    assert flown.speed[-1] < 0.12, "the hand has not slowed it"


@every_engine
def test_a_circle_without_friction_keeps_its_spin(engine: Engine) -> None:
    """Every normal of a circle passes through its centre."""
    flown = drift(SHAPES["circle"], engine, friction=0.0)
    assert flown.touched
    assert flown.spin == pytest.approx(np.full(TICKS, 0.4), abs=1e-9)


@every_shape
def test_both_engines_part_alike(shape: dict[str, Any]) -> None:
    one, other = (drift(shape, engine) for engine in Engine)
    assert one.speed[-1] == pytest.approx(other.speed[-1], abs=5e-3)
    assert one.spin[-1] == pytest.approx(other.spin[-1], abs=0.05)
