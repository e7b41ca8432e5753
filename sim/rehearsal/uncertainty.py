"""What is not known for sure of a state, as an editable model, and what one future draws of it.

A draw is a handful of numbers that follow from the seed and the future's number alone, whatever thread flies it. Where
an estimator says how sure it is (`sim.perception.motion`), its covariance takes the place of the model's spread.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from pydantic import Field, ValidationError

from sim.compiled import FloatArray
from sim.config import PARAMETERS, Estimator, MissionConfig, Source
from sim.errors import ConfigError
from sim.model.target import to_centre_of_mass
from sim.parameters import ConfigModel, Number, parameter
from sim.record import Record, record_of
from sim.rehearsal.situation import Situation
from sim.snapshot import FrozenMessage

_LEAST_INVERSE = 0.2
"""An inverse inertia is not drawn under this part of what was assumed: the filter does not believe it either."""


class UncertaintyModel(ConfigModel):
    """How unsure each thing is that a future draws; zero: it is taken to be as believed or as configured.

    Spreads are standard deviations. Factors and relative ones are of the natural logarithm, so that nothing becomes
    negative: 0.2 is about 20 %.
    """

    target_position: Number = parameter(
        1e-3,
        "Of the target's position, each axis, where no estimator says how sure it is",
        unit="m",
        source="chosen: the couple's sensors read it to 0.5 mm; shape and marker are known no better",
        ge=0,
        le=0.1,
    )
    target_angle: Number = parameter(
        0.01,
        "Of the target's angle, likewise",
        unit="rad",
        source="chosen: the couple's sensors read it to 0.3 degrees",
        ge=0,
        le=1,
    )
    target_velocity: Number = parameter(
        2e-3, "Of the target's velocity, each axis, likewise", unit="m/s", source="the couple's sensors", ge=0, le=1
    )
    target_spin: Number = parameter(
        0.02, "Of the target's spin, likewise", unit="rad/s", source="the couple's sensors", ge=0, le=10
    )
    target_mass: Number = parameter(
        0.17,
        "Of the target's mass, relative, where no estimator says how sure it is",
        unit="1",
        source="the couple's sample: 30 % either way, evenly",
        ge=0,
        le=1,
    )
    target_inertia: Number = parameter(
        0.17, "Of the target's moment of inertia, likewise", unit="1", source="as of its mass", ge=0, le=1
    )
    friction: Number = parameter(
        0.2,
        "Of the coefficient of friction: half the range about the configured one, evenly drawn, none below zero",
        unit="1",
        source="the couple's sample: 0.1 to 0.5 about 0.3",
        ge=0,
        le=3,
    )
    contact_stiffness: Number = parameter(
        0.1, "Of the stiffness of all contacts, a factor", unit="1", source="chosen: a tip of rubber", ge=0, le=1
    )
    servo_time_constant: Number = parameter(
        0.1, "Of the servos' time constant, a factor", unit="1", source="chosen: identified to 10 %", ge=0, le=1
    )
    sensor_noise: Number = parameter(
        0.1, "Of the noise of all sensors, a factor", unit="1", source="chosen: identified to 10 %", ge=0, le=1
    )
    delay: Number = parameter(
        1e-3,
        "Of the delay of motion capture, where that is the source",
        unit="s",
        source="chosen: a tick",
        ge=0,
        le=0.1,
    )


CERTAIN = UncertaintyModel(**dict.fromkeys(UncertaintyModel.model_fields, 0.0))
"""Everything is as believed and as configured; only the sensors' noise differs from future to future."""


def uncertainty_of(given: Mapping[str, Any]) -> UncertaintyModel:
    """The model with these values in place of its defaults.

    Raises:
        ConfigError: there is no such field, or a value is out of bounds; the message names field, value and bound.

    """
    try:
        return UncertaintyModel.model_validate(dict(given))
    except ValidationError as error:
        raise ConfigError(
            "; ".join(_finding(each) for each in error.errors(include_url=False)),
            tip=f"its fields are {', '.join(UncertaintyModel.model_fields)}",
        ) from None


