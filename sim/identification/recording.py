"""A recorded run as a fit reads it: what was commanded, and what was perceived; never what only a simulation knows."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.signal import lfilter

from sim.capture.events import Ticks
from sim.compiled import FloatArray
from sim.config import Estimator, MissionConfig, Source
from sim.errors import MissionRefused
from sim.identification.pictures import pictures
from sim.identification.proximity import is_near
from sim.perception.perceived import is_perfect
from sim.record import record_of

Numbers = np.ndarray[Any, np.dtype[np.int64]]
BoolArray = np.ndarray[Any, np.dtype[np.bool_]]

SHORTEST = 1.0
"""A shorter run says too little [s]."""

MOST_DELAY = 6
"""Control periods by which commands may be late when they are looked for in the joints' motion."""

MOST_MISSED = 4
"""Joint states in a row that may be missed without a gap: for so long a robot surely keeps its joint rates."""

_TIME_CONSTANTS = (3e-4, 1e-3, 2e-3, 3e-3, 4e-3, 6e-3, 8e-3, 0.012, 0.016, 0.025, 0.04)
"""Of servos, tried when the delay of commands is looked for [s]."""

_SAME_RATE = 1e-9
"""Rates of a robot differ by less from the differences of its angles [rad/s]."""

_MOVING = 1e-3
"""Below this no joint is commanded [rad/s]."""


@dataclass(frozen=True)
class Recording:
    """One run. Arrays lead with the row; rows of a segment are a control period apart."""

    name: str
    config: MissionConfig
    """That it was flown with."""
    time: FloatArray
    """Mission time [s], shape (rows,)."""
    segment: Numbers
    """Number of the stretch without a gap that a row belongs to, shape (rows,)."""
    commanded: FloatArray
    """Joint rates [rad/s], shape (rows, 2, 3): decided at the row's instant."""
    joint_angle: FloatArray
    """Shape (rows, 2, 3)."""
    mount_angle: FloatArray
    """As far as it is known, shape (rows, 2)."""
    base_pose: FloatArray
    """Shape (rows, 3); not a number where it was not seen."""
    target_pose: FloatArray
    """Likewise."""
    wrench: FloatArray
    """What the target does to the hands, about their centres, world axes, shape (rows, 2, 3)."""
    touching: BoolArray
    """Whether a hand was felt to touch, shape (rows, 2)."""
    near: BoolArray
    """Whether the target may touch the robot without being felt, shape (rows,)."""
    gated: bool
    """Whether a wrench is zero wherever no touch is felt."""
    threshold: float
    """Force that a hand does not feel as a touch [N]; zero where sensors are perfect."""
    smoothing: float
    """Time constant by which wrenches lag behind [s]."""
    command_delay: float
    """Of commands, in whole control periods, as the joints show it [s]."""
    servo_guess: float
    """Time constant of the servos, as roughly as the joints show it at a glance [s]; 0 where none moves."""

    @property
    def period(self) -> float:
        """Control period [s]."""
        return self.config.control.period

    @property
    def felt_force(self) -> FloatArray:
        """Size of each hand's force [N], shape (rows, 2)."""
        force: FloatArray = np.hypot(self.wrench[..., 0], self.wrench[..., 1])
        return force


