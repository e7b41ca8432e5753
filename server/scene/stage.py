"""What stands still: the table with its grid, and the lights."""

from __future__ import annotations

import math

import viser

from server.scene.canvas import Canvas
from server.scene.palette import GRID, GRID_SECTION

TABLE_RADIUS = 1.5
"""Where the table has faded out [m]."""
CELL, SECTION = 0.05, 0.25
"""Spacing of the grid's lines [m]."""


def set_stage(canvas: Canvas) -> None:
    """Puts up table and lights."""
    _table(canvas)
    _lights(canvas.scene)


def _table(canvas: Canvas) -> None:
    """A floor that fades into the night, with a fine grid; it takes the shadows."""
    canvas.group("table", "/table")
    canvas.scene.add_grid(
        "/table/grid",
        width=2.4 * TABLE_RADIUS,
        height=2.4 * TABLE_RADIUS,
        cell_size=CELL,
        cell_thickness=0.6,
        cell_color=GRID,
        section_size=SECTION,
        section_thickness=0.9,
        section_color=GRID_SECTION,
        fade_distance=TABLE_RADIUS,
        fade_strength=2.0,
        fade_from="origin",
        plane_color=(52, 62, 79),
        plane_opacity=1.0,
        shadow_opacity=0.8,
    )


def _lights(scene: viser.SceneApi) -> None:
    """A lamp above that throws the shadows, a cold rim from behind, little from all around."""
    scene.configure_default_lights(enabled=False)
    scene.configure_environment_map("studio", background=False, environment_intensity=0.35)
    scene.add_light_spot(
        "/lights/key",
        position=(-0.55, -0.35, 1.7),
        direction=(0.55, 0.55, -1.7),
        color=(255, 244, 228),
        intensity=6.5,
        angle=math.radians(34),
        penumbra=0.9,
        decay=1.2,
        cast_shadow=True,
    )
    scene.add_light_spot(
        "/lights/rim",
        position=(0.9, 1.6, 0.7),
        direction=(-0.9, -1.4, -0.6),
        color=(150, 190, 255),
        intensity=8.0,
        angle=math.radians(40),
        penumbra=1.0,
        decay=1.2,
    )
    scene.add_light_hemisphere("/lights/fill", sky_color=(120, 140, 175), ground_color=(20, 22, 28), intensity=0.5)