def _finding(finding: Any) -> str:
    path = ".".join(map(str, finding["loc"]))
    if finding["type"] == "extra_forbidden":
        return f"uncertainty.{path} is not a field of the uncertainty model"
    field = UncertaintyModel.model_fields.get(str(finding["loc"][0]) if finding["loc"] else "")
    unit = "" if field is None else field.json_schema_extra["unit"]  # type: ignore[index]
    return f"uncertainty.{path} = {finding['input']!r}{'' if unit in ('', '1') else f' {unit}'}: {finding['msg']}"


class DrawnQuantity(NamedTuple):
    """One number of a draw."""

    name: str
    unit: str
    description: str


_MOTION = tuple(
    DrawnQuantity(f"{body}_{name}", unit, f"{words} of the {body}, beside what is believed")
    for body in ("base", "target")
    for name, unit, words in (
        ("x", "m", "Position"),
        ("y", "m", "Position"),
        ("angle", "rad", "Angle"),
        ("velocity_x", "m/s", "Velocity"),
        ("velocity_y", "m/s", "Velocity"),
        ("spin", "rad/s", "Angular velocity"),
    )
)

DRAWN = (
    *_MOTION,
    DrawnQuantity("target_mass", "kg", "Mass of the target"),
    DrawnQuantity("target_inertia", "kg m2", "Moment of inertia of the target"),
    DrawnQuantity("friction", "1", "Coefficient of friction"),
    DrawnQuantity("contact_stiffness", "N/m", "Stiffness of a tip's contact; that of solids changes alike"),
    DrawnQuantity("servo_time_constant", "s", "Time constant of the servos"),
    DrawnQuantity("sensor_noise", "1", "Noise of the sensors over the configured one"),
    DrawnQuantity("delay", "s", "Delay of motion capture"),
)
"""What a future draws, in the order of its random numbers."""


class Draw(FrozenMessage):
    """What one future is flown with: the same numbers give the same flight, bit for bit."""

    future: int = Field(ge=0, description="Its number, from 0")
    seed: int = Field(ge=0, description="Of its sensors' noise")
    values: dict[str, float] = Field(description="Of each of `DRAWN`: offsets of motion, true values of the rest")


def draw(situation: Situation, config: MissionConfig, model: UncertaintyModel, seed: int, future: int) -> Draw:
    """What the future of that number draws in a situation.

    Args:
        situation: the state that it begins in.
        config: that it is flown with.
        model: how unsure what is.
        seed: of the rehearsal.
        future: its number, from 0; each has a stream of its own.

    """
    stream = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(future,)))
    noise_seed, even = int(stream.integers(0, 2**63 - 1)), float(stream.uniform(-1.0, 1.0))
    normal = stream.standard_normal(len(DRAWN))  # last: who adds one at its end changes none of the others
    offsets, mass, inertia = _motion(situation, config, model, normal)
    values = dict(zip((each.name for each in _MOTION), offsets.ravel().tolist(), strict=True))
    factor = dict(zip((each.name for each in DRAWN), normal.tolist(), strict=True))
    contact, servo, perception = config.contact, config.robot.servo, config.perception
    filmed = perception.source is Source.MOTION_CAPTURE
    values |= {
        "target_mass": _within("target.mass", mass),
        "target_inertia": _within("target.inertia", inertia),
        "friction": _within("contact.friction", contact.friction + model.friction * even),
        "contact_stiffness": _within(
            "contact.stiffness", contact.stiffness * math.exp(model.contact_stiffness * factor["contact_stiffness"])
        ),
        "servo_time_constant": _within(
            "robot.servo.time_constant",
            servo.time_constant * math.exp(model.servo_time_constant * factor["servo_time_constant"]),
        ),
        "sensor_noise": math.exp(model.sensor_noise * factor["sensor_noise"]),
        "delay": _delay(config, model.delay * factor["delay"] if filmed else 0.0),
    }
    return Draw(future=future, seed=noise_seed, values=values)


