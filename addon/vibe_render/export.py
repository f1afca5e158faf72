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

from . import (
    bindings,
    export_material,
    export_texture,
    export_view,
    export_world,
    fog,
    planes,
    roster,
    sane,
    shaders,
    view_maps,
)
from .contract import schema
from .export_material import NO_MATERIAL, Exported, Measured
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
    materials = _materials(survey)
    instances, mended = sane.instances(_with_materials(found, survey, materials))
    warnings = [*geometry.warnings, *(m.row["warning"] for m in materials.values() if m.row["warning"])]
    warnings += [*export_view.ignored(scene), *mended]
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
        "camera": export_view.camera(survey),
        "lights": export_view.lights(survey),
        "materials": _write_textures(survey, materials, folder),
        "objects": [
            {"name": name, "subject": bool(chosen)}
            for (name, _), chosen in zip(geometry.objects, survey.chosen, strict=True)
        ],
        "world": {"kind": "color"} if image is None else {"kind": "environment", "image": "world.npy"},
        "volume": _volume(survey, instances),
        "film": export_view.film(scene),
        "parameters": {key: _parameter(instance) for key, instance in instances.items()},
    }
    _write_meshes(survey, folder)
    temporary = folder / "scene.json.part"
    content = sane.content(content, "", warnings)
    temporary.write_text(json.dumps(content, indent=1, allow_nan=False), encoding="utf-8")
    os.replace(temporary, folder / "scene.json")
    return Job(folder, survey, instances, list(dict.fromkeys(w for w in (*warnings, note) if w)))


def known(survey: Survey) -> dict[str, schema.Instance]:
    """The scene's parameters by key, without what the engine alone needs: nothing is rendered or written."""
    found = bindings.instances(survey.scene, survey.objects, survey.pivot)
    return sane.instances(_with_materials(found, survey, {}))[0]


def _scaled(scene: bpy.types.Scene, pixels: int) -> int:
    return max(1, int(pixels * scene.render.resolution_percentage / 100))


def _materials(survey: Survey) -> dict[str, Exported]:
    """All materials by name, with what their nodes compute."""
    geometry = survey.geometry
    known = {m.name_full: m for m in bpy.data.materials}
    materials = {name: known.get(name) for name in geometry.materials}
    found: dict[str, dict[str, Measured]] = {name: {} for name in materials}
    wanted = []
    for name, material in materials.items():
        if material is None:
            continue
        uvs = geometry.uvs[geometry.material == geometry.materials.index(name)]
        for channel, source in export_material.computed(material).items():
            picture = _over_uvs(material, channel, source, uvs)
            if picture:
                found[name][channel] = Measured(picture.image.mean((0, 1)), picture)
            else:
                wanted.append(view_maps.Wanted(material, channel, source))
    seen = view_maps.measure(survey.scene, wanted)
    for w in wanted:
        name = w.material.name_full
        view = seen.get((name, w.channel))
        if view:
            picture = export_texture.Picture(view.image, "EXTEND", "", view.window)
            found[name][w.channel] = Measured(view.mean, picture)
            far = _straight_on(survey, w) if w.channel == "base_color" else None
            if far:
                found[name]["far"] = Measured(view.mean, far)
        elif w.source is not None and w.channel != "normal":
            found[name][w.channel] = Measured(_mean(survey, w))
    return {name: export_material.export(material, found[name]) for name, material in materials.items()}


def _over_uvs(
    material: bpy.types.Material, channel: str, source: bpy.types.NodeSocket | None, uvs: np.ndarray
) -> export_texture.Picture | None:
    """A texture where one is enough, and as sharp as the original: of base colors and cut-outs."""
    if source is None or channel not in ("base_color", "alpha"):
        return None
    chosen, matrix = export_material.uv_of(material)
    name, own = export_texture.uv_mapping(source)
    if name != chosen or not np.allclose(matrix, own):
        return None
    outputs = ("Color", "Alpha") if channel == "alpha" else ("Color",)
    tiles = export_texture.plain_image(source, outputs) is not None
    inside = uvs.size and -1e-3 <= uvs.min() <= uvs.max() <= 1 + 1e-3
    return export_texture.over_uvs(material, channel, source) if tiles or inside else None


def _straight_on(survey: Survey, wanted: view_maps.Wanted) -> export_texture.Picture | None:
    """The pattern of a flat surface as mirrors may show it, also where the camera does not look."""
    geometry, eye = survey.geometry, survey.scene.camera.matrix_world.translation
    chosen = geometry.material == geometry.materials.index(wanted.material.name_full)
    pivot = np.array(survey.pivot)
    corners = geometry.vertices[geometry.faces[chosen]].astype(float)
    plane = planes.plane_of(corners, pivot, float(np.linalg.norm(pivot - np.array(eye))))
    if plane is None:
        return None
    view = view_maps.measure(survey.scene, [wanted], plane).get((wanted.material.name_full, wanted.channel))
    if view is None:
        return None
    left, bottom, right, top = view.window
    scale, shift = np.array([1 / (right - left), 1 / (top - bottom)]), np.array([left, bottom])
    mapping = np.array(plane.mapping)
    mapping[:, 3] -= shift
    return export_texture.Picture(view.image, "CLIP", "", None, (mapping * scale[:, None]).tolist())


def _mean(survey: Survey, wanted: view_maps.Wanted) -> np.ndarray:
    number = survey.geometry.materials.index(wanted.material.name_full)
    mask = survey.seen.material == number
    assert wanted.source is not None
    return export_texture.measured(survey.scene, wanted.material, wanted.source, mask)


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


def _write_textures(survey: Survey, materials: Mapping[str, Exported], folder: Path) -> list[dict[str, Any]]:
    roles = _roles(survey)
    rows: list[dict[str, Any]] = []
    for exported in materials.values():
        row = {**exported.row, "role": roles[exported.row["name"]]}
        pictures = {}
        for channel, picture in exported.pictures.items():
            (folder / "textures").mkdir(exist_ok=True)
            name = f"textures/{len(rows)}_{channel}.npy"
            np.save(folder / name, picture.image.astype(np.float32))
            pictures[channel] = {
                "image": name,
                "extension": picture.extension,
                "window": picture.window,
                "plane": picture.plane,
            }
        row["texture"], row["maps"] = pictures.pop("base_color", None), pictures
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
