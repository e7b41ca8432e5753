"""What a fit may vary: parameters of the configuration, and when commands come.

Each has a prior: its nominal value with a wide spread, and bounds. A value that a run says nothing about stays there.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from sim.compiled import FloatArray
from sim.config import PARAMETERS, HandMount, MissionConfig, value_at
from sim.errors import ConfigError

STAMP_ERROR = "perception.capture.stamp_error"
COMMAND_DELAY = "command.delay"


class Parameter(NamedTuple):
    """Something that a fit may vary."""

    name: str
    """Full path of a parameter of the configuration, or a name of its own."""
    unit: str
    description: str
    nominal: float
    """What is taken for granted without a fit; the mean of the prior."""
    spread: float
    """Standard deviation of the prior, and the scale of the parameter."""
    low: float
    """Bounds."""
    high: float

    @property
    def in_configuration(self) -> bool:
        """Whether a preset can keep it."""
        return self.name in PARAMETERS


_SPREADS: Mapping[str, tuple[float, float]] = {
    "contact.stiffness": (1.0, 0.0),
    "contact.damping": (1.0, 1.0),
    "contact.friction": (0.0, 0.3),
    "contact.friction_speed": (1.0, 0.0),
    "contact.solid_stiffness": (1.0, 0.0),
    "contact.solid_damping": (1.0, 1.0),
    "robot.servo.time_constant": (1.0, 3e-3),
    "robot.base.mass": (0.3, 0.0),
    "robot.base.inertia": (0.5, 0.0),
    "robot.base.centre_of_mass_ahead": (0.0, 0.05),
    "target.mass": (0.5, 0.0),
    "target.inertia": (0.5, 0.0),
    "target.centre_of_mass_x": (0.0, 0.01),
    "target.centre_of_mass_y": (0.0, 0.01),
    STAMP_ERROR: (0.0, 0.01),
    "table.drag": (0.0, 0.05),
    "table.tilt_x": (0.0, 1e-3),
    "table.tilt_y": (0.0, 1e-3),
    **{
        f"perception.wrist.{arm}.{name}": (0.0, spread)
        for arm in ("left", "right")
        for name, spread in (("gain", 0.2), ("bias_x", 0.3), ("bias_y", 0.3), ("bias_torque", 0.01))
    },
}
"""Of the configuration: the prior's spread, relative to the nominal value and beside it."""

_OWN: Mapping[str, tuple[str, str, float, float, float, float]] = {
    COMMAND_DELAY: ("s", "From a commanded joint rate to the servo that follows it", 0.0, 5e-3, -5e-3, 0.1),
}
"""What the configuration has not: unit, words, nominal value, spread, bounds."""

ALL = (*_SPREADS, *_OWN)
"""Names of everything that can be fitted."""

DEFAULT = (
    "contact.stiffness",
    "contact.damping",
    "contact.friction",
    "robot.servo.time_constant",
    STAMP_ERROR,
    COMMAND_DELAY,
    "target.inertia",
    "table.drag",
    "table.tilt_x",
    "table.tilt_y",
)
"""What is fitted unless something else is asked for; of these, what the runs do not tell stays nominal."""

CONTACT_ONLY = ("contact.", "target.mass", "target.inertia", "perception.wrist.")
"""How the names begin of what free flight says nothing about."""

MOST = 16
"""Parameters of one fit."""


def parameters_of(config: MissionConfig, names: Sequence[str], command_delay: float = 0.0) -> tuple[Parameter, ...]:
    """The parameters of these names, about a run's own configuration.

    Args:
        config: that the run was flown with: what is nominal.
        names: as in `ALL`.
        command_delay: nominal delay of commands, as the joints show it [s].

    Raises:
        ConfigError: a name is unknown or stands twice, or there are none or too many.

    """
    for place, name in enumerate(names):
        if name not in ALL:
            raise ConfigError(f"parameters: {name!r} cannot be fitted", tip=f"what can be: {', '.join(ALL)}")
        if name in names[:place]:
            raise ConfigError(f"parameters: {name} stands twice", tip="name each once")
    if not 1 <= len(names) <= MOST:
        raise ConfigError(f"parameters: {len(names)} are given; from 1 to {MOST} are fitted at once")
    return tuple(parameter_of(config, name, command_delay) for name in names)


def parameter_of(config: MissionConfig, name: str, command_delay: float = 0.0) -> Parameter:
    """One of `ALL`, about a configuration."""
    if name in _OWN:
        unit, words, nominal, spread, low, high = _OWN[name]
        return Parameter(name, unit, words, command_delay if name == COMMAND_DELAY else nominal, spread, low, high)
    field, nominal = PARAMETERS[name], float(value_at(config, name))
    relative, beside = _SPREADS[name]
    low, high = bounds_of(name)
    unit = str(field.json_schema_extra["unit"])
    return Parameter(name, unit, str(field.description), nominal, abs(nominal) * relative + beside, low, high)


def bounds_of(path: str) -> tuple[float, float]:
    """The bounds of a parameter of the configuration; infinite where there is none."""
    low, high = -math.inf, math.inf
    for bound in PARAMETERS[path].metadata:
        low = max(low, getattr(bound, "ge", getattr(bound, "gt", low)))
        high = min(high, getattr(bound, "le", getattr(bound, "lt", high)))
    return float(low), float(high)


class Hypothesis(NamedTuple):
    """What robot, target, table and sensors are taken to be."""

    config: MissionConfig
    command_delay: float
    """[s]"""


def hypothesis(config: MissionConfig, values: Mapping[str, float], command_delay: float = 0.0) -> Hypothesis:
    """What is so if these values are; everything else is as configured."""
    return Hypothesis(
        config=changed(config, {name: value for name, value in values.items() if name in PARAMETERS}),
        command_delay=float(values.get(COMMAND_DELAY, command_delay)),
    )


def changed(config: MissionConfig, values: Mapping[str, float]) -> MissionConfig:
    """A copy with these numbers by their full paths, which are within their bounds: nothing is checked."""
    result: Any = config
    for path, value in values.items():
        result = _with(result, path.split("."), value)
    return result  # type: ignore[no-any-return]


def _with(group: Any, names: Sequence[str], value: float) -> Any:
    inner = value if len(names) == 1 else _with(getattr(group, names[0]), names[1:], value)
    return group.model_copy(update={names[0]: inner})


def scaled_bounds(parameters: Sequence[Parameter]) -> tuple[FloatArray, FloatArray]:
    """Bounds as multiples of each parameter's spread away from its nominal value, shape (parameters,)."""
    low = np.array([(each.low - each.nominal) / each.spread + 1e-6 for each in parameters])
    high = np.array([(each.high - each.nominal) / each.spread for each in parameters])
    return low, high


def yields(config: MissionConfig) -> bool:
    """Whether the hands turn on their mounts under contact."""
    return config.robot.servo.hand_mount is HandMount.YIELDING
