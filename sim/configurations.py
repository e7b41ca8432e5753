"""The named configurations, and how a configuration is revised, read and checked as a whole."""

from __future__ import annotations

import difflib
import json
import math
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from sim.config import (
    PARAMETERS,
    ArmConfig,
    BaseConfig,
    ContactConfig,
    ControlConfig,
    Engine,
    Estimator,
    FilterConfig,
    HandMount,
    ImperfectionsConfig,
    LinkConfig,
    MissionConfig,
    NoiseConfig,
    PerceptionConfig,
    RateConfig,
    RobotConfig,
    ServoConfig,
    SimulationConfig,
    SingularityHandling,
    Source,
    TableConfig,
    TargetConfig,
    TargetShape,
    TrackingConfig,
    value_at,
)
from sim.errors import ConfigError
from sim.method.published.parameters import ImpedanceConfig, PublishedConfig, TouchConfig
from sim.method.registry import MethodName
from sim.model.clearance import initial_overlap
from sim.model.contact_step import CONTACTS, longest_step
from sim.model.inertia import Outline, outlines
from sim.model.shape import even_plate, inner_radius
from sim.model.target import target_shape
from sim.parameters import MethodConfig, points_text
from sim.schema_history import PARAMETER_CHANGES, change_of

MOST_CHANGES = 4 * len(PARAMETERS)
"""Names that one nested mapping of changes may hold, groups included."""

DEEPEST_CHANGE = 8
"""Levels that it may have; parameters have four."""

LONGEST_NAME = 100
"""Characters of a name that are compared, and repeated in a message."""

LARGEST_REACH = 2.0
"""From a polygon's centroid to its farthest corner [m]."""

LEAST_INNER_RADIUS = 1e-3
"""From a polygon's centroid to its nearest side [m]: as deep as a tip may sink in."""

_TOO_SHORT = "too_short"
OF_LENGTH = (_TOO_SHORT, "too_long")
"""Findings about how many values a list has, which are in no unit."""

MOST_FINDINGS = 8
"""Findings that a message lists; it says how many more there are."""


def _printed() -> MissionConfig:
    """The constants of the paper's Tables I and II, digit for digit; what they leave out as `published`."""
    arm = ArmConfig(
        link_1=LinkConfig(length=0.250, mass=0.633, inertia=2.55e-3, centre_of_mass=0.229),
        link_2=LinkConfig(length=0.175, mass=0.647, inertia=1.19e-3, centre_of_mass=0.162),
        # The third row mixes link 3 (its centre) with link and hand together (their mass): no one body has all
        # of its numbers, so both stay as computed with; their 0.2067 kg is what the table rounds.
    )
    base = BaseConfig(mass=8.31, inertia=0.135, centre_of_mass_ahead=0.0761)
    return MissionConfig(
        robot=RobotConfig(base=base, arm=arm),
        target=TargetConfig(mass=2.35, inertia=9.33e-3),
        contact=ContactConfig(friction=0.1),
        published=PublishedConfig(touch=TouchConfig(contact_position=0.8, hand_tilt=0.175, target_tilt=0.175)),
    )


def _figures() -> MissionConfig:
    """The impedance that fits the paper's figures (our inference, docs/method.md)."""
    return MissionConfig(published=PublishedConfig(impedance=ImpedanceConfig(mass=0.2, damping=0.1, stiffness=0.1)))


def _testbed() -> MissionConfig:
    """The air-bearing robot of the paper's experiment (Sec. V): 200 Hz, hands that do not yield, its PID gains.

    The impedance is the middle of the band of successes at m = 0.1 kg, where neither bound is near.
    """
    return MissionConfig(
        robot=RobotConfig(servo=ServoConfig(hand_mount=HandMount.RIGID)),
        control=ControlConfig(
            period=0.005,
            tracking=TrackingConfig(proportional=2.5, integral=0.10),
        ),
        published=PublishedConfig(impedance=ImpedanceConfig(mass=0.1, damping=6.0, stiffness=50.0)),
        simulation=SimulationConfig(time_step=1e-3),
    )


