# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a scene to a job folder for the engine: `scene.json`, `meshes.npz` and its textures as `.npy`."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Vector

from . import bindings, export_material, export_texture, export_world, fog, poses, roster, shaders
from .contract import schema
from .export_material import NO_MATERIAL, Exported
from .survey import Survey

FORMAT = 1


@dataclass
class Job:
    """What has been exported.

    Attributes:
        folder: Where it is.
        survey: The scene as it was looked at.
        instances: Its parameters, by key.
        warnings: What the engine sees only approximately, in words for the artist.
    """

    folder: Path
    survey: Survey
    instances: dict[str, schema.Instance]
    warnings: list[str] = field(default_factory=list)


def export(survey: Survey, folder: Path) -> Job:
    """Writes the job folder; `scene.json` comes last and atomically.

    Args:
        survey: What is known about the scene.
        folder: Made if it does not exist.
    """
    folder.mkdir(parents=True, exist_ok=True)
    scene, geometry = survey.scene, survey.geometry
    found = bindings.instances(scene, survey.objects, survey.pivot)
    materials = {name: _material(survey, name) for name in geometry.materials}
    instances = _with_materials(found, survey, materials)
    warnings = [*geometry.warnings, *(m.row["warning"] for m in materials.values() if m.row["warning"])]
    warnings += _ignored(scene)
    image, note = export_world.environment(scene.world)
    if image is not None:
        np.save(folder / "world.npy", image.astype(np.float32))
    content = {
        "format": FORMAT,
        "schema": schema.schema_hash(),
        "blender": bpy.app.version_string,
        "source": Path(bpy.data.filepath).name,
        "resolution": [_scaled(scene, scene.render.resolution_x), _scaled(scene, scene.render.resolution_y)],
        "pixel_aspect": scene.render.pixel_aspect_x / scene.render.pixel_aspect_y,
        "pivot": survey.pivot,
        "references": bindings.references(scene, survey.objects, survey.pivot),
        "camera": _camera(survey),
        "lights": _lights(survey),
        "materials": _write_textures(survey, materials, folder),
        "objects": [
            {"name": name, "subject": bool(chosen)}
            for (name, _), chosen in zip(geometry.objects, survey.chosen, strict=True)
        ],
        "world": {"kind": "color"} if image is None else {"kind": "environment", "image": "world.npy"},
        "volume": _volume(survey, instances),
        "film": _film(scene),
        "parameters": {key: _parameter(instance) for key, instance in instances.items()},
    }
    _write_meshes(survey, folder)
    temporary = folder / "scene.json.part"
    temporary.write_text(json.dumps(content, indent=1), encoding="utf-8")
    os.replace(temporary, folder / "scene.json")
    return Job(folder, survey, instances, [w for w in (*warnings, note) if w])


def _scaled(scene: bpy.types.Scene, pixels: int) -> int:
    return max(1, int(pixels * scene.render.resolution_percentage / 100))


def _material(survey: Survey, name: str) -> Exported:
    number = survey.geometry.materials.index(name)
    mask = survey.seen.material == number
    material = next((m for m in bpy.data.materials if m.name_full == name), None) if name else None
    if material is None:
        return export_material.export(None, _unread, _unmeasured)
    return export_material.export(
        material,
        lambda source: export_texture.texture(survey.scene, material, source, mask),
        lambda source: export_texture.measured(survey.scene, material, source, mask),
    )


def _unread(_source: bpy.types.NodeSocket) -> export_texture.Picture:
    raise AssertionError("a missing material has no inputs")


def _unmeasured(_source: bpy.types.NodeSocket) -> np.ndarray:
    raise AssertionError("a missing material has no inputs")


def _roles(survey: Survey) -> dict[str, str]:
    """Of every material: "subject" if the subject shows it, else "surroundings"."""
    geometry = survey.geometry
    theirs = set(geometry.material[survey.chosen[geometry.object]].tolist())
    return {
        name or NO_MATERIAL: "subject" if number in theirs else "surroundings"
        for number, name in enumerate(geometry.materials)
    }


def _with_materials(
    found: Mapping[str, schema.Instance], survey: Survey, materials: Mapping[str, Exported]
) -> dict[str, schema.Instance]:
    """The parameters, with roles as the render sees them and what bindings cannot know as locked values."""
    roles = _roles(survey)
    instances = {
        key: replace(i, role=roles.get(i.owner, i.role)) if i.parameter.group == "material" else i
        for key, i in found.items()
    }
    for exported in materials.values():
        owner = exported.row["name"]
        for name, value in exported.values.items():
            parameter = schema.FAMILIES[f"material/{name}"]
            before = instances.get(parameter.key(owner))
            if before is None or before.locked:
                reason = before.locked if before else exported.reason
                made = schema.Instance(parameter, owner, value, role=roles[owner], locked=reason)
                instances[made.key] = made
    return instances


