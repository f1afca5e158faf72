# SPDX-License-Identifier: GPL-3.0-or-later
"""Point lights: spheres that shine to all sides."""

from __future__ import annotations

from typing import Any

from bpy.types import Light, Object
from mathutils import Matrix, Vector

from ...core.value_slots import PropertySlot, ValueSlot
from .light_type import SIZE, LightExtent


class PointLightType:
    """Blender's "POINT"; spots and area lights are points with differences."""

    name = "POINT"
    energy = "power"
    extent: LightExtent = SIZE
    extent_property = "shadow_soft_size"
    has_position = True

    def offset(self, obj: Object, pivot: Vector, rotation: Matrix) -> Vector:
        """From the pivot to the light."""
        return obj.matrix_world.translation - pivot

    def extent_slot(self, light: Light, locked: str) -> ValueSlot:
        """The property that holds it."""
        return PropertySlot(light, self.extent_property, locked)

    def exported(self, obj: Object) -> dict[str, Any]:
        """Nothing more."""
        return {}

    def approximations(self, obj: Object) -> list[str]:
        """None."""
        return []
