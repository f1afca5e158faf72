# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects to make shapes of: balls, boxes, turned profiles, and meshes of formulas."""

from __future__ import annotations

import math
from collections.abc import Iterable

import bpy
import numpy as np
from bpy.types import Object

from lab.blender.scenes import fields


def finish_active(name: str, smooth: float | None = 40.0, **modifiers: dict) -> Object:
    """Names the active object and gives it modifiers and smooth shading.

    Args:
        smooth: Edges are sharp above this angle, degrees; None for flat shading.
        modifiers: Type -> its settings: bevel={"width": 0.02}.
    """
    thing = bpy.context.object
    thing.name = name
    for kind, settings in modifiers.items():
        modifier = thing.modifiers.new(kind.title(), kind.upper())
        for key, value in settings.items():
            setattr(modifier, key, value)
    if smooth is not None:
        thing.data.shade_smooth()
        thing.data.set_sharp_from_angle(angle=math.radians(smooth))
    thing.select_set(False)
    return thing


def mesh(name: str, vertices: np.ndarray, faces: Iterable, uvs: np.ndarray | None = None) -> Object:
    """A smooth object of a mesh, linked to the scene.

    Args:
        vertices: (V, 3).
        faces: Indices of vertices, a row for each face.
        uvs: A place for each corner of each face; None for no UV map.
    """
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices.tolist(), [], np.asarray(faces).tolist())
    if uvs is not None:
        mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", uvs.astype(np.float32).ravel())
    mesh.shade_smooth()
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(thing)
    return thing


def ball(name: str, radius: float, place: tuple[float, float, float], rings: int = 32) -> Object:
    """A ball with UVs; Blender's own has its faces in another order every time.

    Args:
        rings: Rows of faces from pole to pole; twice as many around.
    """
    thing = mesh(name, *fields.sphere(2 * rings, rings + 1, radius))
    thing.location = place
    return thing


def box(
    name: str,
    size: tuple[float, float, float],
    place: tuple[float, float, float],
    turn: float = 0.0,
    bevel: float = 0.02,
) -> Object:
    """A box with rounded edges.

    Args:
        size: Along x, y and z, meters.
        turn: Around z, radians.
        bevel: Width of the rounding, meters; 0 for sharp edges.
    """
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=place, rotation=(0.0, 0.0, turn))
    thing = bpy.context.object
    thing.scale = size
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    return finish_active(name, 40.0, **({"bevel": {"width": bevel, "segments": 3}} if bevel else {}))


def lathe(name: str, profile: list[tuple[float, float]], thickness: float = 0.0) -> Object:
    """A profile turned around the z axis.

    Args:
        profile: Radius and height of each point.
        thickness: Of its wall, meters; 0 for an open surface.
    """
    thing = mesh(name, *fields.lathe(np.array(profile, float)))
    if thickness:
        solid = thing.modifiers.new("Solid", "SOLIDIFY")
        solid.thickness, solid.offset = thickness, 0.0
    return thing
