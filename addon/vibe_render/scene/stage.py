# SPDX-License-Identifier: GPL-3.0-or-later
"""Stages: camera, lights and backdrop, as in a photo studio, around a mesh from a file; and the scene of `vibe demo`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np
from bpy.types import Material, Object, Scene
from mathutils import Matrix, Vector

from ..core.color import Color
from ..core.compat import enable_nodes
from ..core.schema_import import limits, options, schema
from . import scene_context
from .geometry.meshes import array
from .orbits import orbit_matrix

Point = Sequence[float] | np.ndarray
DEMO_SUBJECT = "Suzanne"  # the object that the demo's prompts are about
_DEMO_VIEW = (24.0, 9.0)  # azimuth and elevation of the demo's camera, degrees
_CAMERA = (32.0, 12.0)  # azimuth and elevation of a stage's camera, degrees
_WALL = 8.0  # distance of the backdrop, in radii of the subject


def plain_material(name: str, color: Color, roughness: float = 0.5, metallic: float = 0.0) -> Material:
    """A Principled material with constant inputs; its base color is linear Rec.709."""
    new_material = bpy.data.materials.new(name)
    shader = next(n for n in enable_nodes(new_material).nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    shader.inputs["Metallic"].default_value = metallic
    new_material.diffuse_color = (*color, 1.0)
    return new_material


def plain_world(scene: Scene, color: Color, strength: float = 1.0) -> None:
    """Gives the scene a world of one color."""
    scene.world = bpy.data.worlds.new("World")
    background = next(n for n in enable_nodes(scene.world).nodes if n.bl_idname == "ShaderNodeBackground")
    background.inputs["Color"].default_value = (*color, 1.0)
    background.inputs["Strength"].default_value = strength


def area_light(
    scene: Scene,
    name: str,
    angles: tuple[float, float],
    distance: float,
    size: float,
    radiance: float,
    pivot: Point,
    color: Color = (1.0, 1.0, 1.0),
) -> Object:
    """Adds a square area light aimed at the pivot: angles (azimuth, elevation) in degrees, distance and size in meters.

    `radiance` is that of a white diffuse surface at the pivot that faces the light.
    """
    lamp = bpy.data.lights.new(name, "AREA")
    lamp.shape, lamp.size, lamp.color = "SQUARE", size, color
    lamp.energy = radiance * schema.radiometry.unit_energy(lamp.type, distance)
    light = bpy.data.objects.new(name, lamp)
    light.matrix_world = orbit_matrix(pivot, *angles, distance)
    scene.collection.objects.link(light)
    return light


def framing_camera(
    scene: Scene, points: np.ndarray, angles: tuple[float, float], fov: float, fill: float, pivot: Point | None = None
) -> Object:
    """Adds a camera that sees all points (N, 3), world space, and makes it the scene's camera.

    It looks at the pivot, by default the center of the points' bounding box, from angles (azimuth, elevation), degrees.
    `fov` is its field of view along the longer side, degrees. `fill` is the share, 0 to 1, of the way from the image's
    center to its border that the points reach.
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


