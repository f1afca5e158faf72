# SPDX-License-Identifier: GPL-3.0-or-later
"""Suns: light from infinitely far away, of which only the direction matters."""

from __future__ import annotations

from typing import Any

from bpy.types import Light, Object
from mathutils import Matrix, Vector

from ...core.value_slots import PropertySlot, ValueSlot
from .light_type import ANGLE


class SunLightType:
    """Blender's "SUN"."""

    name = "SUN"
    energy = "strength"
    extent = ANGLE
    extent_property = "angle"
    has_position = False

    def offset(self, obj: Object, pivot: Vector, rotation: Matrix) -> Vector:
        """Against the way that it shines, wherever the object stands."""
        return rotation.col[2]

    def extent_slot(self, light: Light, locked: str) -> ValueSlot:
        """Its angular diameter, radians."""
        return PropertySlot(light, self.extent_property, locked)

    def exported(self, obj: Object) -> dict[str, Any]:
        """Nothing more."""
        return {}

    def approximations(self, obj: Object) -> list[str]:
        """None."""
        return []
