# SPDX-License-Identifier: Apache-2.0
"""The radiance of a white surface that faces the lights, and the lightness with which the view transform displays it."""

import math
from bisect import bisect_left
from collections.abc import Callable, Collection
from dataclasses import dataclass

from ..color.floats import luminance
from ..schema import Instance, Values, radiometry
from ..words.types import SceneDescription

# View transform -> L* on an sRGB display of the grays, measured on Blender's own OCIO config; others as AgX.
_GRAYS = (0.005, 0.01, 0.02, 0.05, 0.1, 0.18, 0.3, 0.5, 0.8, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 10.0)
_LIGHTNESS = {
    "AgX": (2.4, 5.7, 12.2, 24.4, 36.9, 49.5, 60.3, 69.5, 76.5, 79.4, 83.9, 86.8, 90.2, 92.3, 95.0, 97.8),
    "Filmic": (4.6, 9.2, 16.4, 29.6, 42.0, 53.4, 63.2, 72.3, 79.6, 82.7, 87.6, 90.4, 93.7, 95.5, 97.5, 99.1),
    "Standard": (4.5, 9.0, 15.5, 26.7, 37.8, 49.5, 61.7, 76.1, 91.7, 99.0, 99.2, 99.4, 99.6, 99.7, 99.8, 99.9),
    "Khronos PBR Neutral": (
        0.1, 0.6, 2.3, 13.2, 29.5, 44.4, 58.2, 73.8, 89.5, 94.4, 97.5, 98.4, 99.1, 99.3, 99.6, 99.8,
    ),
}  # fmt: skip


def radiance(lightness: float, view: str) -> float:
    """The scene-linear gray that a view transform displays with L* = `lightness` (clamped to [0.5, 98])."""
    curve = _LIGHTNESS.get(view, _LIGHTNESS["AgX"])
    lightness = min(max(lightness, 0.5), 98.0)
    if lightness <= curve[0]:
        return _GRAYS[0] * lightness / curve[0]
    if lightness >= curve[-1]:
        return _GRAYS[-1]
    i = bisect_left(curve, lightness)
    t = (lightness - curve[i - 1]) / (curve[i] - curve[i - 1])
    return math.exp(math.log(_GRAYS[i - 1]) + t * (math.log(_GRAYS[i]) - math.log(_GRAYS[i - 1])))


Range = tuple[Values, Values]


@dataclass(frozen=True)
class WorldLook:
    """The world at strength 1: its mean color, linear, and the mean luminance of its linked image (1 for a plain color)."""

    color: Values = (1.0, 1.0, 1.0)
    picture: float = 1.0


@dataclass(frozen=True)
class Sources:
    """Facts about the scene and its light that ranges are computed from, in addition to the effect."""

    scene: SceneDescription
    exposure: float = 0.0  # stops between the scene's radiance and the view transform, by the artist's values
    world: WorldLook = WorldLook()  # the world's look by the ranges that are decided so far
    backdrop: WorldLook = WorldLook()  # the same for the backdrop, if there is one; else the world
    own_color: Values = (1.0, 1.0, 1.0)  # sRGB of the color that a material gets or has, for its glow
    key: float = 0.0  # radiance, before exposure, of a white surface that faces the key; 0 without one


Value = Callable[[Instance], Values]
_WHITE: Values = (1.0, 1.0, 1.0)


def watts(instance: Instance, scene: SceneDescription) -> float:
    """The `power` (per m² of distance), `strength` or `emission` by which a white surface facing it has radiance 1."""
    if instance.parameter.group == "material":
        glow = scene.emitters[instance.owner]
        return 1.0 / max(glow.light * glow.strength, 1e-6)
    sun = instance.parameter.name == "strength"
    light = scene.light(instance.owner)
    return radiometry.unit_energy("SUN" if sun else light.type or "AREA") / 2**light.stops


def facing_radiance(
    instances: dict[str, Instance], scene: SceneDescription, value: Value, lights: Collection[str] | None = None
) -> float:
    """Radiance, before exposure, of a white surface that faces all the named `lights`; None: all lights and glows.

    The name of a glow is "material/NAME". `value` gives the value of an instance.
    """
    found = {}
    for instance in instances.values():
        if instance.parameter.group == "light" and instance.parameter.name in ("power", "strength"):
            color = instances.get(f"light/{instance.owner}/color")
            shed = value(instance)[0] / (watts(instance, scene) * instance.reference)
            found[instance.owner] = luminance(value(color) if color else _WHITE) * shed
    for material, glow in scene.emitters.items():
        strength, color = (instances.get(f"material/{material}/{n}") for n in ("emission", "emission_color"))
        if strength:
            over = value(color) if color else _WHITE
            own = tuple(a * b for a, b in zip(over, glow.color, strict=True))
            found[f"material/{material}"] = luminance(own) * value(strength)[0] * glow.strength * glow.light
    return sum(bright for name, bright in found.items() if lights is None or name in lights)


def kelvin_color(kelvin: float) -> Values:
    """The linear RGB color of light of a temperature in kelvins, scaled to a largest component of 1."""
    mireds = 1e6 / kelvin - 1e6 / 6500.0
    tint = [math.exp(growth * mireds) for growth in (0.0029, -0.0009, -0.0072)]
    return tuple(v / max(tint) for v in tint)
