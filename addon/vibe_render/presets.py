# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes a look from one scene and puts it on another, by role: see `schema.preset`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import bpy
import numpy as np

from .contract import preset, schema
from .export import Job
from .survey import Survey

# What a white surface that faces the light sends back, per watt at a distance of 1 m (sun: per W/m2).
_RADIANCE = {
    "POINT": 0.25 / math.pi**2,
    "SPOT": 0.25 / math.pi**2,
    "AREA": 1 / math.pi**2,
    "SUN": 1 / math.pi,
}
_TEXTURE_LUMA = 0.5  # of a typical texture: what a color is divided by to become a tint


def load(path: Path) -> preset.Preset:
    """Reads a preset file.

    Raises:
        VibeError: If it cannot be read, or see `preset.loads`.
    """
    try:
        return preset.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise schema.VibeError(f"{path} cannot be read: {error}.", "Check the path.") from error


def extract(name: str, job: Job, values: Mapping[str, Sequence[float]]) -> preset.Preset:
    """The look that a vibe gave a scene.

    Args:
        name: What the artist typed.
        job: The scene as it was exported.
        values: What the vibe has changed, by key.
    """
    roles: dict[str, list[preset.Entry]] = {}
    kinds: dict[str, list[str]] = {}
    for role, group in preset.ROLES.items():
        entries = {owner: _entry(job, group, owner, values) for owner in _owners(job, role)}
        if any(entries.values()):
            roles[role] = list(entries.values())
            if group == "light":
                kinds[role] = [bpy.data.objects[owner].data.type for owner in entries]
    return preset.Preset(name, roles, kinds)


def match(look: preset.Preset, job: Job) -> dict[str, list[float]]:
    """Values for another scene, by key; what that scene does not have is left out.

    Where the scene has more materials or lights of a role than the preset, the rest get the last entry.
    """
    values: dict[str, list[float]] = {}
    for role, entries in look.roles.items():
        group = preset.ROLES[role]
        for place, owner in enumerate(_owners(job, role) if entries else ()):
            index = min(place, len(entries) - 1)
            entry = dict(entries[index])
            if group == "light":
                kind = look.kinds.get(role, [])[index : index + 1]
                entry = _for_light(entry, kind[0] if kind else "AREA", bpy.data.objects[owner].data.type)
            for name, value in entry.items():
                values |= _fitted(job, group, owner, name, value)
    return values


def _owners(job: Job, role: str) -> list[str]:
    """Names in keys of all that has a role, the most visible or the brightest first."""
    group = preset.ROLES[role]
    if group not in ("material", "light"):
        return [""]
    theirs = {i.owner for i in job.instances.values() if i.parameter.group == group and i.role == role}
    if group == "material":
        shares = _shares(job.survey)
        return sorted(theirs, key=lambda owner: (-shares.get(owner, 0), owner))
    return sorted(theirs)


def _shares(survey: Survey) -> dict[str, int]:
    """Rays that meet each material."""
    numbers, counts = np.unique(survey.seen.material, return_counts=True)
    return {survey.geometry.materials[n]: int(c) for n, c in zip(numbers, counts, strict=True) if n >= 0}


def _entry(job: Job, group: str, owner: str, values: Mapping[str, Sequence[float]]) -> preset.Entry:
    """What has been changed of one material, light, …, free of names and lengths."""
    entry = {}
    for name in (p.name for p in schema.PARAMETERS if p.group == group):
        key = schema.FAMILIES[f"{group}/{name}"].key(owner)
        if key in values and key in job.instances:
            entry[name] = [v / job.instances[key].reference for v in values[key]]
            if group == "light" and name == "azimuth":
                camera = values.get("camera/azimuth", [_camera_azimuth(job)])[0]
                entry[name] = [_wrapped(entry[name][0] - camera)]
    return preset.clamped(group, entry)


def _camera_azimuth(job: Job) -> float:
    instance = job.instances.get("camera/azimuth")
    return instance.value[0] if instance else 0.0


def _wrapped(degrees: float) -> float:
    return (degrees + 180.0) % 360.0 - 180.0


def _for_light(entry: preset.Entry, made_on: str, kind: str) -> preset.Entry:
    """An entry of one type of light for another: as bright, and as soft."""
    result = dict(entry)
    bright = result.pop("power", None) or result.pop("strength", None)
    if bright:
        result["strength" if kind == "SUN" else "power"] = [bright[0] * _RADIANCE[made_on] / _RADIANCE[kind]]
    if kind == "SUN" and "size" in result:
        result["angle"] = [math.degrees(2 * math.atan(result.pop("size")[0] / 2))]
    elif kind != "SUN" and "angle" in result:
        result["size"] = [2 * math.tan(math.radians(min(result.pop("angle")[0], 170.0)) / 2)]
    return result


def _fitted(job: Job, group: str, owner: str, name: str, value: list[float]) -> dict[str, list[float]]:
    """One value as the scene can take it, within its bounds."""
    instance = job.instances.get(schema.FAMILIES[f"{group}/{name}"].key(owner))
    if instance is None:
        return _as_tint(job, group, owner, value) if name in ("base_color", "color") else {}
    if instance.locked:
        return {}
    if group == "light" and name == "azimuth":
        value = [value[0] + _camera_azimuth(job)]
    bounds = zip(value, instance.lower, instance.upper, strict=True)
    return {instance.key: [min(max(v * instance.reference, low), high) for v, low, high in bounds]}


def _as_tint(job: Job, group: str, owner: str, color: list[float]) -> dict[str, list[float]]:
    """A color for something whose own color is a texture."""
    tint = job.instances.get(f"{group}/{owner}/tint" if owner else f"{group}/tint")
    recolor = job.instances.get(f"{group}/{owner}/recolor")
    if tint is None or tint.locked:
        return {}
    level = _TEXTURE_LUMA if group == "material" else max(*color, 1e-3)
    found = {tint.key: [min(v / level, high) for v, high in zip(color, tint.upper, strict=True)]}
    return {**found, recolor.key: [1.0]} if recolor and not recolor.locked else found
