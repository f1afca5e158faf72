# SPDX-License-Identifier: Apache-2.0
"""From one effect of a word to a range of one parameter instance, in the parameter's unit."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..schema import Instance, Values
from .color import chroma, from_hex, from_lab, luminance, to_lab, to_linear, to_srgb
from .illumination import watts
from .meaning import fog_color
from .types import Attribute, PlanContext
from .view import radiance, reachable
from .vocabulary import Effect, default_vocabulary

Range = tuple[Values, Values]
_MIDDLE = 45.0  # L* that neither brightens nor darkens; "slightly" moves towards it
_DIRECTIONS = ("azimuth", "elevation", "rotation")
_BLACKEST, _WHITEST = 0.006, 0.85  # no real surface reflects less, or more
_BRIGHTEST = 2.5  # radiance of a backdrop that has a color
_DARK = 0.02  # radiance below which a backdrop is black
_BOX = 0.06  # half the width of a color's box, in steps that look even


@dataclass(frozen=True)
class Sources:
    """What ranges are computed from besides the effect itself.

    Attributes:
        context: The scene and its current picture.
        exposure: Stops between the scene's radiance and the view transform, as the artist has them.
        world_color: Linear color of the world that the plan settles on, strength 1.
        own_color: sRGB of the color that the material gets or has, for glows.
        illumination: Radiance, after exposure, of a white surface where the effect acts.
        veil: Radiance that the surface mirrors all over, whatever its color.
        environment: Whether the world is a linked picture.
    """

    context: PlanContext
    exposure: float = 0.0
    world_color: Values = (1.0, 1.0, 1.0)
    own_color: Values = (1.0, 1.0, 1.0)
    illumination: float = 1.0
    veil: float = 0.0
    environment: bool = False


def effect_range(effect: Effect, attribute: Attribute, instance: Instance, sources: Sources) -> Range:
    """The range that an effect asks for, clipped to the instance's hard bounds (never empty)."""
    if effect.color:
        low, high = _color_range(effect, attribute, instance, sources)
    elif effect.name == "azimuth" and effect.mode in ("camera", "sides"):
        low, high = _azimuth(effect, instance, sources.context.camera_azimuth)
    else:
        mode = {"times": _times, "plus": _plus, "lightness": _lightness, "aim": _aim}.get(effect.mode, _plain)
        low, high = mode(effect, attribute.strength, instance, sources)
    return clip(low, high, instance)


def clip(low: Values, high: Values, instance: Instance) -> Range:
    """Componentwise intersection with the hard bounds; what lies outside becomes the nearest bound."""
    pairs = list(
        zip(_spread(low, instance), _spread(high, instance), instance.lower, instance.upper, strict=True)
    )
    lower = tuple(min(max(a, bottom), top) for a, _, bottom, top in pairs)
    upper = tuple(min(max(b, bottom), top) for _, b, bottom, top in pairs)
    return lower, tuple(map(max, lower, upper))


def scaled(
    low: float, high: float, neutral: float, strength: float, bounds: tuple[float, float]
) -> tuple[float, float]:
    """Moves a range towards the neutral value for "slightly", away from it for "very".

    Monotone in `strength`; a range around the neutral value stays as it is.
    """
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


def _plain(effect: Effect, strength: float, instance: Instance, _: Sources) -> Range:
    parameter, unit = instance.parameter, instance.reference
    if parameter.name in _DIRECTIONS or parameter.name in (
        "ior",
        "base_color",
        "color",
        "specular_tint",
        "tint",
    ):
        strength = 1.0
    bounds = (parameter.lower, parameter.upper)
    logs = parameter.scale.name == "log"
    there, back = (math.log, math.exp) if logs else (float, float)
    pairs = []
    for low, high in zip(effect.lower, effect.upper, strict=True):
        limits = there(bounds[0]), there(bounds[1])
        a, b = scaled(there(low), there(high), there(parameter.default), strength, limits)
        pairs.append((back(a) * unit, back(b) * unit))
    return tuple(a for a, _ in pairs), tuple(b for _, b in pairs)


