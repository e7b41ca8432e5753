"""Solids with materials as one binary glTF 2.0 file, the only mesh format of viser with real materials."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np
import trimesh
from trimesh.exchange.gltf import export_glb

from server.scene.palette import Colour, Material
from server.scene.solids import Solid, joined

Part = tuple[Solid, Material]

_MARKS = itertools.count(1)
"""Of the files that this process has made: by its mark a page finds what it has decoded (`server.pages.scene_page`)."""


def glb(parts: Sequence[Part]) -> bytes:
    """All parts in the node's own axes; those of one material are one mesh, drawn together."""
    materials = list(dict.fromkeys(material for _, material in parts))
    scene = trimesh.Scene()
    for index, material in enumerate(materials):
        scene.add_geometry(_mesh(joined([solid for solid, of in parts if of == material])), geom_name=str(index))

    def finish(tree: dict[str, Any]) -> None:
        # Not as visuals of the meshes: those round linear light to 8 bits, in which dark colours are all alike.
        tree["scenes"][0]["extras"] = {"mark": next(_MARKS)}
        tree["materials"] = [_material(material) for material in materials]
        for mesh in tree["meshes"]:
            mesh["primitives"][0]["material"] = int(mesh["name"])

    content: bytes = export_glb(scene, include_normals=True, tree_postprocessor=finish)
    return content


def _mesh(solid: Solid) -> trimesh.Trimesh:
    return trimesh.Trimesh(solid.vertices, solid.faces, vertex_normals=solid.normals, process=False)


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
