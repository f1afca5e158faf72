# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes a look from a scene, by role: see `schema.preset`. `fit` puts it on another scene."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Protocol

import bpy
import numpy as np

from ..core.schema_import import preset, schema
from ..export.analysis import SceneAnalysis
from ..scene.light_types import type_of


class SceneParameters(Protocol):
    """What presets need of a scene: an exported job has it, and so has a scene that was only read."""

    @property
    def analysis(self) -> SceneAnalysis:
        """What is known about the scene."""

    @property
    def instances(self) -> dict[str, schema.Instance]:
        """Its parameters, by key."""


def load_preset(path: Path) -> preset.Preset:
    """Reads a preset file.

    Raises:
        VibeError: It cannot be read, is too large, or is no preset (see `preset.loads`).
    """
    try:
        with path.open("rb") as file:
            content = file.read(preset.LARGEST + 1)
        if len(content) > preset.LARGEST:
            raise schema.VibeError(f"{path.name} is too large for a preset.", "Choose a preset file.")
        look = preset.loads(content.decode("utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise schema.VibeError(
            f"{path} cannot be read: {getattr(error, 'strerror', None) or error}.", "Check the path."
        ) from error
    return look


def extract_look(
    prompt: str,
    scene: SceneParameters,
    values: Mapping[str, Sequence[float]],
    name: str = "",
    goals: str = "",
) -> preset.Preset:
    """The look that a vibe gave a scene.

    Args:
        values: The values that the vibe has changed, by key.
        name: The preset's name; without one, the prompt's first words.
        goals: What the vibe was searched for by, as JSON; "" for none.
    """
    roles: dict[str, list[preset.Entry]] = {}
    kinds: dict[str, list[str]] = {}
    for role, group in preset.ROLES.items():
        entries = {owner: _entry(scene, group, owner, values) for owner in role_owners(scene, role)}
        if any(entries.values()):
            roles[role] = list(entries.values())
            if group == "light":
                kinds[role] = [_kind(owner) for owner in entries]
    return preset.Preset(preset.title(name or prompt), roles, kinds, prompt, json.loads(goals or "{}"))


def role_owners(scene: SceneParameters, role: str) -> list[str]:
    """The owners (names in keys) of a role: materials by visible area, lights by brightness, the largest first.

    Args:
        role: One of `preset.ROLES`.
    """
    group = preset.ROLES[role]
    if group not in ("material", "light"):
        return [""]
    theirs = {i.owner for i in scene.instances.values() if i.parameter.group == group and i.role == role}
    order = (
        visible_areas(scene.analysis) if group == "material" else {o: _brightness(scene, o) for o in theirs}
    )
    return sorted(theirs, key=lambda owner: (-order.get(owner, 0), owner))


def camera_azimuth(scene: SceneParameters) -> float:
    """The camera's azimuth in degrees, from which presets count the azimuth of lights."""
    instance = scene.instances.get("camera/azimuth")
    return instance.value[0] if instance else 0.0


def visible_areas(analysis: SceneAnalysis) -> dict[str, float]:
    """The number of camera rays that hit each material, by name."""
    numbers, counts = np.unique(analysis.visible.material, return_counts=True)
    return {analysis.geometry.materials[n]: float(c) for n, c in zip(numbers, counts, strict=True) if n >= 0}


def _brightness(scene: SceneParameters, owner: str) -> float:
    """What a white surface at the subject that faces the light sends back."""
    for name in ("power", "strength"):
        if instance := scene.instances.get(f"light/{owner}/{name}"):
            return schema.radiometry.radiance(_kind(owner), instance.value[0] / instance.reference)
    return 0.0


def _kind(light: str) -> str:
    """The type of a light, also of one that another variant would add."""
    if light in bpy.data.objects:
        return type_of(bpy.data.objects[light]).name
    return schema.added_lights.ADDED_LIGHTS[light].type


def _entry(
    scene: SceneParameters, group: str, owner: str, values: Mapping[str, Sequence[float]]
) -> preset.Entry:
    """The changed values of one owner, as multiples of the scene's lengths and without names."""
    entry = {}
    for name in (p.name for p in schema.PARAMETERS if p.group == group):
        key = schema.FAMILIES[f"{group}/{name}"].key(owner)
        if key in values and key in scene.instances:
            entry[name] = [v / scene.instances[key].reference for v in values[key]]
            if group == "light" and name == "azimuth":
                camera = values.get("camera/azimuth", [camera_azimuth(scene)])[0]
                entry[name] = [_wrapped(entry[name][0] - camera)]
    return preset.clamped(group, entry)


def _wrapped(degrees: float) -> float:
    return (degrees + 180.0) % 360.0 - 180.0
