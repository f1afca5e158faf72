# SPDX-License-Identifier: Apache-2.0
"""From one effect of a word to a range of one parameter instance, in the parameter's unit."""

import math

from ..color.floats import lab_from_srgb, linear_from_srgb, luminance, srgb_from_lab, srgb_from_linear
from ..color.shades import hue_apart, relative_shade
from ..schema import Instance, Values
from ..words.lexicon.entries import Effect
from ..words.types import Attribute
from .color_ranges import OWN_COLOR, beyond_present, color_range, shaded
from .light_levels import Range, Sources, kelvin_color, radiance, watts

_MIDDLE = 45.0  # L* that neither brightens nor darkens; "slightly" moves towards it
_IN_PLACE_OF_KEY = Effect("world", "strength", "lightness", (62.0,), (88.0,))
_NEUTRAL, _KELVIN, _WARM_TO_COOL = 6500.0, (1200.0, 16000.0), (2700.0, 11000.0)
_LEAST_COMPONENT = 0.25  # of a glow's greatest: what lacks a color cannot be tinted to have it
_OFF_WHITE = 50.0  # degrees of hue from warm and from cool light
_AS_NAMED = (
    "azimuth", "elevation", "rotation", "ior", "base_color", "color", "specular_tint", "tint", "backdrop_color",
    "backdrop_tint",
)  # fmt: skip
"""Parameters of which there is no less and no more: directions and colors."""


def effect_range(effect: Effect, attribute: Attribute, instance: Instance, sources: Sources) -> Range:
    """The range that an effect asks for, clipped to the instance's hard bounds (never empty)."""
    if attribute.shades and effect.name in OWN_COLOR and not (effect.color or effect.mode):
        low, high = (
            linear_from_srgb(shaded(srgb_from_linear(_spread(v, instance)), attribute))
            for v in (effect.lower, effect.upper)
        )
    elif effect.color:
        low, high = color_range(effect, attribute, instance, sources)
    elif effect.name == "temperature" and instance.parameter.kind == "color":
        own = _computed_glow(instance, sources)
        shown = tuple(a * b for a, b in zip(instance.value, own, strict=True))
        low, high = _glow_color(effect, attribute.strength, shown)
    elif effect.name == "azimuth" and effect.mode in ("camera", "sides"):
        low, high = _azimuth(effect, instance, sources.scene.camera_azimuth)
    else:
        low, high = _MODES.get(effect.mode, _plain)(effect, attribute.strength, instance, sources)
    if attribute.shades and effect.name in OWN_COLOR:
        low, high = beyond_present(low, high, attribute, instance)
    if effect.name == "elevation":
        bottom, top = sources.scene.light(instance.owner).elevations
        low, high = ((min(max(v[0], bottom), top),) for v in (low, high))
    if instance.parameter.name == "emission_color" and effect.family.startswith("light/"):
        low, high = _over_glow(low, high, _computed_glow(instance, sources))
    if effect.family == "material/emission" and not effect.mode and instance.owner in sources.scene.emitters:
        computed = max(sources.scene.emitters[instance.owner].strength, 1e-3)
        low, high = (low[0] / computed,), (high[0] / computed,)
    return clip(low, high, instance)


def within(values: Values, lower: Values, upper: Values) -> Values:
    """Values, projected into a range."""
    return tuple(min(max(v, a), b) for v, a, b in zip(values, lower, upper, strict=True))


def _computed_glow(instance: Instance, sources: Sources) -> Values:
    glow = sources.scene.emitters.get(instance.owner)
    return glow.color if glow else (1.0, 1.0, 1.0)


