# SPDX-License-Identifier: Apache-2.0
"""The types of light that the renderer knows. A new one is a file beside these and a row in `LIGHT_TYPES`."""

from __future__ import annotations

from ....scene import SceneData
from ....scene.values import RenderValues
from ....schema import VibeError
from .area import AreaLight
from .light_source import LightSource
from .point import PointLight
from .spot import SpotLight
from .sun import SunLight

LIGHT_TYPES: dict[str, type[LightSource]] = {
    "AREA": AreaLight,
    "POINT": PointLight,
    "SUN": SunLight,
    "SPOT": SpotLight,
}
"""Blender's name of a light type to its class."""


def light_type(name: str) -> type[LightSource]:
    """The class of a light type.

    Raises:
        VibeError: The renderer has no such type.
    """
    if name not in LIGHT_TYPES:
        raise VibeError(
            f'Lights of type "{name}" cannot be rendered.', f"Use one of {', '.join(sorted(LIGHT_TYPES))}."
        )
    return LIGHT_TYPES[name]


def light_sources(scene: SceneData, values: RenderValues) -> list[LightSource]:
    """All lights of the scene at the render's values.

    Raises:
        VibeError: The scene has a light of an unknown type.
    """
    return [light_type(light.type).of(light, scene, values) for light in scene.lights]
