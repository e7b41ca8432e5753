"""What cannot be seen of the motion: contact forces, momentum, spin and manipulability."""

from __future__ import annotations

import math

import numpy as np

from server.scene.arrows import (
    FORCE_LEGEND,
    FORCE_SCALE,
    MOMENTUM_LEGEND,
    MOMENTUM_SCALE,
    SHORTEST_ARROW,
    add_arrows,
    add_legend,
    point_arrows,
)
from server.scene.bodies import link_name
from server.scene.canvas import Canvas, ChangeDetector, Moving, as_tuple
from server.scene.figures import arc_points, manipulability_ellipse, raised, solid_line, tip_points
from server.scene.palette import ARMS, FORCE_ARROW, MOMENTUM_ARROW, SPIN, veil
from server.scene.solids import FloatArray, circle, prism
from server.scene.target import half_height, work_height
from sim.config import MissionConfig
from sim.model.target import target_shape
from sim.snapshot import ArmState, Snapshot

SPIN_TIME = 1.0
"""The spin arc spans what the target turns in this time [s]."""
LARGEST_SWEEP = 5.6
"""Where the spin arc stops, short of a full turn [rad]."""
ELLIPSE_SCALE = 0.25
"""Length of a semi-axis for 1 m/s of wrist velocity at 1 rad/s of joint rates [m/(m/rad)]."""


class ForcesDrawing:
    """What the target does to each tip, as arrows to scale."""

    def __init__(self, canvas: Canvas, config: MissionConfig) -> None:
        self._tip_offset = config.robot.arm.hand.tip_offset
        self._height = work_height(target_shape(config.target)) + 0.028
        canvas.group("forces", "/forces")
        self._arrows = add_arrows(canvas, "/forces/tips", FORCE_ARROW)
        add_legend(canvas, "forces", FORCE_LEGEND, FORCE_ARROW)
        self._watch = ChangeDetector(5e-4)

    def show(self, snapshot: Snapshot) -> None:
        """Draws an arrow at each tip that is pressed."""
        arrows = [arrow for arm in (snapshot.left, snapshot.right) for arrow in self._of(arm)]
        points = np.array(arrows).reshape(-1, 2, 3)
        if self._watch.changed(as_tuple(points)):
            point_arrows(self._arrows, points)

    def _of(self, arm: ArmState) -> list[FloatArray]:
        """The arrows of one hand, each of shape (2, 3)."""
        tips = tip_points(arm.hand_pose, self._tip_offset)
        return [
            raised(np.stack((tip, tip + FORCE_SCALE * np.array(force))), self._height)
            for tip, force in zip(tips, arm.tip_force, strict=True)
            if FORCE_SCALE * math.hypot(*force) > SHORTEST_ARROW
        ]


class MotionDrawing:
    """The target's linear momentum as an arrow, its spin as the arc that it turns in a second."""

    def __init__(self, canvas: Canvas, config: MissionConfig) -> None:
        shape = target_shape(config.target)
        self._mass, self._radius = config.target.mass, 1.13 * shape.corner_circle
        top = work_height(shape) + half_height(shape)
        self._at = canvas.group("momentum", "/momentum", top + 0.024)
        self._arrow = add_arrows(canvas, "/momentum/arrow", MOMENTUM_ARROW)
        add_legend(canvas, "momentum", MOMENTUM_LEGEND, MOMENTUM_ARROW)
        canvas.group("momentum", "/target/spin", half_height(shape) + 0.002)
        self._arc = canvas.scene.add_line_segments("/target/spin/arc", self._arc_lines(0.1), SPIN, thickness=0.0042)
        self._momentum, self._spin = ChangeDetector(2e-4), ChangeDetector(4e-3)

    def show(self, snapshot: Snapshot) -> None:
        """Moves the arrow with the target and reshapes both when the motion has changed."""
        x, y, _ = snapshot.target.pose
        self._at.move((x, y, 0.0))
        momentum = tuple(MOMENTUM_SCALE * self._mass * speed for speed in snapshot.target.twist[:2])
        if self._momentum.changed(momentum):
            drawn = math.hypot(*momentum) > SHORTEST_ARROW
            point_arrows(self._arrow, np.array([[(0.0, 0.0, 0.0), (*momentum, 0.0)]] if drawn else []))
        if self._spin.changed((snapshot.spin,)):
            self._arc.visible = abs(snapshot.spin) > self._spin.tolerance
            self._arc.points = self._arc_lines(snapshot.spin).astype(np.float32)

    def _arc_lines(self, spin: float) -> FloatArray:
        """The arc from the target's mark on, with an arrow head, in the target's frame."""
        sweep = math.copysign(min(abs(spin) * SPIN_TIME, LARGEST_SWEEP), spin)
        start, end = math.pi / 2, math.pi / 2 + sweep
        back = end - math.copysign(min(0.16, abs(sweep)), sweep)
        head = np.concatenate([arc_points(self._radius + reach, back, 0.0, 1) for reach in (-0.012, 0.012)])
        tip = arc_points(self._radius, end, 0.0, 1)
        curve = raised(arc_points(self._radius, start, sweep, 49), 0.0)
        strokes = [raised(np.vstack((tip, point)), 0.0) for point in head]
        return np.concatenate([solid_line(curve), *(solid_line(stroke) for stroke in strokes)])


class EllipsesDrawing:
    """At each wrist, the velocities that joints 1 and 2 can give it: flat means near a singularity."""

    def __init__(self, canvas: Canvas, config: MissionConfig) -> None:
        arm = config.robot.arm
        self._lengths = (arm.link_1.length, arm.link_2.length)
        self._groups = [self._group(canvas, number) for number in range(len(ARMS))]
        names = [f"{link_name(number, 2)}/ellipse" for number in range(len(ARMS))]
        ring = solid_line(raised(arc_points(1.0, 0.0, 2 * math.pi, 65), 0.0))
        self._rings = [
            canvas.scene.add_line_segments(f"{name}/ring", ring, colour, thickness=0.0020)
            for name, colour in zip(names, ARMS, strict=True)
        ]
        self._discs = [
            canvas.parts(f"{name}/disc", [(prism(circle(1.0), -1e-4, 0.0), veil(colour, 0.10))], shadow=False)
            for name, colour in zip(names, ARMS, strict=True)
        ]
        self._watches = [ChangeDetector(4e-3), ChangeDetector(4e-3)]

    def _group(self, canvas: Canvas, arm: int) -> Moving:
        group = canvas.group("manipulability", f"{link_name(arm, 2)}/ellipse", 0.026)
        group.move((0.0, self._lengths[1], 0.0))
        return group

    def show(self, snapshot: Snapshot) -> None:
        """Reshapes the ellipses when the elbows have bent."""
        for arm, state in enumerate((snapshot.left, snapshot.right)):
            elbow = state.joint_angle[1]
            if self._watches[arm].changed((elbow,)):
                major, minor, angle = manipulability_ellipse(*self._lengths, elbow)
                scale = (ELLIPSE_SCALE * major, ELLIPSE_SCALE * minor, 1.0)
                self._groups[arm].turn(angle)
                self._rings[arm].scale = scale
                self._discs[arm].scale = scale
