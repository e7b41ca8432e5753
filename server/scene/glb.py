"""Solids with materials as one binary glTF 2.0 file, the only mesh format of viser with real materials."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from server.scene.palette import Colour, Material
from server.scene.solids import Solid, joined

Part = tuple[Solid, Material]

MAGIC, VERSION, JSON_CHUNK, BINARY_CHUNK = 0x46546C67, 2, 0x4E4F534A, 0x004E4942
FLOAT32, UINT32 = 5126, 5125
VERTEX_BUFFER, INDEX_BUFFER = 34962, 34963


class _Writer:
    """Collects what the file's JSON refers to."""

    def __init__(self) -> None:
        self.binary = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def add(self, array: npt.NDArray[Any], kind: str, component: int, buffer: int) -> int:
        """Stores an array and gives the index of its accessor."""
        payload = array.tobytes()
        self.views.append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(payload), "target": buffer})
        self.binary += payload
        accessor: dict[str, Any] = {
            "bufferView": len(self.views) - 1,
            "componentType": component,
            "type": kind,
            "count": len(array),
        }
        if kind == "VEC3":
            accessor |= {"min": array.min(axis=0).tolist(), "max": array.max(axis=0).tolist()}
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def glb(parts: Sequence[Part]) -> bytes:
    """One mesh of all parts, in the node's own axes; parts of one material are drawn together."""
    writer = _Writer()
    materials = list(dict.fromkeys(material for _, material in parts))
    primitives = []
    for index, material in enumerate(materials):
        solid = joined([solid for solid, of in parts if of == material])
        primitives.append(_primitive(writer, solid, index))
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": primitives}],
        "materials": [_material(material) for material in materials],
        "accessors": writer.accessors,
        "bufferViews": writer.views,
        "buffers": [{"byteLength": len(writer.binary)}],
    }
    return _container(document, bytes(writer.binary))


def _primitive(writer: _Writer, solid: Solid, material: int) -> dict[str, Any]:
    attributes = {
        "POSITION": writer.add(solid.vertices.astype(np.float32), "VEC3", FLOAT32, VERTEX_BUFFER),
        "NORMAL": writer.add(solid.normals.astype(np.float32), "VEC3", FLOAT32, VERTEX_BUFFER),
    }
    indices = writer.add(solid.faces.astype(np.uint32).ravel(), "SCALAR", UINT32, INDEX_BUFFER)
    return {"attributes": attributes, "indices": indices, "material": material}


def _material(material: Material) -> dict[str, Any]:
    colour = linear(material.colour)
    description: dict[str, Any] = {
        "pbrMetallicRoughness": {
            "baseColorFactor": [*colour, material.opacity],
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
        },
        "emissiveFactor": [material.glow * channel for channel in colour],
    }
    if material.opacity < 1.0:
        description["alphaMode"] = "BLEND"
    return description


def linear(colour: Colour) -> list[float]:
    """Linear light from an sRGB colour (IEC 61966-2-1)."""
    encoded = np.array(colour) / 255.0
    decoded = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    return [float(channel) for channel in decoded]


def _container(document: dict[str, Any], binary: bytes) -> bytes:
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<II", len(text), JSON_CHUNK) + text + struct.pack("<II", len(binary), BINARY_CHUNK) + binary
    return struct.pack("<III", MAGIC, VERSION, 12 + len(chunks)) + chunks
