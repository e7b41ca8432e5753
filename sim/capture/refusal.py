"""What speaks against a command before anything moves: a caged target, what the method says, too loose a cage."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from sim.capture.caging import cage
from sim.capture.chronicle import Happened
from sim.config import MissionConfig, RobotConfig
from sim.control.phases import Command, Phase
from sim.method.method import method_of
from sim.method.registry import MethodName
from sim.model.target import Outline

LEAST_MARGIN = 0.005
"""Of a cage that is worth closing [m]."""
CLOSING = (Command.CAPTURE, Command.CAGE, Command.DIRECT_CAGE)
BEGINNING = (*CLOSING, Command.DETUMBLE)
"""The commands that a sequence begins with."""


def refusal(command: Command, config: MissionConfig, phase: Phase, happened: Happened, *, on_robot: bool) -> str:
    """Why a command cannot end well from the last tick on, with numbers; empty if it can.

    Args:
        command: that is asked.
        config: of the mission.
        phase: of the mission.
        happened: until the last tick.
        on_robot: whether it is a real robot that would fly.

    """
    if command in BEGINNING and phase is Phase.HOLDING and _is_caged(happened):
        return "the arms hold the target, which is caged; release it first"
    against = method_of(config).refusal(command, config, happened.last[-1], on_robot=on_robot)
    return against or (_too_loose(config) if command in CLOSING else "")


def _is_caged(happened: Happened) -> bool:
    """Whether a sequence ended with a cage, and the arms have held ever since."""
    phases = [visit.phase for visit in happened.visits[-2:]]
    return happened.outcome is not None and happened.outcome.caged and phases == [Phase.CAGING, Phase.HOLDING]


def _too_loose(config: MissionConfig) -> str:
    margin = _margin(config.method, config.robot, Outline.of(config.target))
    if margin is None or margin >= LEAST_MARGIN:
        return ""
    hand = config.robot.arm.hand
    return (
        f"the tips, {2e3 * hand.tip_offset:.0f} mm apart, would hold this target (target.shape = "
        f"{config.target.shape.value}) with a margin of {1e3 * margin:.1f} mm where {1e3 * LEAST_MARGIN:g} mm are "
        "needed: its corners are too blunt for them"
    )


@lru_cache(maxsize=64)
def _margin(method: MethodName, robot: RobotConfig, outline: Outline) -> float | None:
    """Of the cage that the method closes [m]; None where it does not say how. Of what it depends on, kept."""
    config = MissionConfig(method=method, robot=robot, target=outline.target())
    enclosure = method_of(config).enclosure
    return None if enclosure is None else cage(config, enclosure(config), np.zeros(3)).margin
