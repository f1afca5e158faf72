# SPDX-License-Identifier: Apache-2.0
"""How much light lamps and glowing materials give to a white surface that faces them, in the artist's units."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection

from ...color.floats import luminance
from ...prompt.types import SceneDescription
from ...schema import Instance, Values, radiometry

_MIRED = (0.0029, -0.0009, -0.0072)
"""By how much the logarithms of warm light's red, green and blue grow per mired (1e6 / K): about `color.blackbody`."""
_WHITE: Values = (1.0, 1.0, 1.0)

Value = Callable[[Instance], Values]


def watts(instance: Instance, scene: SceneDescription) -> float:
    """What `power` (per d^2), `strength` or `emission` makes a facing white surface's radiance 1, at the light's own exposure."""
    if instance.parameter.group == "material":
        glow = scene.emitters[instance.owner]
        return 1.0 / max(glow.light * glow.strength, 1e-6)
    sun = instance.parameter.name == "strength"
    light = scene.light(instance.owner)
    return radiometry.unit_energy("SUN" if sun else light.type or "AREA") / 2**light.stops


def facing_radiance(
    instances: dict[str, Instance],
    scene: SceneDescription,
    value: Value,
    lights: Collection[str] | None = None,
) -> float:
    """Radiance, before exposure, of a white surface that faces these lights, or all of them.

    A glowing material is the light "material/NAME".
    """
    sources = _lamps(instances, scene, value) | _glows(instances, scene, value)
    return sum(bright for name, bright in sources.items() if lights is None or name in lights)


def _lamps(instances: dict[str, Instance], scene: SceneDescription, value: Value) -> dict[str, float]:
    """Lamp -> the radiance of a white surface that faces it."""
    found = {}
    for instance in instances.values():
        if instance.parameter.group == "light" and instance.parameter.name in ("power", "strength"):
            color = instances.get(f"light/{instance.owner}/color")
            shed = value(instance)[0] / (watts(instance, scene) * instance.reference)
            found[instance.owner] = luminance(value(color) if color else _WHITE) * shed
    return found


def _glows(instances: dict[str, Instance], scene: SceneDescription, value: Value) -> dict[str, float]:
    """The same of glowing materials."""
    found = {}
    for material, glow in scene.emitters.items():
        strength, color = (instances.get(f"material/{material}/{n}") for n in ("emission", "emission_color"))
        if strength:
            over = value(color) if color else _WHITE
            own = tuple(a * b for a, b in zip(over, glow.color, strict=True))
            found[f"material/{material}"] = luminance(own) * value(strength)[0] * glow.strength * glow.light
    return found


def kelvin_color(kelvin: float) -> Values:
    """The linear color of light of a temperature, its largest component 1."""
    mireds = 1e6 / kelvin - 1e6 / 6500.0
    tint = [math.exp(m * mireds) for m in _MIRED]
    return tuple(v / max(tint) for v in tint)
