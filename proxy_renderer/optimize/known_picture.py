# SPDX-License-Identifier: Apache-2.0
"""The Cycles image that a vibe ended with: a further sentence starts with it and needs no new render."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

import numpy as np

from ..render.cycles import CyclesPicture, is_of_light
from ..rigs.lighting import OFF
from ..rigs.places import BRIGHTNESS
from ..scene import Light, SceneData
from ..schema import Values, split_key

_ROUNDING, _ZERO = (1e-4, 1e-5)  # relative and absolute rounding error of a number on the way into Blender and back
_BAKED = 0.02  # mean difference, relative to the mean, by which two bakes of an image may differ
_COMPARED = ("resolution", "pixel_aspect", "camera", "materials", "objects", "volume", "bounces", "unseen", "world")


@dataclass(frozen=True)
class KnownPicture:
    """A Cycles image, with the scene and the values that it shows."""

    scene: SceneData  # with the lights that the vibe has added; its mesh stays in memory
    values: Mapping[str, Values]  # of all parameters of the scene
    picture: CyclesPicture

    def values_in(self, scene: SceneData) -> dict[str, Values] | None:
        """Key -> power or color of light in the image where it differs from the scene's; None if more does."""
        mine, theirs = ({light.name: light for light in each.lights} for each in (self.scene, scene))
        powers = (i for i in scene.instances.values() if i.parameter.family in BRIGHTNESS)
        unlit = theirs.keys() - mine.keys() - {i.owner for i in powers if i.value[0] > OFF * i.reference}
        if scene.mesh is not self.scene.mesh or mine.keys() != theirs.keys() - unlit:
            return None
        pairs = [(getattr(self.scene, name), getattr(scene, name)) for name in _COMPARED]
        pairs += [(_without_values(mine[name]), _without_values(theirs[name])) for name in mine]
        if self.scene.film.gain != scene.film.gain or not all(alike(one, other) for one, other in pairs):
            return None
        differing: dict[str, Values] = {}
        for key, instance in scene.instances.items():
            group, owner, _ = split_key(key)
            if group == "film" or (group == "light" and owner in unlit):
                continue
            if key not in self.values:
                return None
            if not alike(self.values[key], instance.value):
                differing[key] = self.values[key]
        return differing if all(is_of_light(key, scene) for key in differing) else None


def _without_values(light: Light) -> Light:
    """The light, with the fields that follow from its parameters reset, as its position; itself if it is fixed."""
    if light.fixed:
        return light
    return replace(light, position=(0.0, 0.0, 0.0), added=False, role="", use_temperature=False)


def alike(one: Any, other: Any) -> bool:
    """True if two dataclasses, mappings, sequences, arrays or numbers are equal up to rounding."""
    if is_dataclass(one):
        names = [field.name for field in fields(one)]
        return type(one) is type(other) and all(alike(getattr(one, n), getattr(other, n)) for n in names)
    if isinstance(one, Mapping):
        return one.keys() == other.keys() and all(alike(one[key], other[key]) for key in one)
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return one.shape == other.shape and bool(np.abs(one - other).mean() <= _BAKED * (one.mean() + 1e-6))
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=_ROUNDING, abs_tol=_ZERO)
    if isinstance(one, Sequence) and isinstance(other, Sequence) and not isinstance(one, str):
        return len(one) == len(other) and all(map(alike, one, other))
    return bool(one == other)
