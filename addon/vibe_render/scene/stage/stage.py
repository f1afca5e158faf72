# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts a bare mesh on a neutral stage: three lights, a camera in three-quarter view, a backdrop."""

from __future__ import annotations

import math
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ...core.schema_import import limits, options, schema
from .. import scene_context
from .parts import area_light, cyclorama, floor, framing_camera, plain_material, plain_world

_CAMERA = (32.0, 12.0)  # azimuth, elevation
_WALL = 8.0  # distance of the backdrop, in radii of the subject


def build_stage(path: str | Path, kind: str = "cyclorama", subject_name: str = "Subject") -> bpy.types.Scene:
    """Starts an empty file and stages the mesh in it; the subject's objects are left selected.

    The mesh is moved to stand on height 0 and scaled until its bounding box has a radius of 1 m.

    Args:
        path: A mesh file of one of `limits.MESH_FORMATS`; axes are read as each format has them by default.
        kind: What the mesh stands on, one of `options.STAGES`.
        subject_name: Name of the material of parts that have none.

    Raises:
        VibeError: If the kind is not known, or the file is missing, broken or without any mesh.
    """
    if kind not in options.STAGES:
        raise schema.VibeError(f"There is no stage {kind!r}.", f"Use one of: {', '.join(options.STAGES)}.")
    path = _checked(path)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True, load_ui=False)
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = 1024
    meshes = _import_meshes(path)
    points = _normalize(meshes, path)
    _dress(meshes, subject_name)
    pivot = (points.min(0) + points.max(0)) / 2
    framing_camera(scene, points, _CAMERA, fov=30.0, fill=0.78)
    _light(scene, pivot)
    _backdrop(scene, kind)
    bpy.ops.object.select_all(action="DESELECT")
    for mesh in meshes:
        mesh.select_set(True)
    return scene


def _checked(path: str | Path) -> Path:
    path = Path(path).absolute()
    if path.suffix.lower() not in limits.MESH_FORMATS:
        raise schema.VibeError(
            f"{path.name} is not a mesh that can be staged.", f"Use {', '.join(limits.MESH_FORMATS)}."
        )
    if not path.is_file():
        raise schema.VibeError(f"There is no file {path}.", "Check the path.")
    return path


def _import_meshes(path: Path) -> list[bpy.types.Object]:
    """Imports the file; returns its mesh objects. Lights and cameras that it brings are dropped."""
    importers = {
        ".obj": bpy.ops.wm.obj_import,
        ".ply": bpy.ops.wm.ply_import,
        ".stl": bpy.ops.wm.stl_import,
        ".glb": bpy.ops.import_scene.gltf,
        ".gltf": bpy.ops.import_scene.gltf,
    }
    try:
        importers[path.suffix.lower()](filepath=str(path))
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[-1].removeprefix("Error: ").rstrip(".")
        raise schema.VibeError(f"{path.name} cannot be read: {reason}.", "Export it again.") from error
    for extra in [o for o in bpy.data.objects if o.type in ("LIGHT", "CAMERA")]:
        bpy.data.objects.remove(extra)
    shown = scene_context.meshes(bpy.context.scene)  # not the shapes that stand for bones
    meshes = [o for o in shown if o.type == "MESH" and o.data.polygons]
    if not meshes:
        raise schema.VibeError(f"There is no mesh with faces in {path.name}.", "Check that it is a model.")
    return meshes


def _normalize(meshes: list[bpy.types.Object], path: Path) -> np.ndarray:
    """Moves and scales the imported objects onto the stage; returns their vertices (V, 3)."""
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


def _vertices(thing: bpy.types.Object) -> np.ndarray:
    """Its vertices (V, 3) as they are shown: a skeleton may put them far from where the file has them."""
    posed = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    flat = np.empty(len(posed.data.vertices) * 3, np.float32)
    posed.data.vertices.foreach_get("co", flat)
    matrix = np.array(posed.matrix_world)
    return flat.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]


def _dress(meshes: list[bpy.types.Object], name: str) -> None:
    """Gives parts without a material a plain one, and parts without normals smooth ones."""
    plain = None
    for thing in meshes:
        if not any(slot.material for slot in thing.material_slots):
            plain = plain or plain_material(name, (0.5, 0.5, 0.5), roughness=0.35)
            thing.data.materials.clear()
            thing.data.materials.append(plain)
        if not thing.data.has_custom_normals:
            thing.data.shade_smooth()
            thing.data.set_sharp_from_angle(angle=math.radians(40))


def _light(scene: bpy.types.Scene, pivot: np.ndarray) -> None:
    """Key from the left, softer fill from the right, rim from behind, a dim neutral world."""
    around = _CAMERA[0]
    area_light(scene, "Key", (around - 52, 40), 5.0, 1.5, 1.1, pivot)
    area_light(scene, "Fill", (around + 60, 18), 5.0, 3.5, 0.13, pivot)
    area_light(scene, "Rim", (around + 150, 45), 5.0, 1.5, 0.9, pivot)
    plain_world(scene, (0.5, 0.5, 0.5), strength=0.2)


def _backdrop(scene: bpy.types.Scene, kind: str) -> None:
    if kind == "none":
        return
    stuff = plain_material("Stage", (0.4, 0.4, 0.4), roughness=0.7)
    if kind == "floor":
        floor(scene, 40.0, stuff)
    else:
        cyclorama(scene, _WALL, 0.9 * _WALL, _CAMERA[0], stuff)
