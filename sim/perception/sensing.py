"""The noise of the sensors: white and Gaussian, each value from the seed, the tick and the channel alone.

So a run is the same bit for bit wherever it flies, and a replay from recorded states hears the same noise again.
"""

from __future__ import annotations

import math

import numpy as np

from sim.compiled import compiled, compiled_inline
from sim.config import NoiseDraws
from sim.model.planar import direction
from sim.record import Record, code_of

_STEP = np.uint64(0x9E3779B97F4A7C15)
_FIRST, _SECOND = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_30, _27, _31, _11 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11)
_ONE = np.uint64(1)

_IN_PAIRS = code_of(NoiseDraws.IN_PAIRS)

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
    drawn, in_pairs = _of_tick(seed, known.tick), noise.draws == _IN_PAIRS
    for axis in range(3):
        place, rate = (noise.angle, noise.spin) if axis == 2 else (noise.position, noise.velocity)
        one, other = _two(drawn, _BASE + axis, _BASE + 3 + axis, in_pairs)
        known.base_pose[axis] += place * one
        known.base_twist[axis] += rate * other
        one, other = _two(drawn, _TARGET + axis, _TARGET + 3 + axis, in_pairs)
        known.target_pose[axis] += place * one
        known.target_twist[axis] += rate * other
        for arm in range(2):
            joint = _JOINTS + 3 * arm + axis
            one, other = _two(drawn, joint, joint + 6, in_pairs)
            known.joint_angle[arm, axis] += noise.joint_angle * one
            known.joint_rate[arm, axis] += noise.joint_rate * other
        push = noise.torque if axis == 2 else noise.force
        one, other = _two(drawn, _WRENCHES + axis, _WRENCHES + 3 + axis, in_pairs)
        known.hand_wrench[0, axis] += push * one
        known.hand_wrench[1, axis] += push * other


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


@compiled_inline
def _two(drawn: np.uint64, channel: int, other: int, in_pairs: bool) -> tuple[float, float]:
    """Draws of two channels: of each by itself, or of both from the first one's bits.

    Box and Muller's radius and direction make two draws. A library's logarithm and cosine take most of the time, so a
    pair shares the one and has the other by `direction`.
    """
    if not in_pairs:
        return _gaussian(drawn, channel), _gaussian(drawn, other)
    bits = _mixed(drawn + np.uint64(channel))
    radius = math.sqrt(-2.0 * math.log(_uniform(bits)))
    cosine, sine = direction(2.0 * math.pi * _uniform(_mixed(bits)))
    return radius * cosine, radius * sine


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
