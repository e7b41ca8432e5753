"""Whether both hands can close on the target where it stands: what the published plan does not ask.

Below `published.caging.slow_spin` the hands turn to the target at once (Sec. III-D). Its faces lie every quarter
turn, so they may have to turn by an eighth of a turn either way; but from 0.25 rad on an arm passes a singularity on
its way, and the hands strike a target that does not turn on with 6 to 11 N. Measured with the configuration `testbed`
at spins of 0, 0.05 and 0.2 rad/s, every 7.5 degrees: up to 0.22 rad at most 0.5 N, beyond it 6 N or more.

In simulation it is flown nevertheless: what the paper's method does there is a result.
"""

from __future__ import annotations

import math

from sim.config import MissionConfig
from sim.control.phases import Command
from sim.record import Record

REACH = 0.22
"""How far the line of both hands may be turned from the base's x axis [rad]."""
CLOSING = (Command.CAPTURE, Command.CAGE, Command.DIRECT_CAGE)
_QUARTER_TURN = 0.5 * math.pi


def refusal(command: Command, config: MissionConfig, row: Record, *, on_robot: bool) -> str:
    """Why both hands should not close on the target now; empty if they may, will not yet, or no robot could be hurt.

    Args:
        command: what is asked.
        config: of the mission.
        row: the last tick, one element of `TICK`.
        on_robot: whether it is a real robot that would fly.

    """
    caging = config.published.caging
    angle, spin = float(row["target_perceived_pose"][2]), float(row["target_perceived_twist"][2])
    if not on_robot or command not in CLOSING or abs(spin) > caging.slow_spin:
        return ""
    ahead = caging.minimum_approach_time + (caging.switching_delay if command is Command.CAPTURE else 0.0)
    turn = math.remainder(angle + spin * ahead - 0.5 * _QUARTER_TURN, _QUARTER_TURN)
    if abs(turn) <= REACH:
        return ""
    return (
        f"the target stands {math.degrees(turn):+.0f} degrees off from where both hands can close on it, and turns at "
        f"{spin:+.2f} rad/s only: an arm would pass a singularity and strike it; wait until it has turned, or turn it "
        "by hand"
    )
