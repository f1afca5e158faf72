# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfers a look from one scene to another by the roles of materials and lights (see `schema.preset`)."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ..core import compat
from ..core.schema_import import labels, messages, preset, schema
from ..core.value_slots import socket_slot
from ..export import reading
from ..export.analysis import SceneAnalysis
from ..export.job_folder import SceneJob
from ..run import result
from ..scene import bindings, prepare, scene_context, snapshot
from ..scene.light_types import EXTENTS, LIGHT_TYPES, type_of
from ..scene.nodes import grade, owned
from ..scene.subject import SubjectChoice, remember_subject
from . import lut

_Values = Mapping[str, Sequence[float]]  # parameter key -> components
SceneParameters = SceneJob | reading.SceneReading  # both have parameters by key (`instances`) and an analysis

_TEXTURE_LUMA = 0.5  # luma of a typical texture: a color divided by it tints the texture to about that color
_DIM = 0.01  # radiance of a white surface in a light; darker lights are not added
_PROMINENT = 0.5  # least visible area of a further material, as a share of the subject's largest; see `fit_look`
# Color that a texture may replace -> the parameter that tints the texture.
_TINTS = {"base_color": "tint", "color": "tint", "backdrop_color": "backdrop_tint"}
_UNNOTED = {"distance", "backdrop_horizon"}  # no line if missing: suns have no distance, images their own horizon


