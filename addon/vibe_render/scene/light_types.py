# SPDX-License-Identifier: GPL-3.0-or-later
"""Types of lights: the only list of them, and all that differs between them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from bpy.types import Light, Object
from mathutils import Matrix, Vector

from ..core.journal import Journal
from ..core.schema_import import schema
from ..core.value_slots import PropertySlot, ValueSlot

_TWO_SIDES = ("RECTANGLE", "ELLIPSE")
_ROUND = 0.01  # relative difference of the sides' scales up to which a cone counts as round


@dataclass(frozen=True)
class LightExtent:
    """A measure of how large a light is: the larger, the softer its shadows."""

    parameter: str  # the schema's name of it
    # from a value per distance to the angle that the light fills, degrees; `from_angle` is the inverse
    to_angle: Callable[[float], float]
    from_angle: Callable[[float], float]


SIZE = LightExtent(
    "size",
    lambda size: math.degrees(2 * math.atan(size / 2)),
    lambda angle: 2 * math.tan(math.radians(min(angle, 170.0)) / 2),
)
"""Of lights at a distance."""
ANGLE = LightExtent("angle", float, float)
"""Of lights at infinity."""
EXTENTS = (SIZE, ANGLE)


class LightType:
    """Blender's "POINT", and the base of the other types.

    Attributes:
        name: Blender's name: the `type` of the light's data-block.
        energy: The schema's name of its energy: "power" (W) or "strength" (W/m²).
        extent: The schema's measure of its size.
        extent_property: The property of the data-block that holds the extent.
        has_position: False for lights at infinity, of which only the direction matters.
    """

    name = "POINT"
    energy = "power"
    extent = SIZE
    extent_property = "shadow_soft_size"
    has_position = True

    def offset(self, obj: Object, pivot: Vector, rotation: Matrix) -> Vector:
        """A world-space vector from the pivot toward the origin of the light; `rotation` is the light's, 3x3."""
        return obj.matrix_world.translation - pivot

    def extent_slot(self, light: Light, locked: str) -> ValueSlot:
        """The slot of the extent, with the reason why it is locked ("" if it is not)."""
        return PropertySlot(light, self.extent_property, locked)

    def exported(self, obj: Object) -> dict[str, Any]:
        """Entries in scene.json that lights of other types do not have."""
        return {}

    def approximations(self, obj: Object) -> list[str]:
        """Notes for the artist on differences between the prediction and Cycles."""
        return []


class SpotLightType(LightType):
    """Blender's "SPOT": a point light that shines into a cone."""

    name = "SPOT"

    def exported(self, obj: Object) -> dict[str, Any]:
        """The opening of the cone in radians, and the part of it over which its edge fades."""
        return {"spot_size": obj.data.spot_size, "spot_blend": obj.data.spot_blend}

    def approximations(self, obj: Object) -> list[str]:
        """Cones that are not round."""
        scale = obj.matrix_world.to_scale()
        if abs(scale.x - scale.y) > _ROUND * abs(scale.x):
            return [f"{obj.name} is scaled unevenly; the prediction shows a round cone."]
        return []


@dataclass
class _AreaSizeSlot:
    """Value slot: the first side of an area light in meters; the second one keeps its proportion to it."""

    light: Light
    locked: str

    def get(self) -> float:
        return self.light.size

    def set(self, journal: Journal, raw: float) -> None:
        ratio = raw / max(self.light.size, 1e-9)
        if self.light.shape in _TWO_SIDES and ratio != 1.0:
            PropertySlot(self.light, "size_y").set(journal, self.light.size_y * ratio)
        PropertySlot(self.light, "size").set(journal, raw)


class AreaLightType(LightType):
    """Blender's "AREA": squares, rectangles, discs and ellipses that shine to one side."""

    name = "AREA"
    extent_property = "size"

    def extent_slot(self, light: Light, locked: str) -> ValueSlot:
        """Both sides at once."""
        return _AreaSizeSlot(light, locked)

    def exported(self, obj: Object) -> dict[str, Any]:
        """Its shape, the proportion of its sides, its spread in radians, and the object's scale along its width."""
        data = obj.data
        aspect = data.size_y / max(data.size, 1e-9) if data.shape in _TWO_SIDES else 1.0
        width, height, _ = (max(abs(side), 1e-6) for side in obj.matrix_world.to_scale())
        aspect *= height / width
        return {"shape": data.shape, "aspect": aspect, "spread": data.spread, "scale": width}


class SunLightType(LightType):
    """Blender's "SUN": light from infinitely far away. Its extent is an angular diameter, radians."""

    name = "SUN"
    energy = "strength"
    extent = ANGLE
    extent_property = "angle"
    has_position = False

    def offset(self, obj: Object, pivot: Vector, rotation: Matrix) -> Vector:
        """The direction against which it shines, wherever the object stands."""
        return rotation.col[2]


_TYPES = (LightType(), SpotLightType(), AreaLightType(), SunLightType())
LIGHT_TYPES: dict[str, LightType] = {each.name: each for each in _TYPES}
"""By Blender's names."""


def light_type(name: str) -> LightType:
    """The type of that name; a VibeError without one."""
    if name not in LIGHT_TYPES:
        raise schema.VibeError(
            f'Lights of type "{name}" are unknown to Vibe Render.', f"Use one of {', '.join(LIGHT_TYPES)}."
        )
    return LIGHT_TYPES[name]


def type_of(obj: Object) -> LightType:
    """The type of a light object; raises as `light_type` does."""
    return light_type(obj.data.type)