def _times(effect: Effect, strength: float, instance: Instance, _: Sources) -> Range:
    """Multiples of the artist's value; a value too small to multiply counts as a hundredth of the upper bound."""
    floor = [u * (0.01 if instance.parameter.kind == "scalar" else 0.0) for u in instance.upper]
    value = tuple(map(max, instance.value, floor)) if effect.lower[0] > 1 else instance.value
    low = tuple(v * a**strength for v, a in zip(value, _spread(effect.lower, instance), strict=True))
    return low, tuple(v * b**strength for v, b in zip(value, _spread(effect.upper, instance), strict=True))


def _plus(effect: Effect, strength: float, instance: Instance, _: Sources) -> Range:
    return (instance.value[0] + effect.lower[0] * strength,), (
        instance.value[0] + effect.upper[0] * strength,
    )


def _lightness(effect: Effect, strength: float, instance: Instance, sources: Sources) -> Range:
    low, high = scaled(effect.lower[0], effect.upper[0], _MIDDLE, strength, (0.5, 97.0))
    if instance.parameter.kind == "color":
        light, a, b = to_lab(to_srgb(instance.value))
        shades = [
            to_linear(from_lab((goal, a * _fade(goal, light), b * _fade(goal, light))))
            for goal in (low, high)
        ]
        return tuple(map(min, *shades)), tuple(map(max, *shades))
    context = sources.context
    if instance.parameter.group == "world":
        scale = 1 / max(luminance(sources.world_color), 1e-3)
    else:
        scale = watts(instance, context) * instance.reference
    scale /= 2**sources.exposure
    return (radiance(low, context.view) * scale,), (radiance(high, context.view) * scale,)


def facing_white(instance: Instance, low: float, high: float, sources: Sources) -> Range:
    """Powers of a light at which a white surface that faces it is displayed with these L*."""
    return clip(
        *_lightness(Effect("light", "power", "lightness", (low,), (high,)), 1.0, instance, sources), instance
    )


def _fade(goal: float, light: float) -> float:
    """Very dark and very light colors have little chroma."""
    return min(1.0, goal / max(light, 10.0))


def _aim(effect: Effect, strength: float, instance: Instance, sources: Sources) -> Range:
    """Stops that bring the subject's mean lightness (or the picture's median) into the range."""
    context = sources.context
    now, current = 50.0, context.values.get(instance.key, instance.value)[0]
    if context.picture and "subject" in context.picture.lab:
        now = context.picture.lab["subject"][0]
    elif context.picture and context.picture.percentiles:
        now = context.picture.percentiles[1]
    low, high = scaled(effect.lower[0], effect.upper[0], 50.0, strength, (2.0, 94.0))
    stops = [
        current + math.log2(radiance(goal, context.view) / radiance(now, context.view))
        for goal in (low, high)
    ]
    # A black subject is not made white: exposure stays within three stops of the artist's.
    kept = [min(max(s, instance.value[0] - 3.0), instance.value[0] + 3.0) for s in stops]
    return (kept[0],), (kept[1],)


def _azimuth(effect: Effect, instance: Instance, camera: float) -> Range:
    """The range nearest to the artist's value among those that mean the same direction."""
    low, high = effect.lower[0], effect.upper[0]
    sides = [(low, high)] if effect.mode == "camera" else [(low, high), (-high, -low)]
    turns = [(camera + a + 360 * k, camera + b + 360 * k) for a, b in sides for k in (-2, -1, 0, 1, 2)]
    legal = [t for t in turns if instance.lower[0] <= t[0] and t[1] <= instance.upper[0]] or turns
    value = instance.value[0]
    best = min(legal, key=lambda t: (max(t[0] - value, value - t[1], 0.0), abs(t[0] + t[1] - 2 * value)))
    return (best[0],), (best[1],)


# ---- colors


