"""Plane geometry: rotations, angles, poses. Counter-clockwise positive, SI.

Cosine and sine are computed here, by the polynomials of fdlibm (Sun Microsystems 1993) after reduction to an eighth of
a turn: within one unit in the last place, in a third of the time of the platform's library, and the same bits on
every machine, whichever library it has.
"""

from __future__ import annotations

import math

import numpy as np

from sim.compiled import FloatArray, compiled, compiled_inline


@compiled_inline
def sign(value: float) -> float:
    """+1 for zero and above, else -1: the paper's sign function (a still target counts as moving right)."""
    return 1.0 if value >= 0.0 else -1.0


_QUARTERS = 2.0 / math.pi
"""Quarter turns per radian."""
_QUARTER_1 = float.fromhex("0x1.921fb544p+0")
"""A quarter turn [rad] is the sum of these three; multiples of the first two up to 2^20 are exact."""
_QUARTER_2 = float.fromhex("0x1.0b4611a6p-34")
_QUARTER_3 = float.fromhex("0x1.3198a2e037073p-69")
_S1, _S2, _S3 = -1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04
_S4, _S5, _S6 = 2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10
_C1, _C2, _C3 = 4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05
_C4, _C5, _C6 = -2.75573143513906633035e-07, 2.08757232129817482790e-09, -1.13596475577881948265e-11


@compiled_inline
def direction(angle: float) -> tuple[float, float]:
    """Cosine and sine of an angle of up to a million radians."""
    quarters = np.floor(angle * _QUARTERS + 0.5)
    rest = ((angle - quarters * _QUARTER_1) - quarters * _QUARTER_2) - quarters * _QUARTER_3
    z = rest * rest
    sine = rest + rest * z * (_S1 + z * (_S2 + z * (_S3 + z * (_S4 + z * (_S5 + z * _S6)))))
    half = 0.5 * z
    about = 1.0 - half
    series = z * z * (_C1 + z * (_C2 + z * (_C3 + z * (_C4 + z * (_C5 + z * _C6)))))
    cosine = about + (((1.0 - about) - half) + series)
    quadrant = quarters - 4.0 * np.floor(0.25 * quarters)
    swapped = (quadrant == 1.0) | (quadrant == 3.0)
    along, across = (sine, cosine) if swapped else (cosine, sine)
    return -along if (quadrant == 1.0) | (quadrant == 2.0) else along, -across if quadrant > 1.5 else across


@compiled_inline
def rotated(angle: float, x: float, y: float) -> tuple[float, float]:
    """The vector (x, y) turned by an angle [rad]: from a frame at that angle into the world's axes."""
    c, s = direction(angle)
    return c * x - s * y, s * x + c * y


@compiled_inline
def in_frame(pose: FloatArray, x: float, y: float) -> tuple[float, float]:
    """A point of the world in the frame of a body at that pose, shape (3,) [m, rad]: what `rotated` undoes."""
    dx, dy = x - pose[0], y - pose[1]
    c, s = direction(pose[2])
    return c * dx + s * dy, -s * dx + c * dy


@compiled
def folded(angle: float, period: float) -> float:
    """The representative of an angle [rad] nearest to zero, within half a period either side."""
    return angle - period * math.floor(angle / period + 0.5)


@compiled_inline
def cross(ax: float, ay: float, bx: float, by: float) -> float:
    """The out-of-plane component of a x b."""
    return ax * by - ay * bx


@compiled_inline
def point_velocity(pose: FloatArray, twist: FloatArray, x: float, y: float) -> tuple[float, float]:
    """Velocity [m/s] of the body's point now at world (x, y), from its pose and twist, shape (3,)."""
    return twist[0] - twist[2] * (y - pose[1]), twist[1] + twist[2] * (x - pose[0])
