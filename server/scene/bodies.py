"""What moves: robot and target, hung in one another as their joints are."""

from __future__ import annotations

import viser

from server.scene.canvas import Canvas, Moving
from server.scene.figures import SIDES, arm_places, base_place
from server.scene.machine import (
    base_parts,
    hand_parts,
    link_parts,
    tip_glow_parts,
    wrist_parts,
)
from server.scene.palette import ARMS
from server.scene.target import target_parts, work_height
from sim.capture.tick import ARMS as ARM_NAMES
from sim.config import MissionConfig
from sim.model.target import target_shape
from sim.snapshot import ArmState, Snapshot

AXES_LENGTH = 0.09
HAND = 4
"""Number of the hand among the links of an arm."""
TOUCH_FORCE = 1e-6
"""A tip shines while its force is above this [N]: rounding, not a threshold of control."""


def link_name(arm: int, link: int) -> str:
    """The node of a link, counted from 1, below those it hangs from; the hand is the fourth."""
    return "/base" + "".join(f"/{ARM_NAMES[arm]}_{number}" for number in range(1, link + 1))


class RobotDrawing:
    """Base, arms and hands; tips shine while they touch."""

    def __init__(self, canvas: Canvas, config: MissionConfig) -> None:
        self._robot = config.robot
        height = work_height(target_shape(config.target))
        self._base = canvas.frame("/base", height)
        canvas.group("robot", "/base/body")
        canvas.parts("/base/body/mesh", base_parts(config.robot, height))
        canvas.axes("/base/axes", AXES_LENGTH)
        self._arms = [ArmDrawing(canvas, config, arm, height) for arm in range(len(SIDES))]

    def show(self, snapshot: Snapshot) -> None:
        """Moves everything to where the snapshot has it."""
        self._base.move(base_place(snapshot.base.pose, self._robot.base.centre_of_mass_ahead))
        for arm, state in zip(self._arms, (snapshot.left, snapshot.right), strict=True):
            arm.show(state)


class ArmDrawing:
    """One arm: three links, and the hand on its mount."""

    def __init__(self, canvas: Canvas, config: MissionConfig, arm: int, height: float) -> None:
        self._robot, self._arm = config.robot, arm
        geometry = config.robot.arm
        self._links = [canvas.frame(link_name(arm, link)) for link in range(1, HAND + 1)]
        solids = (
            link_parts(geometry.link_1, geometry, ARMS[arm], height),
            link_parts(geometry.link_2, geometry, ARMS[arm], height),
            wrist_parts(geometry, ARMS[arm]),
            hand_parts(geometry.hand),
        )
        for number, parts in enumerate(solids, start=1):
            canvas.group("robot", f"{link_name(arm, number)}/body")
            canvas.parts(f"{link_name(arm, number)}/body/mesh", parts)
        self._glows = [self._glow(canvas, tip) for tip in (0, 1)]
        self._axes(canvas)

    def _glow(self, canvas: Canvas, tip: int) -> viser.GlbHandle:
        """The shine of a tip, dark at first."""
        hand, node = self._robot.arm.hand, link_name(self._arm, HAND)
        glow = canvas.parts(f"{node}/body/tip_{tip}", tip_glow_parts(hand.tip_radius), shadow=False)
        glow.position = (SIDES[tip] * hand.tip_offset, hand.centre_offset, 0.0)
        glow.visible = False
        return glow

    def _axes(self, canvas: Canvas) -> None:
        """The hand's frame, at its centre."""
        axes = canvas.axes(f"{link_name(self._arm, HAND)}/axes", AXES_LENGTH)
        axes.move((0.0, self._robot.arm.hand.centre_offset, 0.0))

    def show(self, state: ArmState) -> None:
        """Turns the joints and lights the tips."""
        places = arm_places(self._robot, self._arm, state.joint_angle, state.mount_angle)
        for node, place in zip(self._links, places, strict=True):
            node.move(place)
        for glow, (x, y) in zip(self._glows, state.tip_force, strict=True):
            glow.visible = abs(x) + abs(y) > TOUCH_FORCE


class TargetDrawing:
    """The target, its frame at its centre."""

    def __init__(self, canvas: Canvas, config: MissionConfig) -> None:
        shape = target_shape(config.target)
        self._node: Moving = canvas.frame("/target", work_height(shape))
        canvas.group("target", "/target/body")
        canvas.parts("/target/body/mesh", target_parts(shape))
        canvas.axes("/target/axes", AXES_LENGTH)
        canvas.axes("/world_axes", 2 * AXES_LENGTH)

    def show(self, snapshot: Snapshot) -> None:
        """Moves the target to where the snapshot has it."""
        self._node.move(snapshot.target.pose)
