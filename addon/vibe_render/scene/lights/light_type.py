# SPDX-License-Identifier: GPL-3.0-or-later
"""What the add-on asks of a type of light."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from bpy.types import Light, Object
from mathutils import Matrix, Vector

from ...core.value_slots import ValueSlot


@dataclass(frozen=True)
class LightExtent:
    """A way to say how large a light is: the larger, the softer its shadows.

    Attributes:
        parameter: The schema's name of it.
        to_angle: From a value per distance to the angle that the light fills, degrees.
        from_angle: The inverse.
    """

    parameter: str
    to_angle: Callable[[float], float]
    from_angle: Callable[[float], float]


def _angle(size: float) -> float:
    return math.degrees(2 * math.atan(size / 2))


def _size(angle: float) -> float:
    return 2 * math.tan(math.radians(min(angle, 170.0)) / 2)


SIZE = LightExtent("size", _angle, _size)
"""Of lights at a distance."""
ANGLE = LightExtent("angle", float, float)
"""Of lights at infinity."""
EXTENTS = (SIZE, ANGLE)


class LightType(Protocol):
    """A type of light. A new one is a class in a module of its own and a line in the registry.

    Attributes:
        name: Blender's name: the `type` of the light's data-block.
        energy: The schema's name of its energy: "power" (W) or "strength" (W/m²).
        extent: How the schema says how large it is.
        extent_property: The property of the data-block that holds that.
    """

    name: str
    energy: str
    extent: LightExtent
    extent_property: str

    def offset(self, obj: Object, pivot: Vector, rotation: Matrix) -> Vector:
        """A vector from the pivot toward where the light comes from, world space; it gives the orbit's angles.

        Args:
            rotation: The light's, 3x3.
        """

    @property
    def has_position(self) -> bool:
        """Whether its position matters; of a light at infinity only the direction does."""

    def extent_slot(self, light: Light, locked: str) -> ValueSlot:
        """The slot of how large it is.

        Args:
            locked: Why it must be left alone; "" where it may change.
        """

    def exported(self, obj: Object) -> dict[str, Any]:
        """What its entry in scene.json has besides what every light has."""

    def approximations(self, obj: Object) -> list[str]:
        """What the prediction shows differently, in words for the artist."""