def _within(path: str, value: float) -> float:
    """The value, or the bound of that parameter which it is beyond."""
    for bound in PARAMETERS[path].metadata:
        low = getattr(bound, "ge", getattr(bound, "gt", None))
        high = getattr(bound, "le", getattr(bound, "lt", None))
        value = max(value, low * (1.0 + 1e-9)) if low is not None else value
        value = min(value, high) if high is not None else value
    return float(value)


def _delay(config: MissionConfig, change: float) -> float:
    capture, period = config.perception.capture, config.control.period
    return max(min(capture.delay + change, max(capture.delay, 60.0 * period)), 0.0)


def _motion(
    situation: Situation, config: MissionConfig, model: UncertaintyModel, normal: FloatArray
) -> tuple[FloatArray, float, float]:
    """Offsets of pose and twist of base and target, shape (2, 2, 3), and the target's mass and inertia."""
    unit = normal[:12].reshape(2, 2, 3)
    target, place = config.target, len(_MOTION)
    mass = target.mass * math.exp(model.target_mass * normal[place])
    inertia = target.inertia * math.exp(model.target_inertia * normal[place + 1])
    if (motion := situation.estimate) is not None:
        offsets, believed = _estimated(situation, motion, unit, normal[place : place + 2])
        if config.perception.estimator is Estimator.MODEL_BASED:
            mass, inertia = believed
    else:
        offsets = unit * _spreads(config, model)
    if situation.touching:
        offsets[:, 0] = 0.0  # where hands touch, contact says more about the poses than any reading
    return offsets, mass, inertia


def _spreads(config: MissionConfig, model: UncertaintyModel) -> FloatArray:
    """Standard deviations of pose and twist of base and target, shape (2, 2, 3), where nothing is filtered.

    A reading with noise is as unsure as its noise, one without as the model says; perfect ones know the base.
    """
    noise = config.perception.noise
    base = [[noise.position, noise.position, noise.angle], [noise.velocity, noise.velocity, noise.spin]]
    position, angle = noise.position or model.target_position, noise.angle or model.target_angle
    velocity, spin = noise.velocity or model.target_velocity, noise.spin or model.target_spin
    return np.array([base, [[position, position, angle], [velocity, velocity, spin]]])


def _estimated(
    situation: Situation, motion: Record, unit: FloatArray, of_inertia: FloatArray
) -> tuple[FloatArray, tuple[float, float]]:
    """Draws from the filters' own covariance: offsets, shape (2, 2, 3), and the target's mass and inertia."""
    offsets = np.zeros((2, 2, 3))
    for axis in range(3):
        ahead = situation.time - 1e-9 * float(motion["base"]["stamp"])
        covariance = motion["base"]["p"][axis, :2, :2]
        place, rate = _root(covariance) @ unit[0, :, axis]
        offsets[0, :, axis] = place + ahead * rate, rate
    inverse = (
        _inverse_mass(motion["target"], situation.config, of_inertia[0]),
        _inverse_inertia(motion["target"], situation.config, of_inertia[1]),
    )
    for axis in range(3):
        offsets[1, :, axis] = _target_offset(situation, motion, axis, inverse[axis == 2], unit[1, :, axis])
    return offsets, (1.0 / inverse[0], 1.0 / inverse[1])


def _target_offset(
    situation: Situation, motion: Record, axis: int, inverse: float, unit: FloatArray
) -> tuple[float, float]:
    """Offsets of pose and rate of one axis of the target, given its drawn inverse inertia."""
    target, drift = motion["target"], motion["target_drift"]
    x, p = target["x"][axis], target["p"][axis]
    ahead = situation.time - 1e-9 * float(target["stamp"])
    apart, sure = inverse - x[2], p[2, 2]
    regression = p[:2, 2] / sure if sure > 0.0 else np.zeros(2)
    place, rate = regression * apart + _root(p[:2, :2] - np.outer(regression, p[2, :2])) @ unit
    way = 0.0 if x[2] == 0.0 else (situation.target_pose[axis] - x[0] - ahead * x[1]) / x[2]
    return place + ahead * rate + way * apart, rate + drift["twist"][axis] * apart


