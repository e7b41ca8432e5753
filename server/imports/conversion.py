"""A foreign log as ticks: every signal brought to the control periods, and what was found wrong on the way."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from server.imports import checking
from server.imports.mapping import JointMap, LogMap, PoseMap, WrenchMap
from server.imports.sources import Signal, signals
from server.library.record import TickArray
from sim.capture.tick import TICK
from sim.compiled import FloatArray
from sim.config import MissionConfig
from sim.errors import ConfigError
from sim.model.robot import chain, robot_model
from sim.perception.contact import is_touching
from sim.record import packed

_RADIANS = {"deg": np.pi / 180.0, "rad": 1.0, None: 1.0}
_METRES = {"mm": 1e-3, "m": 1.0, None: 1.0}

MOST_TICKS = 720_000
"""An hour at 200 Hz."""

_PERIOD_OFF = 0.2
"""Joint states may come by that part sooner or later than every control period."""

_TWIST_SPAN = 0.05
"""Of poses by whose straight line a twist is shown [s]."""


class Converted(NamedTuple):
    """A log as ticks."""

    config: MissionConfig
    ticks: TickArray
    """Rows of `TICK`; numbers jump across gaps."""
    notices: list[str]
    """What was found wrong."""


def converted(path: Path, given: LogMap) -> Converted:
    """The ticks of a foreign log.

    Raises:
        ConfigError: it cannot be read, or a unit cannot be right; the message names what, and says what to do.

    """
    config, notices = given.config(), list[str]()
    names = _names(given)
    found = {
        name: checking.in_order(signal, name, notices)
        for name, signal in signals(path, names, given.time.source, given.time.unit).items()
    }
    grid = _Grid(found, given, config, notices)
    rows = np.zeros(len(grid.tick), TICK)
    for name in TICK.names or ():
        if TICK[name].base.kind == "f":
            rows[name] = np.nan
    rows["tick"], rows["time"] = grid.tick, grid.tick * config.control.period
    _fill_joints(rows, grid, given, notices)
    for body, of in (("base", given.base_pose), ("target", given.target_pose)):
        _fill_pose(rows, grid, of, body)
    _fill_hands(rows, config)
    for arm, wrench in enumerate((given.left_wrench, given.right_wrench)):
        _fill_wrench(rows, grid, wrench, arm, config)
    if given.commanded_joint_rate is None:
        notices.append("it has no commands: it can be looked at and compared, but not fitted")
    return Converted(config, rows, notices)


def _names(given: LogMap) -> list[str]:
    found = [*given.joint_angle.left, *given.joint_angle.right]
    if given.commanded_joint_rate is not None:
        found += [*given.commanded_joint_rate.left, *given.commanded_joint_rate.right]
    for pose in (given.base_pose, given.target_pose):
        found += [pose.x, pose.y, *([pose.angle] if pose.angle else _quaternion(pose))]
    for wrench in (given.left_wrench, given.right_wrench):
        found += [] if wrench is None else [wrench.x, wrench.y, wrench.torque]
    return list(dict.fromkeys(found))


def _quaternion(pose: PoseMap) -> list[str]:
    """The names of z and w, which tell a turn about the vertical."""
    stem = pose.quaternion or ""
    return [f"{stem}.z", f"{stem}.w"]


class _Grid:
    """Control periods in which joints were seen, and signals at them."""

    def __init__(self, found: dict[str, Signal], given: LogMap, config: MissionConfig, notices: list[str]) -> None:
        self.found, self.period = found, config.control.period
        time = found[given.joint_angle.left[0]].time
        usual = float(np.median(np.diff(time))) if len(time) > 2 else np.inf
        if not abs(usual / self.period - 1.0) <= _PERIOD_OFF:
            raise ConfigError(
                f"joint_angle: its samples are {usual:.4g} s apart, and control.period is {self.period:g} s",
                tip=f"set control.period = {usual:.3g} in [changes] of the map, or check time.unit",
            )
        self.start = float(time[0])
        last = round((float(time[-1]) - self.start) / self.period)
        if last >= MOST_TICKS:
            most = MOST_TICKS * self.period
            raise ConfigError(f"it lasts {last * self.period:.0f} s; at most {most:.0f} s are imported")
        self.tick = np.arange(last + 1)
        inside = np.ones(last + 1, dtype=bool)
        for begin, end in checking.note_gaps(time, checking.GAP * self.period, "joint_angle", notices):
            at = self.start + self.tick * self.period
            inside &= ~((at > begin + 0.5 * self.period) & (at < end - 0.5 * self.period))
        self.tick = self.tick[inside]
        self.time = self.start + self.tick * self.period
        for name, signal in found.items():
            checking.note_holes(signal.value, name, notices)

    def between(self, name: str) -> FloatArray:
        """By straight lines; not a number where the samples beside it are none, or far."""
        time, value = self.found[name]
        known = np.isfinite(value)
        if known.sum() < 2:
            return np.full(len(self.time), np.nan)
        result: FloatArray = np.interp(self.time, time[known], value[known], left=np.nan, right=np.nan)
        after = np.clip(np.searchsorted(time[known], self.time), 1, known.sum() - 1)
        apart = time[known][after] - time[known][after - 1]
        result[apart > checking.GAP * max(self.period, float(np.median(np.diff(time))))] = np.nan
        return result

    def held(self, name: str) -> FloatArray:
        """The last sample, as commands hold."""
        time, value = self.found[name]
        place = np.searchsorted(time, self.time + 1e-9, side="right") - 1
        return np.where(place >= 0, value[np.maximum(place, 0)], np.nan)

    def seen(self, name: str) -> FloatArray:
        """Each sample at the control period nearest to its time; not a number in all others."""
        time, value = self.found[name]
        result = np.full(len(self.time), np.nan)
        place = np.clip(np.searchsorted(self.time, time), 1, len(self.time) - 1)
        place -= self.time[place] - time > time - self.time[place - 1]
        near = np.abs(self.time[place] - time) <= 0.51 * self.period
        result[place[near]] = value[near]
        return result


def _joints(grid: _Grid, of: JointMap, at: str) -> FloatArray:
    read = grid.held if at == "held" else grid.between
    columns = [read(name) for name in (*of.left, *of.right)]
    result: FloatArray = _RADIANS[of.unit] * np.stack(columns, axis=1).reshape(-1, 2, 3)
    return result


def _fill_joints(rows: TickArray, grid: _Grid, given: LogMap, notices: list[str]) -> None:
    joints = given.joint_angle
    checking.require_radians([grid.found[name] for name in (*joints.left, *joints.right)], joints.unit, "joint_angle")
    rows["joint_angle"] = _joints(grid, joints, "between")
    rows["joint_rate"] = np.gradient(rows["joint_angle"], grid.time, axis=0) if len(rows) > 1 else 0.0
    rows["mount_angle"] = rows["mount_rate"] = 0.0
    if given.commanded_joint_rate is not None:
        commanded = _joints(grid, given.commanded_joint_rate, "held")
        checking.require_same_unit(rows["joint_angle"], commanded, grid.period, given.commanded_joint_rate.unit)
        if np.isnan(commanded).any():
            notices.append(f"commanded_joint_rate: {int(np.isnan(commanded).any(axis=(1, 2)).sum())} ticks have none")
        rows["commanded_joint_rate"] = commanded


def _fill_pose(rows: TickArray, grid: _Grid, of: PoseMap, body: str) -> None:
    """As it was seen, for fits; and between, for plots and the scene."""
    name = f"{body}_pose"
    checking.require_metres([grid.found[of.x], grid.found[of.y]], of.unit, name)
    if of.angle is None:
        z, w = (grid.found[each] for each in _quaternion(of))
        angle = Signal(z.time, 2.0 * np.arctan2(z.value, np.interp(z.time, w.time, w.value)))
    else:
        checking.require_slow_turns(grid.found[of.angle], of.angle_unit, name)
        read = grid.found[of.angle]
        angle = Signal(read.time, _RADIANS[of.angle_unit] * read.value)
    known = np.isfinite(angle.value)
    grid.found[f"{name}.angle"] = Signal(angle.time[known], np.unwrap(angle.value[known]))
    for axis, source, factor in ((0, of.x, _METRES[of.unit]), (1, of.y, _METRES[of.unit]), (2, f"{name}.angle", 1.0)):
        rows[f"{body}_perceived_pose"][:, axis] = factor * grid.seen(source)
        rows[name][:, axis] = factor * _nowhere_empty(grid.between(source))
    twist = _twist(rows[name], grid.period)
    rows[f"{body}_twist"], rows[f"{body}_perceived_twist"] = twist, twist


def _nowhere_empty(values: FloatArray) -> FloatArray:
    """With the nearest known values where nothing is known: a scene must show something."""
    known = np.flatnonzero(np.isfinite(values))
    if not len(known):
        return np.zeros(len(values))
    return np.interp(np.arange(len(values)), known, values[known])


def _twist(pose: FloatArray, period: float) -> FloatArray:
    """By differences over `_TWIST_SPAN`, to be shown."""
    reach = max(1, round(0.5 * _TWIST_SPAN / period))
    rows = np.arange(len(pose))
    before, after = np.maximum(rows - reach, 0), np.minimum(rows + reach, len(pose) - 1)
    span = np.maximum(after - before, 1) * period
    result: FloatArray = (pose[after] - pose[before]) / span[:, None]
    return result


def _fill_hands(rows: TickArray, config: MissionConfig) -> None:
    robot = packed(robot_model(config.robot))[0]
    angle = np.nan_to_num(rows["joint_angle"])
    for row in range(len(rows)):
        links = chain(robot, rows["base_pose"][row], angle[row], np.zeros(2))
        rows["hand_pose"][row] = links.hand_pose
    for arm in range(2):
        rows["hand_twist"][:, arm] = _twist(rows["hand_pose"][:, arm], config.control.period)


def _fill_wrench(rows: TickArray, grid: _Grid, of: WrenchMap | None, arm: int, config: MissionConfig) -> None:
    """In world axes, on the hand, and where it says touch; without a wrist nothing is felt."""
    wrench = np.full((len(rows), 3), np.nan)
    if of is not None:
        sign = -1.0 if of.acts_on == "target" else 1.0
        wrench = sign * np.stack([grid.between(name) for name in (of.x, of.y, of.torque)], axis=1)
        if of.frame == "hand":
            cosine, sine = np.cos(rows["hand_pose"][:, arm, 2]), np.sin(rows["hand_pose"][:, arm, 2])
            wrench[:, :2] = np.stack(
                [cosine * wrench[:, 0] - sine * wrench[:, 1], sine * wrench[:, 0] + cosine * wrench[:, 1]], axis=1
            )
    rows["hand_wrench"][:, arm] = np.nan_to_num(wrench)
    rows["perceived_hand_wrench"][:, arm] = wrench
    rows["tip_force"][:, arm] = 0.0
    rest = np.nanmedian(wrench[:, :2], axis=0) if np.isfinite(wrench[:, :2]).any() else np.zeros(2)
    force = np.nan_to_num(np.hypot(*(wrench[:, :2] - rest).T))
    rows["perceived_contact"][:, arm] = _touching(force, config.perception.contact_threshold)
    rows["tip_contact"][:, arm, 0] = rows["perceived_contact"][:, arm]


def _touching(force: FloatArray, threshold: float) -> Sequence[bool]:
    found, touching = [], False
    for each in force.tolist():
        touching = bool(is_touching(touching, each, threshold))
        found.append(touching)
    return found
