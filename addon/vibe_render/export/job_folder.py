# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a scene to a job folder for the engine: 'scene.json', 'meshes.npz' and its textures as '.npy'."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from bpy.types import Scene

from ..core import names, rendered
from ..core.schema_import import atomic, labels, schema
from ..scene import bindings, fog, scene_context
from ..scene.nodes import backgrounds, mix, trails
from . import measured, notes, view, world_light
from .analysis import SceneAnalysis
from .materials import NO_MATERIAL, ExportedMaterial, export_material

FORMAT = 1


def _finite_instances(read: Mapping[str, schema.Instance]) -> tuple[dict[str, schema.Instance], list[str]]:
    """Parameters by key, and warnings: a value that is not finite becomes the default, locked, with a warning."""
    finite, warnings = {}, []
    for key, instance in read.items():
        if not all(map(math.isfinite, instance.value)):
            parameter = instance.parameter
            default = (parameter.default * instance.reference,) * parameter.components
            instance = replace(instance, value=default, locked=instance.locked or "it is not a number in Blender")
            warnings.append(f"{labels.title(key)} is not a number in Blender; the prediction takes {default[0]:g}.")
        finite[key] = instance
    return finite, warnings


def _finite_content(value: Any, path: str, warnings: list[str]) -> Any:
    """A copy of nested dicts and lists, 0 for numbers that are not finite; adds a warning with `path` for each."""
    if isinstance(value, Mapping):
        return {key: _finite_content(item, f"{path}/{key}" if path else key, warnings) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite_content(item, path, warnings) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        name = path.replace("/", " › ").replace("_", " ")
        warnings.append(f"{name} is not a number in Blender; the prediction takes 0.")
        return 0.0
    return value


@dataclass
class SceneJob:
    """A job folder that has been written, and the add-on's facts about its scene: parameters and notes."""

    folder: Path
    analysis: SceneAnalysis
    instances: dict[str, schema.Instance]  # the scene's parameters, by key
    standby: dict[str, schema.Instance]  # by key, those of lights and a backdrop that only words may add
    warnings: list[str]  # notes for the artist, with `view_notes`: on what the engine approximates
    view_notes: list[str]  # notes for the artist on faults of the camera's view, which no look can cure
    filling: str  # the object that fills the image; "" if others are visible

    @property
    def before(self) -> dict[str, schema.Instance]:
        """The parameters before a vibe: the scene's, and those of a possible backdrop, which starts out like the world."""
        backdrop = {key: i for key, i in self.standby.items() if i.parameter.group == "world"}
        return {**self.instances, **backdrop}

    def with_additions_of(self, values: Mapping[str, Sequence[float]]) -> SceneJob:
        """The job with those standby lights, backdrop and copies of materials that `values` (by key) belong to."""
        owners = {schema.split_key(key)[1] for key in values if key in self.standby}
        added = {key: i for key, i in self.standby.items() if i.owner in owners}
        return replace(self, instances={**self.instances, **added, **copied_values(self.instances, values)})


def copied_values(instances: Mapping[str, schema.Instance], keys: Iterable[str]) -> dict[str, schema.Instance]:
    """Parameters, by key, of copied materials: those of `keys` not in `instances`, with the original's values."""
    sources = {key: instances.get(schema.material_copies.copied_key(key)) for key in keys if key not in instances}
    return {key: replace(i, owner=schema.split_key(key)[1]) for key, i in sources.items() if i}


def write_job(analysis: SceneAnalysis, folder: Path, measure: bool = True) -> SceneJob:
    """Writes the job folder, `scene.json` last and atomically.

    Without `measure`, textures and world, which may need renders, are left out: such a job can only explain words.
    """
    folder.mkdir(parents=True, exist_ok=True)
    scene, geometry = analysis.scene, analysis.geometry
    view_notes = notes.view_notes(analysis)
    materials = measured.measured_materials(analysis) if measure else _unmeasured(analysis)
    instances, replaced = _instances(analysis, materials)
    light_rows, standby = view.standby_lights(analysis)
    standby |= view.standby_backdrop(analysis, instances)
    by_reason = notes.notes_by_reason(_material_notes(analysis, materials))
    warnings = [names.note(), *view_notes, *by_reason, *geometry.warnings]
    table = view.color_table(scene)
    warnings += rendered.image_notes(scene)
    if any(color != (1.0, 1.0, 1.0) for color in mix.read_mix(scene).values()):
        warnings.append("The compositor's light mix is left out of the prediction. Apply it in Light Mix instead.")
    warnings += [*view.light_notes(scene), *replaced]
    if table is None and (tree := rendered.changing_compositor(scene)):
        warnings.append(
            f'The compositor "{tree.name}" changes the image after the render. The prediction and the search leave it '
            "out; the final picture has it."
        )
    # Parameters of materials outside the camera's view: their light may still be visible.
    every = bindings.instances(scene, analysis.objects, analysis.pivot, groups=("material",), everything=True)
    unseen = _finite_instances({key: i for key, i in every.items() if i.owner in {*geometry.materials}})[0]
    world, note = _write_world(scene, folder) if measure else ({"kind": "color"}, "")
    content = _content(analysis, materials, instances, folder) | {
        "standby": {"lights": light_rows, "parameters": {key: _parameter(i) for key, i in standby.items()}},
        "world": world,
        "volume": _volume(analysis, instances),
        "unseen": {key: _parameter(i) for key, i in unseen.items() if key not in instances},
    }
    if scene.view_settings.use_white_balance and not content["film"]["white_balance"]:
        warnings.append("The view transform's white balance is left out of the prediction.")
    if table is not None:
        content["film"]["compositor"] = "compositor.npy"
        np.save(folder / "compositor.npy", table.astype(np.float32))
    _write(content, analysis, folder, warnings)
    all_warnings = list(dict.fromkeys(w for w in (*warnings, note) if w))
    number = notes.filling(analysis)
    filling = "" if number is None else geometry.objects[number][0]
    return SceneJob(folder, analysis, instances, standby, all_warnings, view_notes, filling)


def write_sketch(analysis: SceneAnalysis, folder: Path) -> None:
    """Writes a job folder with all that words can refer to, almost without renders: no textures, world or fog."""
    folder.mkdir(parents=True, exist_ok=True)
    materials = _unmeasured(analysis)
    # Parameters that explain words: positions of lights, emission of materials.
    instances = _instances(analysis, materials, ("camera", "light", "material"))[0]
    content = _content(analysis, materials, instances, folder) | {
        "world": {"kind": "color"},
        "volume": {"kind": "none", "center": analysis.pivot, "half_size": (1.0, 1.0, 1.0), "base": 0.0},
    }
    _write(content, analysis, folder, [])


def _unmeasured(analysis: SceneAnalysis) -> dict[str, ExportedMaterial]:
    """All materials of a scene by name, without the inputs that nodes compute."""
    by_name = {m.name_full: m for m in bpy.data.materials}
    exported = [export_material(by_name.get(name), {}) for name in analysis.geometry.materials]
    return {each.row["name"]: each for each in exported}


def _content(
    analysis: SceneAnalysis,
    materials: Mapping[str, ExportedMaterial],
    instances: Mapping[str, schema.Instance],
    folder: Path,
) -> dict[str, Any]:
    scene, geometry, render = analysis.scene, analysis.geometry, analysis.scene.render
    flags = zip(geometry.objects, analysis.is_subject, geometry.hidden, strict=True)
    scale = render.resolution_percentage / 100
    return {
        "format": FORMAT,
        "schema": schema.schema_hash(),
        "blender": bpy.app.version_string,
        "source": Path(bpy.data.filepath).name,
        "resolution": [max(1, int(side * scale)) for side in (render.resolution_x, render.resolution_y)],
        "pixel_aspect": render.pixel_aspect_x / render.pixel_aspect_y,
        "pivot": analysis.pivot,
        "references": scene_context.scene_lengths(analysis.context()),
        "camera": view.camera_row(analysis),
        "lights": view.light_rows(analysis),
        "materials": _write_textures(analysis, materials, folder),
        "objects": [
            {"name": name, "subject": bool(chosen), "hidden": sorted(hidden)} for (name, _), chosen, hidden in flags
        ],
        "film": view.film_row(scene),
        "bounces": min(scene.cycles.max_bounces, scene.cycles.diffuse_bounces),
        "parameters": {key: _parameter(instance) for key, instance in instances.items()},
    }


def _write(content: dict[str, Any], analysis: SceneAnalysis, folder: Path, warnings: list[str]) -> None:
    names = ("vertices", "faces", "normals", "uvs", "material", "object")
    np.savez(folder / "meshes.npz", **{name: getattr(analysis.geometry, name) for name in names})
    sound = _finite_content(content, "", warnings)
    atomic.write_text(folder / "scene.json", json.dumps(sound, indent=1, allow_nan=False))


def _write_world(scene: Scene, folder: Path) -> tuple[dict[str, Any], str]:
    """Writes the world's images; returns its entry in scene.json, and a note on what is approximated ("" for none)."""
    world = rendered.world(scene)
    light, backdrop, note = world_light.pictures(world)
    row: dict[str, Any] = {
        "kind": "color" if light is None else "environment",
        "hidden": rendered.unlit_by(world),
        "horizon": backgrounds.horizon_height(scene, world),
    }
    for name, image in (("image", light), ("backdrop", backdrop)):
        if image is not None:
            row[name] = f"world_{name}.npy"
            np.save(folder / row[name], image.astype(np.float32))
    return row, note


def _material_notes(analysis: SceneAnalysis, materials: Mapping[str, ExportedMaterial]) -> dict[str, list[str]]:
    """Notes on each visible material by name, the one that fills most of the image first."""
    seen = analysis.visible.material
    counts = np.bincount(seen[seen >= 0].ravel(), minlength=len(analysis.geometry.materials))
    order = np.argsort(-counts, kind="stable")
    names = [analysis.geometry.materials[n] for n in order if counts[n]]
    return {materials[name].row["name"]: materials[name].notes for name in names}


def read_parameters(analysis: SceneAnalysis) -> dict[str, schema.Instance]:
    """The parameters of the scene and of a possible backdrop, by key; unlike `write_job`, renders and writes nothing."""
    instances = _instances(analysis, {})[0]
    return {**instances, **view.standby_backdrop(analysis, instances)}


def _roles(analysis: SceneAnalysis) -> dict[str, str]:
    """The role of each material, by name: "subject" if a face of the subject has it, otherwise "surroundings"."""
    geometry = analysis.geometry
    theirs = set(geometry.material[analysis.is_subject[geometry.object]].tolist())
    return {
        name or NO_MATERIAL: "subject" if number in theirs else "surroundings"
        for number, name in enumerate(geometry.materials)
    }


def _instances(
    analysis: SceneAnalysis, materials: Mapping[str, ExportedMaterial], groups: Sequence[str] = schema.GROUPS
) -> tuple[dict[str, schema.Instance], list[str]]:
    """The scene's parameters by key, and warnings, see `_finite_instances`.

    Values of materials that only the export knows, such as means of textures, are locked.
    """
    roles = _roles(analysis)
    bound = bindings.instances(analysis.scene, analysis.objects, analysis.pivot, groups)
    instances = {
        key: replace(i, role=roles.get(i.owner, i.role)) if i.parameter.group == "material" else i
        for key, i in bound.items()
    }
    for exported in materials.values():
        owner = exported.row["name"]
        for name, value in exported.values.items():
            parameter = schema.FAMILIES[f"material/{name}"]
            before = instances.get(parameter.key(owner))
            if before is None or before.locked:
                reason = before.locked if before else exported.reason
                instance = schema.Instance(parameter, owner, value, role=roles[owner], locked=reason)
                instances[instance.key] = instance
    return _finite_instances(instances)


def _parameter(instance: schema.Instance) -> dict[str, Any]:
    value = list(instance.value) if instance.parameter.components == 3 else instance.value[0]
    return {"value": value, "reference": instance.reference, "role": instance.role, "locked": instance.locked}


def _write_textures(
    analysis: SceneAnalysis, materials: Mapping[str, ExportedMaterial], folder: Path
) -> list[dict[str, Any]]:
    roles = _roles(analysis)
    rows: list[dict[str, Any]] = []
    for exported in materials.values():
        row = {**exported.row, "role": roles[exported.row["name"]]}
        pictures = {}
        for channel, picture in exported.pictures.items():
            (folder / "textures").mkdir(exist_ok=True)
            name = f"textures/{len(rows)}_{channel}.npy"
            np.save(folder / name, picture.image.astype(np.float32))
            place = {"extension": picture.extension, "window": picture.window, "plane": picture.plane}
            pictures[channel] = {"image": name, **place}
        row["texture"], row["maps"] = pictures.pop("base_color", None), pictures
        rows.append(row)
    return rows


def _volume(analysis: SceneAnalysis, instances: Mapping[str, schema.Instance]) -> dict[str, Any]:
    domain = fog.fog_domain(analysis.context())
    density = instances.get("volume/density")
    kind = "box" if density and density.value[0] > 0 else "none"
    if trails.world_volume(rendered.world(analysis.scene)):
        kind = "world"
    return {"kind": kind, "center": list(domain.center), "half_size": list(domain.half_size), "base": domain.base}