def _parameter(instance: schema.Instance) -> dict[str, Any]:
    value = list(instance.value) if instance.parameter.components == 3 else instance.value[0]
    return {"value": value, "reference": instance.reference, "role": instance.role, "locked": instance.locked}


def _camera(survey: Survey) -> dict[str, Any]:
    thing = survey.scene.camera
    data = thing.data
    return {
        "name": thing.name_full,
        "type": data.type,
        "residual": _rows(poses.Pose.of(thing, Vector(survey.pivot)).residual),
        "ortho_scale": data.ortho_scale,
        "shift": [data.shift_x, data.shift_y],
        "sensor_fit": data.sensor_fit,
        "clip": [data.clip_start, data.clip_end],
    }


def _lights(survey: Survey) -> list[dict[str, Any]]:
    pivot = Vector(survey.pivot)
    cast = roster.Cast(survey.scene, survey.objects, pivot)
    return [_light(thing, role, pivot) for thing, role in roster.light_roles(cast).items()]


def _light(thing: bpy.types.Object, role: str, pivot: Vector) -> dict[str, Any]:
    data = thing.data
    row: dict[str, Any] = {
        "name": thing.name_full,
        "type": data.type,
        "residual": _rows(poses.Pose.of(thing, pivot).residual),
        "position": list(thing.matrix_world.translation),
        "shadow": data.use_shadow,
        "normalize": getattr(data, "normalize", True),
        "exposure": getattr(data, "exposure", 0.0),
        "use_temperature": getattr(data, "use_temperature", False),
        "role": role,
    }
    if data.type == "AREA":
        both = data.shape in ("RECTANGLE", "ELLIPSE")
        aspect = data.size_y / max(data.size, 1e-9) if both else 1.0
        row |= {"shape": data.shape, "aspect": aspect, "spread": data.spread}
    if data.type == "SPOT":
        row |= {"spot_size": data.spot_size, "spot_blend": data.spot_blend}
    return row


def _rows(matrix: Any) -> list[list[float]]:
    return [list(row) for row in matrix]


def _write_textures(survey: Survey, materials: Mapping[str, Exported], folder: Path) -> list[dict[str, Any]]:
    roles, rows = _roles(survey), []
    for exported in materials.values():
        row = {**exported.row, "role": roles[exported.row["name"]]}
        if exported.picture:
            (folder / "textures").mkdir(exist_ok=True)
            name = f"textures/{len(rows)}.npy"
            np.save(folder / name, exported.picture.image.astype(np.float32))
            row["texture"] = {"image": name, "extension": exported.picture.extension}
        rows.append(row)
    return rows


def _write_meshes(survey: Survey, folder: Path) -> None:
    g = survey.geometry
    np.savez(
        folder / "meshes.npz",
        vertices=g.vertices,
        faces=g.faces,
        normals=g.normals,
        uvs=g.uvs,
        material=g.material,
        object=g.object,
    )


def _volume(survey: Survey, instances: Mapping[str, schema.Instance]) -> dict[str, Any]:
    scene = survey.scene
    domain = fog.domain(roster.Cast(scene, survey.objects, Vector(survey.pivot)))
    density = instances.get("volume/density")
    if scene.world and shaders.world_volume(scene.world):
        kind = "world"
    else:
        kind = "box" if density and density.value[0] > 0 else "none"
    return {
        "kind": kind,
        "center": list(domain.center),
        "half_size": list(domain.half_size),
        "base": domain.base,
    }


def _film(scene: bpy.types.Scene) -> dict[str, Any]:
    view = scene.view_settings
    space = getattr(getattr(bpy.data, "colorspace", None), "working_space", "Linear Rec.709")
    return {
        "ocio": ocio_config(),
        "display": scene.display_settings.display_device,
        "view": view.view_transform,
        "look": "" if view.look == "None" else view.look,
        "transparent": scene.render.film_transparent,
        "working_space": space,
    }


def ocio_config() -> str:
    """The color management configuration that this Blender uses."""
    shipped = bpy.utils.system_resource("DATAFILES", path="colormanagement")
    candidates = (
        os.environ.get("BLENDER_OCIO"),
        os.environ.get("OCIO"),
        os.path.join(shipped, "config.ocio"),
    )
    return next((path for path in candidates if path and os.path.isfile(path)), "")


def _ignored(scene: bpy.types.Scene) -> list[str]:
    """Settings of the picture that the prediction leaves out."""
    notes = []
    if scene.view_settings.use_curve_mapping:
        notes.append("The view transform's curves are left out of the prediction.")
    if getattr(scene.view_settings, "use_white_balance", False):
        notes.append("The view transform's white balance is left out of the prediction.")
    if scene.camera.data.dof.use_dof:
        notes.append("Depth of field is left out of the prediction.")
    return notes
