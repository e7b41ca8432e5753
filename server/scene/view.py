"""The scene: one viser server that draws the latest snapshot for every browser alike."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Protocol

import numpy as np
import rich
import viser

from server.scene import cameras
from server.scene.bodies import RobotDrawing, TargetDrawing
from server.scene.cage import CageDrawing
from server.scene.cameras import CAMERAS, CameraName, View
from server.scene.canvas import HIDDEN_AT_FIRST, LAYERS, Canvas
from server.scene.doorway import DoorwayServer, Picture
from server.scene.dynamics import EllipsesDrawing, ForcesDrawing, MotionDrawing
from server.scene.futures import FuturesDrawing
from server.scene.reach import ReachDrawing
from server.scene.solids import FloatArray
from server.scene.stage import set_stage
from server.scene.touches import TouchDrawing
from server.scene.traces import PlanDrawing, TracedPoints, TrailsDrawing
from sim.config import ArmConfig, BaseConfig, MissionConfig, TargetConfig
from sim.rehearsal.summary import CaseResult
from sim.snapshot import Snapshot

FOLLOWING = ("follow", "hand")
"""Presets that go along with what they look at."""
FOLLOW_EVERY = 2
"""A following camera moves with every second snapshot."""
SETTLING = 45
"""Snapshots for which a newly chosen camera holds to its preset: word from browsers may still be of before."""
FOLLOW_TOLERANCE = 5e-4
"""A following camera stays until what it follows has moved this far [m]."""
ORBIT = (0.15, 6.0)
"""Nearest and farthest that a visitor may take the camera [m]."""


class Drawing(Protocol):
    """A part of the scene that follows the mission."""

    def show(self, snapshot: Snapshot) -> None:
        """Draws what the snapshot says, sending only what changed."""
        ...


class Scene:
    """The mission in three dimensions, live or replayed: it draws snapshots and decides nothing.

    Everything lives in the viser server, so a browser that comes late sees the same. `show` may be
    called from any thread; one call at a time is drawn.
    """

    def __init__(self, config: MissionConfig) -> None:
        self._config = config
        self._lock = threading.Lock()
        self._server: DoorwayServer | None = None
        self._canvas: Canvas | None = None
        self._drawings: list[Drawing] = []
        self._trails: TrailsDrawing | None = None
        self._futures: FuturesDrawing | None = None
        self._layers = {layer: layer not in HIDDEN_AT_FIRST for layer in LAYERS}
        self._camera: CameraName = "perspective"
        self._latest: Snapshot | None = None
        self._given: dict[int, View] = {}
        self._arrived: set[int] = set()
        self._shown = 0
        self._settled_at = 0

    def start(self) -> Path:
        """Starts the viser server; the unix socket that it listens on."""
        # viser greets on standard output, which is not ours to write to.
        rich.reconfigure(quiet=True)
        server = DoorwayServer()
        server.gui.configure_theme(dark_mode=True, show_logo=False, show_share_button=False)
        with self._lock:
            self._server = server
            self._build(server)
        server.on_client_connect(self._welcome)
        server.on_client_disconnect(self._forget)
        return server.doorway

    def stop(self) -> None:
        """Closes the viser server and its connections."""
        with self._lock:
            server, self._server = self._server, None
            self._drawings, self._trails, self._futures = [], None, None
        if server is not None:
            server.stop()

    def show(self, snapshot: Snapshot) -> None:
        """Draws a snapshot; a scene that is not started ignores it."""
        with self._lock:
            server, self._latest = self._server, snapshot
            if server is None:
                return
            with server.atomic():
                for drawing in self._drawings:
                    drawing.show(snapshot)
            self._shown += 1
            if self._shown % FOLLOW_EVERY == 0:
                self._follow(server, snapshot)

    @property
    def watched(self) -> bool:
        """Whether any browser shows the scene; for any thread."""
        server = self._server
        return server is not None and server.watched

    def pass_by(self, tick: int, points: TracedPoints) -> None:
        """Note where target and hands are in that tick, for their trails, without drawing anything."""
        with self._lock:
            if self._trails is not None and self._futures is not None:
                self._trails.extend(tick, points)
                self._futures.note(tick)

    def foretell(self, case: CaseResult | None) -> None:
        """Draws the futures of a case until the mission begins again; none takes away what is drawn of them."""
        with self._lock:
            if self._server is not None and self._futures is not None:
                with self._server.atomic():
                    self._futures.foretell(case)

    def reconfigure(self, config: MissionConfig) -> None:
        """Draws this configuration from now on; layers and camera stay.

        Cheap to call with every snapshot: nodes are rebuilt only if the geometry has changed.
        """
        if config is self._config:
            return
        with self._lock:
            before, self._config = self._config, config
            if self._server is not None and _drawn(before) != _drawn(config):
                self._latest = None
                with self._server.atomic():
                    self._server.scene.reset()
                    self._build(self._server)

    def set_layers(self, layers: Mapping[str, bool]) -> None:
        """Shows or hides layers, by the names in `LAYERS`.

        Raises:
            ValueError: a name is not a layer.

        """
        unknown = sorted(set(layers) - set(LAYERS))
        if unknown:
            raise ValueError(f"layer {unknown[0]!r} is unknown; there are {', '.join(LAYERS)}")
        with self._lock:
            self._layers |= layers
            self._apply_layers()

    def arrange(self, camera: CameraName | None, layers: Mapping[str, bool]) -> None:
        """Chooses camera and layers; None leaves the camera.

        Raises:
            ValueError: there is no such camera or layer; nothing is changed then.

        """
        if layers:
            self.set_layers(layers)
        if camera is not None:
            self.set_camera(camera)

    @property
    def layers(self) -> dict[str, bool]:
        """Which layers are shown."""
        return dict(self._layers)

    @property
    def camera(self) -> CameraName:
        """The preset in force."""
        return self._camera

    def set_camera(self, name: CameraName) -> None:
        """Takes all browsers to a preset; those that come later begin there.

        Raises:
            ValueError: the name is not one of `CAMERAS`.

        """
        if name not in CAMERAS:
            raise ValueError(f"camera {name!r} is unknown; there are {', '.join(CAMERAS)}")
        with self._lock:
            self._camera = name
            self._settled_at = self._shown + SETTLING
            if self._server is not None:
                self._aim(self._server)
                for client in self._server.get_clients().values():
                    self._give(client, self._view(client.camera.aspect))

    def ask_for(self, picture: Picture) -> None:
        """Has browsers draw a picture of what is shown now, from where they look; a scene not started ignores it."""
        with self._lock:
            if self._server is not None:
                view, field_of_view = self._pictured(self._server, picture.width / picture.height)
                self._server.ask_for(picture, view, field_of_view)

    def _pictured(self, server: viser.ViserServer, aspect: float) -> tuple[View, float]:
        """From where a visitor looks, who has moved the camera; else the preset in force, framed for the picture."""
        for client in server.get_clients().values():
            camera = client.camera
            # A browser's first word is of where viser itself begins, not of what a visitor has chosen.
            arrived = client.client_id in self._arrived
            if arrived and _is_somewhere(camera) and not self._is_untouched(client, server):
                return View(camera.position, camera.look_at), camera.fov
        return self._view(aspect), cameras.FIELD_OF_VIEW

    def _build(self, server: viser.ViserServer) -> None:
        """Makes all nodes for the configuration in force."""
        canvas = self._canvas = Canvas(server.scene)
        set_stage(canvas)
        makers: tuple[Callable[[Canvas, MissionConfig], Drawing], ...] = (
            RobotDrawing,
            TargetDrawing,
            PlanDrawing,
            TouchDrawing,
            ReachDrawing,
            ForcesDrawing,
            MotionDrawing,
            EllipsesDrawing,
            CageDrawing,
        )
        self._drawings = [make(canvas, self._config) for make in makers]
        self._trails = TrailsDrawing(canvas)
        self._futures = FuturesDrawing(canvas, self._config)
        self._drawings += [self._trails, self._futures]
        self._apply_layers()
        self._aim(server)

    def _apply_layers(self) -> None:
        if self._canvas is not None:
            for layer, visible in self._layers.items():
                self._canvas.set_layer(layer, visible)

    def _aim(self, server: viser.ViserServer) -> None:
        """Where a browser's camera begins, before the shape of its window is known."""
        view = self._view(cameras.WIDE)
        server.initial_camera.position = view.position
        server.initial_camera.look_at = view.look_at
        server.initial_camera.fov = cameras.FIELD_OF_VIEW

    def _view(self, aspect: float) -> View:
        """The preset in force, for a window of that width over height."""
        if self._camera == "perspective":
            return cameras.perspective(self._config, aspect)
        if self._camera == "top":
            return cameras.top(self._config, aspect)
        point = self._followed(self._latest)
        if self._camera == "hand":
            return cameras.close_up(point, aspect)
        wide = cameras.perspective(self._config, aspect)
        return cameras.carried(wide.position, wide.look_at, point)

    def _followed(self, snapshot: Snapshot | None) -> tuple[float, float]:
        """What a following camera looks at: the target, or the hand that is nearest to it."""
        if snapshot is None:
            return self._config.target.initial_x, self._config.target.initial_y
        target = snapshot.target.pose[:2]
        if self._camera != "hand":
            return target
        hands = [arm.hand_pose[:2] for arm in (snapshot.left, snapshot.right)]
        return min(hands, key=lambda hand: float(np.hypot(hand[0] - target[0], hand[1] - target[1])))

    def _welcome(self, client: viser.ClientHandle) -> None:
        """Frames the view for a new browser's window, and again whenever that changes shape."""
        client.camera.min_orbit_distance, client.camera.max_orbit_distance = ORBIT
        client.camera.on_update(lambda _: self._reframe(client))
        self._reframe(client)

    def _reframe(self, client: viser.ClientHandle) -> None:
        """Fits the preset to the window, unless the visitor has moved the camera.

        The initial camera reaches the browser after its first word, so one look is not enough.
        """
        with self._lock:
            if self._server is None:
                return
            wanted = self._view(client.camera.aspect)
            untouched = self._is_untouched(client, self._server)
            if untouched:
                self._arrived.add(client.client_id)
            if untouched and not _is_near(client.camera.position, wanted.position):
                self._give(client, wanted)

    def _is_untouched(self, client: viser.ClientHandle, server: viser.ViserServer) -> bool:
        """Whether a browser's camera stands where it was put; of one that follows that is not known."""
        here = client.camera.position
        if _is_near(here, server.initial_camera.position):
            return True
        given = self._given.get(client.client_id, self._view(client.camera.aspect)).position
        return self._camera not in FOLLOWING and _is_near(here, given)

    def _forget(self, client: viser.ClientHandle) -> None:
        with self._lock:
            self._given.pop(client.client_id, None)
            self._arrived.discard(client.client_id)

    def _give(self, client: viser.ClientHandle, view: View) -> None:
        """Moves a browser's camera."""
        self._given[client.client_id] = view
        with client.atomic():
            client.camera.position = view.position
            client.camera.look_at = view.look_at

    def _follow(self, server: viser.ViserServer, snapshot: Snapshot) -> None:
        """Carries the browsers' cameras along, each from the side its visitor has chosen."""
        if self._camera not in FOLLOWING:
            return
        point = self._followed(snapshot)
        for client in server.get_clients().values():
            camera = client.camera
            if self._shown < self._settled_at or not _is_somewhere(camera):
                view = self._view(camera.aspect)
            else:
                view = cameras.carried(camera.position, camera.look_at, point)
            if not _is_near(camera.position, view.position):
                self._give(client, view)


def _drawn(config: MissionConfig) -> tuple[BaseConfig, ArmConfig, TargetConfig]:
    """What of a configuration the drawing depends on; the rest may change while a mission flies."""
    return config.robot.base, config.robot.arm, config.target


def _is_somewhere(camera: viser.CameraHandle) -> bool:
    """Whether a browser says where its camera is: what is no number would be carried along for ever."""
    return bool(np.isfinite(camera.position).all() and np.isfinite(camera.look_at).all())


def _is_near(position: FloatArray, other: FloatArray) -> bool:
    """Whether two camera positions are the same but for rounding on the way."""
    return float(np.linalg.norm(position - other)) < FOLLOW_TOLERANCE
