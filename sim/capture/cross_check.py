"""Both engines on the same commands, and where they part.

The capture is flown in each engine by its own controller; that gives two outcomes. The joint rates that the first one's
controller commanded are then given to the other's plant, tick by tick and without a controller: what parts there is the
plants' own difference, not what a controller makes of it.

pymunk moves positions by the velocities at the start of a step, so that moving hands lag by half a step of motion,
some 5e-5 m at a millisecond, and come up when they rest (docs/decisions/0010-reduced-plant.md).
"""

from __future__ import annotations

import numpy as np
from pydantic import Field

from sim.capture.events import Ticks
from sim.capture.run import run_capture
from sim.capture.tick import ARMS, TICK
from sim.compiled import FloatArray, compiled
from sim.config import Engine, MissionConfig
from sim.configurations import revised
from sim.model.reduced_model import CHAIN, SHAPE, set_chain
from sim.model.robot import robot_model, tip_position
from sim.plant.engine import simulated_plant
from sim.plant.plant import PlantHandle, advance_plant, robot_shape
from sim.record import Record, copy_rows, copy_vector, packed, record_of
from sim.snapshot import FrozenMessage, Outcome

TOLERANCE = 1e-6
"""How far apart base, hands and target may be before they count as parted [m]."""


class FirstTouch(FrozenMessage):
    """Where and when a tip first met the target."""

    time: float = Field(description="Mission time [s]")
    arm: str = Field(description="left or right")
    tip: int = Field(description="1 on the hand's -x side, 2 on its +x side")
    place: tuple[float, float] = Field(description="The tip's centre in the world [m]")


class EngineFlight(FrozenMessage):
    """What came of the capture in one engine, by its own controller."""

    engine: str
    outcome: Outcome
    first_touch: FirstTouch | None = Field(description="Null if no tip met the target")


class Divergence(FrozenMessage):
    """The first tick in which the plants are further apart than the tolerance."""

    time: float = Field(description="Mission time [s]")
    part: str = Field(description="base, left hand, right hand or target: what is furthest apart")
    distance: float = Field(description="Between its places in both engines [m]")


class CrossCheck(FrozenMessage):
    """Both engines on the same commands."""

    flights: tuple[EngineFlight, EngineFlight] = Field(description="First the engine that was configured")
    compared_time: float = Field(description="How long the other plant followed the first one's joint rates [s]")
    tolerance: float = Field(description="Of a divergence [m]")
    before_touch: float = Field(description="Greatest distance up to the first touch in either plant [m]")
    first_touch: FirstTouch | None = Field(description="Of the other plant under those joint rates; null if none")
    divergence: Divergence | None = Field(description="Null if they stay within the tolerance")

    same_outcome: bool = Field(description="Whether both flights are of one class, as the paper judges")
    same_first_touch: bool = Field(description="Whether the same tip touches first in both, within two ticks; or none")

    @property
    def same(self) -> bool:
        """Whether the engines agree."""
        return self.same_outcome and self.same_first_touch


def cross_check(config: MissionConfig, *, direct: bool = False) -> CrossCheck:
    """Fly a capture, or direct caging, in both engines.

    Raises:
        ConfigError: the other engine cannot fly this configuration.
        PlantDiverged: the simulated state of one is not finite.

    """
    engines = sorted(Engine, key=lambda engine: engine is not config.simulation.engine)
    configs = [revised(config, {"simulation": {"engine": engine.value}}) for engine in engines]
    rows, outcomes = zip(*(_flown(each, direct) for each in configs), strict=True)
    led, followed = rows[0], _under_rates(configs[1], rows[0]["commanded_joint_rate"])
    led = led[: len(followed)]
    apart = _distances(led, followed)
    touched = np.flatnonzero(led["tip_contact"].any(axis=(1, 2)) | followed["tip_contact"].any(axis=(1, 2)))
    before = apart[: touched[0]] if len(touched) else apart
    flights = tuple(
        EngineFlight(engine=engine.value, outcome=outcome, first_touch=_first_touch(config, ticks))
        for engine, outcome, ticks in zip(engines, outcomes, rows, strict=True)
    )
    return CrossCheck(
        flights=flights,
        same_outcome=flights[0].outcome.at_first_closure is flights[1].outcome.at_first_closure,
        same_first_touch=_same_touch(flights[0].first_touch, flights[1].first_touch, config.control.period),
        compared_time=float(followed["time"][-1]),
        tolerance=TOLERANCE,
        before_touch=float(before.max(initial=0.0)),
        first_touch=_first_touch(config, followed),
        divergence=_divergence(led, apart),
    )


