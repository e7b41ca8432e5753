"""The scene as a computer without a graphics card can draw it: no environment map, no shadows.

Browsers share one viser server, so what makes a scene light is taken out of the frames on their way to the browsers
that ask for it. A frame is two lengths, a zstd-compressed msgpack of messages, and raw arrays from the next multiple
of eight on (`viser.infra`); only frames that hold a light or an environment map are rewritten.
"""

from __future__ import annotations

from typing import Any

import msgspec
import zstandard

LENGTH = 8
"""Bytes of each of the two lengths at the head of a frame."""
ALIGNMENT = 8
"""Of the raw arrays."""
LARGEST_WORDS = 64 * 2**20
"""Bytes of messages that are unpacked; a whole scene has a few hundred thousand."""
BRIGHTER = 5.0
"""What the light from all around is multiplied by, in place of the environment map."""

MARKS = (b"EnvironmentMapMessage", b"SpotLightMessage", b"HemisphereLightMessage")


def lightened(frame: bytes) -> bytes:
    """The same frame without environment map and shadows; what is no such frame is left as it is."""
    packed = int.from_bytes(frame[LENGTH : 2 * LENGTH], "little")
    end = 2 * LENGTH + packed
    try:
        words = zstandard.ZstdDecompressor().decompress(frame[2 * LENGTH : end], max_output_size=LARGEST_WORDS)
    except zstandard.ZstdError:
        return frame
    if not any(mark in words for mark in MARKS):
        return frame
    body = msgspec.msgpack.decode(words)
    for message in body["messages"]:
        _lighten(message)
    written = msgspec.msgpack.encode(body)
    compressed = zstandard.ZstdCompressor(level=1).compress(written)
    head = len(written).to_bytes(LENGTH, "little") + len(compressed).to_bytes(LENGTH, "little") + compressed
    arrays = frame[_aligned(end) :]
    return head + bytes(_aligned(len(head)) - len(head)) + arrays if arrays else head


def _lighten(message: dict[str, Any]) -> None:
    """Change one message in place."""
    kind = message.get("type")
    if kind == "EnvironmentMapMessage":
        message["hdri_data"] = None
    elif kind == "SpotLightMessage":
        message["props"]["cast_shadow"] = False
    elif kind == "HemisphereLightMessage":
        message["props"]["intensity"] *= BRIGHTER


def _aligned(length: int) -> int:
    return -(-length // ALIGNMENT) * ALIGNMENT