def _over_glow(low: Values, high: Values, own: Values) -> Range:
    """The tints that turn the mean color of a computed glow into those of a range, as far as its components allow."""
    if max(own) - min(own) < 1e-3:
        return low, high
    least = _LEAST_COMPONENT * max(*own, 1e-6)
    tints = [
        tuple(w / max(v, least) for w, v in zip(wanted * (3 // len(wanted)), own, strict=True))
        for wanted in (low, high)
    ]
    top = max(tints[1])
    return tuple(v / top for v in tints[0]), tuple(v / top for v in tints[1])


def clip(low: Values, high: Values, instance: Instance) -> Range:
    """Componentwise intersection with the hard bounds; what lies outside becomes the nearest bound."""
    lower, upper = (within(_spread(end, instance), instance.lower, instance.upper) for end in (low, high))
    return lower, tuple(map(max, lower, upper))


def scaled(
    low: float, high: float, neutral: float, strength: float, bounds: tuple[float, float]
) -> tuple[float, float]:
    """A range moved towards the neutral value for "slightly", away from it for "very"; one around it stays."""
    if strength == 1.0 or (low <= neutral <= high and not (low == neutral or high == neutral)):
        return low, high
    if strength < 1.0:
        return neutral + (low - neutral) * strength, neutral + (high - neutral) * strength
    near, far = (low, high) if low >= neutral else (high, low)
    far = min(max(neutral + (far - neutral) * strength, bounds[0]), bounds[1])
    near = near + (far - near) * min(strength - 1.0, 1.0)
    return min(near, far), max(near, far)


def _spread(values: Values, instance: Instance) -> Values:
    return values * instance.parameter.components if len(values) == 1 else values


def _glow_color(effect: Effect, strength: float, color: Values) -> Range:
    """Colors of a glow between two temperatures; one of a color that no temperature has keeps it."""
    own = srgb_from_linear(tuple(v / max(*color, 1e-6) for v in color))
    vivid = all(hue_apart(own, srgb_from_linear(kelvin_color(k))) > _OFF_WHITE for k in _WARM_TO_COOL)
    ends = scaled(effect.lower[0], effect.upper[0], _NEUTRAL, strength, _KELVIN)
    tints = [kelvin_color(k) for k in ends]
    if vivid:
        tints = [tuple(a * b for a, b in zip(color, tint, strict=True)) for tint in tints]
    return tuple(map(min, *tints)), tuple(map(max, *tints))


def _plain(effect: Effect, strength: float, instance: Instance, _: Sources) -> Range:
    parameter, unit = instance.parameter, instance.reference
    if parameter.name in _AS_NAMED:
        strength = 1.0
    there, back = (math.log, math.exp) if parameter.scale.name == "log" else (float, float)
    limits = there(parameter.lower), there(parameter.upper)
    pairs = []
    for low, high in zip(effect.lower, effect.upper, strict=True):
        a, b = scaled(there(low), there(high), there(parameter.default), strength, limits)
        pairs.append((back(a) * unit, back(b) * unit))
    return tuple(a for a, _ in pairs), tuple(b for _, b in pairs)


def _times(effect: Effect, strength: float, instance: Instance, _: Sources) -> Range:
    """Multiples of the artist's value; one that is hardly above nothing counts as a little."""
    scalar, logs = instance.parameter.kind == "scalar", instance.parameter.scale.name == "log"
    least = tuple(10 * v for v in instance.lower) if logs else tuple(0.01 * v for v in instance.upper)
    floor = least if scalar else (0.0,) * len(instance.value)
    value = tuple(map(max, instance.value, floor)) if effect.lower[0] > 1 else instance.value
    low = tuple(v * a**strength for v, a in zip(value, _spread(effect.lower, instance), strict=True))
    return low, tuple(v * b**strength for v, b in zip(value, _spread(effect.upper, instance), strict=True))


def _plus(effect: Effect, strength: float, instance: Instance, _: Sources) -> Range:
    low, high = (instance.value[0] + end[0] * strength for end in (effect.lower, effect.upper))
    return (low,), (high,)


def _near(effect: Effect, strength: float, instance: Instance, _: Sources) -> Range:
    """The artist's value, moved by shares of its whole range along the perceptual scale."""
    scale = instance.parameter.scale
    bounds = list(zip(instance.value, instance.lower, instance.upper, strict=True))
    low, high = (
        tuple(scale.from_unit(scale.to_unit(v, a, b) + way, a, b) for v, a, b in bounds)
        for way in (effect.lower[0], effect.upper[0])
    )
    return low, high


def _shade(effect: Effect, strength: float, instance: Instance, _: Sources) -> Range:
    """The artist's color made lighter or darker, and more or less of a color."""
    own = srgb_from_linear(instance.value)
    corners = [
        linear_from_srgb(relative_shade(own, lighter, chroma, strength))
        for lighter in (effect.lower[0], effect.upper[0])
        for chroma in (effect.lower[1], effect.upper[1])
    ]
    return tuple(map(min, *corners)), tuple(map(max, *corners))


def _lightness(effect: Effect, strength: float, instance: Instance, sources: Sources) -> Range:
    low, high = scaled(effect.lower[0], effect.upper[0], _MIDDLE, strength, (0.5, 97.0))
    if instance.parameter.kind == "color":
        light, a, b = lab_from_srgb(srgb_from_linear(instance.value))
        shades = [
            linear_from_srgb(srgb_from_lab((goal, a * _fade(goal, light), b * _fade(goal, light))))
            for goal in (low, high)
        ]
        return tuple(map(min, *shades)), tuple(map(max, *shades))
    scene = sources.scene
    if instance.parameter.group == "world":
        scale = 1 / max(luminance(sources.world.color), 1e-3)
    else:
        scale = watts(instance, scene) * instance.reference
    scale /= 2**sources.exposure
    return (radiance(low, scene.view) * scale,), (radiance(high, scene.view) * scale,)


def _share(effect: Effect, strength: float, instance: Instance, sources: Sources) -> Range:
    """Strengths that are shares of the key's light; a world that is the only light takes the key's place."""
    if not sources.key:
        return _lightness(_IN_PLACE_OF_KEY, 1.0, instance, sources)
    if instance.parameter.group == "world":
        scale = sources.key / max(luminance(sources.world.color), 1e-3)
    else:
        scale = sources.key * watts(instance, sources.scene) * instance.reference
    return (effect.lower[0] * scale,), (effect.upper[0] * scale,)


def facing_white(instance: Instance, low: float, high: float, sources: Sources) -> Range:
    """Powers of a light at which a white surface that faces it is displayed with these L*."""
    effect = Effect("light", "power", "lightness", (low,), (high,))
    return clip(*_lightness(effect, 1.0, instance, sources), instance)


def _fade(goal: float, light: float) -> float:
    """Very dark and very light colors have little chroma."""
    return min(1.0, goal / max(light, 10.0))


def _azimuth(effect: Effect, instance: Instance, camera: float) -> Range:
    """The range nearest to the artist's value among those that mean the same direction."""
    low, high = effect.lower[0], effect.upper[0]
    sides = [(low, high)] if effect.mode == "camera" else [(low, high), (-high, -low)]
    turns = [(camera + a + 360 * k, camera + b + 360 * k) for a, b in sides for k in (-2, -1, 0, 1, 2)]
    legal = [t for t in turns if instance.lower[0] <= t[0] and t[1] <= instance.upper[0]] or turns
    value = instance.value[0]
    best = min(legal, key=lambda t: (max(t[0] - value, value - t[1], 0.0), abs(t[0] + t[1] - 2 * value)))
    return (best[0],), (best[1],)


_MODES = {
    "times": _times, "plus": _plus, "near": _near, "shade": _shade, "lightness": _lightness, "share": _share,
}  # fmt: skip
