"""Where the drawing's nodes are made: names, layers, and sending only what changed."""

from __future__ import annotations

import math
from collections.abc import Sequence

import viser

from server.scene.figures import Place
from server.scene.glb import Part, glb
from server.scene.solids import FloatArray

LAYERS = (
    "table",
    "robot",
    "target",
    "trails",
    "plan",
    "reach",
    "ghost",
    "futures",
    "forces",
    "momentum",
    "manipulability",
    "cage",
    "frames",
)
"""What can be switched on and off, each by itself."""
HIDDEN_AT_FIRST = frozenset({"frames", "reach"})

LENGTH_TOLERANCE = 5e-5
"""A move below this is not sent [m]: a twentieth of a pixel in the default view."""
ANGLE_TOLERANCE = 2e-4
"""A turn below this is not sent [rad]."""


class Canvas:
    """The viser scene, with the nodes that each layer begins with."""

    def __init__(self, scene: viser.SceneApi) -> None:
        self.scene = scene
        self.roots: dict[str, list[viser.SceneNodeHandle]] = {layer: [] for layer in LAYERS}

    def frame(self, name: str, height: float = 0.0) -> Moving:
        """An invisible coordinate frame that others hang from."""
        return Moving(self.scene.add_frame(name, show_axes=False, position=(0.0, 0.0, height)), height)

    def group(self, layer: str, name: str, height: float = 0.0) -> Moving:
        """A frame whose visibility is that of the layer."""
        moving = self.frame(name, height)
        self.roots[layer].append(moving.handle)
        return moving

    def parts(self, name: str, parts: Sequence[Part], *, shadow: bool = True) -> viser.GlbHandle:
        """Solids with materials in the parent's frame; their shadows fall on the table only."""
        return self.scene.add_glb(name, glb(parts), cast_shadow=shadow, receive_shadow=False)

    def axes(self, name: str, length: float) -> Moving:
        """A frame with its axes drawn, in the layer `frames`."""
        handle = self.scene.add_frame(name, axes_length=length, axes_radius=length / 60, origin_radius=length / 30)
        self.roots["frames"].append(handle)
        return Moving(handle)

    def set_layer(self, layer: str, visible: bool) -> None:
        """Shows or hides a layer."""
        for root in self.roots[layer]:
            root.visible = visible


class Moving:
    """A node that moves in its parent's plane; a message goes out only when it really did."""

    def __init__(self, handle: viser.SceneNodeHandle, height: float = 0.0) -> None:
        self.handle = handle
        self.height = height
        self._x, self._y, self._angle = math.nan, math.nan, math.nan

    def move(self, place: Place | Sequence[float]) -> None:
        """Puts the node at x, y [m] and angle [rad] in its parent's frame."""
        x, y, angle = place
        if not (abs(x - self._x) < LENGTH_TOLERANCE and abs(y - self._y) < LENGTH_TOLERANCE):
            self._x, self._y = x, y
            self.handle.position = (x, y, self.height)
        self.turn(angle)

    def turn(self, angle: float) -> None:
        """Turns the node about its parent's z axis [rad]."""
        if not abs(angle - self._angle) < ANGLE_TOLERANCE:
            self._angle = angle
            self.handle.wxyz = (math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2))


class ChangeDetector:
    """Whether numbers have changed by more than a tolerance since they were last let through."""

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance
        self._last: Sequence[float] = ()

    def changed(self, values: Sequence[float]) -> bool:
        """Whether to act on these values; if so they are what the next are compared with."""
        if len(values) == len(self._last) and self._near(values):
            return False
        self._last = values
        return True

    def _near(self, values: Sequence[float]) -> bool:
        return all(abs(new - old) < self.tolerance for new, old in zip(values, self._last, strict=True))


def as_tuple(values: FloatArray) -> tuple[float, ...]:
    """The numbers of an array, flat."""
    return tuple(values.ravel().tolist())
