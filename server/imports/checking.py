"""What is wrong with the signals of a foreign log: gaps, clocks that step, holes, and units that cannot be right."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from server.imports.sources import Signal
from sim.compiled import FloatArray
from sim.errors import ConfigError

GAP = 5.0
"""Times of samples more control periods apart are a gap."""

_FASTEST_TURN = 20.0
"""No body turns faster [rad/s]: as the schema bounds spins."""
_FARTHEST = 10.0
"""[m]"""
_LARGEST_JOINT = 7.0
"""[rad]: as the schema bounds joint angles."""
_FASTEST_JOINT = 30.0
"""Commanded [rad/s]."""
_DEGREES = float(np.rad2deg(1.0))
_SAME = 0.2
"""Part by which two rates may differ and still be taken for the same, in another unit."""


def in_order(signal: Signal, name: str, notices: list[str]) -> Signal:
    """The samples whose time is later than all before; what the others say is noted.

    Raises:
        ConfigError: no time is a number.

    """
    known = np.isfinite(signal.time)
    time, value = signal.time[known], signal.value[known]
    if not len(time):
        raise ConfigError(f"{name}: none of its times is a number", tip="check time.source and time.unit in the map")
    later = np.concatenate([[True], time[1:] > np.maximum.accumulate(time)[:-1]])
    back = np.diff(time, prepend=time[0])
    steps = np.flatnonzero(back < 0.0)
    if len(steps):
        notices.append(
            f"{name}: its clock steps back {len(steps)} times, first by {-back[steps[0]]:.3g} s at "
            f"{time[steps[0] - 1] - time[0]:.3f} s; {int((~later).sum())} samples are left out"
        )
    return Signal(time[later], value[later])


def note_gaps(time: FloatArray, longest: float, name: str, notices: list[str]) -> list[tuple[float, float]]:
    """Start and end of each gap longer than that [s]; noted."""
    apart = np.diff(time)
    places = np.flatnonzero(apart > longest)
    found = [(float(time[place]), float(time[place + 1])) for place in places]
    if found:
        widest = max(end - start for start, end in found)
        first = found[0][0] - time[0]
        notices.append(f"{name}: {len(found)} gaps, the longest of {widest:.3g} s, the first at {first:.3f} s")
    return found


def note_holes(value: FloatArray, name: str, notices: list[str]) -> None:
    """Note stretches that are not numbers.

    Raises:
        ConfigError: nothing is a number.

    """
    missing = ~np.isfinite(value)
    if missing.all():
        raise ConfigError(f"{name}: none of its {len(value)} values is a number", tip="correct the map")
    runs = int(np.sum(missing & ~np.concatenate([[False], missing[:-1]])))
    if runs:
        notices.append(f"{name}: {int(missing.sum())} of {len(value)} values are not numbers, in {runs} stretches")


def require_radians(signals: Sequence[Signal], unit: str | None, name: str) -> None:
    """Ask for the unit of joint angles that cannot be radians.

    Raises:
        ConfigError: no unit is said, and they are beyond what a joint turns.

    """
    largest = max(float(np.nanmax(np.abs(each.value))) for each in signals)
    if unit is None and largest > _LARGEST_JOINT:
        raise ConfigError(
            f"{name}: {largest:.4g} is beyond {_LARGEST_JOINT:g} rad: are these degrees?",
            tip=f'say unit = "deg" in [{name}] of the map, or unit = "rad" if they are radians',
        )


def require_slow_turns(signal: Signal, unit: str | None, name: str) -> None:
    """Ask for the unit of a body's angle that turns faster than any body in radians.

    Raises:
        ConfigError: no unit is said, and it does.

    """
    known = np.isfinite(signal.value)
    time, value = signal.time[known], signal.value[known]
    if unit is not None or len(time) < 20:
        return
    rate = np.abs(np.polyfit(time[: len(time) // 2] - time[0], np.unwrap(value)[: len(time) // 2], 1)[0])
    largest = float(np.abs(value).max())
    if rate > _FASTEST_TURN or (largest > 2.2 * np.pi and np.abs(np.diff(value)).max() > 6.0):
        raise ConfigError(
            f"{name}.angle: it reaches {largest:.4g} and turns by {rate:.3g} a second: are these degrees?",
            tip=f'say angle_unit = "deg" in [{name}] of the map, or angle_unit = "rad" if they are radians',
        )


def require_metres(signals: Sequence[Signal], unit: str | None, name: str) -> None:
    """Ask for the unit of positions that no testbed has room for in metres.

    Raises:
        ConfigError: no unit is said, and they are.

    """
    largest = max(float(np.nanmax(np.abs(each.value))) for each in signals)
    if unit is None and largest > _FARTHEST:
        raise ConfigError(
            f"{name}: {largest:.4g} is farther than {_FARTHEST:g} m from the origin: are these millimetres?",
            tip=f'say unit = "mm" in [{name}] of the map, or unit = "m" if they are metres',
        )


def require_same_unit(angle: FloatArray, commanded: FloatArray, period: float, unit: str | None) -> None:
    """Ask for the unit of commanded rates that are to the joints' motion as degrees are to radians.

    Args:
        angle: joint angles [rad], shape (rows, 2, 3).
        commanded: rates, likewise.
        period: between rows [s].
        unit: of the commands, if it is said.

    Raises:
        ConfigError: none is said, and they are.

    """
    moved, asked = np.diff(angle, axis=0) / period, commanded[:-1]
    both = np.isfinite(moved) & np.isfinite(asked)
    if unit is not None or not both.any():
        return
    moved, asked = moved[both], asked[both]
    if np.abs(asked).max() < 1e-3:
        return
    slope = float(asked @ moved / (asked @ asked))
    for factor, words in ((1.0 / _DEGREES, "degrees a second"), (_DEGREES, "radians, and the joint angles degrees")):
        if abs(slope / factor - 1.0) < _SAME:
            raise ConfigError(
                f"commanded_joint_rate: joints move {slope:.3g} times as fast as commanded: are the commands {words}?",
                tip='say unit = "deg" or unit = "rad" in [commanded_joint_rate] and [joint_angle] of the map',
            )
    if np.abs(asked).max() > _FASTEST_JOINT:
        raise ConfigError(
            f"commanded_joint_rate: {np.abs(asked).max():.4g} is beyond {_FASTEST_JOINT:g} rad/s: are these degrees?",
            tip='say unit = "deg" or unit = "rad" in [commanded_joint_rate] of the map',
        )
