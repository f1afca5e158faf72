# SPDX-License-Identifier: GPL-3.0-or-later
"""Area lights: squares, rectangles, discs and ellipses that shine to one side."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from bpy.types import Light, Object

from ...core.journal import Journal
from ...core.value_slots import PropertySlot, ValueSlot
from .point import PointLightType

_TWO_SIDES = ("RECTANGLE", "ELLIPSE")


@dataclass
class AreaSizeSlot:
    """Value slot: the size of an area light; its two sides keep their proportion."""

    light: Light
    locked: str

    def get(self) -> float:
        """The first side, meters."""
        return self.light.size

    def set(self, journal: Journal, raw: float) -> None:
        """Scales both sides."""
        ratio = raw / max(self.light.size, 1e-9)
        if self.light.shape in _TWO_SIDES and ratio != 1.0:
            PropertySlot(self.light, "size_y").set(journal, self.light.size_y * ratio)
        PropertySlot(self.light, "size").set(journal, raw)


class AreaLightType(PointLightType):
    """Blender's "AREA"."""

    name = "AREA"
    extent_property = "size"

    def extent_slot(self, light: Light, locked: str) -> ValueSlot:
        """Both sides at once."""
        return AreaSizeSlot(light, locked)

    def exported(self, obj: Object) -> dict[str, Any]:
        """Its shape, the proportion of its sides, its spread in radians, and the object's scale along its width."""
        data = obj.data
        aspect = data.size_y / max(data.size, 1e-9) if data.shape in _TWO_SIDES else 1.0
        width, height, _ = (max(abs(side), 1e-6) for side in obj.matrix_world.to_scale())
        aspect *= height / width
        return {"shape": data.shape, "aspect": aspect, "spread": data.spread, "scale": width}