def mesh_object(scene: Scene, name: str, vertices: np.ndarray, faces: list, stuff: Material) -> Object:
    """Adds a smooth-shaded mesh with the material `stuff`; vertices (V, 3), faces as lists of vertex indices."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices.tolist(), [], faces)
    mesh.shade_smooth()
    mesh.materials.append(stuff)
    obj = bpy.data.objects.new(name, mesh)
    scene.collection.objects.link(obj)
    return obj


def floor(scene: Scene, half_size: float, stuff: Material) -> Object:
    """Adds a square floor at height 0, centered at the origin; `half_size` is half its side, meters."""
    corners = half_size * np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], float)
    return mesh_object(scene, "Stage", corners, [(0, 1, 2, 3)], stuff)


def cyclorama(scene: Scene, radius: float, height: float, azimuth: float, stuff: Material) -> Object:
    """Adds a round floor that curves up into a wall, but not within 60° of `azimuth` (degrees): the camera is there."""
    turn = np.linspace(0, math.pi / 2, 17)
    bend = 0.5 * radius
    start = np.linspace(0.01 * radius, radius - bend, 5)
    # profile of the wall, (P, 2): distance from the center, height
    away = np.concatenate([start, radius - bend + bend * np.sin(turn[1:]), [radius]])
    wall = np.stack([away, np.concatenate([np.zeros(5), bend - bend * np.cos(turn[1:]), [height]])], axis=1)
    flat = np.stack([np.linspace(0.01 * radius, radius, len(wall)), np.zeros(len(wall))], axis=1)
    # The wall covers about two thirds of the circle: the camera may move in the rest.
    around = np.arange(0, 360, 5)
    raised = np.clip((np.abs((around - azimuth + 180) % 360 - 180) - 60) / 30, 0, 1)
    raised = (raised**2 * (3 - 2 * raised))[:, None, None]
    away, up = np.moveaxis(raised * wall + (1 - raised) * flat, -1, 0)  # (A, P) each
    angle = np.radians(around)[:, None]
    vertices = np.stack([away * np.sin(angle), -away * np.cos(angle), up], axis=-1)
    spoke, ring = np.meshgrid(np.arange(len(around)), np.arange(len(wall) - 1), indexing="ij")
    here, there = spoke * len(wall) + ring, (spoke + 1) % len(around) * len(wall) + ring
    faces = np.stack([here, here + 1, there + 1, there], axis=-1).reshape(-1, 4)
    # the small hole in the middle is closed by one flat ring of triangles around its center
    center = len(around) * len(wall)
    hub = np.arange(len(around))
    lid = np.stack([np.full_like(hub, center), hub * len(wall), np.roll(hub, -1) * len(wall)], axis=-1)
    points = np.concatenate([vertices.reshape(-1, 3), np.zeros((1, 3))])
    return mesh_object(scene, "Stage", points, [*faces.tolist(), *lid.tolist()], stuff)


def build_demo() -> Scene:
    """Starts an empty file and builds the demo scene in it."""
    scene = _empty_scene()
    _add_demo_objects()
    wall = plain_material("Wall", (0.36, 0.35, 0.34), roughness=0.8)
    cyclorama(scene, 8.0, 7.0, _DEMO_VIEW[0], wall).name = "Backdrop"
    pivot = np.array([0.0, 0.0, 0.86])
    framed = pivot + np.array([(-1.3, 0, 0), (1.3, 0, 0), (0, 0, 0.95)])
    framing_camera(scene, framed, _DEMO_VIEW, fov=28.0, fill=0.9, pivot=pivot)
    area_light(scene, "Key", (-35.0, 38.0), 4.5, 1.4, 1.45, pivot, (1.0, 0.95, 0.88))
    area_light(scene, "Rim", (150.0, 32.0), 4.5, 1.2, 1.0, pivot, (0.86, 0.93, 1.0))
    plain_world(scene, (0.5, 0.53, 0.57), strength=0.22)
    scene.objects[DEMO_SUBJECT].select_set(True)
    return scene


def _empty_scene() -> Scene:
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True, load_ui=False)
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = 1024
    return scene


def _add_demo_objects() -> None:
    clay = plain_material("Clay", (0.46, 0.40, 0.34), roughness=0.45)
    stone = plain_material("Stone", (0.55, 0.53, 0.50), roughness=0.6)
    brass = plain_material("Brass", (0.72, 0.48, 0.19), roughness=0.22, metallic=1.0)
    enamel = plain_material("Enamel", (0.09, 0.16, 0.22), roughness=0.18)
    bpy.ops.mesh.primitive_monkey_add(size=1.15, location=(0.0, 0.0, 1.19))
    suzanne = bpy.context.object
    # Suzanne looks to the front; this turns her a little toward the key light
    suzanne.rotation_euler = (math.radians(-14), 0.0, math.radians(4))
    smooth = suzanne.modifiers.new("Smooth", "SUBSURF")
    smooth.levels = smooth.render_levels = 3
    _finish(DEMO_SUBJECT, clay)
    bpy.ops.mesh.primitive_cylinder_add(vertices=96, radius=0.5, depth=0.72, location=(0.0, 0.0, 0.36))
    _finish("Plinth", stone, bevel=0.03)
    ring = {"major_radius": 0.32, "minor_radius": 0.075, "major_segments": 96, "minor_segments": 32}
    turn = (math.radians(82), 0.0, math.radians(-28))
    bpy.ops.mesh.primitive_torus_add(**ring, location=(0.78, -0.5, 0.385), rotation=turn)
    _finish("Ring", brass)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.36, location=(-1.05, 0.15, 0.36))
    _finish("Large Ball", enamel)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=0.17, location=(-0.62, -0.72, 0.17))
    _finish("Small Ball", brass)
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0.72, 0.75, 0.3))
    bpy.context.object.scale = (0.24, 0.24, 0.6)
    row = bpy.context.object.modifiers.new("Row", "ARRAY")
    row.count = 3
    row.relative_offset_displace = (1.25, 0.0, 0.0)
    _finish("Blocks", stone, bevel=0.02)


def _finish(name: str, stuff: Material, bevel: float = 0.0) -> None:
    """Names and smooths the object that was added last, rounds its edges, and gives it a material."""
    thing = bpy.context.object
    thing.name = name
    if bevel:
        edges = thing.modifiers.new("Bevel", "BEVEL")
        edges.width, edges.segments, edges.limit_method = bevel, 4, "ANGLE"
    _shade(thing)
    thing.data.materials.append(stuff)
    thing.select_set(False)


def _shade(thing: Object) -> None:
    thing.data.shade_smooth()
    thing.data.set_sharp_from_angle(angle=math.radians(40))


def build_stage(path: str | Path, kind: str = "cyclorama") -> Scene:
    """Starts an empty file, imports a mesh file and adds camera, lights and a backdrop of a kind (`options.STAGES`).

    The mesh is moved to stand on height 0, and scaled until half the diagonal of its bounding box is 1 m. It is left
    selected. Raises VibeError for an unknown kind, or a file that is missing, broken or without any mesh.
    """
    if kind not in options.STAGES:
        raise schema.VibeError(f"There is no stage {kind!r}.", f"Use one of: {', '.join(options.STAGES)}.")
    path = Path(path).absolute()
    if path.suffix.lower() not in limits.MESH_FORMATS:
        remedy = f"Use {', '.join(limits.MESH_FORMATS)}."
        raise schema.VibeError(f"{path.name} is not a mesh that can be staged.", remedy)
    if not path.is_file():
        raise schema.VibeError(f"There is no file {path}.", "Check the path.")
    scene = _empty_scene()
    meshes = _import_meshes(path)
    points = _normalize(meshes, path)
    plain = None
    for mesh in meshes:
        if not any(slot.material for slot in mesh.material_slots):
            plain = plain or plain_material("Subject", (0.5, 0.5, 0.5), roughness=0.35)
            mesh.data.materials.clear()
            mesh.data.materials.append(plain)
        if not mesh.data.has_custom_normals:
            _shade(mesh)
    pivot = (points.min(0) + points.max(0)) / 2
    framing_camera(scene, points, _CAMERA, fov=30.0, fill=0.78)
    # key from the left, softer fill from the right, rim from behind, a dim neutral world
    around = _CAMERA[0]
    area_light(scene, "Key", (around - 52, 40), 5.0, 1.5, 1.1, pivot)
    area_light(scene, "Fill", (around + 60, 18), 5.0, 3.5, 0.13, pivot)
    area_light(scene, "Rim", (around + 150, 45), 5.0, 1.5, 0.9, pivot)
    plain_world(scene, (0.5, 0.5, 0.5), strength=0.2)
    if kind != "none":
        gray = plain_material("Stage", (0.4, 0.4, 0.4), roughness=0.7)
        if kind == "floor":
            floor(scene, 40.0, gray)
        else:
            cyclorama(scene, _WALL, 0.9 * _WALL, around, gray)
    bpy.ops.object.select_all(action="DESELECT")
    for mesh in meshes:
        mesh.select_set(True)
    return scene


def _import_meshes(path: Path) -> list[Object]:
    """Imports a file and returns its mesh objects; removes its lights and cameras."""
    kind = path.suffix.lower()[1:]
    operator = bpy.ops.import_scene.gltf if kind in ("glb", "gltf") else getattr(bpy.ops.wm, f"{kind}_import")
    try:
        operator(filepath=str(path))
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[-1].removeprefix("Error: ").rstrip(".")
        raise schema.VibeError(f"{path.name} cannot be read: {reason}.", "Export it again.") from error
    for extra in [o for o in bpy.data.objects if o.type in ("LIGHT", "CAMERA")]:
        bpy.data.objects.remove(extra)
    shown = scene_context.meshes(bpy.context.scene)  # without the objects that only display bones
    meshes = [o for o in shown if o.type == "MESH" and o.data.polygons]
    if not meshes:
        raise schema.VibeError(f"There is no mesh with faces in {path.name}.", "Check that it is a model.")
    return meshes


def _normalize(meshes: list[Object], path: Path) -> np.ndarray:
    """Moves and scales the imported objects as in `build_stage`; returns their vertices (V, 3), world space."""
    bpy.context.view_layer.update()
    points = np.concatenate([_vertices(o) for o in meshes])
    low, high = points.min(0), points.max(0)
    radius = float(np.linalg.norm(high - low)) / 2
    if radius <= 0:
        raise schema.VibeError(f"The mesh in {path.name} has no size.", "Check that it is a model.")
    foot = Vector(((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]))
    place = Matrix.Scale(1 / radius, 4) @ Matrix.Translation(-foot)
    for root in [o for o in bpy.context.scene.objects if o.parent is None]:
        root.matrix_world = place @ root.matrix_world
    bpy.context.view_layer.update()
    return np.concatenate([_vertices(o) for o in meshes])


def _vertices(thing: Object) -> np.ndarray:
    """An object's evaluated vertices (V, 3), world space; evaluated, because an armature may move them far."""
    posed = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    vertices = array(posed.data.vertices, "co", (len(posed.data.vertices), 3), np.float32)
    matrix = np.array(posed.matrix_world)
    return vertices @ matrix[:3, :3].T + matrix[:3, 3]