def _inverse_inertia(target: Record, config: MissionConfig, normal: float) -> float:
    drawn = float(target["x"][2, 2]) + math.sqrt(max(0.0, float(target["p"][2, 2, 2]))) * normal
    return max(drawn, _LEAST_INVERSE / config.perception.assumed_inertia)


def _inverse_mass(target: Record, config: MissionConfig, normal: float) -> float:
    """Drawn from what both axes say together: each is the same guess beforehand, and learned on its own since."""
    perception = config.perception
    x, p = target["x"][:2, 2], target["p"][:2, 2, 2]
    before = (perception.assumed_mass_uncertainty / perception.assumed_mass) ** 2
    if before == 0.0 or min(p) <= 0.0:
        return max(float(x.mean()), _LEAST_INVERSE / perception.assumed_mass)
    information = 1.0 / p
    total = max(float(information.sum()) - 1.0 / before, float(information.max()))
    mean = (float(information @ x) - 1.0 / (before * perception.assumed_mass)) / total
    mean = mean if total > float(information.max()) else float(x[int(information.argmax())])
    return max(mean + normal / math.sqrt(total), _LEAST_INVERSE / perception.assumed_mass)


def _root(covariance: FloatArray) -> FloatArray:
    """A matrix R with R R^T the covariance, shape (2, 2), lower triangular; of a singular one, too."""
    a = math.sqrt(max(0.0, float(covariance[0, 0])))
    b = float(covariance[1, 0]) / a if a > 0.0 else 0.0
    return np.array([[a, 0.0], [b, math.sqrt(max(0.0, float(covariance[1, 1]) - b * b))]])


def true_config(config: MissionConfig, drawn: Draw) -> MissionConfig:
    """The configuration that the future is flown with: what the method takes for granted stays as it was."""
    values = drawn.values
    servo = config.robot.servo.model_copy(update={"time_constant": values["servo_time_constant"]})
    stiffer = values["contact_stiffness"] / config.contact.stiffness
    noise, capture = config.perception.noise, config.perception.capture
    noisier = {
        name: value * values["sensor_noise"]
        for name in type(noise).model_fields
        if isinstance(value := getattr(noise, name), float)
    }
    return config.model_copy(
        update={
            "robot": config.robot.model_copy(update={"servo": servo}),
            "target": config.target.model_copy(
                update={"mass": values["target_mass"], "inertia": values["target_inertia"]}
            ),
            "contact": config.contact.model_copy(
                update={
                    "friction": values["friction"],
                    "stiffness": values["contact_stiffness"],
                    "solid_stiffness": config.contact.solid_stiffness * stiffer,
                }
            ),
            "perception": config.perception.model_copy(
                update={
                    "noise": noise.model_copy(update=noisier),
                    "capture": capture.model_copy(update={"delay": values["delay"]}),
                }
            ),
            "simulation": config.simulation.model_copy(update={"seed": drawn.seed}),
        }
    )


def true_state(situation: Situation, drawn: Draw) -> Record:
    """The state that the future begins in, one element of `PLANT_STATE`."""
    state = situation.state.copy()
    offsets = np.array([drawn.values[each.name] for each in _MOTION]).reshape(2, 2, 3)
    for body, name in enumerate(("base", "target")):
        state[f"{name}_pose"] += offsets[body, 0]
        state[f"{name}_twist"] += offsets[body, 1]
    to_centre_of_mass(record_of(situation.config.target), state["target_pose"], state["target_twist"])
    return state
