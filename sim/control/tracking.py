"""Hand velocity that follows a plan: feed-forward and PID on the pose error (Sec. III-D)."""

from __future__ import annotations

from sim.compiled import FloatArray, compiled_inline
from sim.record import Record


@compiled_inline
def tracking_velocity(
    gains: Record,
    period: float,
    desired_pose: FloatArray,
    desired_twist: FloatArray,
    pose: FloatArray,
    twist: tuple[float, float, float],
    integral: FloatArray,
    velocity: FloatArray,
) -> None:
    """The velocity that one hand should have, and its error integral one period on, both in place, shape (3,).

    Args:
        gains: record of `TrackingConfig`.
        period: control period [s].
        desired_pose: [m, rad].
        desired_twist: the feed-forward [m/s, rad/s].
        pose: measured [m, rad].
        twist: measured [m/s, rad/s].
        integral: of the pose error [m s, rad s]; changed.
        velocity: the result [m/s, rad/s]; changed.

    """
    for axis in range(3):
        error = desired_pose[axis] - pose[axis]
        integral[axis] += error * period
        velocity[axis] = (
            desired_twist[axis]
            + gains.proportional * error
            + gains.integral * integral[axis]
            + gains.derivative * (desired_twist[axis] - twist[axis])
        )
