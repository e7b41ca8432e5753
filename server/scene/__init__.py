"""The 3D scene: the only room that imports viser. It draws snapshots and decides nothing."""

from server.scene.cameras import CAMERAS, CameraName
from server.scene.canvas import LAYERS
from server.scene.doorway import Picture
from server.scene.view import Scene

__all__ = ["CAMERAS", "LAYERS", "CameraName", "Picture", "Scene"]
