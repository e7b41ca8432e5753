"""What a browser may say to a scene: where its own camera is, and nothing else, whoever it is.

viser takes much more: it keeps some of it, and repeats it to every browser that comes later. The console uses none of
that: what of a scene is drawn is chosen over REST. So a message is passed on only if it is a camera's, with numbers
that a camera can have; it is rewritten, so that nothing else comes along.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Annotated, Any

import msgspec

LARGEST = 2048
"""Bytes; a camera takes some 300."""

FARTHEST = 1e4
"""Of anything that a camera names, from the origin [m]."""

_Triple = tuple[float, float, float]
_Pixels = Annotated[int, msgspec.Meta(ge=1, le=65_536)]


class Camera(msgspec.Struct, tag_field="type", tag="ViewerCameraMessage", forbid_unknown_fields=True):
    """viser's message of that name."""

    wxyz: tuple[float, float, float, float]
    position: _Triple
    fov: Annotated[float, msgspec.Meta(gt=0.0, lt=math.pi)]
    near: float
    far: float
    image_height: _Pixels
    image_width: _Pixels
    look_at: _Triple
    up_direction: _Triple

    @property
    def numbers(self) -> Iterable[float]:
        """All that could be anything."""
        return (*self.wxyz, *self.position, self.near, self.far, *self.look_at, *self.up_direction)


_DECODER = msgspec.msgpack.Decoder(Camera)
_ENCODER = msgspec.msgpack.Encoder()


def accepted_camera(message: Any) -> bytes | None:
    """A browser's message as it is passed to viser; None if it is not."""
    if not isinstance(message, bytes) or len(message) > LARGEST:
        return None
    try:
        camera = _DECODER.decode(message)
    except (msgspec.MsgspecError, RecursionError):
        return None
    # Not true of NaN, either.
    return _ENCODER.encode(camera) if all(abs(number) <= FARTHEST for number in camera.numbers) else None