def _becalm() -> MissionConfig:
    """Our own method with its defaults, and what it is meant for: noisy sensors, and a filter that knows the forces."""
    noise = NoiseConfig(
        position=5e-4, angle=math.radians(0.3), velocity=2e-3, spin=0.02, joint_angle=2e-4, joint_rate=2e-3, force=0.02,
        torque=1e-3,
    )  # fmt: skip
    perception = PerceptionConfig(
        estimator=Estimator.MODEL_BASED,
        noise=noise,
        filter=FilterConfig(position=5e-4, angle=math.radians(0.3)),
        contact_threshold=0.045,
    )
    rates = RateConfig(singularity_handling=SingularityHandling.DAMPED)
    return MissionConfig(
        method=MethodName("co_moving_couple"), perception=perception, control=ControlConfig(rates=rates)
    )


def _testbed_becalm() -> MissionConfig:
    """Our own method on the air-bearing robot, whose simulated sensors and table are as wrong as the emulated ones.

    A robot has sensors of its own: there the simulated ones are those of rehearsals.
    """
    testbed = _testbed()
    noise = NoiseConfig(position=2e-4, angle=1e-3, velocity=5e-3, spin=0.02, force=0.02, torque=1e-3)
    imperfections = ImperfectionsConfig(
        force_bias=3e-3, torque_bias=2e-4, encoder_resolution=2.0 * math.pi / 2**19, outliers=1e-3
    )
    perception = PerceptionConfig(
        source=Source.MOTION_CAPTURE,
        estimator=Estimator.MODEL_BASED,
        noise=noise,
        imperfections=imperfections,
        contact_threshold=0.06,
    )
    rates = RateConfig(singularity_handling=SingularityHandling.DAMPED)
    return testbed.model_copy(
        update={
            "method": MethodName("co_moving_couple"),
            "perception": perception,
            "table": TableConfig(drag=5e-3, tilt_x=2e-6, tilt_y=-2e-6),
            "control": testbed.control.model_copy(update={"rates": rates}),
        }
    )


NAMED_CONFIGURATIONS: Mapping[str, MissionConfig] = {
    "published": MissionConfig(),
    "as_printed": _printed(),
    "published_figures": _figures(),
    "testbed": _testbed(),
    "becalm": _becalm(),
    "testbed_becalm": _testbed_becalm(),
}
DEFAULT_CONFIGURATION = "becalm"
"""With which the console opens, and which one capture flies unless another is named."""
REFERENCE_CONFIGURATION = "published"
"""All parameters at their defaults: what studies vary unless another is named."""


def named_configuration(name: str) -> MissionConfig:
    """The configuration of that name.

    Raises:
        ConfigError: no configuration has that name.

    """
    try:
        return NAMED_CONFIGURATIONS[name]
    except KeyError:
        raise ConfigError(f"configuration = {name!r} is unknown; there are {', '.join(NAMED_CONFIGURATIONS)}") from None


def nested(paths: Mapping[str, Any]) -> dict[str, Any]:
    """Full paths to values, as the nested mapping that the models read.

    Raises:
        ConfigError: a value is given for a group.

    """
    tree: dict[str, Any] = {}
    for path, value in paths.items():
        branch = tree
        *groups, leaf = path.split(".")
        for group in groups:
            branch = branch.setdefault(group, {})
            if not isinstance(branch, dict):
                raise ConfigError(f"{shortened(path)}: {shortened(group)} is a group, and is given as a value, too")
        branch[leaf] = value
    return tree


