"""The scene's colours: sRGB, 0 to 255.

Arms, touch, momentum, spin and cage use the Okabe-Ito hues, which colour-blind people can distinguish; none
of them is the only sign: arms differ in side, touches also draw arrows, cages also change their line.
"""

from __future__ import annotations

from typing import NamedTuple

Colour = tuple[int, int, int]

LEFT: Colour = (86, 180, 233)
RIGHT: Colour = (230, 159, 0)
ARMS: tuple[Colour, Colour] = (LEFT, RIGHT)
TOUCH: Colour = (240, 228, 66)
SPIN: Colour = (20, 184, 136)
CAGE: Colour = (60, 214, 166)
TARGET: Colour = (214, 222, 234)
FUTURE: Colour = (190, 170, 255)
WORST: Colour = (224, 94, 20)
FAINT: Colour = (122, 134, 152)

NIGHT: Colour = (14, 17, 22)
"""The page behind the scene, the same as the console's."""
GRID: Colour = (58, 68, 84)
GRID_SECTION: Colour = (92, 106, 128)

FORCE_ARROW: Colour = (196, 150, 0)
MOMENTUM_ARROW: Colour = (168, 62, 122)
"""Deeper than the colours they stand for: the lamp brings arrows up to those."""


class Material(NamedTuple):
    """A physically based surface, as glTF knows it."""

    colour: Colour
    metallic: float = 0.0
    roughness: float = 0.5
    glow: float = 0.0
    """Share of the colour that shines by itself."""
    opacity: float = 1.0


SHELL = Material((190, 197, 207), 0.10, 0.45)
GRAPHITE = Material((44, 50, 60), 0.35, 0.48)
ALUMINIUM = Material((172, 180, 192), 0.45, 0.38)
STEEL = Material((150, 157, 168), 0.85, 0.28)
TANK = Material((196, 172, 128), 0.75, 0.34)
FINGER = Material((104, 114, 130), 0.45, 0.4)
TIP = Material((176, 184, 196), 0.0, 0.5)
LAMP = Material((120, 214, 255), 0.0, 0.4, glow=1.0)
SOLAR = Material((26, 44, 92), 0.55, 0.22)
FOIL = Material((196, 150, 74), 0.7, 0.38)
MARK = Material((244, 246, 250), 0.0, 0.5, glow=0.25)
FACES = (
    Material((88, 140, 178), 0.25, 0.45),
    Material((222, 226, 232), 0.15, 0.5),
    Material((190, 122, 74), 0.25, 0.45),
    Material((92, 98, 110), 0.25, 0.45),
)
"""The target's sides in its frame: +x blue, +y white (it bears the mark), -x copper, -y grey."""


def accent(colour: Colour) -> Material:
    """The surface of bands and stripes in a colour that must read in the dark."""
    return Material(colour, 0.0, 0.5, glow=0.35)


def light(colour: Colour, opacity: float = 1.0) -> Material:
    """A surface that shines in that colour."""
    return Material(colour, 0.0, 1.0, glow=1.0, opacity=opacity)


def veil(colour: Colour, opacity: float) -> Material:
    """A see-through surface, for what is not there (yet)."""
    return Material(colour, 0.0, 0.9, glow=0.45, opacity=opacity)
