# SPDX-License-Identifier: GPL-3.0-or-later
"""What a photographer's stage is made of: camera, lights, backdrop, plain materials."""

from __future__ import annotations

import math
from collections.abc import Sequence

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ...core.color import Color
from ...core.compat import enable_nodes
from ...core.schema_import import schema

Point = Sequence[float] | np.ndarray


def plain_material(
    name: str, color: Color, roughness: float = 0.5, metallic: float = 0.0
) -> bpy.types.Material:
    """A Principled material with constant inputs.

    Args:
        color: Base color, linear Rec.709.
        roughness: In [0, 1].
        metallic: In [0, 1].
    """
    new_material = bpy.data.materials.new(name)
    shader = next(n for n in enable_nodes(new_material).nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    shader.inputs["Metallic"].default_value = metallic
    new_material.diffuse_color = (*color, 1.0)
    return new_material


def plain_world(scene: bpy.types.Scene, color: Color, strength: float = 1.0) -> None:
    """Gives the scene a world of one color."""
    scene.world = bpy.data.worlds.new("World")
    background = next(n for n in enable_nodes(scene.world).nodes if n.bl_idname == "ShaderNodeBackground")
    background.inputs["Color"].default_value = (*color, 1.0)
    background.inputs["Strength"].default_value = strength


def orbit_matrix(pivot: Point, azimuth: float, elevation: float, distance: float) -> Matrix:
    """World matrix of a camera or light on an orbit, looking at the pivot.

    Args:
        pivot: World space, meters.
        azimuth: Degrees, as in `schema.orbit`.
        distance: From the pivot, meters.
    """
    rotation = Matrix(schema.orbit.frame(azimuth, elevation)).to_4x4()
    place = Vector(pivot) + distance * Vector(schema.orbit.direction(azimuth, elevation))
    return Matrix.Translation(place) @ rotation


def area_light(
    scene: bpy.types.Scene,
    name: str,
    angles: tuple[float, float],
    distance: float,
    size: float,
    radiance: float,
    pivot: Point,
    color: Color = (1.0, 1.0, 1.0),
) -> bpy.types.Object:
    """A square area light aimed at the pivot.

    Args:
        angles: Azimuth and elevation, degrees.
        distance: From the pivot, meters.
        size: Edge length, meters.
        radiance: What a white diffuse surface at the pivot that faces the light sends back.
        pivot: World space, meters.
    """
    lamp = bpy.data.lights.new(name, "AREA")
    lamp.shape, lamp.size, lamp.color = "SQUARE", size, color
    lamp.energy = radiance * schema.radiometry.unit_energy(lamp.type, distance)
    light = bpy.data.objects.new(name, lamp)
    light.matrix_world = orbit_matrix(pivot, *angles, distance)
    scene.collection.objects.link(light)
    return light


def framing_camera(
    scene: bpy.types.Scene,
    points: np.ndarray,
    angles: tuple[float, float],
    fov: float,
    fill: float,
    pivot: Point | None = None,
) -> bpy.types.Object:
    """A camera that sees all points, and makes it the scene's.

    Args:
        points: (N, 3), world space.
        angles: Azimuth and elevation, degrees.
        fov: Along the longer side of the picture, degrees.
        fill: The share of the picture's half width or height that the points may reach.
        pivot: What it looks at; None for the middle of the points' bounding box.
    """
    middle = np.asarray(pivot if pivot is not None else (points.min(0) + points.max(0)) / 2)
    x, y, z = ((points - middle) @ np.array(schema.orbit.frame(*angles))).T
    width, height = scene.render.resolution_x, scene.render.resolution_y
    half = fill * math.tan(math.radians(fov) / 2) / max(width, height)
    # |x| / (distance - z) <= half * width, for every point, and likewise upwards
    distance = float(np.max(np.maximum(np.abs(x) / (half * width), np.abs(y) / (half * height)) + z))
    data = bpy.data.cameras.new("Camera")
    data.angle = math.radians(fov)
    data.clip_start, data.clip_end = distance * 0.01, distance * 100
    obj = bpy.data.objects.new("Camera", data)
    obj.matrix_world = orbit_matrix(middle, *angles, distance)
    scene.collection.objects.link(obj)
    scene.camera = obj
    return obj


def mesh_object(
    scene: bpy.types.Scene, name: str, vertices: np.ndarray, faces: list, stuff: bpy.types.Material
) -> bpy.types.Object:
    """A smooth mesh of one material; vertices (V, 3), faces lists of vertex numbers."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices.tolist(), [], faces)
    mesh.shade_smooth()
    mesh.materials.append(stuff)
    obj = bpy.data.objects.new(name, mesh)
    scene.collection.objects.link(obj)
    return obj


def floor(scene: bpy.types.Scene, half_size: float, stuff: bpy.types.Material) -> bpy.types.Object:
    """A square floor at height 0."""
    corners = half_size * np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], float)
    return mesh_object(scene, "Stage", corners, [(0, 1, 2, 3)], stuff)


def cyclorama(
    scene: bpy.types.Scene, radius: float, height: float, azimuth: float, stuff: bpy.types.Material
) -> bpy.types.Object:
    """A round floor that sweeps up into a wall behind the subject, without an edge.

    The wall goes two thirds of the way around, so that the camera may move; towards the camera the
    floor stays flat.

    Args:
        radius: From the middle to the wall, meters.
        height: Of the wall, meters.
        azimuth: Of the camera, degrees.
    """
    turn = np.linspace(0, math.pi / 2, 17)
    bend = 0.5 * radius
    start = np.linspace(0.01 * radius, radius - bend, 5)
    wall = np.stack(
        [
            np.concatenate([start, radius - bend + bend * np.sin(turn[1:]), [radius]]),
            np.concatenate([np.zeros(5), bend - bend * np.cos(turn[1:]), [height]]),
        ],
        axis=1,
    )  # (P, 2): distance from the middle, height
    flat = np.stack([np.linspace(0.01 * radius, radius, len(wall)), np.zeros(len(wall))], axis=1)
    around = np.arange(0, 360, 5)
    raised = np.clip((np.abs((around - azimuth + 180) % 360 - 180) - 60) / 30, 0, 1)
    raised = (raised**2 * (3 - 2 * raised))[:, None, None]
    profiles = raised * wall + (1 - raised) * flat  # (A, P, 2)
    angle = np.radians(around)[:, None]
    vertices = np.stack(
        [profiles[..., 0] * np.sin(angle), -profiles[..., 0] * np.cos(angle), profiles[..., 1]], axis=-1
    )
    spoke, ring = np.meshgrid(np.arange(len(around)), np.arange(len(wall) - 1), indexing="ij")
    here, there = spoke * len(wall) + ring, (spoke + 1) % len(around) * len(wall) + ring
    faces = np.stack([here, here + 1, there + 1, there], axis=-1).reshape(-1, 4)
    # the small hole in the middle is closed by one flat ring of triangles around its center
    center = len(around) * len(wall)
    hub = np.arange(len(around))
    lid = np.stack([np.full_like(hub, center), hub * len(wall), np.roll(hub, -1) * len(wall)], axis=-1)
    points = np.concatenate([vertices.reshape(-1, 3), np.zeros((1, 3))])
    return mesh_object(scene, "Stage", points, [*faces.tolist(), *lid.tolist()], stuff)
