# SPDX-License-Identifier: GPL-3.0-or-later
"""What the surfaces of a scene shed light: emissive panels, windows, neon."""

from __future__ import annotations

import math
from collections.abc import Iterable

import bpy
import numpy as np
from bpy.types import Material, Object
from mathutils import Vector

from .nodes import layers
from .nodes.shaders import NodeInGroups
from .nodes.trails import resolve

_COLOR, _STRENGTH = 0.5, 1.0  # what a color and a strength that nodes compute are taken for


def radiance(material: Material) -> float:
    """About the radiance that a material's surface emits, its strongest component; 0 if it does not."""
    return sum(layer.share * _emitted(layer.shader) for layer in layers.layers(material))


def _emitted(shader: NodeInGroups) -> float:
    values = []
    for name, computed in (("Emission Color", _COLOR), ("Emission Strength", _STRENGTH)):
        entry = shader.entry(name)
        if entry is None:
            return 0.0
        origin = resolve(entry)
        value = origin.socket.default_value
        values.append(computed if origin.source else max(value[:3]) if hasattr(value, "__len__") else value)
    return max(values[0] * values[1], 0.0)


def light_at(depsgraph: bpy.types.Depsgraph, objects: Iterable[Object], place: Vector) -> float:
    """Radiance of a white surface at a place that faces all that glows; nothing is taken to stand in the way."""
    total = 0.0
    for obj in objects:
        strengths = [radiance(slot.material) if slot.material else 0.0 for slot in obj.material_slots]
        if any(strengths):
            evaluated = obj.evaluated_get(depsgraph)
            if mesh := evaluated.to_mesh():
                total += _shed(mesh, np.array(evaluated.matrix_world), strengths, place)
                evaluated.to_mesh_clear()
    return total


def _shed(mesh: bpy.types.Mesh, matrix: np.ndarray, strengths: list[float], place: Vector) -> float:
    """The sum of radiance x area / (pi d^2) over a mesh's faces, half of which look the other way."""
    count = len(mesh.polygons)
    area, index, center = np.zeros(count), np.zeros(count, np.int32), np.zeros(3 * count)
    mesh.polygons.foreach_get("area", area)
    mesh.polygons.foreach_get("material_index", index)
    mesh.polygons.foreach_get("center", center)
    way = center.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3] - np.array(place)
    scale = abs(np.linalg.det(matrix[:3, :3])) ** (2.0 / 3.0)
    strength = np.array(strengths)[np.clip(index, 0, len(strengths) - 1)]
    share = np.minimum(0.5 * scale * area / (math.pi * np.maximum((way**2).sum(1), 1e-6)), 1.0)
    return float((strength * share).sum())
