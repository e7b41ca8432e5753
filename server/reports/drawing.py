"""Planar drawings of robot and target at one tick, and rows of them as a sequence."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon

from server.reports.style import BASE, GREY, INK, LEFT, PALE, RIGHT, figure
from sim.capture.events import Ticks
from sim.compiled import FloatArray
from sim.config import MissionConfig
from sim.model.clearance import hand_outline
from sim.model.planar import rotated
from sim.model.robot import JOINTS, base_shape, chain, robot_model
from sim.model.shape import Shape, inner_radius, outline
from sim.model.target import target_shape

PATH_STRIDE = 20
"""Ticks between two points of a target's path that is drawn."""

_FRAME = (-0.50, 0.50, -0.22, 0.60)  # of a drawing [m]: x from, to, y from, to
_FORCE_SCALE = 0.09  # [m/N]
_LONGEST_ARROW = 0.25  # [m]: that of 2.8 N; harder blows are not drawn longer
_ARM_COLOURS = (LEFT, RIGHT)


class DrawnInstant(NamedTuple):
    """An instant to be drawn."""

    time: float
    """[s]"""
    caption: str


def sequence(config: MissionConfig, ticks: Ticks, frames: Sequence[DrawnInstant], columns: int) -> Figure:
    """Drawings at these instants, in rows of so many; the target's path up to each is drawn faintly."""
    rows = math.ceil(len(frames) / columns)
    drawn = figure(1.75 * columns, 1.92 * rows)
    grid = drawn.subplots(rows, columns, squeeze=False)
    for axes, frame in zip(grid.flat, frames, strict=False):
        place = int(np.clip(np.searchsorted(ticks["time"], frame.time), 0, len(ticks) - 1))
        draw_instant(axes, config, ticks[place], frame.caption, ticks["target_pose"][: place + 1 : PATH_STRIDE, :2])
    for axes in grid.flat[len(frames) :]:
        axes.set_visible(False)
    return drawn


def draw_instant(axes: Axes, config: MissionConfig, tick: Any, caption: str, path: FloatArray) -> None:
    """A drawing with its time above and what happens then below."""
    draw(axes, config, tick, path)
    axes.set_title(f"{tick['time']:.2f} s", fontsize=7.5, pad=2)
    axes.set_xlabel(caption, fontsize=6.6, color=GREY, labelpad=2)


def draw(axes: Axes, config: MissionConfig, tick: Any, path: FloatArray | None = None) -> None:
    """Robot and target at one tick, world axes; arrows are the forces of the tips on the target.

    Args:
        axes: to draw into.
        config: that was flown.
        tick: one element of `TICK`.
        path: of the target's centre until then, shape (points, 2) [m].

    """
    x0, x1, y0, y1 = _FRAME
    axes.set(xlim=(x0, x1), ylim=(y0, y1), aspect="equal", xticks=[], yticks=[])
    for spine in axes.spines.values():
        spine.set(visible=True, color=PALE)
    if path is not None and len(path) > 1:
        axes.plot(path[:, 0], path[:, 1], color=PALE, linewidth=0.8, zorder=1)
    shape = target_shape(config.target)
    _outline(axes, tick["base_pose"], base_shape(config.robot.base), BASE, alpha=0.28)
    _outline(axes, tick["target_pose"], shape, INK, alpha=0.16)
    dx, dy = rotated(float(tick["target_pose"][2]), inner_radius(shape), 0.0)
    x, y = tick["target_pose"][:2]
    axes.plot([x, x + dx], [y, y + dy], color=INK, linewidth=0.8, zorder=4)
    _arms(axes, config, tick)


def _outline(axes: Axes, pose: FloatArray, shape: Shape, colour: str, alpha: float) -> None:
    points = np.array([rotated(float(pose[2]), *point) for point in outline(shape).tolist()]) + np.asarray(pose[:2])
    axes.add_patch(Polygon(points, facecolor=colour, alpha=alpha, linewidth=0, zorder=2))
    axes.add_patch(Polygon(points, fill=False, edgecolor=colour, linewidth=0.9, zorder=3))


def _arms(axes: Axes, config: MissionConfig, tick: Any) -> None:
    links = chain(robot_model(config.robot), tick["base_pose"], tick["joint_angle"], tick["mount_angle"])
    hand = config.robot.arm.hand
    outline = hand_outline(config.robot.arm)
    for arm, colour in enumerate(_ARM_COLOURS):
        joints = links.joint[arm, : JOINTS + 1]
        pose = links.hand_pose[arm]
        mounted = np.array([rotated(pose[2], *point) for point in outline]) + pose[:2]
        for points, width in ((joints, 2.4), (mounted, 1.9)):
            axes.plot(*points.T, color=colour, linewidth=width, alpha=0.75, solid_joinstyle="round", zorder=5)
        axes.plot(*joints[:JOINTS].T, "o", color="white", markeredgecolor=colour, markersize=2.6, zorder=6)
        for tip in mounted[[0, 3]]:
            axes.add_patch(Circle(tuple(tip), hand.tip_radius, facecolor=colour, edgecolor="white", lw=0.4, zorder=6))
        _force(axes, tick, arm, mounted[[0, 3]])


def _force(axes: Axes, tick: Any, arm: int, tips: FloatArray) -> None:
    """The push of each touching tip on the target."""
    for tip in range(2):
        push = -np.asarray(tick["tip_force"][arm, tip])
        if np.hypot(*push) < 1e-3:
            continue
        tail = tips[tip]
        head = tail + push * min(_FORCE_SCALE, _LONGEST_ARROW / float(np.hypot(*push)))
        arrow = {"arrowstyle": "-|>", "color": INK, "lw": 1.0, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 6}
        axes.annotate("", head, tail, arrowprops=arrow, zorder=8, annotation_clip=False)