def _color_range(effect: Effect, attribute: Attribute, instance: Instance, sources: Sources) -> Range:
    srgb, view = _named(effect, attribute, sources), sources.context.view
    if effect.mode == "shown" and instance.parameter.kind == "scalar":
        return _shown_strength(srgb, instance, sources)
    if effect.mode == "cast":
        cast = _cast(to_linear(srgb), 0.06 if instance.parameter.name == "lift" else 0.16)
        return tuple(v - 0.02 for v in cast), tuple(v + 0.02 for v in cast)
    if effect.mode == "gel":
        linear = _gel(to_linear(srgb), 0.9)
    elif effect.mode == "albedo":
        linear = _fog_albedo(srgb)
    elif effect.mode == "shown":
        linear = reachable(srgb, view, _BRIGHTEST)
        linear = tuple(v / max(linear) for v in linear) if max(linear) > _DARK else linear
    else:
        linear = _surface(srgb, view, sources.illumination, sources.veil)
    if instance.parameter.family == "material/tint":
        texture = max(sources.context.texture_luminance.get(instance.owner, 0.4), 0.02)
        linear = tuple(v / texture for v in linear)
    if attribute.strength < 0.8:
        linear = tuple(a + (b - a) * attribute.strength for a, b in zip(instance.value, linear, strict=True))
    return _box(linear)


def _surface(srgb: Values, view: str, illumination: float, veil: float) -> Values:
    """The albedo that is displayed as a color under the light that is going to fall on it."""
    if to_lab(srgb)[0] > 93:
        return (_WHITEST,) * 3 if chroma(to_lab(srgb)) < 4 else tuple(_WHITEST * v for v in to_linear(srgb))
    light = min(max(illumination, 0.6), 4.0)
    wanted = reachable(srgb, view, _WHITEST * light)
    albedo = tuple(max(v - veil, 0.4 * v) / light for v in wanted)
    return tuple(min(max(v, _BLACKEST), _WHITEST) for v in albedo)


def _named(effect: Effect, attribute: Attribute, sources: Sources) -> Values:
    if effect.color == "@":
        return attribute.color or (0.5, 0.5, 0.5)
    if effect.color == "own":
        return sources.own_color
    return (
        from_hex(effect.color) if effect.color.startswith("#") else default_vocabulary().colors[effect.color]
    )


def _box(linear: Values) -> Range:
    """All that looks about like a linear color: even steps of `_BOX` on the screen's scale."""
    shown = [max(v, 0.0) ** (1 / 2.2) for v in linear]
    return tuple(max(v - _BOX, 0.0) ** 2.2 for v in shown), tuple((v + _BOX) ** 2.2 for v in shown)


def _gel(linear: Values, purity: float) -> Values:
    """The color with its largest component at 1, and not fully saturated: filters and fog never are."""
    top = max(linear)
    return tuple(1 - purity * (1 - v / top) for v in linear) if top > 0.01 else (1.0, 1.0, 1.0)


def _fog_albedo(srgb: Values) -> Values:
    """Fog scatters many times: it is paler and much brighter than the color it is named for."""
    pale = to_linear(fog_color(srgb))
    darkness = min(luminance(to_linear(srgb)) * 12 + 0.25, 0.95)  # black fog is smoke
    return tuple(v * darkness / max(pale) for v in pale)


def _cast(linear: Values, amount: float) -> Values:
    gel = _gel(linear, 1.0)
    mean = sum(gel) / 3
    return tuple(1 + amount * (v - mean) / max(mean, 0.2) for v in gel)


def _shown_strength(srgb: Values, instance: Instance, sources: Sources) -> Range:
    """Strength at which a world of the "shown" color looks as named; white as white, not grey."""
    context = sources.context
    if to_lab(srgb)[0] > 93:
        ends = tuple(radiance(goal, context.view) for goal in (88.0, 93.0))
    else:
        bright = max(reachable(srgb, context.view, _BRIGHTEST))
        ends = (0.8 * bright, 1.25 * bright) if bright > _DARK else (0.0, 1.0)
    environment = context.environment_luminance if sources.environment else 1.0
    return tuple((min(v / 2**sources.exposure / environment, 10.0),) for v in ends)  # type: ignore[return-value]