def recording(
    name: str, config: MissionConfig, chunks: Iterable[Ticks], *, raw: bool = False, robot: bool = False
) -> Recording:
    """A run from its ticks, consecutive arrays of `TICK`.

    Args:
        name: of the run.
        config: that it was flown with.
        chunks: its ticks.
        raw: whether poses and wrenches are readings themselves, as of an imported log, and no filter's.
        robot: whether a robot was flown; of earlier logs, which do not say so, it is seen in their joint rates.

    Raises:
        MissionRefused: nothing can be learnt from it; the message says why, and what would be needed.

    """
    found = [chunk for chunk in chunks if len(chunk)]
    if not found:
        raise MissionRefused(f"run {name}: it has no ticks", tip="take a run that has flown")
    rows = np.concatenate(found)
    _require_usable(name, config, rows)
    rows, missed = _on_grid(rows, config.control.period)
    robots = raw or robot or _is_of_robot(config, rows)
    modelled = not raw and config.perception.estimator is Estimator.MODEL_BASED
    commanded, angle = rows["commanded_joint_rate"].copy(), rows["joint_angle"].copy()
    segment = np.concatenate([[0], np.cumsum(np.diff(rows["tick"]) != 1)])
    wrench = np.where(missed[:, None, None], np.nan, rows["perceived_hand_wrench"])
    touching = rows["perceived_contact"] != 0
    perfect = bool(is_perfect(record_of(config.perception))) and not robots
    filmed = robots or config.perception.source is Source.MOTION_CAPTURE
    delay, constant = _lag_of_joints(commanded, angle, segment, config.control.period)
    base, target = rows["base_perceived_pose"], rows["target_perceived_pose"]
    if filmed and not modelled and not raw:
        base, target = pictures(config, rows)
    return Recording(
        name=name,
        config=config,
        time=rows["time"].copy(),
        segment=segment,
        commanded=commanded,
        joint_angle=angle,
        mount_angle=np.nan_to_num(rows["mount_angle"]),
        base_pose=_unwound(base),
        target_pose=_unwound(target),
        wrench=wrench,
        touching=touching,
        near=is_near(config, base, angle, target),
        gated=not rows["perceived_hand_wrench"][~touching].any(),
        threshold=0.0 if perfect else config.perception.contact_threshold,
        smoothing=config.perception.force_smoothing_time if modelled else 0.0,
        command_delay=delay,
        servo_guess=constant,
    )


def _on_grid(rows: Ticks, period: float) -> tuple[Ticks, BoolArray]:
    """Rows a control period apart, and which of them nobody has read.

    A console that misses a joint state goes on with the next one: the tick after the last, but later by two periods.
    In between the robot goes on as it was commanded, joints on their way from the one reading to the other. Where more
    than `MOST_MISSED` are missing there is a gap in the ticks.
    """
    late = np.rint(np.diff(rows["time"]) / period).astype(int) - np.diff(rows["tick"])
    put_in = np.concatenate([np.where((late > 0) & (late <= MOST_MISSED), late, 0), [0]])
    after = np.cumsum(1 + put_in) - 1 - put_in
    result = np.repeat(rows, 1 + put_in)
    places = np.arange(len(result))
    missed: BoolArray = ~np.isin(places, after)
    result["tick"] = rows["tick"][0] + places
    jumped = np.concatenate(
        [[0], np.cumsum(np.maximum(0, np.diff(rows["tick"]) - 1) + np.where(late > MOST_MISSED, late, 0))]
    )
    result["tick"] += np.repeat(jumped, 1 + put_in)
    since = (places - after[np.searchsorted(after, places, side="right") - 1]) * period
    result["time"] += since
    for body in ("base", "target"):
        result[f"{body}_perceived_pose"] += since[:, None] * result[f"{body}_perceived_twist"]
    angle = rows["joint_angle"].reshape(len(rows), -1)
    for joint in range(angle.shape[1]):
        result["joint_angle"].reshape(len(result), -1)[missed, joint] = np.interp(
            places[missed], after, angle[:, joint]
        )
    return result, missed


def _is_of_robot(config: MissionConfig, rows: Ticks) -> bool:
    """Whether the ticks are a robot's, whose joint rates are the differences of its encoders.

    A robot's configuration is that of perfect sensors: what its link tells counts as the state.
    """
    if not is_perfect(record_of(config.perception)) or len(rows) < 3:
        return False
    whole = np.diff(rows["tick"]) == 1
    rates = np.diff(rows["joint_angle"], axis=0)[whole] / config.control.period
    return bool(np.median(np.abs(rates - rows["joint_rate"][1:][whole])) < _SAME_RATE and rates.any())


