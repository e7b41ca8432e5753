"""The cage region: what the four tips enclose, and whether it is closed or locked."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import viser

from server.scene.canvas import Canvas, ChangeDetector, as_tuple
from server.scene.figures import base_place, closed_outline, dashed_line, raised, solid_line, tip_points
from server.scene.palette import CAGE, FAINT
from server.scene.solids import FloatArray
from server.scene.target import half_height
from sim.config import BaseConfig, MissionConfig
from sim.model.target import target_shape
from sim.snapshot import Snapshot

CageState = Literal["none", "open", "closed", "locked"]


def cage_state(snapshot: Snapshot) -> CageState:
    """How the cage is drawn: not at all, still open, closed around the target, or locked with a margin."""
    if snapshot.phase == "holding" and snapshot.cage_margin is not None:
        return "locked"
    if snapshot.cage_closed:
        return "closed"
    return "open" if snapshot.phase in ("caging", "holding") else "none"


def corners_in_base(snapshot: Snapshot, base: BaseConfig, tip_offset: float) -> FloatArray:
    """Tips in the base's frame about its geometric centre, in order around, the first repeated: shape (5, 2)."""
    x, y, angle = base_place(snapshot.base.pose, base.centre_of_mass_ahead)
    hands = (snapshot.left.hand_pose, snapshot.right.hand_pose)
    tips = np.concatenate([tip_points(pose, tip_offset) for pose in hands])
    cosine, sine = math.cos(angle), math.sin(angle)
    return closed_outline((tips - (x, y)) @ np.array([[cosine, -sine], [sine, cosine]]))


class CageDrawing:
    """A fence through the four tips: faint dashes while open, bright dashes closed, solid when locked."""

    def __init__(self, canvas: Canvas, config: MissionConfig) -> None:
        self._base, self._tip_offset = config.robot.base, config.robot.arm.hand.tip_offset
        self._top = half_height(target_shape(config.target)) + 0.014
        canvas.group("cage", "/base/cage")
        self._canvas = canvas
        self._floor = canvas.scene.add_mesh_simple(
            "/base/cage/region",
            np.zeros((4, 3)),
            np.array([[0, 1, 2], [0, 2, 3]]),
            color=CAGE,
            opacity=0.10,
            side="double",
            cast_shadow=False,
            receive_shadow=False,
        )
        self._fence: viser.LineSegmentsHandle | None = None
        self._state: CageState = "none"
        self._watch = ChangeDetector(4e-4)
        self._floor.visible = False

    def show(self, snapshot: Snapshot) -> None:
        """Redraws the fence when a tip has moved on the base or the state has changed."""
        state = cage_state(snapshot)
        if state == self._state == "none":
            return
        corners = corners_in_base(snapshot, self._base, self._tip_offset)
        if self._watch.changed(as_tuple(corners)) or state != self._state:
            self._state = state
            self._draw(corners)

    def _draw(self, corners: FloatArray) -> None:
        if self._fence is not None:
            self._fence.remove()
            self._fence = None
        self._floor.visible = self._state in ("closed", "locked")
        if self._state == "none":
            return
        top = raised(corners, self._top)
        outline = solid_line(top) if self._state == "locked" else dashed_line(top, 0.010, 0.008)
        posts = np.stack((raised(corners[:-1], 0.012), top[:-1]), axis=1)
        self._floor.vertices = top[:-1].astype(np.float32)
        self._fence = self._canvas.scene.add_line_segments(
            "/base/cage/fence",
            np.concatenate((outline, posts)),
            FAINT if self._state == "open" else CAGE,
            thickness=0.005 if self._state == "locked" else 0.0028,
        )