def revised(config: MissionConfig, changes: Mapping[str, Any]) -> MissionConfig:
    """A copy of the configuration with a nested mapping of changes applied and checked as a whole.

    Raises:
        ConfigError: a field that does not exist, a value out of bounds, parts that do not fit, or too many changes.

    """
    require_bounded(changes)
    tree = merged(config.model_dump(mode="json"), changes)
    try:
        result = MissionConfig.model_validate_json(json.dumps(tree))
    except ValidationError as error:
        raise ConfigError(
            explained(error),
            tip="the console and GET /api/v1/mission/config/schema list every parameter with its bounds",
        ) from None
    require_polygon_of_its_kind(result)
    require_centre_of_mass_within(result)
    for body in outlines(result):
        if any(value_at(result, path) != value_at(config, path) for path in body.parameters):
            require_inertia_of_its_size(result, body)
    require_shape_for_method(result)
    require_clear_start(result)
    require_stable_contact(result)
    return result


def require_bounded(changes: Mapping[str, Any]) -> None:
    """Refuse changes of more names or levels than parameters have: explaining each takes time.

    Raises:
        ConfigError: the message names the bound.

    """
    level: list[Any] = [changes]
    names = 0
    for _ in range(DEEPEST_CHANGE):
        level = [list(group.values()) if isinstance(group, Mapping) else group for group in level]
        level = [each for group in level if isinstance(group, list) for each in group]
        names += len(level)
        if names > MOST_CHANGES:
            tip = f"there are {len(PARAMETERS)} parameters; send only what changes"
            raise ConfigError(f"changes = more than {MOST_CHANGES} names", tip=tip)
        if not level:
            return
    tip = "a parameter's path has a few groups, such as published.impedance.damping"
    raise ConfigError(f"changes = more than {DEEPEST_CHANGE} levels", tip=tip)


def require_polygon_of_its_kind(config: MissionConfig) -> None:
    """Refuse vertices that are no convex polygon, or one that is too large or too thin, whatever shape is chosen.

    Raises:
        ConfigError: the message names what is wrong with which vertex, or the size that would be right.

    """
    try:
        shape = even_plate(np.array(config.target.vertices))
    except ConfigError as error:
        raise ConfigError(f"target.{error}", tip=error.tip) from None
    stated = f"target.vertices = {stated_value(config, 'target.vertices')}"
    if shape.corner_circle > LARGEST_REACH:
        raise ConfigError(
            f"{stated}: the farthest corner is {shape.corner_circle:.4g} m from the centroid; it must be at most "
            f"{LARGEST_REACH:g} m",
            tip="vertices are in metres",
        )
    if inner_radius(shape) < LEAST_INNER_RADIUS:
        raise ConfigError(
            f"{stated}: the nearest side is {inner_radius(shape):.4g} m from the centroid; it must be at least "
            f"{LEAST_INNER_RADIUS:g} m, or a tip passes through",
            tip="vertices are in metres",
        )


def require_centre_of_mass_within(config: MissionConfig) -> None:
    """Refuse a target whose centre of mass lies outside of its outline, or so near it that a tip passes it.

    Raises:
        ConfigError: the message names the centre of mass, and what would be right.

    """
    depth = inner_radius(target_shape(config.target))
    if depth < LEAST_INNER_RADIUS:
        target = config.target
        where = f"{-depth:.4g} m outside of" if depth < 0.0 else f"{depth:.4g} m within"
        raise ConfigError(
            f"target.centre_of_mass_x, _y = {target.centre_of_mass_x:g}, {target.centre_of_mass_y:g} m: it lies "
            f"{where} the target's outline, and must be at least {LEAST_INNER_RADIUS:g} m within",
            tip="both are counted from the outline's centroid",
        )


