"""viser without a port: its server listens on a socket in a folder that only this process's user may enter.

viser knows no login and takes any origin, so that whoever reaches a port of it may do what the service's own checks
forbid: other users of the machine, and any page in a browser on it. A unix socket is reached by the service alone.
viser takes a host and a port only; here a host that is a path is such a socket.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import viser
import websockets.asyncio.server
from viser._messages import GetRenderRequestMessage
from viser.infra import _infra

from server.scene.cameras import View, orientation

LONGEST_PATH = 100
"""Bytes that the path of a unix socket may have, on the system that allows fewest (104, with its end)."""


class _PatchedModule:
    """A module as viser sees it: itself, but for what stands here instead."""

    def __init__(self, module: ModuleType, **instead: Any) -> None:
        self._module = module
        self.__dict__.update(instead)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._module, name)


def _serve(handler: Any, host: str, port: int, **options: Any) -> Any:
    if host.startswith("/"):
        return websockets.asyncio.server.unix_serve(handler, host, **options)
    return websockets.asyncio.server.serve(handler, host, port, **options)


_infra.websockets = _PatchedModule(  # type: ignore[assignment, attr-defined]
    websockets,
    asyncio=_PatchedModule(websockets.asyncio, server=_PatchedModule(websockets.asyncio.server, serve=_serve)),
)


class Picture(NamedTuple):
    """A picture that browsers are asked for."""

    name: str
    """By which who asked knows it again."""
    width: int
    height: int
    """[pixels]"""


class DoorwayServer(viser.ViserServer):
    """viser on a unix socket, and without its tunnel: nothing that a browser sends may publish the scene outside."""

    def __init__(self) -> None:
        """Start it.

        Raises:
            OSError: no folder for the socket can be made.

        """
        self._folder = Path(tempfile.mkdtemp(prefix="becalm-scene-"))
        if len(os.fsencode(self._folder / "viser")) > LONGEST_PATH:
            self._folder.rmdir()
            self._folder = Path(tempfile.mkdtemp(prefix="becalm-scene-", dir="/tmp"))
        self.doorway = self._folder / "viser"
        super().__init__(host=str(self.doorway), port=0, verbose=False)
        self._open: set[int] = set()
        self._websock_server.on_client_connect(lambda client: self._open.add(client.client_id))
        self._websock_server.on_client_disconnect(lambda client: self._open.discard(client.client_id))

    @property
    def watched(self) -> bool:
        """Whether any browser is connected, also one that has not said yet where its camera is; for any thread."""
        return bool(self._open)

    def ask_for(self, picture: Picture, view: View, field_of_view: float) -> None:
        """Have every browser draw what it has been sent until now once more, at that size, on nothing.

        viser's own `get_render` waits for the bytes, and may overtake what the scene has been told: requests of one
        browser and the scene's updates wait in two lists. This one stands in the scene's list, and its answer goes to
        the page around the scene (`server.pages.scene_page`), never through here.

        Args:
            picture: which.
            view: from where.
            field_of_view: vertical [rad].

        """
        told = self._websock_server.get_message_buffer()
        told.remove_from_buffer(
            lambda message: isinstance(message, GetRenderRequestMessage)
        )  # browsers come later, too
        self._websock_server.queue_message(
            GetRenderRequestMessage(
                format="image/png",
                width=picture.width,
                height=picture.height,
                quality=100,
                wxyz=orientation(view),
                position=(float(view.position[0]), float(view.position[1]), float(view.position[2])),
                fov=field_of_view,
                render_uuid=picture.name,
            )
        )
        self._websock_server.flush()

    def stop(self) -> None:
        """End it, and remove its socket."""
        super().stop()
        shutil.rmtree(self._folder, ignore_errors=True)

    def request_share_url(self, verbose: bool = True) -> None:
        """Refuses: access goes through the service's own port, which checks identity and origin."""

    def disconnect_share_url(self) -> None:
        """There is never a tunnel to close."""
