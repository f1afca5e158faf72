# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's types of lights: the only list of them, and all differences between them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from bpy.types import Light, Object
from mathutils import Matrix, Vector

from ..core.journal import Journal
from ..core.value_slots import PropertySlot, ValueSlot

_TWO_SIDES = ("RECTANGLE", "ELLIPSE")


@dataclass(frozen=True)
class LightExtent:
    """A measure of how large a light is: the larger, the softer its shadows."""

    parameter: str  # the schema's name of this measure
    # from the value (of `SIZE`: multiples of the light's distance) to the angle that the light fills, degrees; and back
    to_angle: Callable[[float], float]
    from_angle: Callable[[float], float]


SIZE = LightExtent(
    "size",
    lambda size: math.degrees(2 * math.atan(size / 2)),
    lambda angle: 2 * math.tan(math.radians(min(angle, 170.0)) / 2),
)
"""The size of a light that has a position."""
ANGLE = LightExtent("angle", float, float)  # the angular diameter of a light at infinity
EXTENTS = (SIZE, ANGLE)


@dataclass(frozen=True)
class LightType:
    """The properties in which Blender's types of lights differ."""

    name: str  # Blender's name: the `type` of the light's data-block
    extent_property: str  # the property of the light's data-block that stores the extent
    energy: str = "power"  # the schema's name of its energy: "power" (W) or "strength" (W/m²)
    extent: LightExtent = SIZE  # how the schema measures its size; for an area light, one value scales both sides
    has_position: bool = True  # False for lights at infinity, which have only a direction

    def offset(self, obj: Object, pivot: Vector, rotation: Matrix) -> Vector:
        """World-space vector from the pivot to a light; for a sun, against its rays, from its `rotation` (3x3)."""
        return obj.matrix_world.translation - pivot if self.has_position else rotation.col[2]

    def extent_slot(self, light: Light, locked: str) -> ValueSlot:
        """The value slot of a light's extent; `locked` is its lock reason, "" if it may change."""
        if self.name == "AREA":
            return _AreaSizeSlot(light, locked)
        return PropertySlot(light, self.extent_property, locked)


LIGHT_TYPES = {
    "POINT": LightType("POINT", "shadow_soft_size"),
    "SPOT": LightType("SPOT", "shadow_soft_size"),
    "AREA": LightType("AREA", "size"),
    "SUN": LightType("SUN", "angle", "strength", ANGLE, has_position=False),
}
"""Every type, by Blender's name."""


@dataclass
class _AreaSizeSlot:
    """Value slot: the width of an area light in meters; writing it scales the height by the same factor."""

    light: Light
    locked: str

    def get(self) -> float:
        return self.light.size

    def set(self, journal: Journal, raw: float) -> None:
        ratio = raw / max(self.light.size, 1e-9)
        if self.light.shape in _TWO_SIDES and ratio != 1.0:
            PropertySlot(self.light, "size_y").set(journal, self.light.size_y * ratio)
        PropertySlot(self.light, "size").set(journal, raw)


def exported(obj: Object) -> dict[str, Any]:
    """A light's entries in scene.json that only its type has; angles in radians, `scale` along the light's width."""
    data = obj.data
    if data.type == "SPOT":
        return {"spot_size": data.spot_size, "spot_blend": data.spot_blend}
    if data.type != "AREA":
        return {}
    aspect = data.size_y / max(data.size, 1e-9) if data.shape in _TWO_SIDES else 1.0
    width, height, _ = (max(abs(side), 1e-6) for side in obj.matrix_world.to_scale())
    aspect *= height / width
    return {"shape": data.shape, "aspect": aspect, "spread": data.spread, "scale": width}


def has_uneven_cone(obj: Object) -> bool:
    """True for a spot whose scale makes its cone elliptical: x and y differ by more than 1 %."""
    scale = obj.matrix_world.to_scale()
    return obj.data.type == "SPOT" and abs(scale.x - scale.y) > 0.01 * abs(scale.x)


def type_of(obj: Object) -> LightType:
    """The type of a light object."""
    return LIGHT_TYPES[obj.data.type]
