# SPDX-License-Identifier: Apache-2.0
"""How brightly the subject is going to be lit: an albedo has to be chosen for the light that falls on it."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator

from ..color.floats import luminance
from ..schema import Instance, Values, radiometry
from ..schema.spec import Region
from .display import radiance
from .types import PlanContext

_FACING = 0.45  # mean cosine over the lit side, times the share of what is seen that is lit
_MIRRORED = 0.05  # of a dielectric at an index of 1.5, grazing angles included
_PUREST = 0.3  # share of white light that the weakest component of colored light is taken to have
_MIRED = (0.0029, -0.0009, -0.0072)
"""By how much the logarithms of warm light's red, green and blue grow per mired (1e6 / K): about `color.blackbody`."""
_WHITE: Values = (1.0, 1.0, 1.0)
_OPEN = 0.8  # what occlusion leaves of the world's light

Value = Callable[[Instance], Values]


def watts(instance: Instance, context: PlanContext) -> float:
    """What `power` (per d^2), `strength` or `emission` makes a facing white surface's radiance 1, at the light's own exposure."""
    if instance.parameter.group == "material":
        glow = context.glows[instance.owner]
        return 1.0 / max(glow.light * glow.strength, 1e-6)
    sun = instance.parameter.name == "strength"
    stops = context.light_stops.get(instance.owner, 0.0)
    light_type = "SUN" if sun else context.light_types.get(instance.owner, "AREA")
    return radiometry.unit_energy(light_type) / 2**stops


def white_radiance(instances: dict[str, Instance], context: PlanContext, value: Value) -> float:
    """Radiance, after exposure, that a white subject has on average, from the lights and the world alone."""
    total = _FACING * facing_radiance(instances, context, value)
    return total * _exposed(instances, value) + _OPEN * world_radiance(instances, context, value)


def facing_radiance(
    instances: dict[str, Instance], context: PlanContext, value: Value, lights: Collection[str] | None = None
) -> float:
    """Radiance, before exposure, of a white surface that faces these lights, or all of them.

    A glowing material is the light "material/NAME".
    """
    lamps = _lamps(instances, context, value)
    return sum(luminance(gel) * bright for name, gel, bright in lamps if lights is None or name in lights)


def warmth(instances: dict[str, Instance], context: PlanContext, value: Value) -> Values:
    """The color, of luminance 1, that the temperatures of the lamps give to the light, the world's being white."""
    parts = [(_OPEN * world_radiance(instances, context, value) / _exposed(instances, value), _WHITE)]
    for name, gel, bright in _lamps(instances, context, value):
        temperature = instances.get(f"light/{name}/temperature")
        mireds = 1e6 / value(temperature)[0] - 1e6 / 6500.0 if temperature else 0.0
        tint = _tint(mireds)
        parts.append((_FACING * bright * luminance(gel), tint))
    return _mixed(parts)


def kelvin_color(kelvin: float) -> Values:
    """The linear color of light of a temperature, its largest component 1."""
    tint = _tint(1e6 / kelvin - 1e6 / 6500.0)
    return tuple(v / max(tint) for v in tint)


def _tint(mireds: float) -> Values:
    return tuple(math.exp(m * mireds) for m in _MIRED)


def _mixed(parts: list[tuple[float, Values]]) -> Values:
    """The color, of luminance 1, of light that comes in parts: how much of it, and its color."""
    total = [sum(amount * color[i] for amount, color in parts) for i in range(3)]
    level = luminance(total)
    return tuple(v / level for v in total) if level > 1e-3 else _WHITE


