"""What sensors get wrong beside noise: bias of a wrist, steps of encoders, pictures with a body missing or elsewhere.

Like noise, each follows from the seed, the tick and the channel alone. The simulation, studies, a replay and the
emulated robot measure with the same code.
"""

from __future__ import annotations

import math

from sim.compiled import FloatArray, compiled
from sim.model.planar import rotated
from sim.perception.sensing import gaussian, uniform
from sim.record import Record

_MISSED, _ELSEWHERE, _WAY, _BIAS = 112, 130, 132, 140
"""First channels, beyond those of the sensors' noise; each body or axis has one a number."""


@compiled
def is_imperfect(imperfections: Record) -> bool:
    """Whether any reading of every tick is wrong beside its noise; a record of `ImperfectionsConfig`."""
    return bool(
        imperfections.force_bias > 0.0 or imperfections.torque_bias > 0.0 or imperfections.encoder_resolution > 0.0
    )


@compiled
def add_imperfections(imperfections: Record, seed: int, hand_angle: FloatArray, known: Record) -> None:
    """Add to the readings in one element of `PERCEIVED`, noise and all, what their sensors get wrong.

    A bias stays the same in the hand's axes, so that it turns with the hand.

    Args:
        imperfections: record of `ImperfectionsConfig`.
        seed: of the run.
        hand_angle: of both hands in the world [rad], shape (2,).
        known: the readings; changed.

    """
    step = imperfections.encoder_resolution
    for arm in range(2):
        along, across = _bias(imperfections, seed, arm, 0), _bias(imperfections, seed, arm, 1)
        bias_x, bias_y = rotated(hand_angle[arm], along, across)
        known.hand_wrench[arm, 0] += bias_x
        known.hand_wrench[arm, 1] += bias_y
        known.hand_wrench[arm, 2] += _bias(imperfections, seed, arm, 2)
        if step > 0.0:
            for joint in range(3):
                known.joint_angle[arm, joint] = math.floor(known.joint_angle[arm, joint] / step + 0.5) * step


@compiled
def is_miscalibrated(wrists: Record) -> bool:
    """Whether a wrist reads anything else than what it feels; a record of `WristsConfig`."""
    for arm in range(2):
        wrist = wrists.left if arm == 0 else wrists.right
        if wrist.gain != 1.0 or wrist.bias_x != 0.0 or wrist.bias_y != 0.0 or wrist.bias_torque != 0.0:
            return True
    return False


@compiled
def miscalibrate(wrists: Record, hand_angle: FloatArray, known: Record) -> None:
    """Make of the wrenches in one element of `PERCEIVED` what wrists of those gains and biases read.

    Args:
        wrists: record of `WristsConfig`.
        hand_angle: of both hands in the world [rad], shape (2,).
        known: the readings; changed.

    """
    for arm in range(2):
        wrist = wrists.left if arm == 0 else wrists.right
        bias_x, bias_y = rotated(hand_angle[arm], wrist.bias_x, wrist.bias_y)
        known.hand_wrench[arm, 0] = wrist.gain * known.hand_wrench[arm, 0] + bias_x
        known.hand_wrench[arm, 1] = wrist.gain * known.hand_wrench[arm, 1] + bias_y
        known.hand_wrench[arm, 2] = wrist.gain * known.hand_wrench[arm, 2] + wrist.bias_torque


@compiled
def is_missed(dropouts: float, seed: int, tick: int, body: int) -> bool:
    """Whether a body, 0 the base and 1 the target, is missing in that tick's picture."""
    return uniform(seed, tick, _MISSED + body) <= dropouts


@compiled
def misplacement(imperfections: Record, seed: int, tick: int, body: int) -> tuple[float, float]:
    """How far from where it is a body is seen in that tick's picture [m]; nowhere else in most."""
    if uniform(seed, tick, _ELSEWHERE + body) > imperfections.outliers:
        return 0.0, 0.0
    return rotated(2.0 * math.pi * uniform(seed, tick, _WAY + body), imperfections.outlier_distance, 0.0)


@compiled
def _bias(imperfections: Record, seed: int, arm: int, axis: int) -> float:
    """Of a wrist, in its hand's axes [N, N, N m]."""
    spread: float = imperfections.torque_bias if axis == 2 else imperfections.force_bias
    return spread * gaussian(seed, 0, _BIAS + 3 * arm + axis)
