# SPDX-License-Identifier: GPL-3.0-or-later
"""What computed nodes of a light (IES textures, gobos) do to its power and color on average, measured by Cycles."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

import bpy
import numpy as np
from bpy.types import Light, Object, Scene
from mathutils import Vector

from ..scene.light_types import type_of
from ..scene.nodes import light_nodes
from . import bake

_FACTOR_HEIGHT, _FACTOR_SAMPLES = 32, 64
_WATTS = 1000.0


def mean_light_factor(light: Object, pivot: Vector) -> tuple[float, float, float]:
    """The mean factor of a light's nodes on what it sheds to the subject's side, a Blackbody's temperature aside.

    The light shines on a ball around it that is as wide as the subject is far: with its nodes, and without.

    Args:
        light: The light; left as it is.
        pivot: The middle of the subject, world space.
    """
    endless = not type_of(light).has_position
    way = pivot - light.matrix_world.translation
    toward = -light.matrix_world.col[2].xyz if endless else way
    with _lit_ball(light, 1.0 if endless else max(way.length, 1e-3)) as (scene, data):
        light_nodes.whiten(data)
        lit = bake.bake_panorama(scene, _FACTOR_SAMPLES)
        light_nodes.flatten(data)
        plain = bake.bake_panorama(scene, _FACTOR_SAMPLES)
    weight = _weights(toward.normalized())
    total = (plain * weight).sum((0, 1))
    if total.max() <= 0.0:  # it looks away from the subject
        weight = np.ones_like(weight)
        total = (plain * weight).sum((0, 1))
    red, green, blue = ((lit * weight).sum((0, 1)) / np.maximum(total, 1e-9)).tolist()
    return red, green, blue


def _weights(toward: Vector) -> np.ndarray:
    """(H, 2H, 1): solid angle of each texel of a panorama, times the cosine to a direction."""
    elevation = ((np.arange(_FACTOR_HEIGHT) + 0.5) / _FACTOR_HEIGHT - 0.5) * math.pi
    azimuth = (0.5 - (np.arange(2 * _FACTOR_HEIGHT) + 0.5) / (2 * _FACTOR_HEIGHT)) * 2 * math.pi
    across = np.cos(elevation)[:, None]
    x, y, z = across * np.cos(azimuth), across * np.sin(azimuth), np.sin(elevation)[:, None]
    return (across * np.maximum(x * toward.x + y * toward.y + z * toward.z, 0.0))[..., None]


@contextmanager
def _lit_ball(light: Object, radius: float) -> Iterator[tuple[Scene, Light]]:
    """A scene with a copy of a light in the middle of a ball, and the copy's data."""
    data, mesh = light.data.copy(), bpy.data.meshes.new("Vibe Bake")
    _make_ball(mesh, radius)
    lamp, ball = bpy.data.objects.new("Vibe Bake", data), bpy.data.objects.new("Vibe Bake", mesh)
    data.energy, data.color = _WATTS, (1.0, 1.0, 1.0)
    if hasattr(data, "use_temperature"):
        data.use_temperature = False
    lamp.visible_camera = ball.visible_shadow = False
    matrix = light.matrix_world.copy()
    matrix.translation = (0.0, 0.0, 0.0)
    lamp.matrix_world = matrix
    try:
        with bake.empty_scene(2 * _FACTOR_HEIGHT, _FACTOR_HEIGHT) as scene:
            for obj in (lamp, ball):
                scene.collection.objects.link(obj)
            yield scene, data
    finally:
        bpy.data.objects.remove(lamp)
        bpy.data.objects.remove(ball)
        bpy.data.lights.remove(data)
        bpy.data.meshes.remove(mesh)


def _make_ball(mesh: bpy.types.Mesh, radius: float) -> None:
    rows, columns = 16, 32
    points = [
        (
            radius * math.sin(math.pi * r / rows) * math.cos(2 * math.pi * c / columns),
            radius * math.sin(math.pi * r / rows) * math.sin(2 * math.pi * c / columns),
            radius * math.cos(math.pi * r / rows),
        )
        for r in range(rows + 1)
        for c in range(columns)
    ]
    cells = [(r * columns + c, r * columns + (c + 1) % columns) for r in range(rows) for c in range(columns)]
    mesh.from_pydata(points, [], [(a, b, b + columns, a + columns) for a, b in cells])
