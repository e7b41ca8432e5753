"""The noise of the sensors: white and Gaussian, each value from the seed, the tick and the channel alone.

So a run is the same bit for bit wherever it flies, and a replay from recorded states hears the same noise again.
"""

from __future__ import annotations

import math

import numpy as np

from sim.compiled import compiled, compiled_inline
from sim.record import Record

_STEP = np.uint64(0x9E3779B97F4A7C15)
_FIRST, _SECOND = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_30, _27, _31, _11 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11)
_ONE = np.uint64(1)

_BASE, _TARGET, _JOINTS, _WRENCHES = 0, 6, 12, 24
"""First channels of the sensors; each pose, twist, joint or wrench has one a number."""


@compiled_inline
def is_noisy(noise: Record) -> bool:
    """Whether any sensor has noise."""
    return bool(
        noise.position > 0.0
        or noise.angle > 0.0
        or noise.velocity > 0.0
        or noise.spin > 0.0
        or noise.joint_angle > 0.0
        or noise.joint_rate > 0.0
        or noise.force > 0.0
        or noise.torque > 0.0
    )


@compiled
def add_noise(noise: Record, seed: int, known: Record) -> None:
    """Add to every reading in one element of `PERCEIVED` the noise of its sensor at that tick.

    Args:
        noise: of `NoiseConfig`: standard deviations, SI.
        seed: of the run.
        known: the readings; changed.

    """
    drawn = _of_tick(seed, known.tick)
    for axis in range(3):
        place, rate = (noise.angle, noise.spin) if axis == 2 else (noise.position, noise.velocity)
        known.base_pose[axis] += place * _gaussian(drawn, _BASE + axis)
        known.base_twist[axis] += rate * _gaussian(drawn, _BASE + 3 + axis)
        known.target_pose[axis] += place * _gaussian(drawn, _TARGET + axis)
        known.target_twist[axis] += rate * _gaussian(drawn, _TARGET + 3 + axis)
        push = noise.torque if axis == 2 else noise.force
        for arm in range(2):
            known.joint_angle[arm, axis] += noise.joint_angle * _gaussian(drawn, _JOINTS + 3 * arm + axis)
            known.joint_rate[arm, axis] += noise.joint_rate * _gaussian(drawn, _JOINTS + 6 + 3 * arm + axis)
            known.hand_wrench[arm, axis] += push * _gaussian(drawn, _WRENCHES + 3 * arm + axis)


@compiled
def gaussian(seed: int, tick: int, channel: int) -> float:
    """A draw of the standard normal distribution that follows from these three numbers (Box and Muller 1958)."""
    return _gaussian(_of_tick(seed, tick), channel)


@compiled
def _gaussian(drawn: np.uint64, channel: int) -> float:
    """A draw of a channel, given what all channels of a tick have in common."""
    bits = _mixed(drawn + np.uint64(channel))
    radius = math.sqrt(-2.0 * math.log(_uniform(bits)))
    return radius * math.cos(2.0 * math.pi * _uniform(_mixed(bits)))


@compiled_inline
def _of_tick(seed: int, tick: int) -> np.uint64:
    return _mixed(_mixed(np.uint64(seed)) + np.uint64(tick))


@compiled
def uniform(seed: int, tick: int, channel: int) -> float:
    """A draw of the uniform distribution over (0, 1] that follows from these three numbers."""
    return _uniform(_mixed(_of_tick(seed, tick) + np.uint64(channel)))


@compiled_inline
def _mixed(bits: np.uint64) -> np.uint64:
    """SplitMix64's output function (Steele, Lea, Flood 2014): neighbouring numbers come out unlike each other."""
    bits = bits + _STEP
    bits = (bits ^ (bits >> _30)) * _FIRST
    bits = (bits ^ (bits >> _27)) * _SECOND
    return bits ^ (bits >> _31)


@compiled_inline
def _uniform(bits: np.uint64) -> float:
    """In (0, 1]: the upper 53 bits."""
    return float((bits >> _11) + _ONE) * 2.0**-53
