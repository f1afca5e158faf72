# SPDX-License-Identifier: GPL-3.0-or-later
"""The light types that the add-on knows: the only list of them."""

from __future__ import annotations

from bpy.types import Object

from ...core.schema_import import schema
from .area import AreaLightType
from .light_type import LightType
from .point import PointLightType
from .spot import SpotLightType
from .sun import SunLightType

_TYPES: tuple[LightType, ...] = (PointLightType(), SpotLightType(), AreaLightType(), SunLightType())
LIGHT_TYPES: dict[str, LightType] = {each.name: each for each in _TYPES}
"""By Blender's names."""


def light_type(name: str) -> LightType:
    """The type of that name.

    Raises:
        VibeError: There is none.
    """
    if name not in LIGHT_TYPES:
        raise schema.VibeError(
            f'Lights of type "{name}" are unknown to Vibe Render.', f"Use one of {', '.join(LIGHT_TYPES)}."
        )
    return LIGHT_TYPES[name]


def type_of(obj: Object) -> LightType:
    """The type of a light object.

    Raises:
        VibeError: It is unknown.
    """
    return light_type(obj.data.type)