def require_stable_contact(config: MissionConfig) -> None:
    """Refuse a physics step that the reduced plant's stiffest contact does not bear.

    Raises:
        ConfigError: the message names step, contact, and the step that would be right.

    """
    if config.simulation.engine is not Engine.REDUCED:
        return
    bounds = {kind: longest_step(config, kind) for kind in CONTACTS}
    kind = min(bounds, key=lambda name: bounds[name])
    step, bound = config.simulation.time_step, bounds[kind]
    if step <= bound:
        return
    stiffness, damping = (getattr(config.contact, name) for name in CONTACTS[kind])
    words = " and ".join(f"contact.{name}" for name in CONTACTS[kind])
    fraction = config.control.period / math.ceil(config.control.period / bound)
    raise ConfigError(
        f"simulation.time_step = {step:g} s is too long for {words} = {stiffness:g} N/m and {damping:g} N s/m: "
        f"the reduced plant is stable up to {bound:.3g} s, so take {fraction:.3g} or less"
    )


def require_inertia_of_its_size(config: MissionConfig, body: Outline) -> None:
    """Refuse a centre of mass outside of its body, and a moment of inertia that no body of its size can have.

    Raises:
        ConfigError: the message names the parameters; the tip has what would be right.

    """
    size = ", ".join(f"{path} = {stated_value(config, path)}" for path in body.shape)
    if min(body.behind, body.ahead) < 0.0:
        centre = value_at(config, body.place)
        low, high = centre - body.behind, centre + body.ahead
        raise ConfigError(
            f"{body.place} = {centre:g} m: the centre of mass of a {body.what} of {size} lies within it",
            tip=f"it can be from {low:.4g} to {high:.4g} m",
        )
    if body.inertia <= body.most:
        return
    placed = f", {body.place} = {value_at(config, body.place):g} m" if body.place else ""
    raise ConfigError(
        f"{body.group}.inertia = {body.inertia:g} kg m2: a {body.what} of {size}{placed} and {body.group}.mass = "
        f"{body.mass:g} kg has at most {body.most:.4g} kg m2, with all of its mass as far out as it reaches",
        tip=f"change them together; an even plate of that outline has {body.even_plate:.4g} kg m2",
    )


def require_shape_for_method(config: MissionConfig) -> None:
    """Refuse a target of a shape that the chosen method cannot capture.

    Raises:
        ConfigError: the message names the shape, the method, and those that it can.

    """
    method: MethodConfig = getattr(config, config.method.value)
    shapes = method.target_shapes
    if shapes is not None and config.target.shape not in shapes:
        raise ConfigError(
            f"target.shape = {config.target.shape}: method = {config.method.value} captures only a target of shape "
            f"{' or '.join(shapes)}: {method.why_these_shapes}",
            tip=f"set target.shape = {shapes[0]}, or choose another method",
        )
    if method.opposite_sides and config.target.shape is TargetShape.REGULAR_POLYGON and config.target.sides % 2:
        raise ConfigError(
            f"target.sides = {config.target.sides}: method = {config.method.value} captures only a polygon with an "
            f"even number of them: {method.why_these_shapes}",
            tip=f"set target.sides = {config.target.sides + 1}, or choose another method",
        )


def require_clear_start(config: MissionConfig) -> None:
    """Refuse a target that overlaps the robot at the start.

    Raises:
        ConfigError: it does; the message names the part and the depth [m].

    """
    overlap = initial_overlap(config)
    if overlap is None:
        return
    part, depth = overlap
    target = config.target
    raise ConfigError(
        f"target.initial_x = {target.initial_x:g} m, target.initial_y = {target.initial_y:g} m: the target overlaps "
        f"the robot's {part} by {1e3 * depth:.1f} mm at the start; it must be clear of it",
        tip="move the target, or change robot.arm.initial_joint_angle_*",
    )