def _lamps(
    instances: dict[str, Instance], context: PlanContext, value: Value
) -> Iterator[tuple[str, Values, float]]:
    """Name and gel of every light, and the radiance of a white surface that faces it without the gel."""
    for instance in instances.values():
        if instance.parameter.group == "light" and instance.parameter.name in ("power", "strength"):
            color = instances.get(f"light/{instance.owner}/color")
            gel = value(color) if color else (1.0, 1.0, 1.0)
            yield instance.owner, gel, value(instance)[0] / (watts(instance, context) * instance.reference)
    for material, glow in context.glows.items():
        strength, color = (instances.get(f"material/{material}/{n}") for n in ("emission", "emission_color"))
        if strength:
            over = value(color) if color else _WHITE
            gel = tuple(a * b for a, b in zip(over, glow.color, strict=True))
            yield f"material/{material}", gel, value(strength)[0] * glow.strength * glow.light


def world_radiance(instances: dict[str, Instance], context: PlanContext, value: Value) -> float:
    """Radiance of the world after exposure; the mean of a linked environment."""
    strength = instances.get("world/strength")
    if strength is None:
        return 0.0
    color, tint = instances.get("world/color"), instances.get("world/tint")
    world = luminance(value(color)) if color else context.environment_luminance
    world *= luminance(value(tint)) if tint else 1.0
    return world * value(strength)[0] * _exposed(instances, value)


def cast(instances: dict[str, Instance], context: PlanContext, value: Value) -> Values:
    """The color, of luminance 1, of the light that falls on the scene, by gels and the world: eyes are used to warm and cool lamps."""
    parts = [(_FACING * bright, gel) for _, gel, bright in _lamps(instances, context, value)]
    color, strength = instances.get("world/color"), instances.get("world/strength")
    if color and strength:
        parts.append((_OPEN * value(strength)[0], value(color)))
    return tuple(max(v, _PUREST) for v in _mixed(parts))


def _exposed(instances: dict[str, Instance], value: Value) -> float:
    return 2 ** sum(
        value(i)[0] for i in instances.values() if i.parameter.name in ("exposure", "grade_exposure")
    )


def veil(material: str, instances: dict[str, Instance], context: PlanContext, value: Value) -> float:
    """White light that a dielectric mirrors from the world all over, which bleaches its color."""
    layers = 0.0
    for name, neutral in (("specular", 0.5), ("coat", 1.0)):
        instance = instances.get(f"material/{material}/{name}")
        layers += _MIRRORED * value(instance)[0] / neutral if instance else 0.0
    return layers * world_radiance(instances, context, value)


def expected(
    region: Region, materials: list[str], instances: dict[str, Instance], context: PlanContext, planned: Value
) -> float:
    """Radiance that a white surface of a region is going to have on the display side of exposure.

    From the lights; where there is a picture, its measured lightness over its albedo calibrates that.
    """
    future = white_radiance(instances, context, planned)
    shown = context.picture.lab.get(region) if context.picture else None
    albedos = [a for name in materials if (a := _albedo(name, instances, context)) is not None]
    mirrored = [
        veil(name, instances, context, lambda i: context.values.get(i.key, i.value)) for name in materials
    ]
    if shown is None or not albedos or sum(albedos) / len(albedos) < 0.05:
        return future

    def current(instance: Instance) -> Values:
        return context.values.get(instance.key, instance.value)

    matte = radiance(shown[0], context.view) - sum(mirrored) / len(mirrored)
    measured = max(matte, 0.02) / (sum(albedos) / len(albedos))
    return measured * future / max(white_radiance(instances, context, current), 1e-4)


def _albedo(material: str, instances: dict[str, Instance], context: PlanContext) -> float | None:
    """Luminance of a diffuse material's current color; None for metals and glass, which have none."""

    def now(name: str, missing: float) -> Values:
        instance = instances.get(f"material/{material}/{name}")
        return context.values.get(instance.key, instance.value) if instance else (missing,)

    if now("metallic", 0.0)[0] > 0.4 or now("transmission", 0.0)[0] > 0.4 or now("emission", 0.0)[0] > 0.05:
        return None
    if f"material/{material}/base_color" in instances:
        return luminance(now("base_color", 0.5))
    tint = now("tint", 1.0)
    return luminance(tint) * context.texture_luminance.get(material, 0.4) if len(tint) == 3 else None