def _flown(config: MissionConfig, direct: bool) -> tuple[Ticks, Outcome]:
    rows: list[Ticks] = []
    outcome = run_capture(config, direct=direct, on_ticks=rows.append).outcome
    return np.concatenate(rows), outcome


def _under_rates(config: MissionConfig, rates: FloatArray) -> Ticks:
    """What a plant does under joint rates, shape (ticks, 2, 3) [rad/s]: poses, hands and contacts at each tick."""
    plant, flown = simulated_plant(config), np.zeros(len(rates), TICK)
    assert plant.handle is not None, "an engine is stepped by compiled code"
    robot = packed(robot_model(config.robot))
    count = _follow_rates(plant.handle, robot, record_of(config), plant.state, np.ascontiguousarray(rates), flown)
    return flown[:count]


@compiled
def _follow_rates(
    handle: PlantHandle, robot: Ticks, parameters: Record, state: Record, rates: FloatArray, rows: Ticks
) -> int:
    """Note a plant's state in each row, then step it under the rates of that row; how many it could follow."""
    shape, links = np.zeros(1, SHAPE)[0], np.zeros(1, CHAIN)[0]
    for place in range(rates.shape[0]):
        row = rows[place]
        set_chain(state.base_pose, robot_shape(handle, robot[0], state, shape), links)
        row.tick, row.time = state.tick, state.time
        copy_vector(row.base_pose, state.base_pose)
        copy_vector(row.target_pose, state.target_pose)
        copy_rows(row.hand_pose, links.hand_pose)
        copy_rows(row.tip_contact, state.tip_contact)
        if not advance_plant(handle, parameters, rates[place], state):
            return place + 1
    return int(rates.shape[0])


_PARTS = ("base", "left hand", "right hand", "target")


def _distances(one: Ticks, other: Ticks) -> FloatArray:
    """Between the places of base, hands and target in two flights [m], shape (ticks, 4)."""
    places = [
        np.stack([ticks["base_pose"], *(ticks["hand_pose"][:, arm] for arm in range(2)), ticks["target_pose"]], axis=1)
        for ticks in (one, other)
    ]
    apart: FloatArray = np.hypot(*np.moveaxis((places[1] - places[0])[..., :2], -1, 0))
    return apart


def _same_touch(one: FirstTouch | None, other: FirstTouch | None, period: float) -> bool:
    if one is None or other is None:
        return one is other
    return (one.arm, one.tip) == (other.arm, other.tip) and abs(one.time - other.time) < 2.5 * period


def _divergence(ticks: Ticks, apart: FloatArray) -> Divergence | None:
    beyond = np.flatnonzero(apart.max(axis=1) > TOLERANCE)
    if not len(beyond):
        return None
    first = int(beyond[0])
    part = int(apart[first].argmax())
    return Divergence(time=float(ticks["time"][first]), part=_PARTS[part], distance=float(apart[first, part]))


def _first_touch(config: MissionConfig, ticks: Ticks) -> FirstTouch | None:
    touching = np.flatnonzero(ticks["tip_contact"].any(axis=(1, 2)))
    if not len(touching):
        return None
    row = ticks[touching[0]]
    arm, tip = (int(place) for place in np.argwhere(row["tip_contact"])[0])
    x, y = tip_position(robot_model(config.robot), row["hand_pose"][arm], tip)
    return FirstTouch(time=float(row["time"]), arm=ARMS[arm], tip=tip + 1, place=(x, y))
