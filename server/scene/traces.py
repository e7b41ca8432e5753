"""Where target and hands have been, and where they are about to go: trails and plan."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt
import viser

from server.scene.canvas import Canvas, Moving
from server.scene.figures import Trail, closed_outline, dashed_line, raised
from server.scene.glb import Part, linear
from server.scene.machine import goal_hand_parts
from server.scene.palette import ARMS, NIGHT, TARGET, Colour, light
from server.scene.solids import ball
from server.scene.target import ghost_parts, half_height, work_height
from sim.capture.tick import ARMS as ARM_NAMES
from sim.config import MissionConfig
from sim.model.shape import Shape, outline
from sim.model.target import seen_target_shape
from sim.snapshot import Plan, Snapshot, Vector2, Vector3

TracedPoints = tuple[Vector2, Vector2, Vector2]
"""Centres of the target, of the left and of the right hand [m]."""
TRAIL_POINTS, TRAIL_SPACING = 200, 0.006
"""A trail keeps its last 1.2 m, in steps of 6 mm."""
TRAIL_HEIGHT = 0.003
_SEEN_WAY = 0.004
"""A shorter way of the target is not drawn [m]."""


class TrailsDrawing:
    """Where the target's centre and the hands have been, on the table below them."""

    def __init__(self, canvas: Canvas) -> None:
        canvas.group("trails", "/trails")
        self._tick = -1
        self._undrawn: set[int] = set()
        self._trails = [Trail(TRAIL_POINTS, TRAIL_SPACING) for _ in range(3)]
        self._lines = [
            canvas.scene.add_line_segments(
                f"/trails/{name}", np.zeros((TRAIL_POINTS, 2, 3)), fading(colour), thickness=0.0035
            )
            for name, colour in zip(("target", *ARM_NAMES), (TARGET, *ARMS), strict=True)
        ]

    def show(self, snapshot: Snapshot) -> None:
        """Lengthens the trails."""
        poses = snapshot.target.pose, snapshot.left.hand_pose, snapshot.right.hand_pose
        self.extend(snapshot.tick, ((x, y) for x, y, _ in poses))
        for place in self._undrawn:
            self._lines[place].points = self._trails[place].segments(TRAIL_HEIGHT).astype(np.float32)
        self._undrawn.clear()

    def extend(self, tick: int, points: Iterable[Vector2]) -> None:
        """Lengthens the trails of target, left and right hand, which `show` will draw.

        A mission that began again, or was rewound, clears them.
        """
        if tick < self._tick:
            for trail in self._trails:
                trail.clear()
        self._tick = tick
        for place, (trail, (x, y)) in enumerate(zip(self._trails, points, strict=True)):
            if trail.extend(x, y):
                self._undrawn.add(place)


def add_ghost(canvas: Canvas, name: str, shape: Shape, colour: Colour) -> Moving:
    """A see-through target with dashed edges, at work height: where it is not, but may come to be."""
    body = canvas.parts(name, ghost_parts(shape, colour), shadow=False)
    edge, roof = closed_outline(outline(shape)), half_height(shape)
    edges = [dashed_line(raised(edge, z), 0.008, 0.006) for z in (-roof, roof)]
    canvas.scene.add_line_segments(f"{name}/edges", np.concatenate(edges), colour, thickness=0.0018)
    return Moving(body, work_height(shape))


def fading(colour: Colour) -> npt.NDArray[np.uint8]:
    """Colours of a trail's segments, shape (TRAIL_POINTS, 2, 3): out of the night, oldest first.

    viser takes the colours of a line's single points as linear light, unlike all its others.
    """
    share = (np.arange(TRAIL_POINTS + 1) / TRAIL_POINTS)[:, None] ** 1.5
    shades = 255 * (np.array(linear(NIGHT)) * (1 - share) + np.array(linear(colour)) * share)
    return np.stack((shades[:-1], shades[1:]), axis=1).astype(np.uint8)


class PlanDrawing:
    """The path of each hand with its knots and goal, and the target as predicted at its end."""

    def __init__(self, canvas: Canvas, config: MissionConfig) -> None:
        shape, hand = seen_target_shape(config.target), config.robot.arm.hand
        self._canvas, self._height = canvas, work_height(shape)
        canvas.group("plan", "/plan")
        canvas.group("ghost", "/ghost")
        goals = [
            canvas.parts(f"/plan/{name}_goal", goal_hand_parts(hand, colour), shadow=False)
            for name, colour in zip(ARM_NAMES, ARMS, strict=True)
        ]
        self._goals = [Moving(goal, self._height) for goal in goals]
        self._ghost = add_ghost(canvas, "/ghost/target", shape, TARGET)
        self._paths: list[list[viser.SceneNodeHandle]] = [[], []]
        self._drift: viser.SceneNodeHandle | None = None
        self._plan: Plan | None = None
        self._draw(None)

    def show(self, snapshot: Snapshot) -> None:
        """Draws the plan if it is another one."""
        if _is_the_same(snapshot.plan, self._plan):
            return
        self._plan = snapshot.plan
        self._draw(snapshot.plan)
        self._draw_drift(snapshot)

    def _draw(self, plan: Plan | None) -> None:
        self._draw_path(0, plan.left if plan else [])
        self._draw_path(1, plan.right if plan else [])
        predicts = plan is not None and plan.kind != "release"
        self._ghost.handle.visible = predicts
        if plan is not None and predicts:
            self._ghost.move(plan.target_at_end)

    def _draw_drift(self, snapshot: Snapshot) -> None:
        """The way of the target's middle to where it is predicted at the plan's end, if it is one to be seen."""
        if self._drift is not None:
            self._drift.remove()
            self._drift = None
        if snapshot.plan is None or snapshot.plan.kind == "release":
            return
        ends = np.array([snapshot.target.pose[:2], snapshot.plan.target_at_end[:2]])
        if np.linalg.norm(ends[1] - ends[0]) > _SEEN_WAY:
            dashes = dashed_line(raised(ends, self._height), 0.006, 0.005)
            self._drift = self._canvas.scene.add_line_segments("/ghost/way", dashes, TARGET, thickness=0.002)

    def _draw_path(self, arm: int, knots: list[Vector3]) -> None:
        for node in self._paths[arm]:
            node.remove()
        self._paths[arm] = []
        self._goals[arm].handle.visible = bool(knots)
        if not knots:
            return
        self._goals[arm].move(knots[-1])
        points = raised(np.array(knots)[:, :2], self._height)
        name = f"/plan/{ARM_NAMES[arm]}"
        balls: list[Part] = [(ball(0.0048).moved(*point), light(ARMS[arm])) for point in points]
        self._paths[arm].append(self._canvas.parts(f"{name}_knots", balls, shadow=False))
        dashes = dashed_line(points, 0.010, 0.006)
        if len(dashes):
            line = self._canvas.scene.add_line_segments(f"{name}_path", dashes, ARMS[arm], thickness=0.003)
            self._paths[arm].append(line)


def _is_the_same(plan: Plan | None, other: Plan | None) -> bool:
    """Whether two plans are drawn alike: one whose touch goes on is."""
    if plan is None or other is None:
        return plan is other
    return plan is other or (plan.kind, plan.times, plan.left, plan.right) == (
        other.kind,
        other.times,
        other.left,
        other.right,
    )
