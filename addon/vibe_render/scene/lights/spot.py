# SPDX-License-Identifier: GPL-3.0-or-later
"""Spot lights: points that shine into a cone."""

from __future__ import annotations

from typing import Any

from bpy.types import Object

from .point import PointLightType

_ROUND = 0.01  # difference of the sides' scales, in parts, up to which a cone counts as round


class SpotLightType(PointLightType):
    """Blender's "SPOT"."""

    name = "SPOT"

    def exported(self, obj: Object) -> dict[str, Any]:
        """The cone: its opening in radians, and the part of it over which its edge fades."""
        return {"spot_size": obj.data.spot_size, "spot_blend": obj.data.spot_blend}

    def approximations(self, obj: Object) -> list[str]:
        """A cone that is not round."""
        scale = obj.matrix_world.to_scale()
        if abs(scale.x - scale.y) > _ROUND * abs(scale.x):
            return [f"{obj.name} is scaled unevenly; the prediction shows a round cone."]
        return []