def merged(tree: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """A nested mapping with nested changes laid over it."""
    result = dict(tree)
    for name, value in changes.items():
        present = result.get(name)
        if isinstance(present, dict) and isinstance(value, Mapping):
            result[name] = merged(present, value)
        else:
            result[name] = value
    return result


def explained(error: ValidationError) -> str:
    """A validation error as one line a finding: field, value and what would be right."""
    lines = []
    findings = independent_findings(error)
    for finding in findings[:MOST_FINDINGS]:
        path = shortened(".".join(str(part) for part in finding["loc"]))
        if finding["type"] == "extra_forbidden":
            lines.append(_unknown_part(path))
        elif path and isinstance(finding["input"], Mapping):  # of a group: its parts do not fit one another
            lines.append(f"{path}: {finding['msg'].removeprefix('Value error, ')}")
        elif path:
            owner = None if finding["type"] in OF_LENGTH else owning_parameter(path)
            unit = "" if owner is None else bracketed_unit(owner)
            lines.append(f"{path} = {shortened(repr(finding['input']))}: {finding['msg']}{unit}")
        else:
            lines.append(finding["msg"].removeprefix("Value error, "))
    if len(findings) > MOST_FINDINGS:
        lines.append(f"and {len(findings) - MOST_FINDINGS} more")
    return "; ".join(lines)


def _unknown_part(path: str) -> str:
    """Why there is nothing of that path in a nested configuration: unknown, or in one piece."""
    if path not in PARAMETERS:
        return unknown_parameter(path)
    nested_path = ": {".join(f'"{name}"' for name in path.split("."))
    return f'"{path}": groups are nested here, {{{nested_path}: ...{"}" * path.count(".")}}}'


def independent_findings(error: ValidationError) -> list[Any]:
    """What pydantic found, but for a list that is too short only because some of its values were refused."""
    findings = error.errors(include_url=False, include_context=False)
    refused = {finding["loc"][:depth] for finding in findings for depth in range(1, len(finding["loc"]))}
    return [each for each in findings if each["type"] != _TOO_SHORT or each["loc"] not in refused]


def shortened(text: str) -> str:
    """The text, or as much of it as a message should repeat."""
    return text if len(text) <= LONGEST_NAME else text[: LONGEST_NAME - 3] + "..."


def owning_parameter(path: str) -> str | None:
    """The parameter at that path, or of which it is a part, as `target.vertices.2.0` is; None if there is none."""
    while path and path not in PARAMETERS:
        path, _, part = path.rpartition(".")
        if not part.isdigit():
            return None
    return path or None


def bracketed_unit(path: str) -> str:
    """The unit of that parameter as a message ends with it; nothing for a pure number or a choice."""
    unit = PARAMETERS[path].json_schema_extra["unit"]
    return "" if unit == "1" else f" [{unit}]"


def stated_value(config: MissionConfig, path: str) -> str:
    """The value of that parameter with its unit, as a message says it."""
    value, unit = value_at(config, path), PARAMETERS[path].json_schema_extra["unit"]
    if isinstance(value, tuple):
        return f"'{points_text(value)}' {unit}"
    return f"{value:g} {unit}" if isinstance(value, float) else str(value)


def unknown_parameter(path: str) -> str:
    """A message that no parameter has this path, with its current name, why it was removed, or the nearest one."""
    change = change_of(path, PARAMETER_CHANGES)
    path = shortened(path)
    if change is not None:
        return f"{path} is no longer a parameter: " + (change.why if change.new is None else f"it is {change.new} now")
    close = difflib.get_close_matches(path, PARAMETERS, n=1)
    return f"{path} is not a parameter" + (f"; did you mean {close[0]}?" if close else "")


def read_config_file(path: Path, kind: str = "config file") -> dict[str, Any]:
    """The nested mapping in a TOML or JSON file; messages call it by its kind.

    Raises:
        ConfigError: the file is missing, is neither, or does not parse.

    """
    try:
        text = path.read_text(encoding="utf-8")
        tree = json.loads(text) if path.suffix == ".json" else tomllib.loads(text)
    except OSError as error:
        raise ConfigError(f"{kind} {str(path)!r}: {error.strerror}") from None
    except ValueError as error:
        raise ConfigError(f"{kind} {str(path)!r} does not parse: {error}") from None
    if not isinstance(tree, dict):
        raise ConfigError(f"{kind} {str(path)!r} holds no table")
    return tree