def load_preset(path: Path) -> preset.Preset:
    """Reads a preset file; raises VibeError if it is unreadable, too large, or no preset (see `preset.loads`)."""
    try:
        with path.open("rb") as file:
            content = file.read(preset.LARGEST + 1)
        if len(content) > preset.LARGEST:
            raise schema.VibeError(f"{path.name} is too large for a preset.", "Choose a preset file.")
        return preset.loads(content.decode("utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or error
        raise schema.VibeError(f"{path} cannot be read: {reason}.", "Check the path.") from error


def extract_look(
    prompt: str, scene: SceneParameters, values: _Values, name: str = "", goals: dict[str, Any] | None = None
) -> preset.Preset:
    """A preset of the look that a vibe gave a scene, titled `name`, or else with the first words of `prompt`.

    `values`: what the vibe changed, by key. `goals`: what its words wish for, as in docs/reference/goals.md.
    """
    roles: dict[str, list[preset.Entry]] = {}
    kinds: dict[str, list[str]] = {}
    for role, group in preset.ROLES.items():
        entries = {owner: _entry(scene, group, owner, values) for owner in role_owners(scene, role)}
        if any(entries.values()):
            roles[role] = list(entries.values())
            if group == "light":
                kinds[role] = [_kind(owner) for owner in entries]
    return preset.Preset(preset.title(name or prompt), roles, kinds, prompt, goals or {})


def role_owners(scene: SceneParameters, role: str) -> list[str]:
    """Names of the materials or lights with a role, largest or brightest first; [""] for "world", "volume", "film"."""
    group = preset.ROLES[role]
    if group not in ("material", "light"):
        return [""]
    theirs = {i.owner for i in scene.instances.values() if i.parameter.group == group and i.role == role}
    # The material with the largest visible area, or the brightest light, comes first.
    order = visible_areas(scene.analysis) if group == "material" else {o: _brightness(scene, o) for o in theirs}
    return sorted(theirs, key=lambda owner: (-order.get(owner, 0), owner))


def camera_azimuth(scene: SceneParameters) -> float:
    """The camera's azimuth in degrees, to which azimuths of lights in presets are relative; 0.0 if there is none."""
    instance = scene.instances.get("camera/azimuth")
    return instance.value[0] if instance else 0.0


def visible_areas(analysis: SceneAnalysis) -> dict[str, float]:
    """Material name -> number of camera rays that hit the material; without those that none hits."""
    numbers, counts = np.unique(analysis.visible.material, return_counts=True)
    return {analysis.geometry.materials[n]: float(c) for n, c in zip(numbers, counts, strict=True) if n >= 0}


def _brightness(scene: SceneParameters, owner: str) -> float:
    """Radiance of a white surface at the subject, facing the light `owner`; 0.0 if it has no power and no strength."""
    for name in ("power", "strength"):
        if instance := scene.instances.get(f"light/{owner}/{name}"):
            return schema.radiometry.radiance(_kind(owner), instance.value[0] / instance.reference)
    return 0.0


def _kind(light: str) -> str:
    """The type, such as "AREA", of the light with this name: a light of the file, or else one of `ADDED_LIGHTS`."""
    if light in bpy.data.objects:
        return type_of(bpy.data.objects[light]).name
    return schema.added_lights.ADDED_LIGHTS[light].type


def _entry(scene: SceneParameters, group: str, owner: str, values: _Values) -> preset.Entry:
    """Parameter name -> changed value of a material, a light or (`owner` "") a group, divided by its reference."""
    entry = {}
    for name in (p.name for p in schema.PARAMETERS if p.group == group):
        key = schema.FAMILIES[f"{group}/{name}"].key(owner)
        if key in values and key in scene.instances:
            entry[name] = [v / scene.instances[key].reference for v in values[key]]
            if group == "light" and name == "azimuth":  # relative to the camera's, -180 to 180 degrees
                camera = values.get("camera/azimuth", [camera_azimuth(scene)])[0]
                entry[name] = [(entry[name][0] - camera + 180.0) % 360.0 - 180.0]
    return preset.clamped(group, entry)


@dataclass
class Fit:
    """A preset fitted to a scene: the values by key, and a line for the artist on each value that does not fit."""

    values: dict[str, list[float]] = field(default_factory=dict)
    rest: list[str] = field(default_factory=list)


def fit_look(look: preset.Preset, target: SceneParameters) -> Fit:
    """Fits a preset to the scene `target`; for a light that the scene lacks, the result has values of a new light."""
    result = Fit()
    for role, entries in look.roles.items():
        group, theirs = preset.ROLES[role], role_owners(target, role)
        kinds = look.kinds.get(role) or [prepare.LIGHT_TYPE] * len(entries)
        if not theirs and entries:
            _missing(result, target, role, entries[0], kinds)
        if role == "subject":
            # Materials without an entry of their own are skipped if they are small: tires do not get the car's paint.
            areas = visible_areas(target.analysis)
            least = _PROMINENT * areas.get(theirs[0], 0.0) if theirs else 0.0
            small = [owner for owner in theirs[len(entries) :] if areas.get(owner, 0.0) < least]
            theirs = [owner for owner in theirs if owner not in small]
            result.rest += [f"{owner}: shows too little to be what the look is about" for owner in small]
        for place, owner in enumerate(theirs if entries else ()):
            index = min(place, len(entries) - 1)  # further materials or lights get the last entry
            entry = entries[index]
            if group == "light":
                entry = _for_light(entry, kinds[index], type_of(bpy.data.objects[owner]).name)
            for name, value in entry.items():
                _put(result, target, group, owner, name, value)
        left_over = sum(map(bool, entries[len(theirs) :])) if theirs else 0
        if left_over:
            result.rest.append(f"{_words(role)}: {left_over} more than this scene has")
    return result


def _words(role: str) -> str:
    """The title of a role: "Subject material", "Rim light"."""
    group = preset.ROLES[role]
    return f"{role.capitalize()} {group}" if group in ("material", "light") else role.capitalize()


def _missing(result: Fit, target: SceneParameters, role: str, entry: preset.Entry, kinds: list[str]) -> None:
    """Adds to `result`, for a role that the scene lacks, values of a new light, unless dark, or a line in `rest`."""
    ours = prepare.OURS.get(role, "")
    entry = _for_light(entry, kinds[0], prepare.LIGHT_TYPE) if ours else entry
    if "power" not in entry or ours in bpy.data.objects:
        if entry:
            result.rest.append(f"{_words(role)}: this scene has none")
    elif schema.radiometry.radiance(prepare.LIGHT_TYPE, entry["power"][0]) >= _DIM:
        corners = scene_context.bounds(target.analysis.scene, target.analysis.objects)
        lengths = scene_context.light_lengths(prepare.added_light_distance(*corners))
        for name, value in entry.items():
            parameter = schema.FAMILIES[f"light/{name}"]
            reference = lengths.get(parameter.reference, 1.0)
            turn = camera_azimuth(target) if name == "azimuth" else 0.0
            result.values[parameter.key(ours)] = [v * reference + turn for v in value]


def _for_light(entry: preset.Entry, made_on: str, kind: str) -> preset.Entry:
    """A preset entry of a light of type `made_on`, converted to a light of type `kind`, as bright and as soft."""
    result, target = dict(entry), LIGHT_TYPES[kind]
    # Power becomes strength, size becomes angle, or the other way around.
    bright = result.pop("power", None) or result.pop("strength", None)
    if bright:
        energy = schema.radiometry.radiance(made_on, bright[0]) * schema.radiometry.unit_energy(kind)
        result[target.energy] = [energy]
    for extent in EXTENTS:
        if extent != target.extent and extent.parameter in result:
            angle = extent.to_angle(result.pop(extent.parameter)[0])
            result[target.extent.parameter] = [target.extent.from_angle(angle)]
    return result


def _put(result: Fit, target: SceneParameters, group: str, owner: str, name: str, value: list[float]) -> None:
    """Adds a preset's value to `result`, scaled to the scene and clipped to its bounds, or a line on why it cannot."""
    key = schema.FAMILIES[f"{group}/{name}"].key(owner)
    instance = target.instances.get(key)
    if instance is None or instance.locked:
        # If a texture replaces the color, its tint gets the value.
        where = f"{group}/{owner}" if owner else group
        tint = target.instances.get(f"{where}/{_TINTS[name]}") if name in _TINTS else None
        if tint and not tint.locked:
            level = _TEXTURE_LUMA if group == "material" else max(*value, 1e-3)
            result.values[tint.key] = [min(v / level, h) for v, h in zip(value, tint.upper, strict=True)]
            recolor = target.instances.get(f"{where}/recolor")
            if recolor and not recolor.locked:
                result.values[recolor.key] = [1.0]
        elif instance or name not in _UNNOTED:
            reason = instance.locked if instance else "there is nothing of that kind in this scene"
            result.rest.append(f"{labels.title(key)}: {reason}")
        return
    if group == "light" and name == "azimuth":
        value = [value[0] + camera_azimuth(target)]
    bounds = zip(value, instance.lower, instance.upper, strict=True)
    result.values[key] = [min(max(v * instance.reference, low), high) for v, low, high in bounds]


def apply_preset(scene: bpy.types.Scene, look: preset.Preset, choice: SubjectChoice) -> list[str]:
    """Applies a preset to the scene like a vibe's result; returns a line for the artist on each value that did not fit.

    Raises VibeError if no value of the preset fits, or the scene cannot be read or changed; it then stays unchanged.
    """
    settings = scene.vibe
    shown = settings.show_original
    # Take out the look of an earlier preset, unless it was kept: so presets can be tried one after the other.
    if settings.vibed_preset:
        settings.show_original = True
    try:
        with snapshot.rollback_on_failure(scene):
            scene_reading = reading.prepare_and_read(scene, choice)
            subject, pivot = scene_reading.analysis.objects, scene_reading.analysis.pivot
            fitted = fit_look(look, scene_reading)
            if not fitted.values:
                message = "Nothing in this scene takes what the preset holds."
                raise schema.VibeError(message, "See what it is for in its description.")
            # First add the new lights without power: so they are dark at strength 0.
            added = (key for key in fitted.values if key not in scene_reading.instances)
            dark = {key: [0.0] for key in added if key.endswith("/power")}
            bindings.write(scene, dark, subject, pivot)
            # no reasons: the preset's name is above the list of changes
            as_result = messages.Result(fitted.values, {}, "")
            settings.changes.clear()
            result.apply(scene, look.prompt or look.name, as_result, subject, pivot)
    except BaseException:
        settings.show_original = shown
        raise
    settings.vibed_preset = look.name
    remember_subject(scene, subject, choice)
    return fitted.rest


def capture_preset(scene: bpy.types.Scene, choice: SubjectChoice, name: str) -> preset.Preset:
    """A preset called `name` of all values that the last vibe or preset changed; raises VibeError if there are none."""
    settings = scene.vibe
    settings.show_original = False  # the look is saved, not the original
    scene_reading = reading.read_scene(scene, choice)
    changed = (change.name for change in settings.changes)
    values = {key: scene_reading.instances[key].value for key in changed if key in scene_reading.instances}
    goals = json.loads(settings.vibed_goals or "{}")
    look = extract_look(settings.vibed_prompt, scene_reading, values, name, goals)
    if not look.roles:
        raise schema.VibeError("There is no look to save.", "Vibe the scene first, or apply a preset.")
    return look


def grade_values(scene: bpy.types.Scene) -> dict[str, tuple[float, ...]]:
    """Parameter name -> value of the scene's grade, as in `lut.neutral_grade`; empty if the scene has no grade."""
    nodes = owned.group_nodes(compat.compositor(scene), grade.NAME)
    if not nodes:
        return {}
    rows = [row for row in bindings.BINDINGS if row.parameter.name in lut.neutral_grade()]
    sockets = {row: nodes[0].inputs[row.parameter.blender.rpartition(" > ")[2]] for row in rows}
    return {row.parameter.name: row.codec.decode(socket_slot(socket).get()) for row, socket in sockets.items()}