def _unwound(pose: FloatArray) -> FloatArray:
    """Poses whose angle does not jump by a turn, shape (rows, 3); what is not a number stays so."""
    result: FloatArray = pose.copy()
    seen = np.isfinite(result[:, 2])
    result[seen, 2] = np.unwrap(result[seen, 2])
    return result


def _require_usable(name: str, config: MissionConfig, rows: Ticks) -> None:
    """Refuse what nothing can be learnt from."""
    period = config.control.period
    if len(rows) * period < SHORTEST:
        raise MissionRefused(
            f"run {name}: {len(rows) * period:.2f} s are recorded; a fit takes {SHORTEST:g} s or more",
            tip="take a longer run",
        )
    commanded = rows["commanded_joint_rate"]
    if not np.isfinite(commanded).any():
        raise MissionRefused(
            f"run {name}: commanded_joint_rate is not in its log: it has no commands, and a fit flies them again",
            tip="import it with the commanded joint rates, or record them",
        )
    for field in ("joint_angle", "base_perceived_pose", "target_perceived_pose"):
        missing = float(np.mean(~np.isfinite(rows[field])))
        if missing > 0.9:
            raise MissionRefused(
                f"run {name}: {field} is not a number in {missing:.0%} of its ticks",
                tip="a fit needs joint angles, and the poses of base and target",
            )


def _lag_of_joints(commanded: FloatArray, angle: FloatArray, segment: Numbers, period: float) -> tuple[float, float]:
    """How late commands are, in whole control periods, and the servos' time constant, that explain joints best [s].

    Both are 0 where no joint is commanded. The shorter delay counts where two are as good.
    """
    rates = np.nan_to_num(commanded)
    if not np.abs(rates).max(initial=0.0) > _MOVING or len(rates) < 3 * MOST_DELAY:
        return 0.0, 0.0
    moved = np.diff(angle, axis=0)[MOST_DELAY:]
    whole = (np.diff(segment) == 0)[MOST_DELAY:, None, None] & np.isfinite(moved)
    misses = np.empty((MOST_DELAY + 1, len(_TIME_CONSTANTS)))
    for late in range(MOST_DELAY + 1):
        for place, constant in enumerate(_TIME_CONSTANTS):
            expected = _servo_motion(rates, constant, period)[MOST_DELAY - late : len(rates) - 1 - late]
            misses[late, place] = np.mean(np.where(whole, moved - expected, 0.0) ** 2)
    best = misses.min(axis=1)
    late = int(np.flatnonzero(best <= 1.02 * best.min())[0])
    return period * late, _TIME_CONSTANTS[int(np.argmin(misses[late]))]


def _servo_motion(rates: FloatArray, constant: float, period: float) -> FloatArray:
    """By how much a first-order servo moves each joint in each period [rad], from rest on; shape of the rates."""
    decay = math.exp(-period / constant)
    rate = lfilter([0.0, 1.0 - decay], [1.0, -decay], rates, axis=0)
    moved: FloatArray = period * rates + (rate - rates) * constant * (1.0 - decay)
    return moved


def commands_at(recorded: Recording, delay: float) -> FloatArray:
    """The joint rates in force from each row to the next [rad/s], shape (rows, 2, 3), if commands are that late [s].

    A delay between two periods blends what both give: rates are those on average over the period.
    """
    whole, part = divmod(delay / recorded.period, 1.0)
    late = int(whole)
    commanded = np.nan_to_num(recorded.commanded)
    place, end = np.arange(len(commanded)), len(commanded) - 1
    early = commanded[np.clip(place - late, 0, end)]
    if part == 0.0:
        return early
    later = commanded[np.clip(place - late - 1, 0, end)]
    blended: FloatArray = (1.0 - part) * early + part * later
    return blended
